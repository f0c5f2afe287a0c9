//! The tables in `src/tables` are what the specifications in `specs` give.
//!
//! `WRITE_TABLES=1 cargo test -p asterix --test tables` writes them: after a specification was added or replaced.

#[path = "specification/emit.rs"]
mod emit;
#[path = "specification/tree.rs"]
mod tree;

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use emit::Specification;

fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(name)
}

/// By category, the oldest edition first.
fn specifications() -> Vec<Specification> {
    let files = fs::read_dir(folder("specs")).expect("the folder of specifications");
    let mut specifications: Vec<Specification> = files
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "ast"))
        .map(|path| Specification::read(&fs::read_to_string(path).expect("a specification")))
        .collect();
    specifications.sort_by_key(|it| (it.category, it.edition));
    specifications
}

/// The module of all tables.
fn index(specifications: &[Specification]) -> String {
    let names: Vec<String> = specifications.iter().map(Specification::name).collect();
    let mut out = String::from(
        "//! The editions: one table for each specification in the folder `specs`.\n//!\n\
         //! Generated from the specifications by `WRITE_TABLES=1 cargo test -p asterix --test tables`.\n\n\
         use crate::definition::Edition;\n\n",
    );
    for name in &names {
        let file = name.to_lowercase();
        let _ = writeln!(out, "#[rustfmt::skip]\nmod {file};\npub use {file}::{name};");
    }
    let _ = writeln!(
        out,
        "\n/// All editions, by category, the oldest first.\npub const ALL: [&Edition; {}] =\n    [{}];",
        names.len(),
        names.join(", ")
    );
    out
}

#[test]
fn tables_are_what_the_specifications_give() {
    let specifications = specifications();
    assert!(specifications.len() >= 9, "specifications are missing");
    let mut files: Vec<(String, String)> =
        specifications.iter().map(|it| (format!("{}.rs", it.name().to_lowercase()), it.table())).collect();
    files.push(("mod.rs".into(), index(&specifications)));
    let tables = folder("src/tables");
    for (name, expected) in &files {
        let path = tables.join(name);
        if std::env::var_os("WRITE_TABLES").is_some() {
            fs::create_dir_all(&tables).expect("the folder of tables");
            fs::write(&path, expected).expect("a table written");
        }
        let found = fs::read_to_string(&path).unwrap_or_default();
        assert!(
            &found == expected,
            "{} is not what the specification gives: write it with WRITE_TABLES=1",
            path.display()
        );
    }
    let count = fs::read_dir(&tables).expect("the folder of tables").count();
    assert_eq!(count, files.len(), "{} holds a table without a specification", tables.display());
}
