//! Trajectory B through simulated cells, the plot extractor and the whole tracker, beside drawn plots of the same F, N and SNR.
//!
//! ```text
//! cells   radar-sim ─▶ plot-extractor ─▶ tracker, which starts and confirms by itself; 16 dB at the centre of a cell at any range
//! plots   drawn plots (C1) ─▶ the filter alone, begun on the target
//! ```
//!
//! Only the cells about the target are simulated: 24 dwells to either side, all Doppler cells, and the beams and ranges of the flight
//! with a margin; elsewhere the tracker gets turns without plots. Scored are updates of confirmed tracks within 150 m of the
//! target, in the scans k = 1…50. The beam passes at a fraction of a second after the start of a turn: the truth is that of this
//! time, and k the scan that it is nearest to.

use std::convert::Infallible;
use std::f64::consts::TAU;

use anyhow::Context;
use common::angle;
use common::config::{ChainConfig, MotionConfig, Swerling, TargetConfig, TrackerConfig};
use common::geometry::{Polar, range_rate_mps};
use common::message::{END_OF_SCAN, END_OF_STREAM};
use common::plots::{Plot, PlotsHeader};
use common::random::{Purpose, generator};
use common::units::NS_PER_S;
use evaluation::consistency::normalised_square;
use nalgebra::{Matrix3, Vector3};
use plot_extractor::PlotExtractor;
use radar_sim::DwellSimulator;
use radar_sim::motion::{Kinematics, Segments};
use rand::Rng;
use tracker::Tracker;
use tracker::track::LiveTrack;

use super::{Score, rows};
use crate::follow::{Follower, LOST_DISTANCE_M};
use crate::parallel::{runs, runs_with};
use crate::settings::Settings;
use crate::trajectory::{SCANS, Trajectory};
use crate::world::{Conditions, mode_before, sights};
use crate::{Case, Options, Progress, Results, Row, fluctuation};

/// F per cell.
const PFA: [f64; 2] = [1e-4, 1e-3];
/// Peak SNR of the target.
const SNR_DB: f64 = 16.0;
/// Dwells simulated on each side of the target.
const DWELLS: u32 = 24;
/// Beams and range cells simulated beyond the flight on each side.
const MARGIN: f64 = 12.0;
/// A plot is the target's within this distance on every axis, cells.
const NEAR_CELLS: f64 = 1.5;

/// One run.
#[derive(Debug, Default)]
struct Flight {
    scores: Vec<Score>,
    detected: u64,
}

pub(super) fn run(options: &Options, progress: &Progress) -> anyhow::Result<Results> {
    let runs_of_each = options.runs_or(200, 2);
    let mut results = Results { runs: runs_of_each, ..Results::default() };
    let kinds = [Swerling::Zero, Swerling::One];
    let pfas = if options.quick { &PFA[..1] } else { &PFA };
    progress.expect(u64::from(runs_of_each) * 2 * (kinds.len() * pfas.len()) as u64);
    for swerling in kinds {
        for &pfa in pfas {
            progress.say(format!("Swerling {}, F = {pfa:e}", fluctuation::name(swerling)));
            let through = |run| through_cells(options.seed, run, swerling, pfa);
            let flights = runs(options.threads, runs_of_each, progress, through);
            let flights = flights.into_iter().collect::<anyhow::Result<Vec<_>>>()?;
            results.rows.extend(rows_of("cells", swerling, pfa, &flights, options.seed));
            let reference_cells = 2 * ChainConfig::default().extractor.reference_cells;
            let conditions = Conditions { pfa, reference_cells, snr_db: SNR_DB, swerling };
            let follower = || Follower::new(&Settings::Default.config(&conditions), &conditions);
            let flights = runs_with(options.threads, runs_of_each, progress, follower, |follower, run| {
                drawn(follower, &conditions, options.seed, run)
            });
            results.rows.extend(rows_of("plots", swerling, pfa, &flights, options.seed));
        }
    }
    results.remarks.push(
        "Cells against drawn plots: (1) the extractor interpolates between cells, so that plots err less than a position that is \
         uniform in its cell (C1), as the drawn ones do: estimates are better, most so of a steady target. Both state their errors: the NEES agree. \
         (2) 16 dB hold at the centre of a cell: between cells up to some dB are lost, though neighbours have a chance of \
         their own; pd differs by the balance of the two, and a false plot within 1.5 cells counts as the target's. (3) The beam \
         passes 0.1 to 0.25 s after the start of the turn, so that manoeuvres begin between scans. (4) Through cells only confirmed \
         tracks count, that the tracker has begun itself: `p_followed` is the share of scans in which there is one."
            .into(),
    );
    Ok(results)
}

