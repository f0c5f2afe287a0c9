//! The report of a soak as one self-contained page.

use common::config::ChainConfig;
use common::latency::LatencyHistograms;
use common::report::Report;
use common::units::MIB;
use hdrhistogram::Histogram;
use serde_json::{Map, Value, json};

use super::resources::{Series, points};

/// The page; its data go where the placeholder is.
const TEMPLATE: &str = include_str!("report.html");
const PLACEHOLDER: &str = "__REPORT_JSON__";
/// Points of a percentile curve: so many for each halving of the share above.
const TICKS_PER_HALF_DISTANCE: u32 = 5;

/// Writes the page.
pub(super) fn html(
    chain: &ChainConfig,
    report: &Report,
    series: &Series,
    latencies: &LatencyHistograms,
    bare: &LatencyHistograms,
) -> String {
    let data = data(chain, report, series, latencies, bare).to_string();
    TEMPLATE.replace(PLACEHOLDER, &data.replace('<', "\\u003c"))
}

fn data(
    chain: &ChainConfig,
    report: &Report,
    series: &Series,
    latencies: &LatencyHistograms,
    bare: &LatencyHistograms,
) -> Value {
    let soak = report.soak.clone().unwrap_or_default();
    let latency = |(name, histogram): (&str, &Histogram<u64>)| {
        let percentiles = report.latency_us.get(name).copied().unwrap_or_default();
        let mut value = json!(percentiles);
        value["budget"] = json!(report.budget.get(name));
        value["ratio_to_reference"] = json!(soak.ratio_to_reference.get(name));
        value["curve"] = curve(histogram);
        (name.to_string(), value)
    };
    let shown = |(_, histogram): &(&str, &Histogram<u64>)| !histogram.is_empty();
    let reference: Map<String, Value> = bare
        .named()
        .filter(shown)
        .map(|(name, histogram)| {
            let mut value = json!(soak.reference.get(name));
            value["curve"] = curve(histogram);
            (name.to_string(), value)
        })
        .collect();
    let times = soak.blocks.values().map(|blocks| &blocks.t_s).max_by_key(|times| times.len());
    let courses: Map<String, Value> = soak
        .blocks
        .iter()
        .map(|(name, blocks)| (name.clone(), json!({"p50": blocks.p50, "p99": blocks.p99, "max": blocks.max})))
        .collect();
    let tracker = series.by_process.get("tracker").map_or(&[][..], Vec::as_slice);
    json!({
        "site": chain.site.name,
        "version": report.version,
        "git": report.git,
        "mode": chain.run.mode.name(),
        "speed": chain.run.speed.to_string(),
        "started_utc": report.config.as_ref().map_or("", |config| config.run.id.as_str()),
        "wall_s": report.wall_s,
        "scans": report.scans,
        "realtime_factor": report.realtime_factor,
        "machine": crate::checks::machine::describe(),
        "verdict": {"ok": soak.ok, "findings": soak.findings, "not_judged": soak.not_judged},
        "latency": latencies.named().filter(shown).map(latency).collect::<Map<_, _>>(),
        "reference": if reference.is_empty() { Value::Null } else { reference.into() },
        "blocks": {"t_s": times, "latency": courses},
        "processes": series.by_process.iter().map(|(name, rows)| {
            let growth = soak.growth_mib.get(name);
            (name.clone(), json!({
                "t_s": points(rows, |row| row.t_s),
                "rss_mib": points(rows, |row| row.rss_bytes as f64 / MIB),
                "fds": points(rows, |row| f64::from(row.files)),
                "cpu_share": points(rows, |row| row.cpu_share),
                "restarts": report.processes.get(name).map_or(0, |used| used.restarts),
                "growth_mib": growth,
                "growth_ok": growth.is_none_or(|&growth| growth <= chain.soak.growth_mib),
            }))
        }).collect::<Map<_, _>>(),
        "per_scan": {
            "t_s": points(tracker, |row| row.t_s),
            "plots": points(tracker, |row| f64::from(row.plots)),
            "tracks": points(tracker, |row| f64::from(row.tracks)),
            "confirmed": points(tracker, |row| f64::from(row.confirmed)),
        },
        "tracking": {
            "targets": report.tracking.targets,
            "confirmed": report.tracking.confirmed,
            "lost": report.tracking.lost,
            "false_tracks": report.tracking.false_tracks,
            "position_rmse_m": report.tracking.position_rmse_m,
            "truth_share": report.tracking.truth_share,
            "tracks": report.tracking.tracks.as_ref().map(|tracks| tracks.count),
            "life_p50_s": report.tracking.tracks.as_ref().map(|tracks| tracks.life_p50_s),
            "hit_share": report.tracking.tracks.as_ref().map(|tracks| tracks.hit_share),
        },
        "loss": report.books,
        "misses": report.misses,
        "misses_total": report.budget.values().map(|budget| budget.misses).sum::<u64>(),
    })
}

/// Values at quantiles that come closer and closer to 1, µs.
fn curve(histogram: &Histogram<u64>) -> Value {
    let steps = histogram.iter_quantiles(TICKS_PER_HALF_DISTANCE);
    steps.map(|step| json!([step.quantile_iterated_to(), step.value_iterated_to() as f64 / 1000.0])).collect()
}
