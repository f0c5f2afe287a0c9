//! `radar-chain tune`: parameters learnt from recordings, as a fragment of a configuration.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use common::config::{ChainConfig, Source};
use common::plots::{Plot, PlotsHeader};
use common::process::{BadInput, EXIT_CHECK_BROKEN, print, say};
use common::recording::{self, Recorded, parts_from};
use tracker::tuning::{Found, Learnt, Lesson, Parameter, allowed, learn};

/// False plots of this variance over Poisson's lie in a few places.
const UNEVEN: f64 = 3.0;

/// Learns from recordings and prints what to change.
///
/// # Errors
/// A recording cannot be read, is of another radar than the first, or holds too little.
pub(crate) fn tune(recordings: &[PathBuf], config: Option<&Path>, overrides: Vec<String>) -> anyhow::Result<ExitCode> {
    let config = recorder::replay::replay_config(&recordings[0], config, overrides)?;
    let recorded = recorder::replay::recorded_config(&recordings[0])?;
    let mut all: Vec<Vec<(PlotsHeader, Vec<Plot>)>> = Vec::new();
    for path in recordings {
        let plots = plots_of(path)?;
        if let (Some((first, _)), Some((own, _))) = (all.first().and_then(|all| all.first()), plots.first())
            && cells(first).map(f64::to_bits) != cells(own).map(f64::to_bits)
        {
            let [found, expected] =
                [own, first].map(|header| cells(header).map(|side| format!("{side:.4}")).join(" × "));
            let first = recordings[0].display();
            let text = format!("{}: cells of {found} (m, rad), expected those of {first}: {expected}", path.display());
            return Err(BadInput(text).into());
        }
        all.push(plots);
    }
    let slices: Vec<_> = all.iter().map(Vec::as_slice).collect();
    let lesson = learn(&slices, &config.tracker, |round| say(&round)).map_err(|error| BadInput(error.to_string()))?;
    print(&fragment(&lesson, &config, &recorded));
    Ok(if lesson.rounds.is_some() { ExitCode::SUCCESS } else { ExitCode::from(EXIT_CHECK_BROKEN) })
}

/// The plots of a recording and the later parts of its run.
fn plots_of(path: &Path) -> anyhow::Result<Vec<(PlotsHeader, Vec<Plot>)>> {
    let mut all = Vec::new();
    for part in parts_from(path) {
        for message in recording::open(&part).map_err(|error| BadInput(error.to_string()))? {
            if let Recorded::Plots(header, plots) = message? {
                all.push((header, plots));
            }
        }
    }
    if all.is_empty() {
        return Err(BadInput(format!("{} holds no plots", path.display())).into());
    }
    Ok(all)
}

fn cells(header: &PlotsHeader) -> [f64; 3] {
    [header.cell_range_m, header.cell_azimuth_rad, header.cell_elevation_rad]
}

/// What was learnt as TOML, with its errors and what the configuration says as comments. Errors of plots are those that the
/// recorded plots state.
fn fragment(lesson: &Lesson, config: &ChainConfig, recorded: &ChainConfig) -> String {
    let mut text = String::new();
    let (counts, plots) = (&lesson.counts, lesson.plots);
    let _ = writeln!(
        text,
        "# Learnt from {plots} plots of tracks in {} scans: value, ± standard error, configuration.",
        counts.scans
    );
    if lesson.rounds.is_none() {
        text.push_str("# Errors of plots and motion have not settled: what was reached is in comments, farther off than its errors say.\n");
    }
    let mut tables: BTreeMap<&str, Vec<String>> = BTreeMap::new();
    if let Some(share) = lesson.detection_probability {
        let value = rounded(allowed(share.value), share.error.max(1e-3));
        let line = line("detection_probability", &value, share, &config.tracker.detection_probability.to_string());
        tables.entry("tracker").or_default().push(line);
    }
    if let Some(clutter) = lesson.clutter {
        let dispersion = lesson.clutter_dispersion.unwrap_or(1.0);
        let line = line("clutter_floor", &number(clutter), clutter, &config.tracker.clutter_floor.to_string());
        let line = if dispersion > UNEVEN {
            format!("# {line}; {dispersion:.0} times as uneven as by chance: a mean, and no floor")
        } else {
            line
        };
        tables.entry("tracker").or_default().push(line);
    }
    for found in &lesson.found {
        let (table, mut line) = of_parameter(found, config, recorded);
        if lesson.rounds.is_none() && !line.starts_with('#') {
            line.insert_str(0, "# ");
        }
        tables.entry(table).or_default().push(line);
    }
    for (table, lines) in tables {
        let _ = writeln!(text, "\n[{table}]\n{}", lines.join("\n"));
    }
    text
}