fn rows_of(source: &'static str, swerling: Swerling, pfa: f64, flights: &[Flight], seed: u64) -> Vec<Row> {
    let case = |segment: &'static str| {
        Case::new()
            .with("trajectory", "B")
            .with("settings", "default")
            .with("segment", segment)
            .with("source", source)
            .with("swerling", fluctuation::parameter(swerling))
            .with("pfa", pfa)
    };
    let scores: Vec<Vec<Score>> = flights.iter().map(|flight| flight.scores.clone()).collect();
    let mut all = Vec::new();
    for (place, segment) in (0..).zip(Trajectory::B.segments()) {
        all.extend(rows(&case(segment.name), &scores, &segment, [seed, place]));
        if segment.name == "all" {
            let scans = u64::from(SCANS);
            let detected: Vec<[u64; 2]> = flights.iter().map(|flight| [flight.detected, scans]).collect();
            let followed: Vec<[u64; 2]> = flights.iter().map(|flight| [flight.scores.len() as u64, scans]).collect();
            all.push(Row::clustered(&case("all"), "pd", &detected));
            all.push(Row::clustered(&case("all"), "p_followed", &followed));
        }
    }
    all
}

/// The filter on drawn plots.
fn drawn(follower: &mut Follower, conditions: &Conditions, seed: u64, run: u32) -> Flight {
    let sights = sights(Trajectory::B, conditions, seed, run);
    let mut flight = Flight::default();
    follower.watch(&sights, seed, run, |record, _| {
        flight.detected += u64::from(sights[record.k as usize + 1].detected);
        if record.position_error_m.norm() <= LOST_DISTANCE_M {
            let errors = [record.predicted_error_m, record.position_error_m, record.velocity_error_mps];
            flight.scores.push(Score::new(record.k, errors, record.nees_position, record.correct));
        }
    });
    flight
}

