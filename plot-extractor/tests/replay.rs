//! The command `plot-extractor replay`.

use std::process::Command;

#[test]
fn a_file_without_dwells_is_refused() {
    let folder = std::env::temp_dir().join(format!("plot-extractor-replay-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let empty = folder.join("empty.jsonl");
    std::fs::write(&empty, "").expect("written");
    let mut command = Command::new(env!("CARGO_BIN_EXE_plot-extractor"));
    command.args(["replay", "--dwells"]).arg(&empty).arg("--plots").arg(folder.join("plots.jsonl"));
    let output = command.output().expect("run");
    let text = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{text}");
    assert!(text.contains("empty.jsonl holds no dwells") && text.lines().count() == 1, "{text}");
    std::fs::remove_dir_all(folder).expect("removed");
}
