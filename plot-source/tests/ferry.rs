//! The recording of a radar on a moving ship that is part of the project, whole and cut.

use std::path::Path;

use common::config::{self, ChainConfig};
use common::truth::{PLANAR, VISIBLE};
use plot_source::{Scan, Source};
use proptest::prelude::*;

const RECORDING: &[u8] = include_bytes!("../../config/data/ferry-radar.jsonl");

fn chain() -> ChainConfig {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../config/ferry.toml");
    config::load(Some(&path), &[]).expect("a valid configuration")
}

fn source(bytes: &[u8]) -> Source {
    let file = (Path::new("ferry.jsonl"), bytes);
    Source::decode(&chain(), file, Some(file)).expect("a recording")
}

/// Counts of the file, by another program: 381 lines, 2046 plots, 762 positions of boats.
#[test]
fn every_plot_and_every_boat_is_read() {
    let source = source(RECORDING);
    assert!(source.notes().iter().any(|note| note.contains("pauses 4")), "{:?}", source.notes());
    assert!(!source.notes().iter().any(|note| note.contains("clock steps")), "{:?}", source.notes());
    let scans: Vec<Scan> = source.collect();
    let plots: Vec<_> = scans.iter().flat_map(|scan| scan.plots.iter().flat_map(|(_, plots)| plots)).collect();
    let boats: Vec<_> = scans.iter().filter_map(|scan| scan.truth.as_ref()).flat_map(|(_, boats)| boats).collect();
    assert_eq!((plots.len(), boats.len()), (2046, 762));
    assert!(boats.iter().all(|boat| boat.flags == VISIBLE | PLANAR && [1, 2].contains(&boat.target_id)));
    // The first plot of the file, and the boat whose position is the first: 137.81 m south and 192.19 m west of the ship.
    let first =
        plots.iter().find(|plot| (plot.range_m - 142.62_f64.hypot(218.25)).abs() < 1e-9).expect("the first plot");
    assert!(first.time_ns.abs_diff(1_620_114_893_033_900_000) < 1000, "{}", first.time_ns);
    assert!((first.azimuth_rad.to_degrees() - 236.84).abs() < 0.01);
    let [east, north, _] = boats[0].position_m();
    assert!((east + 192.19).abs() < 0.02 && (north + 137.81).abs() < 0.02, "{east} {north}");
    // Boats of ten knots do not jump: neither truth nor the ship's own way does.
    assert!(boats.iter().all(|boat| boat.velocity_mps()[0].hypot(boat.velocity_mps()[1]) < 10.0));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    /// A file that was cut anywhere is read up to its last whole line, and the line that was cut is counted.
    #[test]
    fn what_is_cut_costs_its_line(cut in 1000..RECORDING.len()) {
        let bytes = &RECORDING[..cut];
        let whole = String::from_utf8_lossy(bytes).lines().map(|line| {
            let scan = serde_json::from_str::<serde_json::Value>(line);
            scan.map_or(0, |scan| scan["plots_ne_m"].as_array().map_or(0, Vec::len))
        }).sum::<usize>();
        let source = Source::decode(&chain(), (Path::new("ferry.jsonl"), bytes), None).expect("a scan at least");
        let is_cut = !bytes.ends_with(b"}") && !bytes.ends_with(b"\n");
        prop_assert_eq!(source.notes().iter().any(|note| note.contains("could not be read")), is_cut);
        prop_assert_eq!(source.flat_map(|scan| scan.plots).map(|(_, plots)| plots.len()).sum::<usize>(), whole);
    }
}
