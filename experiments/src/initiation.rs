//! `initiation`: new targets confirmed in time against false tracks, for both logics of the tracker.
//!
//! The tracker is fed with the drawn plots of a turning radar ([`crate::turning`]): one target, which appears after
//! 8 turns in a place drawn anew in every run, and false plots. A target is *confirmed* if a confirmed track is
//! within 200 m of it in one of its first 10 turns; a *false track* is one that is confirmed, after the first turns, and never
//! that near. Three things are swept, each value a point of a receiver curve: the threshold of existence that confirms, M of N,
//! and, at the usual threshold, the density of new targets that a pair of plots is weighed with before a track starts at all.
//!
//! All cases see the same targets and draws: they differ from each other by less than their intervals say, and may miss
//! their references together.
//!
//! The reference of M-of-N counts all sequences of hits and misses of the window that confirm, weighted by (C4): what
//! there would be without false plots and without errors of association.

use std::collections::BTreeMap;

use common::amplitude::Detector;
use common::config::{Logic, Swerling, TrackerConfig};
use common::random::{Purpose, generator};
use common::units::from_db;
use evaluation::initiation::delay_scans;
use serde_json::Value;
use tracker::Tracker;

use crate::figures::{Axis, Figure, Panel, Series, Shape};
use crate::fluctuation;
use crate::parallel::runs;
use crate::turning::{CELLS, PERIOD_S, Target, Turning, scan_of};
use crate::{Case, Options, Progress, Results, Row};

/// Mean signal-to-noise ratios, dB.
const SNR_DB: [f64; 3] = [10.0, 13.0, 16.0];
/// F per cell.
const PFA: [f64; 3] = [1e-5, 1e-4, 1e-3];
/// Kinds of targets.
const SWERLING: [Swerling; 2] = [Swerling::Zero, Swerling::One];
/// Thresholds of existence.
const EXISTENCE: [f64; 4] = [0.05, 0.5, 0.99, 0.9999];
/// New targets expected per cell and scan (usually 10⁻⁹), with the usual threshold of existence.
const START_DENSITY: [f64; 4] = [1e-7, 1e-5, 1e-3, 1e-1];
/// M-of-N: hits that confirm and the scans in which they must come.
const M_OF_N: [[u32; 2]; 4] = [[2, 2], [3, 4], [3, 5], [4, 6]];
/// First turn of the target: its predecessors make the false plots and their tracks usual.
const FIRST_SCAN: u32 = 8;
/// Turns in which it has to be confirmed.
const WINDOW: u32 = 10;
/// False tracks count from this turn on.
const WARM_UP: u32 = 6;
/// Turns of a run.
const SCANS: u32 = 24;
/// A track is the target's within this distance, m.
const NEAR_M: f64 = 200.0;

/// A logic with its threshold.
#[derive(Debug, Clone, Copy)]
enum Confirm {
    Existence(f64),
    StartDensity(f64),
    MOfN([u32; 2]),
}

impl Confirm {
    fn config(self) -> TrackerConfig {
        let config = TrackerConfig::default();
        match self {
            Self::Existence(threshold) => TrackerConfig { confirm_existence: threshold, ..config },
            Self::StartDensity(density) => TrackerConfig { start_density: density, ..config },
            Self::MOfN([hits, scans]) => {
                TrackerConfig { logic: Logic::MOfN, confirm_hits: hits, confirm_scans: scans, ..config }
            }
        }
    }

    fn logic(self) -> &'static str {
        match self {
            Self::Existence(_) => "existence",
            Self::StartDensity(_) => "start-density",
            Self::MOfN(_) => "m-of-n",
        }
    }

    fn parameter(self) -> Value {
        match self {
            Self::Existence(value) | Self::StartDensity(value) => value.into(),
            Self::MOfN([hits, scans]) => format!("{hits}/{scans}").into(),
        }
    }
}

/// Radar and target of one case.
#[derive(Debug, Clone, Copy)]
struct Setting {
    swerling: Swerling,
    pfa: f64,
    snr_db: f64,
}

/// What one run with one logic has brought.
#[derive(Debug, Clone, Copy)]
struct Outcome {
    delay: Option<u64>,
    false_tracks: u64,
}

