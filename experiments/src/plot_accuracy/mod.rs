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

mod figure;
mod sight;

use common::config::Swerling;
use common::random::{Purpose, generator};
use common::units::{from_db, to_db};
use evaluation::poisson;
use rand::{Rng, RngExt};

use crate::fluctuation;
use crate::parallel::runs;
use crate::rows::LEVEL;
use crate::{Case, Options, Progress, Results, Row};
use sight::{Sight, sight};

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
    results.figures.push(figure::new(&errors));
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
