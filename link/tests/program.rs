//! The program says what is wrong before it sends or receives anything.

use std::process::{Command, Output};

fn link(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_radar-link")).args(arguments).output().expect("the program")
}

#[test]
fn what_cannot_be_reached_or_read_is_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("zenoh.json5");
    std::fs::write(&file, "{ mode: ").expect("written");
    let (root, settings) =
        (format!("ipc.root='{}'", folder.path().display()), format!("link.zenoh='{}'", file.display()));
    let send = ["stage", "link-out", "--ipc-prefix", "linkprogram", "--set", "link.send=['tracks']", "--set", &root];
    for (ways, named) in [
        (&[][..], "key `link.listen` is 0, expected an address"),
        (&["--set", "link.listen=['tcp/nowhere']"], "cannot open the link by tcp/nowhere"),
        (&["--set", "link.connect=['tcp/127.0.0.1:9']", "--set", &settings], "key `link.zenoh`: cannot read"),
    ] {
        let result = link(&[&send, ways].concat());
        let said = String::from_utf8_lossy(&result.stderr).into_owned();
        assert!(result.status.code() == Some(2) && said.contains(named), "{:?}: {said}", result.status.code());
    }
    let help = link(&["--help"]);
    assert!(String::from_utf8_lossy(&help.stdout).contains("radar-link stage link-out"));
}
