//! Changing between `cargo run`, `cargo build` and `cargo test` compiles no dependency again: in all of them each one has
//! the same features. (Those that only tests need are compiled when tests are first built.) The program `link` stands
//! apart: Zenoh asks for more features of what others use, too, and nobody who has one host is to compile them.

use std::collections::{BTreeMap, BTreeSet};
use std::process::Command;

/// Has one more feature where Parquet or a test asks for it; it and the random numbers of WebSockets above it are small.
const TWICE: &str = "zerocopy ";

/// The dependencies from the registry in a build of `packages`, each with the features of its forms: a form for the
/// programs, and perhaps another for build scripts and procedural macros.
fn dependencies(packages: &[&str], edges: &str) -> BTreeMap<String, BTreeSet<String>> {
    let mut tree = Command::new(env!("CARGO"));
    tree.current_dir(env!("CARGO_MANIFEST_DIR")).args(["tree", "--locked", "--no-dedupe", "--prefix", "none"]);
    let output = tree.args(["--edges", edges, "--format", "{p}|{f}"]).args(packages).output().expect("cargo");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let mut found: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for line in String::from_utf8(output.stdout).expect("text").lines() {
        let (package, features) = line.split_once('|').unwrap_or_default();
        let is_ours = package.contains("(/");
        if !package.is_empty() && !is_ours {
            found.entry(package.to_string()).or_default().insert(features.replace(" (*)", ""));
        }
    }
    found
}

#[test]
fn run_build_and_test_share_every_dependency() {
    let run = dependencies(&["--package", "radar-chain"], "normal,build");
    assert!(run.keys().any(|name| name.starts_with("iceoryx2 ")), "{:?}", run.keys());
    // Without a package named, as `cargo run` and `cargo build` have it: the default members.
    let build = dependencies(&[], "normal,build");
    let test = dependencies(&[], "normal,build,dev");
    let differing = |one: &BTreeMap<String, BTreeSet<String>>, other: &BTreeMap<String, BTreeSet<String>>| {
        let differs = |(name, features): (&String, &BTreeSet<String>)| {
            let others = other.get(name).cloned().unwrap_or_default();
            (!features.is_subset(&others) && !name.starts_with(TWICE))
                .then(|| format!("{name}: {features:?}, {others:?}"))
        };
        one.iter().filter_map(differs).collect::<Vec<_>>()
    };
    assert_eq!(differing(&run, &build), Vec::<String>::new(), "cargo run and cargo build");
    assert_eq!(differing(&build, &test), Vec::<String>::new(), "cargo build and cargo test");
}

#[test]
fn the_first_run_compiles_neither_parquet_nor_plots_nor_regular_expressions() {
    let named = |found: &String, heavy: &str| found.split(' ').next() == Some(heavy);
    let run = dependencies(&["--package", "radar-chain"], "normal,build");
    for heavy in ["parquet", "plotters", "regex", "regex-automata", "clang-sys", "criterion", "indicatif", "zenoh"] {
        let found = run.keys().find(|found| named(found, heavy));
        assert_eq!(found, None, "in the launcher's build; cargo tree -i {heavy} says by whom");
    }
    // `cargo run` gives each crate the features that any default member asks for.
    let build = dependencies(&[], "normal,build");
    for heavy in ["zenoh", "regex-automata"] {
        assert!(!build.keys().any(|found| named(found, heavy)), "a default member asks for {heavy}");
    }
}
