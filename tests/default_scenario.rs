//! The scenario of `config/uav.toml` through real processes, full-size cells: what the
//! README promises of it, on a short run.

mod support;

use std::path::Path;

use support::{Bench, output, text_of};

#[test]
fn drones_are_confirmed_soon_and_nothing_else_is() {
    let bench = Bench::new();
    let config = Path::new(env!("CARGO_MANIFEST_DIR")).join("config/uav.toml");
    let result = output(bench.command("run", &config).args(["--scans", "40", "--speed", "max"]));
    assert!(result.status.success(), "{}", text_of(&result));
    let report = bench.report();
    let (detection, tracking) = (&report.detection, &report.tracking);
    assert_eq!((report.scans, report.lost()), (40, 0));

    // 10⁹ cells: the set probability of false alarm within four standard errors of the count.
    let expected = detection.cells as f64 * 1e-6;
    let found = detection.false_alarm_cells as f64;
    assert!((found - expected).abs() < 4.0 * expected.sqrt(), "{found} false alarms, {expected} expected");
    for (axis, value) in &detection.normalised_error_squared {
        assert!((0.7..1.4).contains(value), "{axis}: {value}"); // some 230 plots: standard error 0.1
    }

    assert_eq!(tracking.confirmed, tracking.targets, "{}", text_of(&result));
    assert_eq!((tracking.targets, tracking.false_tracks, tracking.lost), (Some(8), Some(0), Some(0)));
    assert!(tracking.confirmation_scans.values().all(|&scans| scans <= 5), "{:?}", tracking.confirmation_scans);
}
