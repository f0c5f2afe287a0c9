//! One target cell in noise: how often it is detected, and how strong it then is.
//!
//! The target fills the cell under test alone, as (C4) assumes: no straddling, no skirts in the reference cells.

use common::amplitude::Detector;
use common::config::Swerling;
use common::random::{Purpose, generator};
use common::units::from_db;
use plot_extractor::cfar::{CaCfar, Hit};
use radar_sim::echo::Echoes;
use radar_sim::{fluctuation as simulated, noise};
use rand::RngExt;

use super::GUARD;
use crate::figures::{Axis, Figure, GREY, Panel, Series, Shape};
use crate::fluctuation;
use crate::parallel::runs;
use crate::{Case, Options, Progress, Results, Row};

/// F, probabilities of false alarm that are set.
const PFA: [f64; 2] = [1e-4, 1e-6];
/// N, reference cells on both sides together.
const REFERENCE_CELLS: [u32; 2] = [16, 32];
/// S, dB.
const SNR_DB: [f64; 9] = [0.0, 3.0, 6.0, 9.0, 12.0, 15.0, 18.0, 21.0, 24.0];
/// Targets of each case in one run.
const TARGETS: usize = 16;
/// Where the tail is looked at: F, N and S.
const TAIL: (f64, u32, f64) = (1e-4, 16, 15.0);
/// Excess of z² over the threshold there.
const EXCESS: [f64; 9] = [0.0, 5.0, 10.0, 20.0, 30.0, 50.0, 75.0, 100.0, 150.0];

#[derive(Debug, Clone, Copy)]
struct Setting {
    swerling: Swerling,
    detector: Detector,
    reference_cells: u32,
    snr_db: f64,
}

impl Setting {
    fn case(&self) -> Case {
        Case::new()
            .with("pfa", self.detector.pfa)
            .with("reference_cells", self.reference_cells)
            .with("swerling", fluctuation::parameter(self.swerling))
            .with("snr_db", self.snr_db)
    }

    /// P_S(q > t) with `reference_cells` other than its own, for comparison.
    fn detection_probability(&self, reference_cells: u32) -> f64 {
        let detector = Detector::new(self.detector.pfa, reference_cells);
        detector.target(self.swerling, from_db(self.snr_db)).detection_probability
    }

    fn is_tail(&self) -> bool {
        (self.detector.pfa, self.reference_cells, self.snr_db) == TAIL
    }

    /// The detections of [`TARGETS`] targets.
    fn simulate(&self, seed: u64, run: u32, index: u32, hits: &mut Vec<Hit>) {
        let reference = self.reference_cells as usize / 2;
        let (half, ranges) = (GUARD + reference, 2 * (GUARD + reference) + 1);
        let mut rng = generator(seed, Purpose::Noise, run, 1 + index);
        let mut amplitudes = vec![0.0; TARGETS * ranges];
        noise::fill(&mut amplitudes, &mut rng);
        let mut echoes = Echoes::default();
        for target in 0..TARGETS {
            let id = index * TARGETS as u32 + target as u32;
            let power = from_db(self.snr_db) * simulated::power(self.swerling, seed, run, id);
            echoes.add(target * ranges + half, power.sqrt(), 0.0);
        }
        echoes.apply(&mut amplitudes, || rng.random::<f32>() * std::f32::consts::TAU);
        let mut powers = vec![0.0; amplitudes.len()];
        hits.clear();
        CaCfar::new(ranges, GUARD, reference, self.detector.pfa).detect(&amplitudes, &mut powers, hits);
        hits.retain(|hit| hit.cell as usize % ranges == half);
    }
}

/// What one run has counted.
struct Counts {
    /// Detections, by setting.
    detected: Vec<u64>,
    /// z² of the detections where the tail is looked at, by setting.
    tail: Vec<(usize, f64)>,
}

