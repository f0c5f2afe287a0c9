//! `plot-accuracy`: simulated cells through the plot extractor, one target at a random place between the cells.
//!
//! Range, azimuth, elevation and range rate are uniform over many cells, so that straddling is as in life. For each kind
//! of target and signal-to-noise ratio (at the centre of a cell, before straddling): whether it is detected, by how
//! much its plot errs on each axis, and whether the error is as large as the plot says: the mean of
//! (error/σ)² must lie in 0.9…1.1 (C6). Two ways of asking: for targets of one strength, also if they are seen only when noise
//! helps; and, as the tracker asks, for plots that state one strength, whatever the target's was (steady targets spread evenly over the
//! volume). `bias` and `rms` are in m, rad, rad and m/s.
//!
//! Few beams and only the dwells about the target are simulated; what is left out holds noise.

use std::convert::Infallible;

use anyhow::Context;
use common::amplitude::Detector;
use common::angle;
use common::config::{ChainConfig, MotionConfig, RadarConfig, Swerling, TargetConfig};
use common::geometry::{Polar, range_rate_mps};
use common::message::END_OF_STREAM;
use common::plots::Plot;
use common::random::{Purpose, generator};
use common::units::{from_db, to_db};
use evaluation::poisson;
use plot_extractor::PlotExtractor;
use radar_sim::{DwellSimulator, fluctuation as simulated};
use rand::{Rng, RngExt};

use crate::figures::{Axis, Figure, Panel, Series, Shape};
use crate::fluctuation;
use crate::parallel::runs;
use crate::rows::LEVEL;
use crate::{Case, Options, Progress, Results, Row};

/// S at the centre of a cell, dB.
const SNR_DB: [f64; 6] = [10.0, 15.0, 20.0, 25.0, 30.0, 40.0];
/// Axes with the factor and the unit in which figures show them.
const AXES: [(&str, f64, &str); 4] = [
    ("range", 1.0, "m"),
    ("azimuth", 180.0 / std::f64::consts::PI, "°"),
    ("elevation", 180.0 / std::f64::consts::PI, "°"),
    ("range_rate", 1.0, "m/s"),
];
/// Bins of the signal-to-noise ratio that a plot states, dB, for targets of all strengths.
const STATED_DB: [[f64; 2]; 5] = [[0.0, 13.0], [13.0, 16.0], [16.0, 20.0], [20.0, 25.0], [25.0, 60.0]];
/// Weakest and strongest of these targets, dB.
const ALL_DB: [f64; 2] = [3.0, 40.0];
/// How many of them there are for each target of given strength: most are too weak to be seen.
const OF_ALL: u32 = 20;
/// Mean normalised squared error that is required (C6).
const REQUIRED: [f64; 2] = [0.9, 1.1];
/// Elevation beams that are simulated.
const BEAMS: u32 = 8;
/// Dwells simulated on each side of the target: an echo of 40 dB has sunk into the noise after four.
const DWELLS: u32 = 8;
/// A plot is the target's if it is not farther than this on any axis, cells.
const GATE_CELLS: f64 = 1.5;

/// What became of one target.
#[derive(Debug, Clone, Copy)]
struct Sight {
    /// Errors of its plot and the plot's standard errors, if there is one.
    plot: Option<([f64; 4], [f64; 4])>,
    /// The signal-to-noise ratio that it states, dB.
    stated_db: f64,
    /// Plots that are not its own, or more than one of it.
    others: u32,
    /// Probability that a cell near it exceeds the threshold, given the power drawn (C4).
    expected: f64,
    /// Noise cells expected over the threshold.
    expected_others: f64,
}

