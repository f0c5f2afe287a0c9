//! Two drones that come near each other: do their tracks keep to them?
//!
//! They converge, fly side by side for ten scans at a separation of 0.1 to 2 cells of range, and part again: each goes on to the other's side
//! (`cross`) or turns back to its own (`part`). Plots are drawn as in [`crate::world`] and each drone has one, also where a radar
//! could not resolve them (`resolved`), or where all four coordinates lie within a cell the two give a single plot of both powers
//! between them (`merged`). Both tracks are processed with independent PDA and with joint events from the same plots.
//!
//! In the last scans every track belongs to the drone that it is nearest to, within 50 m. A run counts as a *change* if each track
//! follows the other's drone, as *lost* if one of the drones is followed by none.

use common::angle;
use common::config::{Swerling, TrackerConfig};
use common::geometry::{Polar, range_rate_mps};
use common::random::{Purpose, generator};
use evaluation::gospa::gospa;
use nalgebra::Vector3;
use radar_sim::motion::{Kinematics, Segments};
use tracker::amplitude::Amplitude;
use tracker::association::{FalsePlots, Rules, Surroundings};
use tracker::gate::Radar;
use tracker::imm::{Imm, transition};
use tracker::joint::{Claimant, Sharing};
use tracker::measurement::{COORDINATES, Measurement};
use tracker::motion::{MODES, Motion};
use tracker::start::two_plots;
use tracker::track::Kinematics as TrackKinematics;
use tracker::update::{Workspace, update};

use crate::figures::{Axis, Figure, Panel, Series, Shape};
use crate::parallel::runs_with;
use crate::surround::Surround;
use crate::world::{Conditions, distance_m, measure, plot, radar};
use crate::{Case, Options, Progress, Results, Row};

/// Separations, cells of range.
const SEPARATIONS: [f64; 5] = [0.1, 0.25, 0.5, 1.0, 2.0];
/// Scans side by side.
const TOGETHER: u32 = 10;
/// Scans of converging and of parting.
const APART: u32 = 14;
/// Scans in which the speed towards each other is taken up or given up.
const TURN: u32 = 2;
/// Where they meet: range and height, m.
const RANGE_M: f64 = 1500.0;
const HEIGHT_M: f64 = 150.0;
/// Speed of each towards the other, m/s.
const CLOSING_MPS: f64 = 8.0;
/// Speed along the common course, m/s.
const ALONG_MPS: f64 = 12.0;
/// A track follows a drone within this distance, m.
const FOLLOWS_M: f64 = 50.0;
/// Cut-off and order of GOSPA.
const GOSPA: (f64, f64) = (100.0, 2.0);
/// Mode probabilities at the start.
const START: [f64; MODES] = [0.33, 0.34, 0.33];
/// What surrounds the drones.
const CONDITIONS: Conditions = Conditions { pfa: 1e-3, snr_db: 16.0, swerling: Swerling::One, reference_cells: 0 };

/// How the two part.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Course {
    /// Each goes on to the other's side.
    Cross,
    /// Each turns back to its own.
    Part,
}

/// How one run ended.
#[derive(Debug, Clone, Copy, Default)]
struct Outcome {
    changed: bool,
    lost: bool,
    gospa_m: f64,
    coalesced: f64,
}

/// Runs the experiment.
///
/// # Errors
/// None: the signature is that of all experiments.
pub fn run(options: &Options, progress: &Progress) -> anyhow::Result<Results> {
    let runs = options.runs_or(1000, 20);
    let separations = options.some_of(&SEPARATIONS);
    progress.expect(u64::from(runs) * separations.len() as u64 * 4);
    let mut results = Results { runs, ..Results::default() };
    let mut panels = Vec::new();
    for (course, name) in [(Course::Cross, "cross"), (Course::Part, "part")] {
        for merged in [false, true] {
            let plots = if merged { "merged" } else { "resolved" };
            let mut changes = [Vec::new(), Vec::new()];
            for &separation in &separations {
                progress.say(format!("{name}, {plots} plots, {separation} cells"));
                let outcomes = runs_with(options.threads, runs, progress, Pair::new, |pair, run| {
                    pair.fly(course, separation, merged, options.seed, run)
                });
                for (index, association) in ["independent", "joint"].into_iter().enumerate() {
                    let case = Case::new()
                        .with("course", name)
                        .with("plots", plots)
                        .with("separation_cells", separation)
                        .with("association", association);
                    let count =
                        |what: fn(&Outcome) -> bool| outcomes.iter().filter(|both| what(&both[index])).count() as u64;
                    let n = u64::from(runs);
                    results.rows.push(Row::proportion(&case, "p_identity_change", count(|o| o.changed), n));
                    results.rows.push(Row::proportion(&case, "p_lost", count(|o| o.lost), n));
                    let wrong = Row::proportion(&case, "p_change_or_lost", count(|o| o.changed || o.lost), n);
                    changes[index].push([separation, wrong.value, wrong.lo, wrong.hi]);
                    results.rows.push(wrong);
                    results.rows.push(Row::mean(&case, "gospa_m", outcomes.iter().map(|both| both[index].gospa_m)));
                    results.rows.push(Row::mean(
                        &case,
                        "coalesced_share",
                        outcomes.iter().map(|both| both[index].coalesced),
                    ));
                }
            }
            let [independent, joint] = changes;
            panels.push(Panel {
                title: format!("{name}, {plots} plots"),
                x: Axis::log("separation, cells of range"),
                y: Axis::linear("share of runs with a change or a loss").between(0.0, 1.0),
                series: vec![
                    Series::new("independent PDA", 0, Shape::Measured(independent)),
                    Series::new("joint events", 1, Shape::Measured(joint)),
                ],
            });
        }
    }
    results.remarks.push(format!(
        "Two targets at {:.0} dB, Swerling I, F = {}; {TOGETHER} scans side by side, closing and parting at 2 × {CLOSING_MPS} m/s.",
        CONDITIONS.snr_db,
        CONDITIONS.pfa
    ));
    results.figures.push(Figure {
        name: "crossing".into(),
        title: "Two drones near each other: tracks that change or lose their drone".into(),
        columns: 2,
        panels,
    });
    Ok(results)
}