/// Measures `pd`; draws it over S, and the tail.
pub fn measure(options: &Options, runs_of_each: u32, progress: &Progress, results: &mut Results) {
    let settings = settings(options);
    let counts = runs(options.threads, runs_of_each, progress, |run| {
        let mut counts = Counts { detected: Vec::with_capacity(settings.len()), tail: Vec::new() };
        let mut hits = Vec::new();
        for (place, setting) in settings.iter().enumerate() {
            setting.simulate(options.seed, run, place as u32, &mut hits);
            counts.detected.push(hits.len() as u64);
            if setting.is_tail() {
                let statistic = |hit: &Hit| f64::from(hit.power) / f64::from(hit.noise);
                counts.tail.extend(hits.iter().map(|hit| (place, statistic(hit))));
            }
        }
        counts
    });
    let trials = u64::from(runs_of_each) * TARGETS as u64;
    let first = results.rows.len();
    for (place, setting) in settings.iter().enumerate() {
        let detected = counts.iter().map(|run| run.detected[place]).sum();
        let expected = setting.detection_probability(setting.reference_cells);
        results.rows.push(Row::proportion(&setting.case(), "pd", detected, trials).against(expected, "(C4), exact"));
    }
    let measured: Vec<(Setting, &Row)> = settings.iter().copied().zip(&results.rows[first..]).collect();
    let figures = PFA.map(|pfa| over_snr(pfa, &measured));
    let tails = fluctuation::ALL.map(|swerling| {
        let place = settings.iter().position(|setting| setting.is_tail() && setting.swerling == swerling);
        let all = || counts.iter().flat_map(|run| &run.tail).filter(|(of, _)| Some(*of) == place);
        tail_panel(swerling, &all().map(|&(_, z2)| z2).collect::<Vec<_>>())
    });
    results.figures.extend(figures);
    results.figures.push(Figure {
        name: "cfar-target-statistic".into(),
        title: format!("Decision statistic of detected targets (F = {:e}, N = {}, SNR {} dB)", TAIL.0, TAIL.1, TAIL.2),
        columns: 3,
        panels: tails.into(),
    });
}

fn settings(options: &Options) -> Vec<Setting> {
    let mut settings = Vec::new();
    for pfa in PFA {
        for cells in REFERENCE_CELLS {
            let detector = Detector::new(pfa, cells);
            for swerling in fluctuation::ALL {
                for snr_db in options.some_of(&SNR_DB) {
                    settings.push(Setting { swerling, detector, reference_cells: cells, snr_db });
                }
            }
        }
    }
    settings
}

/// Detection over S, one panel for each kind of target.
fn over_snr(pfa: f64, measured: &[(Setting, &Row)]) -> Figure {
    let panel = |swerling: Swerling| {
        let of = |cells: u32| {
            let same = move |setting: &Setting| {
                (setting.swerling, setting.reference_cells, setting.detector.pfa) == (swerling, cells, pfa)
            };
            measured.iter().filter(move |(setting, _)| same(setting))
        };
        let fine = || (0..=96).map(|quarter| 0.25 * f64::from(quarter));
        let theory = |cells: u32| {
            let detector = Detector::new(pfa, cells);
            fine().map(|snr_db| [snr_db, detector.target(swerling, from_db(snr_db)).detection_probability]).collect()
        };
        let mut series = vec![Series::new("known noise, theory", GREY, Shape::Dashed(theory(0)))];
        for (colour, cells) in REFERENCE_CELLS.into_iter().enumerate() {
            series.push(Series::new(format!("N = {cells}, theory"), colour, Shape::Line(theory(cells))));
            let points = of(cells).map(|(setting, row)| [setting.snr_db, row.value, row.lo, row.hi]).collect();
            series.push(Series::new(format!("N = {cells}, measured"), colour, Shape::Measured(points)));
        }
        Panel {
            title: format!("Swerling {}", fluctuation::name(swerling)),
            x: Axis::linear("signal-to-noise ratio / dB").between(0.0, 24.0),
            y: Axis::linear("probability of detection").between(0.0, 1.0),
            series,
        }
    };
    Figure {
        name: format!("cfar-pd-{pfa:e}"),
        title: format!("CA-CFAR: detection of a target in the centre of its cell, F = {pfa:e}"),
        columns: 3,
        panels: fluctuation::ALL.map(panel).into(),
    }
}

/// Share of detections beyond each excess over the threshold.
fn tail_panel(swerling: Swerling, statistics: &[f64]) -> Panel {
    let (pfa, cells, snr_db) = TAIL;
    let theory = |cells: u32| {
        let detector = Detector::new(pfa, cells);
        let target = detector.target(swerling, from_db(snr_db));
        let share = |excess: f64| target.survival(detector.threshold + excess) / target.detection_probability;
        (0..=75).map(|step| 2.0 * f64::from(step)).map(|excess| [excess, share(excess)]).collect()
    };
    let threshold = Detector::new(pfa, cells).threshold;
    let n = statistics.len() as u64;
    let measured = EXCESS.map(|excess| {
        let beyond = statistics.iter().filter(|&&z2| excess <= 0.0 || z2 > threshold + excess).count();
        let share = evaluation::proportion::wilson(beyond as u64, n, crate::rows::LEVEL);
        [excess, share.value, share.lo, share.hi]
    });
    Panel {
        title: format!("Swerling {}", fluctuation::name(swerling)),
        x: Axis::linear("excess of z² over the threshold"),
        y: Axis::log("share of detections beyond").between(1e-3, 1.0),
        series: vec![
            Series::new("known noise, theory", GREY, Shape::Dashed(theory(0))),
            Series::new(format!("N = {cells}, theory"), 0, Shape::Line(theory(cells))),
            Series::new(format!("N = {cells}, measured"), 0, Shape::Measured(measured.into())),
        ],
    }
}
