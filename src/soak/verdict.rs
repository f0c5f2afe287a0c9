//! Whether a soak stayed within its limits, and what did not.

use std::fmt::Write;

use common::config::ChainConfig;
use common::report::{Report, Soak};

/// What broke a limit, in words; nothing if all was kept.
pub(super) fn findings(chain: &ChainConfig, report: &Report, soak: &Soak, disturbed: bool) -> Vec<String> {
    let mut findings = Vec::new();
    for (name, budget) in &report.budget {
        for limit in budget.limits.iter().filter(|limit| !limit.ok) {
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
            "books of {topic} at {consumer} do not balance: {} received + {} lost, {} sent",
            book.received, book.lost, book.sent
        ));
    }
    for (process, growth) in soak.growth_mib.iter().filter(|&(_, &growth)| growth > chain.soak.growth_mib) {
        let limit = chain.soak.growth_mib;
        findings.push(format!("{process} gained {growth:.2} MiB after warm-up, {limit} MiB allowed"));
    }
    let restarted: Vec<&str> =
        report.processes.iter().filter(|(_, used)| used.restarts > 0).map(|(name, _)| name.as_str()).collect();
    if !restarted.is_empty() {
        findings.push(format!("restarted: {}", restarted.join(", ")));
    } else if disturbed {
        findings.push("a stage found something broken or had to be restarted".into());
    }
    findings
}

/// The soak's part of the report for a terminal.
pub(super) fn to_text(report: &Report) -> String {
    let mut text = String::new();
    let Some(soak) = &report.soak else { return text };
    // Writing into a String cannot fail.
    let _ = writeln!(text, "\nsoak");
    for (process, growth) in &soak.growth_mib {
        let _ = writeln!(text, "  {:<30}{growth:+.2} MiB after warm-up", format!("memory of {process}"));
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
    let _ = writeln!(text, "  {:<30}{balanced} of {} balance", "books", report.books.len());
    for miss in report.misses.iter().take(5) {
        let (scan, latency) = (miss.scan, &miss.latency);
        let _ = writeln!(
            text,
            "  {:<30}scan {scan}: {:.0} µs > {:.0} µs",
            format!("miss of {latency}"),
            miss.us,
            miss.limit_us
        );
    }
    let misses: u64 = report.budget.values().map(|budget| budget.misses).sum();
    if misses > 5 {
        let _ = writeln!(text, "  {:<30}{misses} in all, the first of each latency in report.json", "misses");
    }
    if soak.ok {
        let _ = writeln!(text, "  within all limits");
    }
    for finding in &soak.findings {
        let _ = writeln!(text, "  BROKEN {finding}");
    }
    text
}
