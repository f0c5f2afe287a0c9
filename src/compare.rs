//! `radar-chain compare`: whether a later soak is worse than an earlier one, beyond what noise can do.
//!
//! Each latency is known block by block over both runs. A figure (median over blocks of their p50, of their p99)
//! gets a 95 % interval by resampling stretches of neighbouring blocks, since what disturbs a machine lasts for a
//! while. The later run is worse where even the lower end of the interval of the ratio lies above what is tolerated.

use std::path::Path;
use std::process::ExitCode;

use common::process::{BadInput, EXIT_CHECK_BROKEN};
use common::random::{Purpose, generator};
use common::report::Report;
use evaluation::{Estimate, bootstrap};

/// Resamples of each interval.
const RESAMPLES: usize = 1000;
/// Level of the intervals.
const LEVEL: f64 = 0.95;

/// One figure of both runs.
struct Row {
    name: String,
    before: f64,
    after: f64,
    /// After over before.
    ratio: Estimate,
    worse: bool,
}

/// Compares two reports of soaks; exit code 1 if the second is worse.
pub(crate) fn compare(a: &Path, b: &Path, tolerance: f64) -> anyhow::Result<ExitCode> {
    let (before, after) = (read(a)?, read(b)?);
    let (rows, notes) = (latencies(&before, &after, tolerance), others(&before, &after));
    println!("{:<22}{:>10}{:>10}{:>8}   95 % interval", "", "before", "after", "ratio");
    for Row { name, before, after, ratio, worse } in &rows {
        let verdict = if *worse { "WORSE" } else { "" };
        let Estimate { value, lo, hi, .. } = ratio;
        println!("{name:<22}{before:>10.1}{after:>10.1}{value:>8.3}   [{lo:.3}, {hi:.3}] {verdict}");
    }
    for (note, worse) in &notes {
        println!("{note}{}", if *worse { " WORSE" } else { "" });
    }
    let worse = rows.iter().filter(|row| row.worse).count() + notes.iter().filter(|(_, worse)| *worse).count();
    if worse == 0 {
        println!("\nnot worse (tolerance {:.0} %)", tolerance * 100.0);
        return Ok(ExitCode::SUCCESS);
    }
    println!("\nworse in {worse} of {} figures (tolerance {:.0} %)", rows.len() + notes.len(), tolerance * 100.0);
    Ok(ExitCode::from(EXIT_CHECK_BROKEN))
}

fn read(path: &Path) -> Result<Report, BadInput> {
    let refuse = |reason: String| BadInput(format!("{}: {reason}", path.display()));
    let text = std::fs::read_to_string(path).map_err(|error| refuse(error.to_string()))?;
    let report: Report =
        serde_json::from_str(&text).map_err(|error| refuse(format!("expected a report of schema 1: {error}")))?;
    if report.soak.is_none() {
        return Err(refuse("expected the report of a soak (`radar-chain soak` writes it)".into()));
    }
    Ok(report)
}

/// Medians of p50 and p99 over blocks.
fn latencies(before: &Report, after: &Report, tolerance: f64) -> Vec<Row> {
    let mut rows = Vec::new();
    let soak = |report: &Report| report.soak.clone().unwrap_or_default();
    let (old, new) = (soak(before), soak(after));
    for (name, blocks) in &old.blocks {
        let Some(later) = new.blocks.get(name) else { continue };
        for (percentile, old, new) in [("p50", &blocks.p50, &later.p50), ("p99", &blocks.p99, &later.p99)] {
            let (old, new) = (median(old, 0), median(new, 1));
            let ratio = ratio(new, old);
            let worse = ratio.lo > 1.0 + tolerance;
            rows.push(Row {
                name: format!("{name} {percentile}, µs"),
                before: old.value,
                after: new.value,
                ratio,
                worse,
            });
        }
    }
    rows
}