/// Two tracks and what they need.
struct Pair {
    config: TrackerConfig,
    rules: Rules,
    motion: Motion,
    radar: Radar,
    workspace: Workspace,
    sharing: Sharing,
    shares: Vec<f64>,
    plots: Vec<Measurement>,
}

impl Pair {
    fn new() -> Self {
        let (config, radar) = (TrackerConfig::default(), radar());
        Self {
            rules: Rules::new(&config),
            motion: TrackKinematics::new(&config, &radar).motion,
            radar,
            workspace: Workspace::default(),
            sharing: Sharing::default(),
            shares: Vec::new(),
            plots: Vec::new(),
            config,
        }
    }

    /// One run: first with independent tracks, then with joint events.
    fn fly(&mut self, course: Course, separation: f64, merged: bool, seed: u64, run: u32) -> [Outcome; 2] {
        let drones = [1.0, -1.0].map(|side| path(course, separation * self.radar.cell[0], side));
        let scans: Vec<Scan> = (0..2 * APART + TOGETHER + 2 * TURN)
            .map(|scan| Scan::draw(&drones, scan, merged && scan > 1, seed, run))
            .collect();
        [false, true].map(|joint| self.follow(&scans, joint, seed, run))
    }

    fn follow(&mut self, scans: &[Scan], joint: bool, seed: u64, run: u32) -> Outcome {
        let detector = CONDITIONS.detector();
        let chain = transition(self.config.stay_probability, 1.0);
        let mut tracks: [Imm; 2] =
            std::array::from_fn(|i| two_plots(&scans[0].plots[i], &scans[1].plots[i], 1.0, &self.motion, START));
        let mut amplitudes = [Amplitude::prior(&self.config, &detector); 2];
        let mut outcome = Outcome::default();
        for (scan, sight) in scans.iter().enumerate().skip(2) {
            let predictions = tracks.map(|track| track.predict(&chain, &self.motion, 1.0));
            for amplitude in &mut amplitudes {
                amplitude.look(&self.config, &detector);
            }
            self.plots.clear();
            self.plots.extend(&sight.plots);
            let cells: f64 = self.radar.cell.iter().product();
            let clutter = |polar: &[f64; COORDINATES]| FalsePlots {
                density: CONDITIONS.pfa / cells / (polar[0] * polar[0] * polar[2].cos().max(1e-3)),
                mean_excess: 0.0,
            };
            let around = Surroundings {
                radar: &self.radar,
                detection_probability: 1.0,
                target: Some(amplitudes[0].statistics()),
                shares: &[],
                clutter,
            };
            let mut rng = generator(seed, Purpose::Clutter, run, scan as u32);
            Surround::new(&detector).draw(&predictions, &self.rules, &around, &mut rng, &mut self.plots);
            for own in 0..2 {
                let detection_probability = |of: usize| {
                    amplitudes[of].statistics().detection_probability.min(self.config.detection_probability)
                };
                let claimant = |of: usize| Claimant {
                    prediction: &predictions[of],
                    time_ns: 0,
                    existence: 1.0 - 1e-6,
                    detection_probability: detection_probability(of),
                    target: Some(amplitudes[of].statistics()),
                    seen_apart: true,
                };
                self.shares.clear();
                let plots = self.plots.len();
                if joint {
                    let rivals = std::iter::once(claimant(1 - own));
                    let (radar, inflation) = (&self.radar, self.rules.inflation);
                    let shared = self.sharing.share(&claimant(own), rivals, &self.plots, clutter, radar, inflation);
                    self.shares.extend(shared.shares);
                    self.shares.extend(shared.common.iter().map(|common| common.share));
                    self.plots.extend(shared.common.iter().map(|common| common.measurement));
                }
                let surroundings = Surroundings {
                    radar: &self.radar,
                    detection_probability: detection_probability(own),
                    target: Some(amplitudes[own].statistics()),
                    shares: &self.shares,
                    clutter,
                };
                let updated =
                    update(&predictions[own], 0, &self.plots, &surroundings, &self.rules, &mut self.workspace);
                tracks[own] = updated.posterior;
                self.plots.truncate(plots);
            }
            let places = tracks.map(|track| track.mixture().position());
            outcome.gospa_m += distance_of_both(&places, sight) / (scans.len() - 2) as f64;
            if scan >= scans.len() - 5 {
                let apart_m = (Vector3::from(places[0]) - Vector3::from(places[1])).norm();
                outcome.coalesced += f64::from(u32::from(apart_m < FOLLOWS_M)) / 5.0;
            }
        }
        let last = scans.last().expect("scans");
        let holder = |track: &Imm| {
            let at = track.mixture().position();
            let distances = last.truth.map(|truth| distance_m(at, &truth));
            let nearest = usize::from(distances[1] < distances[0]);
            (distances[nearest] < FOLLOWS_M).then_some(nearest)
        };
        let holders = [holder(&tracks[0]), holder(&tracks[1])];
        outcome.changed = holders == [Some(1), Some(0)];
        outcome.lost = (0..2).any(|drone| !holders.contains(&Some(drone)));
        outcome
    }
}

