//! Noise alone: how often the CFAR says there is something, and how strong it then is.

use common::amplitude::Detector;
use common::random::{Purpose, generator};
use plot_extractor::cfar::CaCfar;
use radar_sim::noise;

use super::GUARD;
use crate::figures::{Axis, Figure, GREY, Panel, Series, Shape};
use crate::parallel::runs_with;
use crate::{Case, Options, Progress, Results, Row};

/// F, probabilities of false alarm that are set.
const PFA: [f64; 5] = [1e-2, 1e-3, 1e-4, 1e-5, 1e-6];
/// N, reference cells on both sides together.
const REFERENCE_CELLS: [u32; 3] = [16, 32, 64];
/// Noise of one run: range profiles, and cells in each. Cells at the ends have fewer reference cells and count too.
const PROFILES: usize = 256;
const RANGES: usize = 512;
/// Excess of z² over the threshold at which the tail is looked at.
const EXCESS: [f64; 11] = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 12.0, 15.0];
/// F at which the tail is looked at: many false alarms.
const TAIL_PFA: usize = 0;

/// What one run has counted, by number of reference cells.
#[derive(Debug, Clone, Copy, Default)]
struct Counts {
    /// Cells over threshold, by F.
    hits: [u64; PFA.len()],
    /// False alarms with all reference cells that exceed the threshold by more than [`EXCESS`].
    over: [u64; EXCESS.len()],
    /// Sum of their excesses.
    excess: f64,
}

struct Scratch {
    detectors: Vec<Vec<CaCfar>>,
    amplitudes: Vec<f32>,
    powers: Vec<f32>,
}

impl Scratch {
    fn new() -> Self {
        let detector = |cells: u32, pfa: f64| CaCfar::new(RANGES, GUARD, cells as usize / 2, pfa);
        Self {
            detectors: REFERENCE_CELLS.map(|cells| PFA.map(|pfa| detector(cells, pfa)).into()).into(),
            amplitudes: vec![0.0; PROFILES * RANGES],
            powers: vec![0.0; PROFILES * RANGES],
        }
    }
}

/// Measures `pfa` and `mean_excess`; draws the ratio to the set F and the tail.
pub fn measure(options: &Options, runs: u32, progress: &Progress, results: &mut Results) {
    let counts =
        runs_with(options.threads, runs, progress, Scratch::new, |scratch, run| one_run(options, scratch, run));
    let of = |cells: usize| counts.iter().map(move |run: &[Counts; REFERENCE_CELLS.len()]| &run[cells]);
    let cells_in_run = (PROFILES * RANGES) as u64;
    let mut ratio = Vec::new();
    let mut tail = Vec::new();
    for (index, (&cells, colour)) in REFERENCE_CELLS.iter().zip(0..).enumerate() {
        let mut points = Vec::new();
        for (place, &pfa) in PFA.iter().enumerate() {
            let case = Case::new().with("pfa", pfa).with("reference_cells", cells);
            let hits: Vec<[u64; 2]> = of(index).map(|run| [run.hits[place], cells_in_run]).collect();
            let row = Row::clustered(&case, "pfa", &hits).against(pfa, "set F (C3)");
            points.push([pfa * (1.0 + 0.08 * (f64::from(colour) - 1.0)), row.value / pfa, row.lo / pfa, row.hi / pfa]);
            results.rows.push(row);
        }
        ratio.push(Series::new(format!("N = {cells}"), colour as usize, Shape::Measured(points)));

        let detector = Detector::new(PFA[TAIL_PFA], cells);
        let case = Case::new().with("pfa", detector.pfa).with("reference_cells", cells);
        let excess = of(index).filter(|run| run.over[0] > 0).map(|run| run.excess / run.over[0] as f64);
        let row = Row::mean(&case, "mean_excess", excess);
        results.rows.push(row.against(detector.noise_mean_excess(), "(N + t₀)/(N − 1), amplitude.md"));
        let over: Vec<u64> = (0..EXCESS.len()).map(|place| of(index).map(|run| run.over[place]).sum()).collect();
        tail.extend(tail_series(&detector, cells, &over, colour as usize));
    }
    let known = Detector::new(PFA[TAIL_PFA], 0);
    let theory = EXCESS.map(|excess| [excess, known.noise_survival(known.threshold + excess) / known.pfa]);
    tail.push(Series::new("known noise, theory", GREY, Shape::Dashed(theory.into())));
    let set = Series::new("set F", GREY, Shape::Line(vec![[5e-7, 1.0], [2e-2, 1.0]]));
    results.figures.push(Figure {
        name: "cfar-false-alarms".into(),
        title: "CA-CFAR in noise: false alarms as set, and their decision statistic".into(),
        columns: 2,
        panels: vec![
            Panel {
                title: String::new(),
                x: Axis::log("set probability of false alarm F per cell").between(5e-7, 2e-2),
                y: Axis::linear("measured / set").between(0.5, 1.5),
                series: std::iter::once(set).chain(ratio).collect(),
            },
            Panel {
                title: String::new(),
                x: Axis::linear(format!("excess of z² over the threshold, F = {}", PFA[TAIL_PFA])),
                y: Axis::log("share of false alarms beyond").between(1e-6, 1.0),
                series: tail,
            },
        ],
    });
}

fn one_run(options: &Options, scratch: &mut Scratch, run: u32) -> [Counts; REFERENCE_CELLS.len()] {
    let Scratch { detectors, amplitudes, powers } = scratch;
    noise::fill(amplitudes, &mut generator(options.seed, Purpose::Noise, run, 0));
    let mut hits = Vec::new();
    std::array::from_fn(|index| {
        let half = GUARD + REFERENCE_CELLS[index] as usize / 2;
        let mut counts = Counts::default();
        for (place, detector) in detectors[index].iter_mut().enumerate() {
            hits.clear();
            detector.detect(amplitudes, powers, &mut hits);
            counts.hits[place] = hits.len() as u64;
            if place != TAIL_PFA {
                continue;
            }
            let threshold = Detector::new(PFA[place], REFERENCE_CELLS[index]).threshold;
            let has_all = |cell: u32| (half..RANGES - half).contains(&(cell as usize % RANGES));
            for hit in hits.iter().filter(|hit| has_all(hit.cell)) {
                let excess = f64::from(hit.power) / f64::from(hit.noise) - threshold;
                counts.excess += excess;
                for (over, &bound) in counts.over.iter_mut().zip(&EXCESS) {
                    // The first bound is the threshold itself, which rounding may put a hit below.
                    *over += u64::from(excess > bound || bound <= 0.0);
                }
            }
        }
        counts
    })
}

/// Measured and theoretical share of false alarms beyond each excess.
fn tail_series(detector: &Detector, cells: u32, over: &[u64], colour: usize) -> [Series; 2] {
    let theory = EXCESS.map(|excess| [excess, detector.noise_survival(detector.threshold + excess) / detector.pfa]);
    let measured = EXCESS.iter().zip(over).map(|(&excess, &count)| {
        let share = evaluation::proportion::wilson(count, over[0], crate::rows::LEVEL);
        [excess, share.value, share.lo, share.hi]
    });
    [
        Series::new(format!("N = {cells}, theory"), colour, Shape::Line(theory.into())),
        Series::new(format!("N = {cells}"), colour, Shape::Measured(measured.collect())),
    ]
}
