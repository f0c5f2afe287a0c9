//! What a report says of the tracks: of runs that are stopped, of replays, of radars without elevation, without truth.

mod support;

use support::{Bench, output, scan, small_config, text_of};

/// The small radar with one wide beam in elevation: it measures range and azimuth alone.
const WITHOUT_ELEVATION: [&str; 10] = [
    "--set",
    "radar.elevations=1",
    "--set",
    "radar.elevation_first_deg=5.0",
    "--set",
    "radar.beamwidth_elevation_deg=20.0",
    "--set",
    "radar.dopplers=1",
    "--scans",
    "40",
];

#[test]
fn a_run_that_is_stopped_has_lost_no_track() {
    let bench = Bench::new();
    let running = bench.start(&["--scans", "0", "--speed", "4"]);
    bench.wait_for("scans", |status| scan(status).filter(|&scan| scan >= 12));
    let stopped = running.stop();
    assert_eq!(stopped.status.code(), Some(0), "{}", text_of(&stopped));
    let tracking = bench.report().tracking;
    assert_eq!((tracking.targets, tracking.confirmed, tracking.lost), (Some(2), Some(2), Some(0)), "{tracking:?}");
}

/// The turn's number changes in the north: a track that goes on there is not lost, whichever way its target crosses.
#[test]
fn a_target_that_crosses_north_is_not_lost() {
    let bench = Bench::new();
    let target = |name: &str, y_m: f64, speed_mps: f64| {
        let x_m = -7.3 * speed_mps;
        format!(
            "{{name='{name}', motion='straight', position_m=[{x_m:.1}, {y_m:.1}, 150.0], \
             velocity_mps=[{speed_mps:.1}, 0.0, 0.0], snr_db=30.0, swerling='I'}}"
        )
    };
    let targets = [("a", 900.0, 20.0), ("b", 1300.0, -20.0), ("c", 1900.0, 15.0), ("d", 2500.0, -25.0)];
    let targets: Vec<String> = targets.map(|(name, y_m, speed_mps)| target(name, y_m, speed_mps)).into();
    let targets = format!("sim.targets=[{}]", targets.join(", "));
    let run = bench.run(&["--scans", "60", "--set", &targets]);
    assert_eq!(run.status.code(), Some(0), "{}", text_of(&run));
    let tracking = bench.report().tracking;
    assert_eq!((tracking.targets, tracking.confirmed, tracking.false_tracks), (Some(4), Some(4), Some(0)));
    assert_eq!((tracking.lost, tracking.id_changes), (Some(0), Some(0)), "{tracking:?}");
}

#[test]
fn targets_of_a_radar_without_elevation_are_scored_in_its_plane() {
    let bench = Bench::new();
    let run = bench.run(&WITHOUT_ELEVATION);
    assert_eq!(run.status.code(), Some(0), "{}", text_of(&run));
    let tracking = bench.report().tracking;
    assert_eq!((tracking.targets, tracking.confirmed, tracking.false_tracks), (Some(2), Some(2), Some(0)));
    assert_eq!(tracking.nees_dimensions, Some([4, 2]));
    let nees = tracking.nees_position.expect("tracks that follow targets");
    assert!((0.3..3.0).contains(&nees), "{nees}");
    assert!(text_of(&run).contains("over its 2 dimensions, 1 is right"), "{}", text_of(&run));
}

#[test]
fn a_replay_of_plots_has_the_latencies_of_its_own_stages_and_passes_a_soak() {
    let bench = Bench::new();
    assert_eq!(bench.run(&["--scans", "20"]).status.code(), Some(0));
    let recording = bench.recordings()[0].display().to_string();
    let replay = |command: &str, arguments: &[&str]| {
        output(bench.bare(command).args(["--replay", &recording, "--speed", "max"]).args(arguments))
    };
    let soaked = replay("soak", &["--out", "soak", "--set", "soak.growth_mib=50"]);
    assert_eq!(soaked.status.code(), Some(0), "{}", text_of(&soaked));
    let report = bench.report_at("soak/report.json");
    assert_eq!([report.latency_us["hop_dwells"].n, report.latency_us["extract"].n], [0, 0]);
    assert_eq!([report.latency_us["track"].n, report.latency_us["end_to_end"].n], [160, 160]);
    assert!(report.latency_us["end_to_end"].max < 60e6, "the recorded run is no part of the latency: {report:?}");
    assert!(report.budget.values().all(|budget| budget.ok && !budget.limits[0].applied), "{:?}", report.budget);

    let run = replay("run", &["--set", "replay.topics=[\"plots\"]", "--report", "blind.json"]);
    assert_eq!(run.status.code(), Some(0), "{}", text_of(&run));
    assert!(!text_of(&run).contains("BROKEN") && text_of(&run).contains("not applied"), "{}", text_of(&run));
    let tracking = bench.report_at("blind.json").tracking;
    assert_eq!(tracking.targets, None, "there is no truth");
    let tracks = tracking.tracks.expect("tracks");
    assert_eq!((tracks.count, tracks.alive, tracks.list.len()), (2, 2, 2));
    assert!(tracks.life_p50_s > 3.0 && tracks.hit_share > 0.9, "{tracks:?}");
    assert!(text_of(&run).contains("course °"), "{}", text_of(&run));
}

#[test]
fn every_recording_keeps_its_report() {
    let bench = Bench::new();
    for seed in ["1", "2"] {
        assert_eq!(bench.run(&["--scans", "4", "--seed", seed]).status.code(), Some(0));
    }
    let seeds: Vec<u64> = bench
        .recordings()
        .iter()
        .map(|recording| {
            let run = recording.display().to_string().replace(".000.mcap", ".report.json");
            bench.report_at(&run).seed
        })
        .collect();
    assert_eq!(seeds, [1, 2]);
}

#[test]
fn plots_that_do_not_fit_into_their_message_are_counted() {
    let bench = Bench::new();
    let crowd = ["--set", "extractor.pfa=0.01", "--set", "radar.sectors_per_scan=1", "--scans", "2"];
    let run = bench.run(&[&crowd[..], &["--set", "radar.ranges=400"]].concat());
    assert_eq!(run.status.code(), Some(0), "{}", text_of(&run));
    let detection = bench.report().detection;
    assert_eq!(detection.plots, 2 * 1024, "{}", text_of(&run));
    assert!(detection.left_out > 0 && text_of(&run).contains("left out of full messages"), "{}", text_of(&run));
}

#[test]
fn scores_of_tracks_alone_say_nothing_of_plots() {
    let bench = Bench::new();
    assert_eq!(bench.run(&["--scans", "8"]).status.code(), Some(0));
    let recording = bench.recordings()[0].display().to_string();
    let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_radar-chain"));
    command.args(["recorder", "score", "--tracks", &recording, "--truth", &recording, "--config"]).arg(small_config());
    let scored = output(&mut command);
    assert_eq!(scored.status.code(), Some(0), "{}", text_of(&scored));
    assert!(!text_of(&scored).contains("detection"), "{}", text_of(&scored));
    assert!(text_of(&scored).contains("targets confirmed             2 of 2"), "{}", text_of(&scored));
    let scored = output(command.args(["--plots", &recording]));
    assert!(text_of(&scored).contains("detection"), "{}", text_of(&scored));
}