/// Median of the blocks of one run, with an interval from resampled stretches of about √n neighbours.
fn median(blocks: &[f64], run: u32) -> Estimate {
    let stretch = (blocks.len() as f64).sqrt().ceil().max(1.0) as usize;
    let stretches: Vec<&[f64]> = blocks.chunks(stretch).collect();
    let mut rng = generator(1, Purpose::Resampling, run, 0);
    bootstrap::interval(&stretches, RESAMPLES, LEVEL, &mut rng, |drawn| {
        let mut values: Vec<f64> = drawn.iter().flat_map(|stretch| stretch.iter().copied()).collect();
        values.sort_unstable_by(f64::total_cmp);
        values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
    })
}

/// Ratio of two independent positive figures: distances on the logarithm add as squares.
fn ratio(a: Estimate, b: Estimate) -> Estimate {
    let distance = |of: &Estimate, end: f64| (end / of.value).ln().abs();
    let (value, n) = (a.value / b.value, a.n.min(b.n));
    let down = distance(&a, a.lo).hypot(distance(&b, b.hi));
    let up = distance(&a, a.hi).hypot(distance(&b, b.lo));
    Estimate { value, lo: value * (-down).exp(), hi: value * up.exp(), n }
}

/// What is compared without intervals: losses, restarts, memory.
fn others(before: &Report, after: &Report) -> Vec<(String, bool)> {
    let restarts = |report: &Report| report.processes.values().map(|used| used.restarts).sum::<u64>();
    let misses = |report: &Report| report.budget.values().filter(|budget| !budget.ok).count() as u64;
    let growth = |report: &Report| {
        let soak = report.soak.as_ref();
        soak.map_or(0.0, |soak| soak.growth_mib.values().copied().fold(0.0, f64::max))
    };
    let counts = [
        ("messages lost", before.lost(), after.lost()),
        ("restarts", restarts(before), restarts(after)),
        ("budgets broken", misses(before), misses(after)),
    ];
    let mut notes: Vec<(String, bool)> =
        counts.iter().map(|(name, old, new)| (format!("{name:<22}{old:>10}{new:>10}"), new > old)).collect();
    let (old, new) = (growth(before), growth(after));
    let limit = after.config.as_ref().map_or(1.0, |config| config.soak.growth_mib);
    notes.push((format!("{:<22}{old:>10.2}{new:>10.2}", "memory growth, MiB"), new > limit && new > old));
    notes
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::report::{Blocks, Soak};
    use rand::RngExt;

    /// A report with one latency of 200 blocks about `p50`, disturbed for whole stretches.
    fn report(p50: f64, seed: u64) -> Report {
        let mut rng = generator(seed, Purpose::Test, 0, 0);
        let mut disturbed = 1.0;
        let mut blocks = Blocks::default();
        for k in 0..200 {
            if k % 15 == 0 {
                disturbed = 1.0 + 0.3 * rng.random::<f64>();
            }
            blocks.t_s.push(f64::from(k));
            blocks.p50.push(p50 * disturbed * (1.0 + 0.1 * rng.random::<f64>()));
            blocks.p99.push(5.0 * p50);
            blocks.max.push(10.0 * p50);
        }
        let soak = Soak { blocks: [("track".to_string(), blocks)].into(), ..Soak::default() };
        Report { soak: Some(soak), ..Report::default() }
    }

    #[test]
    fn noise_is_not_worse() {
        let worse = (0..50).filter(|&seed| {
            latencies(&report(100.0, 2 * seed), &report(100.0, 2 * seed + 1), 0.05).iter().any(|row| row.worse)
        });
        assert!(worse.count() <= 2);
    }

    #[test]
    fn a_slower_run_is_worse_and_a_faster_is_not() {
        let worse = |b: f64| latencies(&report(100.0, 1), &report(b, 2), 0.05).iter().filter(|row| row.worse).count();
        assert_eq!((worse(140.0), worse(70.0)), (2, 0));
    }

    #[test]
    fn a_loss_is_worse() {
        let mut lossy = Report::default();
        lossy.loss.entry("plots".into()).or_default().insert("tracker".into(), 3);
        assert!(others(&Report::default(), &lossy).iter().any(|(note, worse)| *worse && note.contains("lost")));
        assert!(others(&lossy, &lossy).iter().all(|(_, worse)| !worse));
    }
}
