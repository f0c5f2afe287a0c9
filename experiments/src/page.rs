//! Tables in Markdown, and pages whose tables are renewed by the runs that they show.
//!
//! ```text
//! <!-- block crossing-tracker -->      all between the two lines is replaced
//! <!-- end -->
//! ```

use anyhow::{Context, bail};
use serde_json::Value;

use crate::Row;

/// A piece of a page that comes from results.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Block {
    /// Its place in the page.
    pub name: &'static str,
    /// Markdown.
    pub text: String,
}

impl Block {
    /// A table; every line has as many cells as the head.
    pub fn table(name: &'static str, head: &[&str], lines: &[Vec<String>]) -> Self {
        let row = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
        let head: Vec<String> = head.iter().map(ToString::to_string).collect();
        let rule: Vec<String> = head.iter().map(|_| "---".into()).collect();
        let body: String = lines.iter().map(|line| row(line)).collect();
        Self { name, text: row(&head) + &row(&rule).replace(' ', "") + &body }
    }

    /// Sentences, one item each.
    pub fn list(name: &'static str, items: &[String]) -> Self {
        Self { name, text: items.iter().fold(String::new(), |text, item| text + "- " + item + "\n") }
    }
}

/// The page with these blocks in it.
///
/// # Errors
/// If a block has no place in the page, or its place no end.
pub fn renew(page: &str, blocks: &[Block]) -> anyhow::Result<String> {
    let mut page = page.to_string();
    for block in blocks {
        let begin = format!("<!-- block {} -->\n", block.name);
        let Some(from) = page.find(&begin).map(|at| at + begin.len()) else {
            bail!("no place for block {}: expected a line `{}`", block.name, begin.trim_end());
        };
        let length = page[from..].find("<!-- end -->").with_context(|| {
            format!("the place of block {} has no end: expected a line `<!-- end -->` after it", block.name)
        })?;
        page.replace_range(from..from + length, &format!("\n{}\n", block.text));
    }
    Ok(page)
}

/// The row of a metric whose case has these parameters, whatever others it has.
pub fn find<'a>(rows: &'a [Row], metric: &str, parameters: &[(&str, Value)]) -> Option<&'a Row> {
    rows.iter()
        .find(|row| row.metric == metric && parameters.iter().all(|(key, value)| row.case.get(key) == Some(value)))
}

/// `0.39 [0.29, 0.50]`, with the reference in brackets behind it if there is one; a dash without a row or a figure.
pub fn figure(row: Option<&Row>, decimals: usize) -> String {
    let Some(row) = row.filter(|row| row.value.is_finite()) else { return "–".into() };
    let number = |x: f64| if x.is_finite() { format!("{x:.decimals$}").replace('-', "−") } else { "∞".into() };
    let reference = row.reference.map(|reference| format!(" ({})", number(reference))).unwrap_or_default();
    format!("{} [{}, {}]{reference}", number(row.value), number(row.lo), number(row.hi))
}

/// F as a power of ten: `10⁻³`.
pub fn power_of_ten(pfa: f64) -> String {
    let digits = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let exponent = -pfa.log10().round();
    digits.get(exponent as usize).map_or_else(|| format!("{pfa:e}"), |digit| format!("10⁻{digit}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Case;

    #[test]
    fn blocks_replace_what_was_there() {
        let page = "a\n<!-- block one -->\nold\n<!-- end -->\nb\n<!-- block two -->\n<!-- end -->\n";
        let one = Block::table("one", &["F", "p"], &[vec!["1".into(), "2".into()]]);
        let two = Block::list("two", &["it is".into()]);
        let renewed = renew(page, &[one.clone(), two.clone()]).expect("places");
        assert_eq!(
            renewed,
            "a\n<!-- block one -->\n\n| F | p |\n|---|---|\n| 1 | 2 |\n\n<!-- end -->\nb\n<!-- block two -->\n\n- it is\n\n<!-- end -->\n"
        );
        assert_eq!(renew(&renewed, &[two, one]).expect("places"), renewed);
        let homeless = renew(page, &[Block::list("three", &[])]).expect_err("no place").to_string();
        assert!(homeless.contains("<!-- block three -->"), "{homeless}");
    }

    #[test]
    fn figures_have_their_interval_and_reference() {
        let row = Row::proportion(&Case::new().with("pfa", 0.1), "p_loss", 500, 1000);
        assert_eq!(figure(Some(&row), 3), "0.500 [0.469, 0.531]");
        assert_eq!(figure(Some(&row.clone().against(0.51, "x")), 2), "0.50 [0.47, 0.53] (0.51)");
        assert_eq!((figure(None, 2), power_of_ten(1e-4)), ("–".into(), "10⁻⁴".into()));
        assert!(find(&[row], "p_loss", &[("pfa", 0.1.into())]).is_some());
    }
}
