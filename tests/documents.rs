//! Documents that are made from the program are as it makes them.

use std::process::Command;

fn printed(arguments: &[&str]) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_radar-chain")).args(arguments).output().expect("the program");
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("text")
}

#[test]
fn the_reference_of_the_configuration_is_up_to_date() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/configuration.md");
    let committed = std::fs::read_to_string(file).expect("a file");
    assert!(committed == printed(&["config", "--docs"]), "just docs writes docs/configuration.md anew");
}
