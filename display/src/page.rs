//! The page: its files, inside the program.

/// Names and contents of the files in `display/page/`.
const FILES: &[(&str, &[u8])] = &include!(concat!(env!("OUT_DIR"), "/page.rs"));

/// A file of the page: its type and its content.
pub(crate) fn asset(name: &str) -> Option<(&'static str, &'static [u8])> {
    let (name, content) = FILES.iter().find(|(of, _)| *of == name)?;
    let kind = match name.rsplit_once('.').map(|(_, end)| end) {
        Some("html") => "text/html; charset=utf-8",
        Some("css") => "text/css; charset=utf-8",
        Some("js") => "text/javascript; charset=utf-8",
        Some("svg") => "image/svg+xml",
        _ => "application/octet-stream",
    };
    Some((kind, content))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_page_names_is_in_the_program_with_its_type() {
        let (kind, page) = asset("index.html").expect("the page");
        assert_eq!(kind, "text/html; charset=utf-8");
        let named = std::str::from_utf8(page).expect("text").split("/assets/").skip(1);
        let names: Vec<_> = named.filter_map(|rest| rest.split('"').next()).collect();
        for needed in ["main.js", "style.css"] {
            assert!(names.contains(&needed), "{needed}: {names:?}");
        }
        for name in names {
            assert!(asset(name).is_some_and(|(kind, _)| kind != "application/octet-stream"), "{name}");
        }
        assert!(asset("../Cargo.toml").is_none());
    }
}