/// Runs the experiment: 80 runs in each case.
///
/// # Errors
/// If the tracker refuses a threshold.
pub fn run(options: &Options, progress: &Progress) -> anyhow::Result<Results> {
    let runs_of_each = options.runs_or(80, 2);
    let existence = options.some_of(&EXISTENCE).into_iter().map(Confirm::Existence);
    let start_density = options.some_of(&START_DENSITY).into_iter().map(Confirm::StartDensity);
    let m_of_n = options.some_of(&M_OF_N).into_iter().map(Confirm::MOfN);
    let confirm: Vec<Confirm> = existence.chain(start_density).chain(m_of_n).collect();
    let settings = settings(options);
    progress.expect(u64::from(runs_of_each) * settings.len() as u64);
    let hours = f64::from(runs_of_each) * f64::from(SCANS - WARM_UP) * PERIOD_S / 3600.0;
    let mut results = Results { runs: runs_of_each, ..Results::default() };
    // From half of a single false track to one in thirty scans.
    let limits = [0.4 / hours, 3600.0 / PERIOD_S / 30.0];
    for (place, setting) in settings.iter().enumerate() {
        progress.say(format!("F = {:e}, {} dB", setting.pfa, setting.snr_db));
        let all = runs(options.threads, runs_of_each, progress, |run| one_run(options.seed, run, setting, &confirm));
        let outcomes: Vec<Vec<Outcome>> = all.into_iter().collect::<anyhow::Result<_>>()?;
        let rows: Vec<[Row; 3]> = confirm
            .iter()
            .enumerate()
            .map(|(place, confirm)| rows(setting, *confirm, outcomes.iter().map(|run| run[place])))
            .collect();
        if place == 0 || settings[place - 1].swerling != setting.swerling {
            results.figures.push(figure(setting.swerling, options));
        }
        let figure = results.figures.last_mut().expect("the figure of its kind of target");
        figure.panels.push(panel(setting, curves(&confirm, &rows, hours.recip()), limits));
        results.rows.extend(rows.into_iter().flatten());
    }
    results.remarks.push(format!(
        "False tracks are those of {CELLS} cells (45° × 2.8° × 4.85 km × 208 m/s) a scan of {PERIOD_S} s, seen for {hours:.2} hours in each case."
    ));
    Ok(results)
}

fn settings(options: &Options) -> Vec<Setting> {
    let mut settings = Vec::new();
    for swerling in SWERLING {
        for pfa in options.some_of(&PFA) {
            for snr_db in options.some_of(&SNR_DB) {
                settings.push(Setting { swerling, pfa, snr_db });
            }
        }
    }
    settings
}

/// All logics on the same plots.
fn one_run(seed: u64, run: u32, setting: &Setting, confirm: &[Confirm]) -> anyhow::Result<Vec<Outcome>> {
    let target = Target::somewhere(FIRST_SCAN, &mut generator(seed, Purpose::Trajectory, run, 0));
    let radar = Turning { seed, run, pfa: setting.pfa, swerling: setting.swerling, snr_db: setting.snr_db };
    let messages = radar.messages(&target, SCANS);
    let outcome = |confirm: &Confirm| {
        let mut tracker = Tracker::new(&confirm.config(), 1)?;
        let mut tracks = Vec::new();
        let mut followed = [false; SCANS as usize];
        // By track: when it was confirmed, and whether it ever was near the target.
        let mut confirmed: BTreeMap<u64, (u32, bool)> = BTreeMap::new();
        for (header, plots) in &messages {
            tracker.take(header, plots, &mut tracks);
            for track in tracks.iter().filter(|track| track.is_confirmed()) {
                let scan = scan_of(track.time_ns).min(SCANS - 1);
                let distance = nalgebra::Vector3::from(track.position_m()) - target.position_at(track.time_ns);
                let near = scan >= FIRST_SCAN && distance.norm() <= NEAR_M;
                followed[scan as usize] |= near;
                confirmed.entry(track.id).or_insert((scan, false)).1 |= near;
            }
        }
        let window = (0..FIRST_SCAN + WINDOW).map(|scan| (scan >= FIRST_SCAN, followed[scan as usize]));
        let is_false = |&&(scan, near): &&(u32, bool)| scan >= WARM_UP && !near;
        Ok(Outcome { delay: delay_scans(window), false_tracks: confirmed.values().filter(is_false).count() as u64 })
    };
    confirm.iter().map(outcome).collect()
}

fn rows(setting: &Setting, confirm: Confirm, outcomes: impl Iterator<Item = Outcome>) -> [Row; 3] {
    let outcomes: Vec<Outcome> = outcomes.collect();
    let n = outcomes.len() as u64;
    let case = Case::new()
        .with("snr_db", setting.snr_db)
        .with("pfa", setting.pfa)
        .with("swerling", fluctuation::parameter(setting.swerling))
        .with("logic", confirm.logic())
        .with("confirm", confirm.parameter());
    let delays = || outcomes.iter().filter_map(|outcome| outcome.delay);
    let false_tracks = outcomes.iter().map(|outcome| outcome.false_tracks).sum();
    let seconds = n as f64 * f64::from(SCANS - WARM_UP) * PERIOD_S;
    let mut p_confirmed = Row::proportion(&case, "p_confirmed", delays().count() as u64, n);
    if let Confirm::MOfN(m_of_n) = confirm {
        let detector = Detector::new(setting.pfa, 0);
        let pd = detector.target(setting.swerling, from_db(setting.snr_db)).detection_probability;
        let misses = confirm.config().tentative_misses;
        p_confirmed = p_confirmed.against(perfect_m_of_n(pd, m_of_n, misses), "all sequences, perfect association");
    }
    [
        p_confirmed,
        Row::mean(&case, "delay_scans", delays().map(|delay| delay as f64)),
        Row::per_hour(&case, "false_tracks_per_hour", false_tracks, seconds),
    ]
}