/// The table of a parameter, and its line there.
fn of_parameter(found: &Found, config: &ChainConfig, recorded: &ChainConfig) -> (&'static str, String) {
    let Found { parameter, before, learnt } = *found;
    if let Parameter::Error(axis) = parameter {
        let plot_source = &recorded.plot_source;
        let stated = [plot_source.sigma_range_m, plot_source.sigma_azimuth_deg, plot_source.sigma_height_m][axis];
        if recorded.origin() == Source::PlotSource {
            let scaled = learnt.map(|Learnt { value, error }| Learnt { value: value * stated, error: error * stated });
            return ("plot_source", of_key(parameter.key(), scaled, stated));
        }
        let name = ["range", "azimuth", "elevation"][axis];
        let told = learnt.map_or("not told by the recording".into(), |learnt| {
            format!("{} ± {} times as large as they state", number(learnt), rounded(learnt.error, learnt.error))
        });
        return ("tracker", format!("# errors of plots in {name}: {told}"));
    }
    let (table, key) = match parameter.key().split_once('.') {
        Some(("turn", key)) => ("tracker.turn", key),
        Some(("bank", key)) => ("tracker.bank", key),
        Some((_, key)) => ("tracker.bandwidth", key),
        None => ("tracker", parameter.key()),
    };
    match learnt {
        Some(learnt) if parameter == Parameter::TurnRates => {
            let rates = &config.tracker.turn.rates_deg_per_s;
            let each = rates.iter().map(|rate| rounded(rate / before * learnt.value, learnt.error));
            let values = format!("[{}]", each.collect::<Vec<_>>().join(", "));
            (table, line(key, &values, learnt, &format!("{rates:?}")))
        }
        _ => (table, of_key(key, learnt, before)),
    }
}

fn of_key(key: &str, learnt: Option<Learnt>, before: f64) -> String {
    match learnt {
        Some(learnt) => line(key, &number(learnt), learnt, &before.to_string()),
        None => format!("# {key}: not told by the recording, configuration {before}"),
    }
}

fn line(key: &str, value: &str, learnt: Learnt, before: &str) -> String {
    let assignment = format!("{key} = {value}");
    format!("{assignment:<31} # ± {}, configuration {before}", rounded(learnt.error, learnt.error))
}

fn number(learnt: Learnt) -> String {
    rounded(learnt.value, learnt.error)
}

/// With two digits of its error, as TOML wants a number.
fn rounded(value: f64, error: f64) -> String {
    let digits = (1.0 - error.log10().floor()).clamp(1.0, 300.0);
    if digits > 6.0 {
        let of_value = (digits + value.abs().max(error).log10().floor()).max(1.0);
        return format!("{value:.0$e}", of_value as usize);
    }
    format!("{value:.0$}", digits as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_the_digits_that_their_errors_allow() {
        assert_eq!(rounded(12.345_6, 0.034), "12.346");
        assert_eq!(rounded(12.345_6, 3.4), "12.3");
        assert_eq!(rounded(1.234_2e-8, 2.0e-10), "1.234e-8");
        for text in [rounded(0.5, 0.01), rounded(3e-9, 1e-10), rounded(400.0, 50.0)] {
            let set = format!("tracker.cv_noise_mps2={text}");
            let config = common::config::adjust(&ChainConfig::default(), std::slice::from_ref(&set)).expect(&set);
            assert!((config.tracker.cv_noise_mps2 / text.parse::<f64>().expect("a number") - 1.0).abs() < 1e-12);
        }
    }
}
