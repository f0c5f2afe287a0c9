//! `radar-chain status`: looks at a running chain without disturbing it.

use std::process::ExitCode;
use std::time::{Duration, Instant};

use common::config::{Sites, load_sites};
use common::ipc::{Domain, Flow, Station, Watchdog, attend};
use common::messages::HealthReports;
use common::process::{BadInput, print};
use common::status::{Board, to_json};
use common::topic::Topic;

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
        print(&format!("{}\n", serde_json::to_string_pretty(&to_json(&board))?));
    } else {
        print(&picture(&running, &board).into_text());
    }
    Ok(ExitCode::SUCCESS)
}

/// The configuration that the running chain has, where its launcher has left it.
fn running_configuration(sites: &Sites) -> anyhow::Result<Sites> {
    let file = Domain::root(&sites.first().ipc).join("chain.toml");
    if file.exists() { Ok(load_sites(Some(&file), &[])?) } else { Ok(sites.clone()) }
}