/// Runs the experiment: 2000 targets in each case.
///
/// # Errors
/// If the simulator refuses the scenario.
pub fn run(options: &Options, progress: &Progress) -> anyhow::Result<Results> {
    let runs_of_each = options.runs_or(2000, 30);
    let settings: Vec<(Swerling, f64)> = fluctuation::ALL
        .into_iter()
        .flat_map(|swerling| options.some_of(&SNR_DB).into_iter().map(move |snr_db| (swerling, snr_db)))
        .collect();
    progress.expect(u64::from(runs_of_each) * (settings.len() as u64 + u64::from(OF_ALL)));
    let mut results = Results { runs: runs_of_each, ..Results::default() };
    let mut errors = Vec::new();
    for (index, &(swerling, snr_db)) in (0..).zip(&settings) {
        let name = fluctuation::name(swerling);
        progress.say(format!("Swerling {name}, {snr_db} dB"));
        // Every case has draws of its own.
        let seed = generator(options.seed, Purpose::Measurement, index, 0).next_u64();
        let one = |run: u32| sight(seed, run, swerling, snr_db);
        let sights: Vec<Sight> =
            runs(options.threads, runs_of_each, progress, one).into_iter().collect::<anyhow::Result<_>>()?;
        let case = Case::new().with("swerling", name).with("snr_db", snr_db);
        results.rows.extend(detection_rows(&case, &sights));
        for (axis, (name, _, _)) in AXES.into_iter().enumerate() {
            errors.extend(axis_rows(&case.clone().with("axis", name), &sights, axis));
        }
    }
    results.remarks.extend(verdict(&errors));
    progress.say("targets of all strengths".into());
    let seed = generator(options.seed, Purpose::Measurement, settings.len() as u32, 0).next_u64();
    let any = |run: u32| {
        // p(S) ∝ S^(−7/4): spread evenly over the volume.
        let mut rng = generator(seed, Purpose::Measurement, run, 0);
        let tail = |db: f64| from_db(db).powf(-0.75);
        let share: f64 = rng.random();
        let snr_db = to_db((tail(ALL_DB[0]) + share * (tail(ALL_DB[1]) - tail(ALL_DB[0]))).powf(-4.0 / 3.0));
        sight(seed, run, Swerling::Zero, snr_db)
    };
    let sights = runs(options.threads, OF_ALL * runs_of_each, progress, any);
    let sights: Vec<Sight> = sights.into_iter().collect::<anyhow::Result<_>>()?;
    for [from_db, to_db] in STATED_DB {
        let within = |sight: &&Sight| sight.stated_db >= from_db && sight.stated_db < to_db;
        let within: Vec<Sight> = sights.iter().filter(within).copied().collect();
        let case = Case::new().with("swerling", "0").with("stated_from_db", from_db).with("stated_to_db", to_db);
        for (axis, (name, _, _)) in AXES.into_iter().enumerate() {
            results.rows.extend(axis_rows(&case.clone().with("axis", name), &within, axis));
        }
    }
    results.figures.push(figure(&errors));
    results.rows.extend(errors);
    Ok(results)
}

fn detection_rows(case: &Case, sights: &[Sight]) -> [Row; 2] {
    let n = sights.len() as u64;
    let detected = sights.iter().filter(|sight| sight.plot.is_some()).count() as u64;
    let others = sights.iter().map(|sight| u64::from(sight.others)).sum();
    let mean = |of: fn(&Sight) -> f64| sights.iter().map(of).sum::<f64>() / n as f64;
    [
        Row::proportion(case, "pd", detected, n)
            .against(mean(|sight| sight.expected), "(C4), any of the cells about it"),
        Row::new(case, "false_plots", poisson::count(others, LEVEL).scaled(1.0 / n as f64))
            .against(mean(|sight| sight.expected_others), "set F times the cells"),
    ]
}

fn axis_rows(case: &Case, sights: &[Sight], axis: usize) -> [Row; 3] {
    let plots = || sights.iter().filter_map(|sight| sight.plot).map(|(error, sigma)| (error[axis], sigma[axis]));
    let normalised = plots().map(|(error, sigma)| (error / sigma).powi(2));
    [
        Row::mean(case, "bias", plots().map(|(error, _)| error)).against(0.0, "no bias"),
        Row::rms(case, "rms", plots().map(|(error, _)| error)),
        Row::mean(case, "nees", normalised).against(1.0, "1; required 0.9 to 1.1 (C6)"),
    ]
}

/// Where the required accuracy of the stated errors is not met.
fn verdict(rows: &[Row]) -> Vec<String> {
    let nees = || rows.iter().filter(|row| row.metric == "nees");
    let place = |row: &Row| {
        let parameter = |key| row.case.get(key).map(ToString::to_string).unwrap_or_default().replace('"', "");
        let [swerling, snr_db, axis] = ["swerling", "snr_db", "axis"].map(parameter);
        format!("Swerling {swerling} at {snr_db} dB, {axis}: {:.2} [{:.2}, {:.2}]", row.value, row.lo, row.hi)
    };
    let within = nees().filter(|row| row.value >= REQUIRED[0] && row.value <= REQUIRED[1]).count();
    let surely_not: Vec<String> =
        nees().filter(|row| row.hi < REQUIRED[0] || row.lo > REQUIRED[1]).map(place).collect();
    let mut verdict = vec![format!("The mean of (error/σ)² lies in 0.9…1.1 in {within} of {} cases.", nees().count())];
    if !surely_not.is_empty() {
        verdict.push(format!("Not met, with the whole interval outside:\n  {}", surely_not.join("\n  ")));
    }
    verdict
}

fn radar() -> ChainConfig {
    let mut chain = ChainConfig::default();
    chain.radar.elevations = BEAMS;
    chain.sim.clutter.range_m = 0.0;
    chain
}

