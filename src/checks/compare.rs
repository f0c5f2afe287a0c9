//! `radar-chain compare`: tests whether a later soak is worse than an earlier one beyond noise.
//!
//! Each latency is known block by block over both runs. Neighbouring blocks are joined to some [`STRETCHES`] stretches,
//! since what disturbs a machine lasts for a while; stretches count as independent. Per latency, five figures are judged:
//!
//! ```text
//! p50, p99, max    geometric mean over all blocks of their p50, p99 and max: worse where even the lower end of the
//!                  interval of the ratio lies above what is tolerated
//! p99.9 of all     share of blocks that reach beyond the earlier run's p99.9, tolerance included: worse where even the
//!                  lower end of the interval of its growth lies above 0
//! max of all       stretches that reach beyond anything of the earlier run: worse where chance would hardly bring so many
//! ```
//!
//! A mean of logarithms takes notice of a bad third of a run as well as of a bad whole, and no single value can carry
//! it away. All figures are judged together: of two runs that are equally good, at most one pair in forty is called
//! worse. What differs between runs but not within them, such as the processors that a run happens to get, is noise that
//! no run can show: the tolerance is for that. Losses and restarts are compared as rates of Poisson processes.

use std::path::Path;
use std::process::ExitCode;

use common::config::ChainConfig;
use common::process::{BadInput, EXIT_CHECK_BROKEN, print};
use common::report::{Blocks, Percentiles, Report, Soak};
use evaluation::simultaneous::sidak;
use evaluation::{Estimate, contrast, mean, poisson};

/// Stretches that a run is cut into, at least: as few as intervals can be made of, hence as long as can be.
const STRETCHES: usize = 20;
/// Blocks that can be judged: two in each stretch.
const BLOCKS: usize = 2 * STRETCHES;
/// Level of all intervals together.
const LEVEL: f64 = 0.95;
/// Figures of each latency.
const FIGURES: usize = 5;

