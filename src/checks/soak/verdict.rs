//! Verdict of a soak: limits kept and limits broken.

use std::fmt::Write;
use std::time::Duration;

use common::config::{ChainConfig, Speed};
use common::latency::{LATENCY_NAMES, Latency};
use common::report::{Report, Soak};
use common::topology::is_observer;

/// Share of the speed asked for that has to be reached.
const PACE: f64 = 0.95;

/// How long a soak was to last, and how it ended.
#[derive(Debug, Default)]
pub(super) struct Asked {
    pub(super) duration: Option<Duration>,
    /// From the first message to the end.
    pub(super) ran: Duration,
    /// The user ended it.
    pub(super) stopped: bool,
}

/// What broke a limit or was not done as asked, in words; nothing if all was kept.
pub(super) fn findings(
    chain: &ChainConfig,
    report: &Report,
    soak: &Soak,
    asked: &Asked,
    disturbed: bool,
) -> Vec<String> {
    let mut findings: Vec<String> = cut_short(chain, report, asked).into_iter().collect();
    if let Speed::Times(factor) = chain.run.speed
        && report.realtime_factor < PACE * factor
    {
        let reached = report.realtime_factor;
        findings.push(format!("{reached:.2} × real time reached, {factor} × requested: the chain is too slow for it"));
    }
    for (name, _) in LATENCY_NAMES.iter().zip(Latency::ALL).filter(|&(_, latency)| has_values(chain, latency)) {
        if report.latency_us.get(*name).is_none_or(|latency| latency.n == 0) {
            findings.push(format!("{name}: no values, its budget cannot be checked"));
        }
    }
    for name in LATENCY_NAMES {
        let Some(budget) = report.budget.get(name) else { continue };
        let broken = budget.limits.iter().filter(|limit| limit.applied && !limit.ok);
        for limit in broken.filter(|limit| bare_us(soak, name, limit.percentile).is_none_or(|us| us <= limit.limit_us))
        {
            let (percentile, value, limit) = (limit.percentile, limit.value_us, limit.limit_us);
            findings.push(format!("{name}: p{percentile} is {value:.0} µs, its budget {limit:.0} µs"));
        }
    }
    if report.lost() > chain.soak.loss {
        findings.push(format!("{} messages lost, {} allowed", report.lost(), chain.soak.loss));
    }
    for book in report.books.iter().filter(|book| !book.balances()) {
        let (topic, consumer) = (&book.topic, &book.consumer);
        findings.push(format!(
            "counts of {topic} at {consumer} do not balance: {} received + {} lost, {} sent",
            book.received, book.lost, book.sent
        ));
    }
    for (process, growth) in soak.growth_mib.iter().filter(|&(_, &growth)| growth > chain.soak.growth_mib) {
        let limit = chain.soak.growth_mib;
        findings.push(format!("{process} gained {growth:.2} MiB after warm-up, {limit} MiB allowed"));
    }
    let restarted = report.processes.iter().filter(|(name, used)| used.restarts > 0 && !is_observer(name));
    let restarted: Vec<&str> = restarted.map(|(name, _)| name.as_str()).collect();
    if !restarted.is_empty() {
        findings.push(format!("restarted: {}", restarted.join(", ")));
    } else if disturbed {
        findings.push("a stage completed with a fault or had to be restarted".into());
    }
    findings
}

/// Budgets that this machine cannot keep, whatever runs on it, in words: the bare hops alone are over them.
pub(super) fn machine_too_slow(report: &Report, soak: &Soak) -> Vec<String> {
    let mut found = Vec::new();
    for name in LATENCY_NAMES {
        let limits = report.budget.get(name).into_iter().flat_map(|budget| &budget.limits);
        for limit in limits.filter(|limit| limit.applied && !limit.ok) {
            let (percentile, allowed) = (limit.percentile, limit.limit_us);
            if let Some(us) = bare_us(soak, name, percentile).filter(|&us| us > allowed) {
                found.push(format!(
                    "{name}: p{percentile} of the bare hop is {us:.0} µs, the budget {allowed:.0} µs: it is the machine"
                ));
            }
        }
    }
    found
}

/// What the bare hops that a latency consists of take at a percentile, µs; `None` if they were not measured.
fn bare_us(soak: &Soak, name: &str, percentile: f64) -> Option<f64> {
    let [dwells, plots] = [Latency::HopDwells, Latency::HopPlots].map(|hop| LATENCY_NAMES[hop as usize]);
    let at = |hop: &str| {
        let of = soak.reference.get(hop)?;
        [(50.0, of.p50), (90.0, of.p90), (99.0, of.p99), (99.9, of.p999)]
            .into_iter()
            .find_map(|(known, us)| ((known - percentile).abs() < 1e-9).then_some(us))
    };
    match name {
        _ if name == dwells || name == plots => at(name),
        "end_to_end" | "scan" => at(dwells).map(|us| us + at(plots).unwrap_or(0.0)),
        _ => None,
    }
}

/// Whether a latency has values in this chain: the stages that it is between must run.
fn has_values(chain: &ChainConfig, latency: Latency) -> bool {
    let runs = |stage| common::topology::runs(chain, stage);
    match latency {
        Latency::HopDwells | Latency::Extract => runs("plot-extractor"),
        Latency::HopPlots | Latency::Track | Latency::EndToEnd | Latency::Scan => runs("tracker"),
        Latency::Record => true,
    }
}

/// What is missing of the time or the scans that were asked for.
fn cut_short(chain: &ChainConfig, report: &Report, asked: &Asked) -> Option<String> {
    let scans = u64::from(chain.run.scans.saturating_sub(chain.run.first_scan));
    match asked.duration {
        Some(duration) if scans == 0 && asked.ran < duration => {
            Some(format!("cut short: {:.0} s of {:.0} s", asked.ran.as_secs_f64(), duration.as_secs_f64()))
        }
        _ if asked.stopped && scans > 0 => Some(format!("cut short: {} of {scans} scans", report.scans)),
        None if asked.stopped => Some(format!("cut short after {} scans", report.scans)),
        _ => None,
    }
}