/// One target, somewhere between the cells, and its plots.
fn sight(seed: u64, run: u32, swerling: Swerling, snr_db: f64) -> anyhow::Result<Sight> {
    let mut chain = radar();
    chain.run.seed = seed;
    let mut rng = generator(seed, Purpose::Trajectory, run, 0);
    chain.sim.targets = vec![target(&chain.radar, run, swerling, snr_db, &mut rng)];
    let mut simulator = DwellSimulator::new(&chain).context("making a scenario of one target")?;
    let mut truth = Vec::new();
    simulator.truth(run, &mut truth);
    let truth = truth.first().context("the target exists in its scan")?;
    let place = Polar::from_enu(&truth.position_m().into());
    let rate_mps = range_rate_mps(&truth.position_m().into(), &truth.velocity_mps().into());

    let mut extractor = PlotExtractor::new(&chain.extractor, &chain.radar);
    let mut amplitudes = vec![0.0; simulator.cells()];
    let mut plots: Vec<Plot> = Vec::new();
    let step_rad = std::f64::consts::TAU / f64::from(chain.radar.dwells_per_scan);
    let nearest = (place.azimuth_rad / step_rad) as u32;
    for dwell in nearest - DWELLS..=nearest + DWELLS {
        simulator.fill(run, dwell, &mut amplitudes);
        let mut header = simulator.header(run, dwell);
        if dwell == nearest + DWELLS {
            header.flags |= END_OF_STREAM;
        }
        let taken = extractor.take(&header, &amplitudes, 0, |_, found| {
            plots.extend_from_slice(found);
            Ok::<(), Infallible>(())
        });
        assert_eq!(taken, Ok(None), "a simulated dwell is accepted");
    }

    let power = simulated::power(swerling, seed, run, truth.target_id);
    let cells = cell_sizes(&chain.radar);
    let span_mps = cells[3] * f64::from(chain.radar.dopplers);
    let error = |plot: &Plot| {
        let rate = plot.range_rate_mps - rate_mps;
        [
            plot.range_m - place.range_m,
            angle::difference(plot.azimuth_rad, place.azimuth_rad),
            plot.elevation_rad - place.elevation_rad,
            rate - span_mps * (rate / span_mps).round(),
        ]
    };
    let near = |plot: &&Plot| error(plot).iter().zip(cells).all(|(error, cell)| error.abs() <= GATE_CELLS * cell);
    let strongest = plots.iter().filter(near).max_by(|a, b| a.statistic.total_cmp(&b.statistic));
    let sigma = |plot: &Plot| {
        [plot.sigma_range_m, plot.sigma_azimuth_rad, plot.sigma_elevation_rad, plot.sigma_range_rate_mps].map(f64::from)
    };
    Ok(Sight {
        plot: strongest.map(|plot| (error(plot), sigma(plot))),
        stated_db: strongest.map_or(f64::NAN, |plot| f64::from(plot.snr_db)),
        others: (plots.len() - usize::from(strongest.is_some())) as u32,
        expected: detection_probability(&chain, &place, rate_mps, snr_db, power),
        expected_others: chain.extractor.pfa * f64::from(2 * DWELLS + 1) * simulator.cells() as f64,
    })
}

/// A target that moves straight from the antenna, in the middle of the simulated cells.
fn target(radar: &RadarConfig, run: u32, swerling: Swerling, snr_db: f64, rng: &mut impl Rng) -> TargetConfig {
    let uniform = |rng: &mut _, from: f64, to: f64| from + (to - from) * RngExt::random::<f64>(rng);
    let [range_m, azimuth_rad, elevation_rad, rate_mps] = cell_sizes(radar);
    let place = Polar {
        // Where all reference cells exist.
        range_m: radar.range_first_m + range_m * uniform(rng, 20.0, 49.0),
        // Away from north, so that all dwells are of one scan.
        azimuth_rad: azimuth_rad * uniform(rng, 20.0, f64::from(radar.dwells_per_scan) - 20.0),
        elevation_rad: radar.elevation_first_deg.to_radians() + elevation_rad * uniform(rng, 2.5, 4.5),
    };
    let span_mps = rate_mps * f64::from(radar.dopplers);
    let velocity = place.to_enu().normalize() * uniform(rng, -0.5 * span_mps, 0.5 * span_mps);
    TargetConfig {
        name: "one".into(),
        motion: MotionConfig::Straight { position_m: place.to_enu().into(), velocity_mps: velocity.into() },
        rcs_m2: None,
        snr_db: Some(snr_db),
        swerling,
        first_scan: run,
    }
}

/// Range, azimuth, elevation, range rate; m, rad, rad, m/s.
fn cell_sizes(radar: &RadarConfig) -> [f64; 4] {
    [
        radar.range_step_m,
        std::f64::consts::TAU / f64::from(radar.dwells_per_scan),
        radar.elevation_step_deg.to_radians(),
        radar.range_rate_step_mps,
    ]
}

