//! The page: its files, inside the program.

/// Names, types and contents of the files in `display/page/`.
macro_rules! files {
    ($($name:literal),+ $(,)?) => {
        /// The files of the page by name.
        const FILES: [(&str, &[u8]); [$($name),+].len()] = [$(($name, include_bytes!(concat!("../page/", $name)))),+];
    };
}

files!("index.html");

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
    fn every_file_of_the_page_is_in_the_program() {
        let folder = std::fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/page")).expect("the page");
        let mut there: Vec<_> =
            folder.map(|of| of.expect("a file").file_name().to_string_lossy().into_owned()).collect();
        there.sort_unstable();
        let mut known: Vec<_> = FILES.iter().map(|(name, _)| (*name).to_string()).collect();
        known.sort_unstable();
        assert_eq!(there, known);
    }
}
