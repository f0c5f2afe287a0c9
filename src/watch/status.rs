//! `radar-chain status`: looks at a running chain without disturbing it.

use std::process::ExitCode;
use std::time::{Duration, Instant};

use common::config::{Sites, load_sites};
use common::health::{Condition, Health, RealtimeSetting};
use common::ipc::{Domain, Flow, Station, Watchdog, attend};
use common::latency::LATENCY_NAMES;
use common::messages::HealthReports;
use common::process::{BadInput, print};
use common::topic::Topic;
use serde_json::{Map, Value, json};

use super::board::{Board, SiteBoard, data_inputs};
use super::screen::picture;
use crate::stages::name::STATUS;

/// Every process reports within a second.
const LISTEN: Duration = Duration::from_millis(1500);

/// Prints what the processes of the chain in this domain say of themselves.
pub(crate) fn status(sites: &Sites, json: bool) -> anyhow::Result<ExitCode> {
    let ipc = &sites.first().ipc;
    let nobody = || BadInput(format!("no chain is running in the domain `{}`", ipc.prefix));
    if !Domain::root(ipc).exists() {
        return Err(nobody().into());
    }
    let domain = Domain::enter(ipc)?;
    if !domain.is_alive() {
        return Err(nobody().into());
    }
    let running = running_configuration(sites)?;
    let station = Station::enter(STATUS, running.first())?;
    let (mut health, mut wakes) = (Vec::new(), Vec::new());
    for site in running.all() {
        let there = station.at(site);
        health.push(there.subscriber::<HealthReports>()?);
        wakes.push(there.wake(Topic::HealthReports)?);
    }
    let wakes: Vec<_> = wakes.iter().collect();
    let (began, mut board) = (Instant::now(), Board::new(&running));
    attend(&wakes, &Watchdog::new(running.first(), STATUS), || -> anyhow::Result<Flow> {
        for site in &health {
            while let Some(report) = site.receive()? {
                report.elements().iter().for_each(|health| board.note(health));
            }
        }
        Ok(if began.elapsed() > LISTEN { Flow::End } else { Flow::Wait })
    })?;
    if json {
        let mut of_sites = board.sites().map(|(name, of_site)| (name.to_string(), site_json(of_site)));
        let all = match running.only() {
            Some(_) => of_sites.next().map(|(_, of_site)| of_site).unwrap_or_default(),
            None => Value::Object(of_sites.collect()),
        };
        print(&format!("{}\n", serde_json::to_string_pretty(&all)?));
    } else {
        print(&picture(&running, &board));
    }
    Ok(ExitCode::SUCCESS)
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
    let by_topic = |count: fn(&common::health::Intake) -> u64| -> Map<String, Value> {
        data_inputs(health).map(|(topic, intake)| (topic.to_string(), count(intake).into())).collect()
    };
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

/// The configuration that the running chain has, where its launcher has left it.
fn running_configuration(sites: &Sites) -> anyhow::Result<Sites> {
    let file = Domain::root(&sites.first().ipc).join("chain.toml");
    if file.exists() { Ok(load_sites(Some(&file), &[])?) } else { Ok(sites.clone()) }
}