/// Probability that one of the 3⁴ cells about a target exceeds the threshold if its power is `power` times the mean:
/// 1 − Π (1 − D), D of a steady target with the straddling loss of each cell. Cells that share reference windows are taken
/// as independent.
fn detection_probability(chain: &ChainConfig, place: &Polar, rate_mps: f64, snr_db: f64, power: f64) -> f64 {
    let radar = &chain.radar;
    let cells = cell_sizes(radar);
    let first =
        [radar.range_first_m, 0.5 * cells[1], radar.elevation_first_deg.to_radians(), radar.range_rate_first_mps()];
    let widths = [
        radar.pulse_width_m,
        radar.beamwidth_azimuth_deg.to_radians(),
        radar.beamwidth_elevation_deg.to_radians(),
        radar.doppler_width_mps,
    ];
    let at = [place.range_m, place.azimuth_rad, place.elevation_rad, rate_mps];
    // Power gains of the nearest cell and its two neighbours on each axis.
    let gains: [[f64; 3]; 4] = std::array::from_fn(|axis| {
        let cell = (at[axis] - first[axis]) / cells[axis];
        [-1.0, 0.0, 1.0].map(|k| {
            let offset = (cell - cell.round() - k) * cells[axis] / widths[axis];
            (-4.0 * std::f64::consts::LN_2 * offset * offset).exp()
        })
    });
    let detector = Detector::new(chain.extractor.pfa, 2 * chain.extractor.reference_cells);
    let mut missed = 1.0;
    for cell in 0..81 {
        let gain: f64 = (0..4).map(|axis| gains[axis][cell / [1, 3, 9, 27][axis] % 3]).product();
        let snr = from_db(snr_db) * power * gain;
        // Far above the threshold nothing is missed, and the sum for D would be long; far below it is noise.
        if snr > 10.0 * detector.threshold {
            return 1.0;
        }
        if snr > 0.1 {
            missed *= 1.0 - detector.target(Swerling::Zero, snr).detection_probability;
        }
    }
    1.0 - missed
}

fn figure(rows: &[Row]) -> Figure {
    let points = |axis: &str, swerling: Swerling, metric: &str, factor: f64| -> Vec<[f64; 4]> {
        let is = |row: &&Row| {
            row.metric == metric
                && row.case.get("axis") == Some(&axis.into())
                && row.case.get("swerling") == Some(&fluctuation::parameter(swerling))
        };
        // Kinds of targets beside each other.
        let shift_db = match swerling {
            Swerling::Zero => -0.4,
            Swerling::One => 0.0,
            Swerling::Three => 0.4,
        };
        let snr_db = |row: &Row| row.case.get("snr_db").and_then(serde_json::Value::as_f64).unwrap_or(f64::NAN);
        rows.iter()
            .filter(is)
            .map(|row| [snr_db(row) + shift_db, factor * row.value, factor * row.lo, factor * row.hi])
            .collect()
    };
    let panel = |metric: &str, axis: &str, factor: f64, y: Axis, background: Option<Series>| Panel {
        title: axis.replace('_', " "),
        x: Axis::linear("signal-to-noise ratio / dB").between(8.0, 42.0),
        y,
        series: background
            .into_iter()
            .chain(fluctuation::ALL.into_iter().enumerate().map(|(colour, swerling)| {
                let label = format!("Swerling {}", fluctuation::name(swerling));
                Series::new(label, colour, Shape::Measured(points(axis, swerling, metric, factor)))
            }))
            .collect(),
    };
    let required = || Shape::Band(vec![[8.0, REQUIRED[0], REQUIRED[1]], [42.0, REQUIRED[0], REQUIRED[1]]]);
    let nees = AXES.map(|(axis, _, _)| {
        let band = Series::new("required", 2, required());
        panel("nees", axis, 1.0, Axis::log("mean (error/σ)²").between(0.5, 10.0), Some(band))
    });
    let rms =
        AXES.map(|(axis, factor, unit)| panel("rms", axis, factor, Axis::log(format!("rms error / {unit}")), None));
    Figure {
        name: "plot-accuracy".into(),
        title: "Plots of single targets between cells: stated and actual errors".into(),
        columns: 4,
        panels: nees.into_iter().chain(rms).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A strong steady target is found, near where it is; where it is, the nearest cell is expected to see it.
    #[test]
    fn a_strong_target_is_found() {
        for run in 0..20 {
            let sight = sight(3, run, Swerling::Zero, 30.0).expect("a scenario");
            let (error, sigma) = sight.plot.expect("a plot");
            assert!(error.iter().zip(sigma).all(|(error, sigma)| error.abs() < 6.0 * sigma), "{sight:?}");
            assert!(sight.expected > 0.99, "{sight:?}");
        }
    }
}
