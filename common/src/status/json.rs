//! What processes say of themselves, as JSON: what `radar-chain status --json` prints.

use serde_json::{Map, Value, json};

use super::board::{Board, SiteBoard, counted_inputs};
use crate::health::{Condition, Health, Intake, RealtimeSetting};
use crate::latency::LATENCY_NAMES;

/// The processes by name; of a chain of several sites, site by site.
pub fn to_json(board: &Board) -> Value {
    let mut of_sites = board.sites().map(|(name, of_site)| (name.to_string(), site_json(of_site)));
    if board.sites().count() > 1 {
        return Value::Object(of_sites.collect());
    }
    of_sites.next().map(|(_, of_site)| of_site).unwrap_or_default()
}

/// The processes of a site, by name.
fn site_json(board: &SiteBoard) -> Value {
    board.all().map(|(name, health, cpu_share)| (name.to_string(), process_json(health, cpu_share))).collect()
}

fn process_json(health: &Health, cpu_share: f64) -> Value {
    let mut observers: Map<String, Value> = Map::new();
    for of in health.observers() {
        let by_observer = observers.entry(of.topic.as_str()).or_insert_with(|| json!({}));
        by_observer[of.observer.as_str()] = of.lost.into();
    }
    let latency = LATENCY_NAMES.iter().zip(&health.latency).filter(|(_, latency)| latency.n > 0);
    let latency: Map<String, Value> = latency
        .map(|(name, of)| {
            let summary = json!({"n": of.n, "p50": of.p50_us, "p99": of.p99_us, "over_budget": of.misses});
            ((*name).to_string(), summary)
        })
        .collect();
    let by_topic = |count: fn(&Intake) -> u64| -> Map<String, Value> {
        counted_inputs(health).map(|(topic, intake)| (topic.to_string(), count(intake).into())).collect()
    };
    let waiting: Map<String, Value> = health.waiting().map(|(topic, most)| (topic.to_string(), most.into())).collect();
    let rejected: Map<String, Value> =
        health.rejected().map(|(reason, count)| (reason.to_string(), count.into())).collect();
    json!({
        "site": health.site,
        "pid": health.pid,
        "session": health.session,
        "seq": health.seq,
        "heartbeat_ns": health.heartbeat_ns,
        "scan": health.scan,
        "condition": Condition::of(health.condition).text(),
        "ended": health.ended == 1,
        "restarts": health.restarts,
        "cpu_ns": health.cpu_ns,
        "cpu_share": cpu_share,
        "rss_bytes": health.rss_bytes,
        "private_kib": health.private_kib,
        "files": health.files,
        "messages_out": health.messages_out,
        "elements_out": health.elements_out,
        "plots": health.plots,
        "tracks": health.tracks,
        "confirmed": health.confirmed,
        "received": by_topic(|intake| intake.received),
        "lost": by_topic(|intake| intake.lost),
        "waiting": waiting,
        "rejected": rejected,
        "observers": observers,
        "latency_us": latency,
        "silences": health.silences,
        "slow_steps": health.slow_steps,
        "refused": RealtimeSetting::names(health.refused),
        "false_alarms": health.false_alarms.known(),
        "false_alarms_off": health.false_alarms.is_off(),
        "clock_uncertainty_us": (health.clock_uncertainty_us > 0.0).then_some(health.clock_uncertainty_us),
    })
}