/// The chain from cells to tracks.
fn through_cells(seed: u64, run: u32, swerling: Swerling, pfa: f64) -> anyhow::Result<Flight> {
    let motion = Trajectory::B.motion(seed, run);
    let mut chain = radar_about(&motion);
    chain.extractor.pfa = pfa;
    chain.run.seed = generator(seed, Purpose::Trajectory, run, 1).next_u64();
    chain.sim.targets = vec![TargetConfig {
        name: "b".into(),
        motion: MotionConfig::Trajectory { trajectory: "b".into(), shift_m: [0.0; 3] },
        rcs_m2: None,
        snr_db: Some(SNR_DB),
        swerling,
        first_scan: 0,
    }];
    let mut simulator = DwellSimulator::new(&chain).context("making a scenario of trajectory B")?;
    let mut extractor = PlotExtractor::new(&chain.extractor, &chain.radar);
    let mut tracker = Tracker::new(&TrackerConfig::default(), 1).context("making a tracker")?;
    let mut amplitudes = vec![0.0; simulator.cells()];
    let (mut truth, mut tracks, mut plots) = (Vec::new(), Vec::new(), Vec::new());
    let mut flight = Flight::default();
    // Scan 0 is k = −1.
    for scan in 0..SCANS + 2 {
        simulator.truth(scan, &mut truth);
        let passed = truth.first().context("the target exists in every scan")?;
        plots.clear();
        detect(
            &mut simulator,
            &mut extractor,
            scan,
            &Polar::from_enu(&passed.position_m().into()),
            &mut amplitudes,
            &mut plots,
        );
        let k = nearest_scan(seconds(&chain, passed.time_ns));
        let is_counted = (1..=i64::from(SCANS)).contains(&k);
        if is_counted {
            let state = motion.at(seconds(&chain, passed.time_ns));
            flight.detected += u64::from(plots.iter().any(|plot| is_near(&chain, plot, &state)));
        }
        let mut best: Option<(f64, Score)> = None;
        for (header, plots) in messages(&chain, &simulator, scan, &plots) {
            tracker.take(&header, &plots, &mut tracks);
            for updated in tracks.iter().filter(|track| track.is_confirmed()) {
                let Some(track) = tracker.alive().iter().find(|track| track.id == updated.id) else { continue };
                let (distance_m, score) = score(track, &motion, seconds(&chain, track.time_ns));
                if distance_m <= LOST_DISTANCE_M && best.is_none_or(|(least, _)| distance_m < least) {
                    best = Some((distance_m, score));
                }
            }
        }
        flight.scores.extend(best.map(|(_, score)| score).filter(|score| (1..=SCANS).contains(&score.k)));
    }
    Ok(flight)
}

/// The default radar, with no more beams and ranges than the flight needs.
fn radar_about(motion: &Segments) -> ChainConfig {
    let mut chain = ChainConfig::default();
    let places: Vec<Polar> =
        (0..=4 * (SCANS + 2)).map(|i| Polar::from_enu(&motion.at(0.25 * f64::from(i)).position_m)).collect();
    let ends = |of: fn(&Polar) -> f64| {
        places.iter().map(of).fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], x| [lo.min(x), hi.max(x)])
    };
    // Whole cells of the default radar.
    let cut = |[lo, hi]: [f64; 2], first: f64, step: f64, cells: u32| {
        let from = ((lo - first) / step - MARGIN).floor().max(0.0);
        let to = ((hi - first) / step + MARGIN).ceil().min(f64::from(cells - 1));
        (first + from * step, (to - from) as u32 + 1)
    };
    let radar = &mut chain.radar;
    let elevations_deg = ends(|place| place.elevation_rad.to_degrees());
    (radar.elevation_first_deg, radar.elevations) =
        cut(elevations_deg, radar.elevation_first_deg, radar.elevation_step_deg, radar.elevations);
    (radar.range_first_m, radar.ranges) =
        cut(ends(|place| place.range_m), radar.range_first_m, radar.range_step_m, radar.ranges);
    chain.sim.clutter.range_m = 0.0;
    chain
}

/// Plots of the dwells about the target in one scan.
fn detect(
    simulator: &mut DwellSimulator,
    extractor: &mut PlotExtractor,
    scan: u32,
    place: &Polar,
    amplitudes: &mut [f32],
    plots: &mut Vec<Plot>,
) {
    let dwells_per_scan = simulator.header(scan, 0).dwells_per_scan;
    let nearest = (place.azimuth_rad / TAU * f64::from(dwells_per_scan)) as u32;
    let last = nearest + DWELLS;
    for dwell in nearest - DWELLS..=last {
        simulator.fill(scan, dwell, amplitudes);
        let mut header = simulator.header(scan, dwell);
        if dwell == last {
            header.flags |= END_OF_STREAM; // Closes all clusters.
        }
        let taken = extractor.take(&header, amplitudes, 0, |_, found| {
            plots.extend_from_slice(found);
            Ok::<(), Infallible>(())
        });
        assert_eq!(taken, Ok(None), "a simulated dwell is accepted");
    }
}

