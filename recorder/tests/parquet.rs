//! `recorder export --format parquet` is done by a program of its own that stands beside the recorder.

use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::{Command, Output};

fn export(folder: &Path) -> Output {
    let mut recorder = Command::new(folder.join("recorder"));
    recorder.args(["export", "run.mcap", "--format", "parquet", "--topics", "plots,truth", "--out", "tables"]);
    recorder.output().expect("the recorder starts")
}

#[test]
fn the_program_beside_it_does_the_export_and_its_exit_code_counts() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::copy(env!("CARGO_BIN_EXE_recorder"), folder.path().join("recorder")).expect("a copy");

    let missing = export(folder.path());
    let told = String::from_utf8_lossy(&missing.stderr).into_owned();
    assert_eq!((missing.status.code(), told.lines().count()), (Some(2), 1), "{told}");
    assert!(told.contains("parquet-export") && told.contains("cargo build --release -p parquet-export"), "{told}");

    let program = folder.path().join("parquet-export");
    std::fs::write(&program, "#!/bin/sh\necho \"$@\"\nexit 1\n").expect("a program");
    std::fs::set_permissions(&program, std::fs::Permissions::from_mode(0o755)).expect("rights");
    let done = export(folder.path());
    assert_eq!(String::from_utf8_lossy(&done.stdout), "run.mcap --topics plots,truth --out tables\n");
    assert_eq!(done.status.code(), Some(1));
}