/// One scan of both drones.
struct Scan {
    truth: [Kinematics; 2],
    /// What is detected of them.
    plots: Vec<Measurement>,
}

impl Scan {
    fn draw(drones: &[Segments; 2], scan: u32, may_merge: bool, seed: u64, run: u32) -> Self {
        let mut rng = generator(seed, Purpose::Measurement, run, scan);
        let truth = [0, 1].map(|i: usize| drones[i].at(f64::from(scan)));
        let both = truth.map(|truth| measure(&truth, &CONDITIONS, &mut rng));
        let radar = radar();
        let near = |i: usize| {
            let [a, b] = truth.map(|truth| polar(&truth));
            offset(a, b, i).abs() < radar.cell[i]
        };
        let mut plots = if may_merge && (0..COORDINATES).all(near) {
            let share = both[0].power / (both[0].power + both[1].power);
            let between = |i| both[1].polar[i] + share * offset(both[0].polar, both[1].polar, i);
            vec![plot(std::array::from_fn(between), both[0].power + both[1].power)]
        } else {
            both.to_vec()
        };
        if scan > 1 {
            plots.retain(|plot| plot.power > CONDITIONS.detector().threshold);
        }
        Self { truth, plots }
    }
}

/// Where the radar sees a target.
fn polar(truth: &Kinematics) -> [f64; COORDINATES] {
    let place = Polar::from_enu(&truth.position_m);
    let rate = range_rate_mps(&truth.position_m, &truth.velocity_mps);
    [place.range_m, place.azimuth_rad, place.elevation_rad, rate]
}

/// Coordinate `i` of `a` minus that of `b`.
fn offset(a: [f64; COORDINATES], b: [f64; COORDINATES], i: usize) -> f64 {
    if i == 1 { angle::difference(a[i], b[i]) } else { a[i] - b[i] }
}

/// The way of one drone: `side` of the middle, north of the antenna and flying east.
fn path(course: Course, separation_m: f64, side: f64) -> Segments {
    let total_s = f64::from(2 * APART + TOGETHER + 2 * TURN);
    let north_m = RANGE_M + side * (0.5 * separation_m + CLOSING_MPS * (f64::from(APART) + 0.5 * f64::from(TURN)));
    let start = Vector3::new(-0.5 * ALONG_MPS * total_s, north_m, HEIGHT_M);
    let turn = side * CLOSING_MPS / f64::from(TURN);
    let away = if course == Course::Cross { -turn } else { turn };
    let steps = [(0.0, 0.0, APART), (turn, 0.0, TURN), (0.0, 0.0, TOGETHER), (away, 0.0, TURN)];
    Segments::new(start, Vector3::new(ALONG_MPS, -side * CLOSING_MPS, 0.0), &steps)
}

/// GOSPA of the two tracks, m.
fn distance_of_both(places: &[[f64; 3]; 2], scan: &Scan) -> f64 {
    let mut distances = Vec::with_capacity(4);
    for (target, truth) in scan.truth.iter().enumerate() {
        for (track, place) in places.iter().enumerate() {
            distances.push((target, track, distance_m(*place, truth)));
        }
    }
    gospa(2, 2, &distances, GOSPA.0, GOSPA.1).distance
}