/// The sectors of a turn with the plots that lie in them.
fn messages(
    chain: &ChainConfig,
    simulator: &DwellSimulator,
    scan: u32,
    plots: &[Plot],
) -> Vec<(PlotsHeader, Vec<Plot>)> {
    let sectors = chain.radar.sectors_per_scan;
    let start = simulator.header(scan, 0);
    let at = |sector: u32| TAU * f64::from(sector) / f64::from(sectors);
    let end_ns = |sector: u32| {
        let seconds = (f64::from(scan) + f64::from(sector + 1) / f64::from(sectors)) * chain.radar.scan_period_s;
        chain.run.epoch_s * 1_000_000_000 + (seconds * NS_PER_S) as u64
    };
    (0..sectors)
        .map(|sector| {
            let header = PlotsHeader {
                seq: u64::from(scan) * u64::from(sectors) + u64::from(sector),
                session: 1,
                time_ns: end_ns(sector),
                covered_from_rad: at(sector),
                covered_to_rad: at(sector + 1),
                scan_period_s: chain.radar.scan_period_s,
                pfa: chain.extractor.pfa,
                cell_range_m: start.range_step_m,
                cell_azimuth_rad: start.azimuth_step_rad,
                cell_elevation_rad: start.elevation_step_rad,
                cell_range_rate_mps: start.range_rate_step_mps,
                reference_cells: 2 * chain.extractor.reference_cells,
                scan,
                sector,
                sectors_per_scan: sectors,
                flags: if sector + 1 == sectors { END_OF_SCAN } else { 0 },
                ..PlotsHeader::default()
            };
            let inside = |plot: &&Plot| (at(sector)..at(sector + 1)).contains(&plot.azimuth_rad);
            (header, plots.iter().filter(inside).copied().collect())
        })
        .collect()
}

/// Time since k = −1, s.
fn seconds(chain: &ChainConfig, time_ns: u64) -> f64 {
    time_ns.saturating_sub(chain.run.epoch_s * 1_000_000_000) as f64 / NS_PER_S
}

/// k of the whole second that a time is nearest to.
fn nearest_scan(time_s: f64) -> i64 {
    time_s.round() as i64 - 1
}

fn is_near(chain: &ChainConfig, plot: &Plot, state: &Kinematics) -> bool {
    let place = Polar::from_enu(&state.position_m);
    let radar = &chain.radar;
    let span_mps = radar.range_rate_step_mps * f64::from(radar.dopplers);
    let rate = plot.range_rate_mps - range_rate_mps(&state.position_m, &state.velocity_mps);
    let cells = [
        (plot.range_m - place.range_m) / radar.range_step_m,
        angle::difference(plot.azimuth_rad, place.azimuth_rad) / TAU * f64::from(radar.dwells_per_scan),
        (plot.elevation_rad - place.elevation_rad) / radar.elevation_step_deg.to_radians(),
        (rate - span_mps * (rate / span_mps).round()) / radar.range_rate_step_mps,
    ];
    cells.iter().all(|offset| offset.abs() <= NEAR_CELLS)
}

/// Distance of a track from the truth at its time, and the errors of its last update.
fn score(track: &LiveTrack, motion: &Segments, time_s: f64) -> (f64, Score) {
    let truth = motion.at(time_s);
    let (estimate, predicted) = (track.posterior.mixture(), track.last.prediction.mixture());
    let p = &estimate.covariance;
    let covariance = Matrix3::new(p[0], p[1], p[3], p[1], p[2], p[4], p[3], p[4], p[5]);
    let error = Vector3::from(estimate.position()) - truth.position_m;
    let errors = [
        Vector3::from(predicted.position()) - truth.position_m,
        error,
        Vector3::from(estimate.velocity()) - truth.velocity_mps,
    ];
    let k = nearest_scan(time_s);
    let correct = track.posterior.most_probable() == mode_before(motion, (k + 1) as f64);
    let nees = normalised_square(&error, &covariance).unwrap_or(f64::NAN);
    (error.norm(), Score::new(k.max(0) as u32, errors, nees, correct))
}
