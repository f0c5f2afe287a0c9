//! Lists the files of the page, so that all of them are in the program.

use std::error::Error;
use std::fmt::Write;
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = format!("{}/page", std::env::var("CARGO_MANIFEST_DIR")?);
    println!("cargo::rerun-if-changed={folder}");
    let mut names = Vec::new();
    for file in std::fs::read_dir(&folder)? {
        names.push(file?.file_name().to_string_lossy().into_owned());
    }
    names.sort_unstable();
    let mut table = String::from("[\n");
    for name in names {
        let file = format!("{folder}/{name}");
        writeln!(table, "({name:?}, include_bytes!({file:?})),")?;
    }
    table.push_str("]\n");
    std::fs::write(Path::new(&std::env::var("OUT_DIR")?).join("page.rs"), table)?;
    Ok(())
}