/// Probability that a target detected with `pd` in every scan, independently, is confirmed within [`WINDOW`] scans by hits alone.
///
/// Two hits in a row start a track; it is confirmed by `hits` hits in `scans` scans, the two included, and ends when
/// these are over or after `misses` scans in a row without one.
fn perfect_m_of_n(pd: f64, [hits, scans]: [u32; 2], misses: u32) -> f64 {
    let confirms = |sequence: u32| {
        let mut track: Option<[u32; 3]> = None; // age, hits, misses in a row
        for scan in 0..WINDOW {
            let hit = |scan: u32| sequence >> scan & 1 == 1;
            track = match track {
                None if scan > 0 && hit(scan) && hit(scan - 1) => Some([2, 2, 0]),
                None => None,
                Some([age, seen, _]) if hit(scan) => Some([age + 1, seen + 1, 0]),
                Some([age, seen, missed]) => Some([age + 1, seen, missed + 1]),
            };
            if let Some([age, seen, missed]) = track {
                if seen >= hits && age <= scans && hit(scan) {
                    return true;
                }
                if age > scans || missed >= misses {
                    track = None;
                }
            }
        }
        false
    };
    let probability = |sequence: u32| {
        let detected = sequence.count_ones() as i32;
        pd.powi(detected) * (1.0 - pd).powi(WINDOW as i32 - detected)
    };
    (0..1 << WINDOW).filter(|&sequence| confirms(sequence)).map(probability).sum()
}

/// Where no false track was seen, the point is drawn at this many of them.
const NONE: f64 = 0.5;

/// The receiver curves of one case, where a single false track is a rate of `one_per_hour`.
fn curves(confirm: &[Confirm], rows: &[[Row; 3]], one_per_hour: f64) -> Vec<Series> {
    let rate = |row: &Row| if row.n == 0 { NONE * one_per_hour } else { row.value };
    let points = |logic: &str| -> Vec<[f64; 4]> {
        let of_logic = confirm.iter().zip(rows).filter(|(confirm, _)| confirm.logic() == logic);
        of_logic.map(|(_, [p, _, false_tracks])| [rate(false_tracks), p.value, p.lo, p.hi]).collect()
    };
    [("existence", 0), ("start-density", 1), ("m-of-n", 2)]
        .into_iter()
        .map(|(logic, place)| Series::new(format!("{logic} swept"), place, Shape::Measured(points(logic))))
        .collect()
}

fn figure(swerling: Swerling, options: &Options) -> Figure {
    let name = fluctuation::name(swerling);
    Figure {
        name: format!("initiation-swerling-{name}"),
        title: format!("Swerling {name}: confirmed within {WINDOW} scans against false tracks ({CELLS} cells a scan)"),
        columns: options.some_of(&SNR_DB).len(),
        panels: Vec::new(),
    }
}

fn panel(setting: &Setting, series: Vec<Series>, [lo, hi]: [f64; 2]) -> Panel {
    Panel {
        title: format!("{} dB, F = {:e}", setting.snr_db, setting.pfa),
        x: Axis::log("false tracks per hour (none: at half of one)").between(lo, hi),
        y: Axis::linear("probability of confirmation").between(0.0, 1.0),
        series,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn perfect_logic_by_hand() {
        // Two of two: at least one pair of neighbours in ten. The complement is counted by Fibonacci-like recursion.
        let pd: f64 = 0.7;
        let (mut last_missed, mut last_hit) = (1.0 - pd, pd);
        for _ in 1..WINDOW {
            (last_missed, last_hit) = ((last_missed + last_hit) * (1.0 - pd), last_missed * pd);
        }
        assert!((perfect_m_of_n(pd, [2, 2], 3) - (1.0 - last_missed - last_hit)).abs() < 1e-12);
        assert!((perfect_m_of_n(1.0, [4, 6], 3) - 1.0).abs() < 1e-12);
        assert!(perfect_m_of_n(0.0, [2, 2], 3).abs() < 1e-12);
        assert!(perfect_m_of_n(0.5, [4, 6], 3) < perfect_m_of_n(0.5, [3, 5], 3));
    }
}
