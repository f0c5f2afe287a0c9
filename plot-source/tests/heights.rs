//! Heights of plots, up to the tracks: they never make a radar worse that could do without them.

mod synthetic;

use std::f64::consts::TAU;
use std::fmt::Write;

use common::config::TrackerConfig;
use common::message::END_OF_SCAN;
use common::tracks::Track;
use synthetic::{chain, messages, open};
use tracker::Tracker;

const TURNS: u32 = 40;
const DRONES: u32 = 6;
const SCENES: u32 = 8;
/// How high all drones fly above the radar, m.
const HEIGHT_M: f64 = 40.0;

/// Numbers in [0, 1) by the splitmix64 generator.
struct Chance(u64);

impl Chance {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ self.0 >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((mixed ^ mixed >> 31) >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn normal(&mut self) -> f64 {
        (-2.0 * (1.0 - self.next()).ln()).sqrt() * (TAU * self.next()).cos()
    }
}

/// Six drones about a radar that turns once a second, as a table; of the plots, so many have a height with this error.
fn table(seed: u64, farthest_m: f64, sigma_height_m: f64, share: f64) -> String {
    let (mut chance, mut heights) = (Chance(seed), Chance(!seed));
    let mut rows = Vec::new();
    for drone in 0..DRONES {
        let azimuth_rad = TAU * (f64::from(drone) + 0.2 + 0.6 * chance.next()) / f64::from(DRONES);
        let range_m = farthest_m * (0.5 + 0.35 * chance.next());
        let course_rad = azimuth_rad + TAU / 2.0 + 0.6 + 0.6 * chance.next();
        for turn in 0..TURNS {
            let time_s = f64::from(turn) + azimuth_rad / TAU;
            let along = |at: fn(f64) -> f64| range_m * at(azimuth_rad) + 8.0 * time_s * at(course_rad);
            let (east_m, north_m) = (along(f64::sin), along(f64::cos));
            let measured_m = east_m.hypot(north_m).hypot(HEIGHT_M) + 3.5 * chance.normal();
            let measured_deg = east_m.atan2(north_m).to_degrees() + 0.77 * chance.normal();
            let height_m = HEIGHT_M + sigma_height_m * heights.normal();
            let height = if heights.next() < share { height_m.to_string() } else { String::new() };
            if chance.next() < 0.9 {
                rows.push((time_s, format!("{time_s},{measured_m},{},{height}", measured_deg.rem_euclid(360.0))));
            }
        }
    }
    rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut table = String::from("time_s,range_m,azimuth_deg,height_m\n");
    for (_, row) in rows {
        writeln!(table, "{row}").expect("memory");
    }
    table
}

/// Scans for which the drones waited for their tracks, and confirmed tracks beyond them, of eight scenes.
fn waited(farthest_m: f64, sigma_height_m: f64, share: f64) -> (u32, u32) {
    let mut chain = chain();
    chain.plot_source.sigma_range_m = 3.5;
    chain.plot_source.sigma_azimuth_deg = 0.77;
    chain.plot_source.cell_range_m = 12.0;
    chain.plot_source.cell_azimuth_deg = 2.6;
    chain.plot_source.coverage_range_m = 1.2 * farthest_m;
    chain.plot_source.sigma_height_m = sigma_height_m;
    let (mut missing, mut beyond) = (0, 0);
    for seed in 0..u64::from(SCENES) {
        let table = table(seed, farthest_m, sigma_height_m, share);
        let source = open(&chain, table.as_bytes()).expect("a table");
        let mut tracker = Tracker::new(&TrackerConfig::default(), 1).expect("a valid configuration");
        let mut tracks: Vec<Track> = Vec::new();
        for (header, plots) in messages(source) {
            let processed = tracker.process_plots(&header, &plots, &mut tracks);
            if header.has(END_OF_SCAN) {
                missing += DRONES.saturating_sub(processed.confirmed);
                beyond += processed.confirmed.saturating_sub(DRONES);
            }
        }
    }
    (missing, beyond)
}

/// The same plots are confirmed as soon, whether all, some or none of them have heights, near and far; a scan later at most
/// where heights say next to nothing.
#[test]
fn tracks_are_confirmed_as_soon_with_heights() {
    for farthest_m in [1000.0, 8000.0] {
        let (without, _) = waited(farthest_m, 0.0, 0.0);
        for sigma_height_m in [2.0, 5.0, 20.0, 80.0] {
            for share in [0.3, 0.7, 1.0] {
                let (with, beyond) = waited(farthest_m, sigma_height_m, share);
                let scene = format!("{farthest_m} m, heights of {share} to {sigma_height_m} m");
                assert!(with <= without + SCENES * DRONES, "{scene}: waited {with} scans against {without}");
                assert!(
                    sigma_height_m > 5.0 || with <= without + SCENES,
                    "{scene}: waited {with} scans against {without}"
                );
                // Two tracks of one drone are rare also where a height is sometimes missing.
                assert!(beyond * 40 < SCENES * DRONES * TURNS, "{scene}: {beyond} tracks too many");
            }
        }
    }
}