/// One figure of both runs.
#[derive(Debug, Clone)]
struct Row {
    name: String,
    before: String,
    after: String,
    /// How they compare, in words.
    found: String,
    verdict: Verdict,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Verdict {
    NotWorse,
    Worse,
    TooShort,
}

impl Verdict {
    fn of(worse: bool) -> Self {
        if worse { Self::Worse } else { Self::NotWorse }
    }
}

/// Compares two reports of soaks; exit code 1 if the second is worse.
pub(crate) fn compare(a: &Path, b: &Path, tolerance: f64) -> anyhow::Result<ExitCode> {
    let (before, after) = (read(a)?, read(b)?);
    if let Some(difference) = difference(before.config.as_ref(), after.config.as_ref()) {
        let (a, b) = (a.display(), b.display());
        return Err(
            BadInput(format!("{a} and {b} cannot be compared: expected soaks of one kind, {difference}")).into()
        );
    }
    let rows = [latencies(&before, &after, tolerance), others(&before, &after)].concat();
    // What is too short to tell is summed up below.
    let told: Vec<&Row> = rows.iter().filter(|row| row.verdict != Verdict::TooShort).collect();
    if !told.is_empty() {
        print(&format!("{:<30}{:>12}{:>12}   \n", "", "before", "after"));
    }
    for Row { name, before, after, found, verdict } in told {
        let mark = if *verdict == Verdict::Worse { "  WORSE" } else { "" };
        print(&format!("{name:<30}{before:>12}{after:>12}   {found}{mark}\n"));
    }
    let count = |verdict| rows.iter().filter(|row| row.verdict == verdict).count();
    let (worse, short) = (count(Verdict::Worse), count(Verdict::TooShort));
    let (all, told) = (rows.len(), format!("tolerance {:.0} %", tolerance * 100.0));
    if worse > 0 {
        print(&format!("\nworse in {worse} of {all} figures ({told})\n"));
        return Ok(ExitCode::from(EXIT_CHECK_BROKEN));
    }
    match short {
        0 => print(&format!("\nnot worse ({told})\n")),
        _ => print(&format!(
            "\ntoo short to tell in {short} of {all} figures: soak for longer; the others are not worse ({told})\n"
        )),
    }
    Ok(ExitCode::SUCCESS)
}

fn read(path: &Path) -> Result<Report, BadInput> {
    let refuse = |reason: String| BadInput(format!("{}: expected the report.json of a soak: {reason}", path.display()));
    let text = std::fs::read_to_string(path).map_err(|error| refuse(error.to_string()))?;
    let report: Report = serde_json::from_str(&text).map_err(|error| refuse(error.to_string()))?;
    if report.soak.is_none() {
        return Err(refuse("this one is of a run (`radar-chain soak` writes those of soaks)".into()));
    }
    Ok(report)
}

/// In what two soaks differ that makes their figures incomparable.
fn difference(before: Option<&ChainConfig>, after: Option<&ChainConfig>) -> Option<String> {
    let kind = |config: &ChainConfig| {
        [
            ("site", config.site.name.clone()),
            ("source", serde_json::to_string(&config.run.source).unwrap_or_default()),
            ("delivery", config.run.mode.name().to_string()),
            ("speed", config.run.speed.to_string()),
            ("scan period", format!("{} s", config.scan_period_s())),
            ("sectors per scan", config.sectors_per_scan().to_string()),
        ]
    };
    let (Some(before), Some(after)) = (before, after) else {
        return Some("one has no configuration".to_string());
    };
    let mut pairs = kind(before).into_iter().zip(kind(after));
    let ((what, before), (_, after)) = pairs.find(|(before, after)| before != after)?;
    Some(format!("{what} is {before} and {after}"))
}

/// All figures of all latencies that the earlier run has.
fn latencies(before: &Report, after: &Report, tolerance: f64) -> Vec<Row> {
    let (Some(old), Some(new)) = (&before.soak, &after.soak) else { return Vec::new() };
    let level = sidak(LEVEL, FIGURES * old.blocks.len());
    let mut rows = Vec::new();
    for (name, earlier) in &old.blocks {
        let whole = |report: &Report| report.latency_us.get(name).copied().unwrap_or_default();
        let (then, now) = (whole(before), whole(after));
        let Some(later) = new.blocks.get(name).filter(|later| !later.max.is_empty()) else {
            let (before, after) = (format!("{} values", then.n), "none".to_string());
            rows.push(Row { name: name.clone(), before, after, found: String::new(), verdict: Verdict::Worse });
            continue;
        };
        rows.extend(one_latency(name, (earlier, then), (later, now), tolerance, level));
    }
    rows
}

/// The figures of one latency, from its blocks and those of the whole run.
fn one_latency(
    name: &str,
    before: (&Blocks, Percentiles),
    after: (&Blocks, Percentiles),
    tolerance: f64,
    level: f64,
) -> [Row; FIGURES] {
    let ((earlier, then), (later, now)) = (before, after);
    let blocks = earlier.max.len().min(later.max.len());
    let row = |figure: &str, before: f64, after: f64, (found, worse): (String, bool)| {
        let (found, verdict) = if blocks < BLOCKS {
            (format!("too short to tell: {blocks} of {BLOCKS} blocks"), Verdict::TooShort)
        } else {
            (found, Verdict::of(worse))
        };
        let [before, after] = [before, after].map(|us| format!("{us:.1}"));
        Row { name: format!("{name} {figure}, µs"), before, after, found, verdict }
    };
    let typical = |figure: &str, earlier: &[f64], later: &[f64]| {
        let [before, after] = [earlier, later].map(|blocks| over_stretches(blocks, level, f64::ln));
        let Estimate { value, lo, hi, .. } = contrast::difference(&after, &before);
        let found = format!("× {:.3} [{:.3}, {:.3}]", value.exp(), lo.exp(), hi.exp());
        row(figure, before.value.exp(), after.value.exp(), (found, lo.exp() > 1.0 + tolerance))
    };
    let tail = {
        let beyond = |us: f64| f64::from(u8::from(us > then.p999 * (1.0 + tolerance)));
        let [before, after] = [&earlier.max, &later.max].map(|blocks| over_stretches(blocks, level, beyond));
        let found = format!("{:.1} % of blocks lie beyond, {:.1} % did", 100.0 * after.value, 100.0 * before.value);
        (found, contrast::difference(&after, &before).lo > 0.0)
    };
    let extreme = {
        let limit = then.max * (1.0 + tolerance);
        let beyond = stretches(&later.max).filter(|stretch| stretch.iter().any(|&us| us > limit)).count();
        let (old, new) = (stretches(&earlier.max).count(), stretches(&later.max).count());
        let found = format!("{beyond} of {new} stretches lie beyond");
        (found, chance_of_beyond(beyond, old, new) < 0.5 * (1.0 - level))
    };
    [
        typical("p50", &earlier.p50, &later.p50),
        typical("p99", &earlier.p99, &later.p99),
        typical("max", &earlier.max, &later.max),
        row("p99.9 of all", then.p999, now.p999, tail),
        row("max of all", then.max, now.max, extreme),
    ]
}

/// The blocks of a run by stretches.
fn stretches(blocks: &[f64]) -> std::slice::Chunks<'_, f64> {
    blocks.chunks((blocks.len() / STRETCHES).max(1))
}

/// Mean over stretches of the mean of `value` within each, with its interval.
fn over_stretches(blocks: &[f64], level: f64, value: impl Fn(f64) -> f64) -> Estimate {
    let mean_of = |stretch: &[f64]| stretch.iter().map(|&block| value(block)).sum::<f64>() / stretch.len() as f64;
    mean::mean(stretches(blocks).map(mean_of), level)
}