/// The soak's part of the report for a terminal; `site` where there are several.
pub(super) fn to_text(report: &Report, site: Option<&str>) -> String {
    let mut text = String::new();
    let Some(soak) = &report.soak else { return text };
    // Writing into a String cannot fail.
    let _ = writeln!(text, "\nsoak{}", site.map(|site| format!(" of {site}")).unwrap_or_default());
    if report.config.as_ref().is_some_and(|config| config.run.speed == Speed::Max) {
        let _ =
            writeln!(text, "  at full speed queues are full by design: only budgets given with --budget are checked");
    }
    for (process, growth) in &soak.growth_mib {
        let _ = writeln!(text, "  {:<30}{growth:+.2} MiB after warm-up", format!("memory of {process}"));
    }
    for not_judged in &soak.not_judged {
        let _ = writeln!(text, "  not checked: {not_judged}");
    }
    for (name, bare) in &soak.reference {
        let ratio = soak.ratio_to_reference.get(name).copied().unwrap_or(f64::NAN);
        let _ = writeln!(
            text,
            "  {:<30}{ratio:.2} × the bare hop (median {:.1} µs, p99 {:.0} µs, {} hops)",
            name, bare.p50, bare.p99, bare.n
        );
    }
    let balanced = report.books.iter().filter(|book| book.balances()).count();
    let _ = writeln!(text, "  {:<30}{balanced} of {} balance", "message counts", report.books.len());
    for miss in report.misses.iter().take(5) {
        let (scan, latency) = (miss.scan, &miss.latency);
        let _ = writeln!(
            text,
            "  {:<30}scan {scan}: {:.0} µs > {:.0} µs",
            format!("{latency} over budget"),
            miss.us,
            miss.limit_us
        );
    }
    let misses: u64 = report.budget.values().map(|budget| budget.misses).sum();
    if misses > 5 {
        let _ =
            writeln!(text, "  {:<30}{misses} scans in all, the first of each latency in report.json", "over budget");
    }
    if soak.ok {
        let judged = if soak.not_judged.is_empty() { "all limits" } else { "all limits that could be checked" };
        let _ = writeln!(text, "  within {judged}");
    }
    for finding in &soak.findings {
        let _ = writeln!(text, "  BROKEN {finding}");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::report::Percentiles;

    fn found(speed: Speed, realtime_factor: f64, scans: u32, asked: &Asked) -> Vec<String> {
        let mut chain = ChainConfig::default();
        (chain.run.speed, chain.run.scans) = (speed, scans);
        let mut report = Report { realtime_factor, scans: 7, ..Report::default() };
        for name in LATENCY_NAMES {
            report.latency_us.insert(name.to_string(), Percentiles { n: 1, ..Percentiles::default() });
        }
        findings(&chain, &report, &Soak::default(), asked, false)
    }

    #[test]
    fn a_soak_that_is_cut_short_or_too_slow_does_not_pass() {
        let asked = |duration: Option<u64>, ran: u64, stopped| Asked {
            duration: duration.map(Duration::from_secs),
            ran: Duration::from_secs(ran),
            stopped,
        };
        let whole = asked(Some(60), 60, false);
        assert_eq!(found(Speed::Times(1.0), 0.99, 0, &whole), [""; 0]);
        assert_eq!(found(Speed::Max, 0.1, 0, &whole), [""; 0]);
        assert!(found(Speed::Times(100.0), 9.25, 0, &whole)[0].starts_with("9.25 × real time reached, 100 ×"));
        assert_eq!(found(Speed::Max, 1.0, 0, &asked(Some(28_800), 5, true)), ["cut short: 5 s of 28800 s"]);
        assert_eq!(found(Speed::Max, 1.0, 10, &asked(None, 5, true)), ["cut short: 7 of 10 scans"]);
        assert_eq!(found(Speed::Max, 1.0, 0, &asked(None, 5, true)), ["cut short after 7 scans"]);
    }

    #[test]
    fn a_budget_that_the_bare_hop_breaks_is_the_machines() {
        use common::report::{BudgetResult, LimitResult};
        let limit = LimitResult { percentile: 99.0, limit_us: 1000.0, value_us: 1400.0, ok: false, applied: true };
        let mut report = Report::default();
        for name in LATENCY_NAMES {
            report.latency_us.insert(name.to_string(), Percentiles { n: 1, ..Percentiles::default() });
        }
        report.budget.insert("hop_plots".into(), BudgetResult { limits: vec![limit], ..BudgetResult::default() });
        for (bare_us, broken) in [(1300.0, false), (20.0, true)] {
            let mut soak = Soak::default();
            soak.reference.insert("hop_plots".into(), Percentiles { p99: bare_us, ..Percentiles::default() });
            let chain = {
                let mut chain = ChainConfig::default();
                chain.run.speed = Speed::Max;
                chain
            };
            let findings = findings(&chain, &report, &soak, &Asked::default(), false);
            assert_eq!(findings.iter().any(|finding| finding.starts_with("hop_plots")), broken, "{findings:?}");
            assert_eq!(machine_too_slow(&report, &soak).len(), usize::from(!broken));
        }
    }

    #[test]
    fn a_budget_without_values_is_not_kept() {
        let findings =
            findings(&ChainConfig::default(), &Report::default(), &Soak::default(), &Asked::default(), false);
        assert!(findings.contains(&"track: no values, its budget cannot be checked".to_string()), "{findings:?}");
    }
}
