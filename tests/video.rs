//! Radar video through a whole chain: every dwell is taken, recorded, replayed to the same plots, and drawn.

mod support;

use std::io::Read;
use std::path::{Path, PathBuf};

use flate2::read::GzDecoder;
use support::{Bench, output, text_of};

/// The preset, and six seconds of a HALO radar in the bench's folder.
fn halo(bench: &Bench) -> (PathBuf, String) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let packed = std::fs::read(root.join("video-source/tests/data/halo-6s.pcap.gz")).expect("the capture");
    let mut bytes = Vec::new();
    GzDecoder::new(&packed[..]).read_to_end(&mut bytes).expect("gzip");
    let file = bench.path("halo.pcap");
    std::fs::write(&file, bytes).expect("the capture unpacked");
    (root.join("config/halo.toml"), format!("video_source.file={}", file.display()))
}

#[test]
fn a_capture_of_a_ships_radar() {
    let bench = Bench::new();
    let (config, file) = halo(&bench);
    let dwells = ["--set", "recorder.dwells=true"];
    let result = output(bench.command("run", &config).args(["--speed", "max", "--set", &file]).args(dwells));
    // Its last packet begins a datagram that does not end: everything else is used, and the run ends with 1.
    assert_eq!(result.status.code(), Some(1), "{}", text_of(&result));
    assert!(text_of(&result).contains("parts that could not be read"), "{}", text_of(&result));
    let report = bench.report();
    assert_eq!(report.lost(), 0, "{}", text_of(&result));
    assert!(report.detection.plots > 500, "{}", text_of(&result));

    let recording = bench.recordings().remove(0);
    let plan = bench.path("plan.svg");
    let mut picture = std::process::Command::new(env!("CARGO_BIN_EXE_radar-chain"));
    let drawn = output(picture.arg("picture").arg(&recording).arg("--out").arg(&plan));
    assert!(drawn.status.success(), "{}", text_of(&drawn));
    let svg = std::fs::read_to_string(&plan).expect("a plan");
    assert!(svg.contains("data:image/png;base64,") && svg.contains("class=\"plot\""));

    let again = Bench::new();
    let replay = format!("replay.file={}", recording.display());
    let topics = ["run.source=replay", "replay.topics=['dwells']", "replay.of=video-source"];
    let mut command = again.command("run", &config);
    command.args(["--speed", "max", "--set", &replay]).args(topics.iter().flat_map(|topic| ["--set", topic]));
    let replayed = output(&mut command);
    assert!(replayed.status.success(), "{}", text_of(&replayed));
    assert_eq!(again.report().detection.plots, report.detection.plots);
}
