//! All detectors in noise and at the edge of clutter: how often each says that there is something.

use common::amplitude::NoiseEstimate;
use common::config::{Cfar, ExtractorConfig};
use common::random::{Purpose, generator};
use common::units::from_db;
use plot_extractor::cfar::{Detector, Hit};
use radar_sim::noise;

use super::GUARD;
use crate::parallel::runs;
use crate::{Case, Options, Progress, Results, Row};

/// F that is set.
const PFA: f64 = 1e-4;
/// Reference cells on each side.
const REFERENCE: u32 = 16;
/// Noise of one run: range profiles, and cells in each.
const PROFILES: usize = 256;
const RANGES: usize = 512;
/// Where clutter begins, how much stronger than the noise it is, and the cells of it that count as its edge.
const EDGE: usize = 256;
const CLUTTER_DB: [f64; 2] = [10.0, 20.0];
const EDGE_CELLS: usize = 3;
/// Scans of which a clutter map takes the first and the last one counts.
const SCANS: u32 = 3;
const KINDS: [(Cfar, &str); 5] =
    [(Cfar::Ca, "ca"), (Cfar::Go, "go"), (Cfar::So, "so"), (Cfar::Os, "os"), (Cfar::ClutterMap, "clutter-map")];

/// Hits of one run: in noise, and at the edge of each clutter.
type Counts = [[u64; 1 + CLUTTER_DB.len()]; KINDS.len()];

/// Measures `pfa` of each detector in noise, and `pfa_edge` at the edge of clutter.
pub fn measure(options: &Options, runs_of_each: u32, progress: &Progress, results: &mut Results) {
    let counts = runs(options.threads, runs_of_each, progress, |run| one_run(options.seed, run));
    for (kind, (cfar, name)) in KINDS.into_iter().enumerate() {
        let case = || Case::new().with("pfa", PFA).with("cfar", name).with("reference_cells", 2 * REFERENCE);
        let of = |place: usize, cells: usize| -> Vec<[u64; 2]> {
            counts.iter().map(|run: &Counts| [run[kind][place], (PROFILES * cells) as u64]).collect()
        };
        results.rows.push(Row::clustered(&case(), "pfa", &of(0, RANGES)).against(PFA, "set F"));
        for (place, clutter_db) in CLUTTER_DB.into_iter().enumerate() {
            let row = Row::clustered(&case().with("clutter_db", clutter_db), "pfa_edge", &of(1 + place, EDGE_CELLS));
            results.rows.push(match cfar {
                Cfar::Go => row.against(of_one_window(), "that of one window, amplitude.md"),
                Cfar::ClutterMap => row.against(PFA, "set F"),
                _ => row,
            });
        }
    }
}

/// P(q > t) of GO-CFAR where one window always is the greater one.
fn of_one_window() -> f64 {
    let greater = NoiseEstimate::Greater(REFERENCE, REFERENCE);
    NoiseEstimate::Mean(REFERENCE).survival(greater.factor(PFA) / greater.mean())
}

fn one_run(seed: u64, run: u32) -> Counts {
    let mut amplitudes = vec![0.0; PROFILES * RANGES];
    let mut powers = amplitudes.clone();
    let mut hits: Vec<Hit> = Vec::new();
    KINDS.map(|(cfar, _)| {
        let config = ExtractorConfig {
            cfar,
            pfa: PFA,
            guard_cells: GUARD as u32,
            reference_cells: REFERENCE,
            ..ExtractorConfig::default()
        };
        std::array::from_fn(|place| {
            let mut detector = Detector::new(&config, RANGES);
            for scan in 0..if cfar == Cfar::ClutterMap { SCANS } else { 1 } {
                noise::fill(&mut amplitudes, &mut generator(seed, Purpose::Noise, run, 1_000_000 + scan));
                if let Some(&clutter_db) = place.checked_sub(1).and_then(|place| CLUTTER_DB.get(place)) {
                    let clutter = from_db(clutter_db).sqrt() as f32;
                    for profile in amplitudes.chunks_mut(RANGES) {
                        profile[EDGE..].iter_mut().for_each(|amplitude| *amplitude *= clutter);
                    }
                }
                hits.clear();
                detector.detect(0, &amplitudes, &mut powers, &mut hits);
            }
            let counts = |hit: &&Hit| place == 0 || (EDGE..EDGE + EDGE_CELLS).contains(&(hit.cell as usize % RANGES));
            hits.iter().filter(counts).count() as u64
        })
    })
}
