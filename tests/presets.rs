//! The presets as they are: every target of their scenarios is confirmed and kept, and nothing else is.

mod support;

use std::path::Path;
use std::process::{Command, Output};

use support::{Bench, output, text_of};

fn run(bench: &Bench, preset: &str, arguments: &[&str]) -> Output {
    let config = Path::new(env!("CARGO_MANIFEST_DIR")).join("config").join(preset);
    output(bench.command("run", &config).args(arguments))
}

fn assert_followed(preset: &str, targets: u64) {
    assert_followed_with(preset, targets, &[]);
}

fn assert_followed_with(preset: &str, targets: u64, arguments: &[&str]) {
    let bench = Bench::new();
    let result = run(&bench, preset, arguments);
    assert!(result.status.success(), "{}", text_of(&result));
    let report = bench.report();
    let tracking = &report.tracking;
    assert_eq!(report.lost(), 0);
    assert_eq!(
        (tracking.targets, tracking.confirmed, tracking.false_tracks, tracking.lost),
        (Some(targets), Some(targets), Some(0), Some(0)),
        "{}",
        text_of(&result)
    );
    assert!(!text_of(&result).contains("WARNING"), "{}", text_of(&result));
}

#[test]
fn aircraft_about_an_approach_radar() {
    assert_followed("approach.toml", 6);
}

#[test]
fn ships_before_a_coastal_radar() {
    assert_followed("coastal.toml", 5);
}

/// Spiky clutter over the whole range is not the noise that the threshold is made for.
#[test]
fn false_alarms_far_from_what_is_set_are_said() {
    let bench = Bench::new();
    let spiky = ["sim.clutter.range_m=20000", "sim.clutter.shape=0.6", "sim.clutter.cnr_db=15"];
    let result = run(&bench, "coastal.toml", &["--scans=20", "--set", spiky[0], "--set", spiky[1], "--set", spiky[2]]);
    assert!(text_of(&result).contains("WARNING tracker: false alarms per cell"), "{}", text_of(&result));
    let told = bench.report().processes["tracker"].false_alarms.expect("measured");
    assert!(told.is_off() && told.measured > 10.0 * told.set, "{told:?}");
}

#[test]
fn turning_ships_by_every_filter_of_turns() {
    for estimator in ["imm-turn", "adaptive-grid", "switching-grid"] {
        assert_followed_with("ship.toml", 5, &["--set", &format!("tracker.estimator={estimator}")]);
    }
}

#[test]
fn manoeuvring_aircraft_by_turns_and_accelerations() {
    for estimator in ["imm-turn", "multi-alternative", "adaptive-bandwidth"] {
        assert_followed_with("aircraft.toml", 5, &["--set", &format!("tracker.estimator={estimator}")]);
    }
}

/// A recorded radar on a moving ship, scored against both boats; its recording teaches a configuration that the chain takes.
#[test]
fn a_ferry_among_boats_and_what_its_recording_teaches() {
    let bench = Bench::new();
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("config/data/ferry-radar.jsonl");
    let [radar, truth] = ["file", "truth"].map(|key| format!("plot_source.{key}='{}'", file.display()));
    let result = run(&bench, "ferry.toml", &["--set", &radar, "--set", &truth]);
    assert!(result.status.success(), "{}", text_of(&result));
    let tracking = bench.report().tracking;
    // Of 762 positions, those before the first two plots of a boat cannot be followed.
    assert_eq!(tracking.truth_points, Some(762));
    assert!(tracking.truth_share.is_some_and(|share| share > 0.8), "{tracking:?}");
    let recording = bench.recordings().remove(0);
    let tune = |file: &Path| output(Command::new(env!("CARGO_BIN_EXE_radar-chain")).arg("tune").arg(file));
    let tuned = tune(&recording);
    // Ten minutes of two boats may not settle every parameter: then the code is 1, and the text says so.
    let unsettled = text_of(&tuned).contains("have not settled");
    assert_eq!(tuned.status.code(), Some(i32::from(unsettled)), "{}", text_of(&tuned));
    let text = String::from_utf8(tuned.stdout).expect("text");
    assert!(text.contains("sigma_azimuth_deg = ") && text.contains("\ndetection_probability = "), "{text}");
    assert_eq!(text.contains("\nsigma_azimuth_deg = "), !unsettled, "{text}");
    let file = bench.path("tuned.toml");
    std::fs::write(&file, &text).expect("a file");
    let taken = output(Command::new(env!("CARGO_BIN_EXE_radar-chain")).arg("config").arg("--config").arg(&file));
    assert!(taken.status.success(), "{}", text_of(&taken));
    let refused = tune(&file);
    let lines = String::from_utf8_lossy(&refused.stderr).lines().count();
    assert_eq!((refused.status.code(), lines), (Some(2), 1), "{}", text_of(&refused));
}
