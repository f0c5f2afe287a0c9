//! A specification as a table in Rust.

use std::fmt::Write;

use super::tree::Node;

/// A specification, read.
pub(crate) struct Specification {
    root: Node,
    pub(crate) category: u8,
    pub(crate) edition: (u32, u32),
}

impl Specification {
    /// Of a specification's text.
    pub(crate) fn read(text: &str) -> Self {
        let root = Node::parse(text);
        let asterix = root.child("asterix").expect("a line `asterix`");
        let category = asterix.rest().split(' ').next().and_then(|word| word.parse().ok()).expect("a category");
        let edition = root.child("edition").and_then(|line| line.rest().split_once('.')).expect("an edition");
        let number = |text: &str| text.parse().expect("numbers in the edition");
        let edition = (number(edition.0), number(edition.1));
        Self { root, category, edition }
    }

    /// Name of its table and, in lower case, of the table's file.
    pub(crate) fn name(&self) -> String {
        format!("CAT{:03}_{}_{}", self.category, self.edition.0, self.edition.1)
    }

    /// The file of its table.
    pub(crate) fn table(&self) -> String {
        let mut out = String::new();
        let title = self.root.child("asterix").expect("a line `asterix`").quoted();
        let (major, minor) = self.edition;
        let _ = writeln!(
            out,
            "//! Category {:03}, edition {major}.{minor}: {title}.\n//!\n\
             //! Generated from the specification by `WRITE_TABLES=1 cargo test -p asterix --test tables`.\n\n\
             #[allow(clippy::wildcard_imports)]\nuse crate::definition::*;\n",
            self.category
        );
        let (profiles, choice) = self.profiles();
        let _ = writeln!(
            out,
            "/// {title}.\npub const {}: &Edition = &Edition {{\n    category: {},\n    number: \"{major}.{minor}\",\n    \
             title: {title:?},\n    profiles: &[{profiles}],\n    choice: {choice},\n}};\n",
            self.name(),
            self.category
        );
        for item in &self.root.child("items").expect("items").below {
            let _ = writeln!(out, "const {}: Item = {};\n", constant(item.word()), named(item, 0));
        }
        out.truncate(out.trim_end().len());
        out + "\n"
    }

    /// The profiles, and how one of them is chosen.
    fn profiles(&self) -> (String, String) {
        if let Some(one) = self.root.child("uap") {
            return (profile("", one), "None".into());
        }
        let several = self.root.child("uaps").expect("a line `uap` or `uaps`");
        let variations = &several.child("variations").expect("variations").below;
        let profiles: Vec<String> = variations.iter().map(|node| profile(node.word(), node)).collect();
        let case = several.child("case").expect("a line `case`");
        let (item, element) = case.rest().split_once('/').expect("an item and an element");
        let chosen: Vec<String> = case
            .below
            .iter()
            .map(|line| {
                let index = variations.iter().position(|node| node.word() == line.rest()).expect("a variation");
                format!("({}, {index})", line.word().trim_end_matches(':'))
            })
            .collect();
        let items = &self.root.child("items").expect("items").below;
        let item_node = items.iter().find(|node| node.word() == item).expect("the item");
        let (mut bit, mut bits) = (0, 0);
        for part in &item_node.body().below {
            bits = part_bits(part);
            if part.word() == element {
                break;
            }
            bit += bits;
        }
        let choice =
            format!("Some(Choice {{ item: {item:?}, bit: {bit}, bits: {bits}, profiles: &[{}] }})", chosen.join(", "));
        (profiles.join(", "), choice)
    }
}

fn constant(name: &str) -> String {
    format!("I{name}")
}

fn profile(name: &str, node: &Node) -> String {
    let slots: Vec<String> = node
        .below
        .iter()
        .map(|line| match line.word() {
            "-" => "Slot::Spare".into(),
            "rfs" => "Slot::Sequence".into(),
            item => format!("Slot::Item(&{})", constant(item)),
        })
        .collect();
    format!("Profile {{ name: {name:?}, slots: &[\n        {},\n    ] }}", slots.join(",\n        "))
}

fn indent(depth: usize) -> String {
    "    ".repeat(depth)
}

fn named(node: &Node, depth: usize) -> String {
    let shape = shape(node.word(), node.body(), depth);
    format!("Item {{ name: {:?}, title: {:?}, shape: {shape} }}", node.word(), node.quoted())
}