/// Probability that of `old` + `new` values of one distribution the `beyond` largest, at least, are all new ones.
///
/// ```text
/// ∏ (new − i)/(old + new − i),   i = 0 … beyond − 1
/// ```
///
/// Source: S. Rosenbaum (1954).
fn chance_of_beyond(beyond: usize, old: usize, new: usize) -> f64 {
    (0..beyond).map(|i| (new - i) as f64 / (old + new - i) as f64).product()
}

/// Losses, restarts, memory.
fn others(before: &Report, after: &Report) -> Vec<Row> {
    let restarts = |report: &Report| report.processes.values().map(|used| used.restarts).sum::<u64>();
    let rate = |name: &str, count: fn(&Report) -> u64| {
        let [old, new] = [before, after].map(|report| poisson::per_hour(count(report), report.wall_s, LEVEL));
        let [told, tell] = [old, new].map(|rate| format!("{:.2}", rate.value));
        let found = format!("[{:.2}, {:.2}] before, [{:.2}, {:.2}] after", old.lo, old.hi, new.lo, new.hi);
        Row { name: format!("{name} an hour"), before: told, after: tell, found, verdict: Verdict::of(new.lo > old.hi) }
    };
    let growth = |report: &Report| {
        let of = |soak: &Soak| soak.growth_mib.values().copied().reduce(f64::max);
        report.soak.as_ref().and_then(of)
    };
    let told = |growth: Option<f64>| growth.map_or("not checked".to_string(), |mib| format!("{mib:.2}"));
    let limit = after.config.as_ref().map_or(1.0, |config| config.soak.growth_mib);
    let (old, new) = (growth(before), growth(after));
    let verdict = match new {
        None => Verdict::TooShort,
        Some(new) => Verdict::of(new > limit && old.is_none_or(|old| new > old)),
    };
    let (before, after, found) = (told(old), told(new), format!("{limit} allowed"));
    vec![
        rate("messages lost", Report::lost),
        rate("restarts", restarts),
        Row { name: "memory growth, MiB".into(), before, after, found, verdict },
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::random::{Purpose, generator};
    use rand::RngExt;

    /// A report of 200 blocks of each of seven latencies, heavy-tailed and disturbed for whole stretches, as the same
    /// machine gives them; `spoil` makes it worse, block by block.
    fn report(seed: u32, blocks: usize, spoil: impl Fn(usize, &mut [f64; 3])) -> Report {
        let mut report = Report { soak: Some(Soak::default()), wall_s: 3600.0, ..Report::default() };
        for (place, name) in common::latency::LATENCY_NAMES.iter().enumerate() {
            let mut rng = generator(1, Purpose::Test, seed, place as u32);
            let (mut course, mut disturbed, mut most) = (Blocks::default(), 1.0, 0.0_f64);
            for k in 0..blocks {
                if k % 5 == 0 {
                    disturbed = 1.0 + 0.3 * rng.random::<f64>();
                }
                let p50 = 100.0 * disturbed * (1.0 + 0.1 * rng.random::<f64>());
                // Pareto, of shape 2.
                let mut figures = [p50, 5.0 * p50, 6.0 * p50 / (1.0 - rng.random::<f64>()).sqrt()];
                spoil(k, &mut figures);
                course.t_s.push(k as f64);
                course.p50.push(figures[0]);
                course.p99.push(figures[1]);
                course.max.push(figures[2]);
                most = most.max(figures[2]);
            }
            let mut maxima = course.max.clone();
            maxima.sort_unstable_by(f64::total_cmp);
            let p999 = maxima[blocks * 4 / 5]; // a block has a few hundred values
            let whole = Percentiles { n: 300 * blocks as u64, p999, max: most, ..Percentiles::default() };
            report.latency_us.insert((*name).to_string(), whole);
            report.soak.as_mut().expect("set above").blocks.insert((*name).to_string(), course);
        }
        report
    }

    fn worse(rows: &[Row]) -> Vec<&str> {
        rows.iter().filter(|row| row.verdict == Verdict::Worse).map(|row| row.name.as_str()).collect()
    }

    /// Both directions of equally good runs: at most one pair in forty, but for three standard deviations of the count.
    #[test]
    fn noise_is_not_worse() {
        let (pairs, mut false_alarms) = (200, 0_u32);
        for seed in 0..pairs {
            let (a, b) = (report(2 * seed, 200, |_, _| ()), report(2 * seed + 1, 200, |_, _| ()));
            for (before, after) in [(&a, &b), (&b, &a)] {
                false_alarms += u32::from(!worse(&latencies(before, after, 0.0)).is_empty());
            }
        }
        assert!(false_alarms <= 20, "{false_alarms} of 400");
    }

    #[test]
    fn a_slower_run_is_worse_and_a_faster_is_not() {
        let before = report(1, 200, |_, _| ());
        let scaled = |by: f64| report(2, 200, move |_, figures| figures.iter_mut().for_each(|us| *us *= by));
        let found = latencies(&before, &scaled(1.4), 0.1);
        assert!(worse(&found).iter().filter(|name| name.contains("p50") || name.contains("p99,")).count() == 14);
        assert_eq!(worse(&latencies(&before, &scaled(0.7), 0.1)), [""; 0]);
    }

    /// Medians over blocks see nothing of it.
    #[test]
    fn a_bad_part_of_a_run_is_worse() {
        let before = report(1, 60, |_, _| ());
        for (every, by) in [(3, 100.0), (5, 1000.0)] {
            let after = report(2, 60, |k, [_, p99, max]| {
                if k % every == 0 {
                    (*p99, *max) = (*p99 * by, *max * by);
                }
            });
            let found = latencies(&before, &after, 0.1);
            for figure in ["track p99, µs", "track max, µs"] {
                assert!(worse(&found).contains(&figure), "{figure}, every {every}: {found:?}");
            }
            assert!(!worse(&found).contains(&"track p50, µs"), "{found:?}");
            assert_eq!(worse(&latencies(&after, &before, 0.1)), [""; 0]);
        }
    }

    #[test]
    fn higher_extremes_alone_are_worse_and_a_single_one_is_not() {
        let before = report(1, 200, |_, _| ());
        let spoilt = |every: usize, by: f64| {
            report(2, 200, move |k, [_, _, max]| *max *= if k % every == every - 1 { by } else { 1.0 })
        };
        assert!(worse(&latencies(&before, &spoilt(10, 1e3), 0.1)).contains(&"track max of all, µs"));
        assert!(worse(&latencies(&before, &spoilt(2, 10.0), 0.1)).contains(&"track p99.9 of all, µs"));
        assert_eq!(worse(&latencies(&before, &spoilt(200, 1e3), 0.1)), [""; 0]);
    }

    /// All orders of 3 + 3 values: in 1 of 20 the three largest are new, in 4 at least the two largest.
    #[test]
    fn the_chance_of_extremes_is_that_of_counting() {
        for (beyond, chance) in [(0, 1.0), (1, 0.5), (2, 0.2), (3, 0.05)] {
            assert!((chance_of_beyond(beyond, 3, 3) - chance).abs() < 1e-12);
        }
    }

    #[test]
    fn short_runs_are_too_short_to_tell() {
        let found = latencies(&report(1, 1, |_, _| ()), &report(2, 1, |_, [p50, ..]| *p50 *= 9.0), 0.1);
        assert_eq!(found.len(), 35);
        assert!(found.iter().all(|row| row.verdict == Verdict::TooShort && row.found.contains("1 of 40 blocks")));
    }

    #[test]
    fn a_latency_that_is_missing_is_worse() {
        let (before, mut after) = (report(1, 200, |_, _| ()), report(2, 200, |_, _| ()));
        after.soak.as_mut().expect("a soak").blocks.remove("track");
        assert_eq!(worse(&latencies(&before, &after, 0.1)), ["track"]);
    }

    #[test]
    fn losses_are_compared_by_their_rates() {
        let lossy = |lost: u64, wall_s: f64| {
            let mut report = Report { wall_s, ..Report::default() };
            report.loss.entry("plots".into()).or_default().insert("tracker".into(), lost);
            report
        };
        assert_eq!(worse(&others(&lossy(0, 3600.0), &lossy(12, 3600.0))), ["messages lost an hour"]);
        assert_eq!(worse(&others(&lossy(12, 3600.0), &lossy(0, 3600.0))), [""; 0]);
        assert_eq!(worse(&others(&lossy(12, 3600.0), &lossy(90, 8.0 * 3600.0))), [""; 0]);
        assert_eq!(worse(&others(&lossy(0, 3600.0), &lossy(1, 8.0 * 3600.0))), [""; 0]);
    }

    #[test]
    fn soaks_of_another_kind_are_not_compared() {
        let config = ChainConfig::default();
        assert_eq!(difference(Some(&config), Some(&config)), None);
        let mut other = config.clone();
        other.run.speed = common::config::Speed::Max;
        assert_eq!(difference(Some(&config), Some(&other)), Some("speed is 1× and max".to_string()));
        other = config.clone();
        other.site.name = "elsewhere".into();
        assert!(difference(Some(&config), Some(&other)).is_some_and(|told| told.contains("and elsewhere")));
        assert!(difference(None, Some(&config)).is_some());
    }
}