fn shape(of: &str, node: &Node, depth: usize) -> String {
    match node.word() {
        "element" => {
            format!("Shape::Element {{ bits: {}, content: {} }}", node.rest(), content(node.body()))
        }
        "group" => {
            let bits: u16 = node.below.iter().map(part_bits).sum();
            format!("Shape::Group {{ bits: {bits}, parts: &[{}] }}", parts(node, depth))
        }
        "extended" => {
            assert_octets_end_with_fx(of, node);
            format!("Shape::Extended(&[{}])", parts(node, depth))
        }
        "repetitive" => {
            let of = shape(of, node.body(), depth);
            match node.rest() {
                "1" => format!("Shape::Counted(&{of})"),
                "fx" => {
                    assert_eq!(part_bits(node) % 8, 7, "item {}: no room for the extension bit", node.text);
                    format!("Shape::Chained(&{of})")
                }
                other => panic!("`repetitive {other}` is not known"),
            }
        }
        "explicit" => "Shape::Explicit".into(),
        "compound" => {
            let items: Vec<String> = node
                .below
                .iter()
                .map(|line| match line.word() {
                    "-" => "None".into(),
                    _ => format!("Some({})", named(line, depth + 1)),
                })
                .collect();
            let separator = format!(",\n{}", indent(depth + 1));
            format!("Shape::Compound(&[\n{}{},\n{}])", indent(depth + 1), items.join(&separator), indent(depth))
        }
        other => panic!("item {of}: shape `{other}` is not known"),
    }
}

fn parts(node: &Node, depth: usize) -> String {
    let parts: Vec<String> = node
        .below
        .iter()
        .map(|line| match line.word() {
            "-" => "Part::Fx".into(),
            "spare" => format!("Part::Spare({})", line.rest()),
            _ => format!("Part::Item({})", named(line, depth + 1)),
        })
        .collect();
    format!("\n{}{},\n{}", indent(depth + 1), parts.join(&format!(",\n{}", indent(depth + 1))), indent(depth))
}

fn part_bits(line: &Node) -> u16 {
    match line.word() {
        "-" => 1,
        "spare" => line.rest().parse().expect("a number of bits"),
        _ => match line.body() {
            body if body.word() == "element" => body.rest().parse().expect("a number of bits"),
            body if body.word() == "group" => body.below.iter().map(part_bits).sum(),
            body => panic!("`{}` inside a group or an extended item is not known", body.text),
        },
    }
}

/// The decoder finds the end of an extended item by the lowest bit of its octets.
fn assert_octets_end_with_fx(of: &str, node: &Node) {
    let mut bit = 0;
    for line in &node.below {
        let is_last_of_octet = bit % 8 == 7;
        assert_eq!(line.word() == "-", is_last_of_octet, "item {of}: an octet without its extension bit");
        bit += part_bits(line);
    }
    assert_eq!(bit % 8, 0, "item {of}: does not fill its octets");
}

fn content(node: &Node) -> String {
    let text = node.text.as_str();
    let signed = |text: &str| text.starts_with("signed");
    match node.word() {
        "raw" | "bds" => "Content::Raw".into(),
        "table" => {
            let rows: Vec<String> = node
                .below
                .iter()
                .map(|row| format!("({}, {:?})", row.word().trim_end_matches(':'), row.rest()))
                .collect();
            format!("Content::Table(&[{}])", rows.join(", "))
        }
        "string" => match node.rest() {
            "ascii" => "Content::Text(Text::Ascii)".into(),
            "icao" => "Content::Text(Text::Icao)".into(),
            "octal" => "Content::Text(Text::Octal)".into(),
            other => panic!("`string {other}` is not known"),
        },
        "signed" | "unsigned" if node.rest().starts_with("integer") => {
            format!("Content::Integer {{ signed: {} }}", signed(text))
        }
        "signed" | "unsigned" if node.rest().starts_with("quantity") => {
            let step = text.split(' ').nth(2).expect("a step");
            let (signed, step, unit) = (signed(text), quotient(step), node.quoted());
            format!("Content::Quantity {{ signed: {signed}, step: {step}, unit: {unit:?} }}")
        }
        "case" => {
            let of = node.rest().rsplit('/').next().expect("a part");
            let cases: Vec<String> = node
                .below
                .iter()
                .filter(|case| case.word() != "default:")
                .map(|case| format!("({}, {})", case.word().trim_end_matches(':'), content(case.body())))
                .collect();
            format!("Content::Case {{ of: {of:?}, cases: &[{}] }}", cases.join(", "))
        }
        other => panic!("content `{other}` is not known"),
    }
}

/// `360/2^16` as `360.0 / 65536.0`: Rust divides as exactly as the specification does.
fn quotient(text: &str) -> String {
    let number = |text: &str| match text.split_once('^') {
        Some((base, power)) => {
            let (base, power): (u64, u32) = (base.parse().expect("a base"), power.parse().expect("a power"));
            base.pow(power)
        }
        None => text.parse().expect("a number"),
    };
    let grouped = |number: u64| {
        let digits = number.to_string();
        let mut text = String::new();
        for (index, digit) in digits.chars().enumerate() {
            if index > 0 && digits.len() > 5 && (digits.len() - index).is_multiple_of(3) {
                text.push('_');
            }
            text.push(digit);
        }
        text + ".0"
    };
    match text.split_once('/') {
        Some((above, below)) => format!("{} / {}", grouped(number(above)), grouped(number(below))),
        None => grouped(number(text)),
    }
}
