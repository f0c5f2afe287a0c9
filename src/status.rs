//! `radar-chain status`: looks at a running chain without disturbing it.

use std::process::ExitCode;
use std::time::{Duration, Instant};

use common::config::ChainConfig;
use common::ipc::{Domain, Flow, Station, Watchdog, attend};
use common::process::BadInput;
use common::services::{HealthReports, Topic};

use crate::board::Board;
use crate::screen::picture;

/// Every process reports within a second.
const LISTEN: Duration = Duration::from_millis(1500);

/// Prints what the processes of the chain in this domain say of themselves.
pub(crate) fn status(chain: &ChainConfig, json: bool) -> anyhow::Result<ExitCode> {
    let nobody = || BadInput(format!("no chain is running in the domain `{}`", chain.ipc.prefix));
    if !Domain::root(&chain.ipc).exists() {
        return Err(nobody().into());
    }
    let domain = Domain::enter(&chain.ipc)?;
    if !domain.is_alive() {
        return Err(nobody().into());
    }
    let running = running_configuration(chain)?;
    let station = Station::enter("status", &running)?;
    let health = station.subscriber::<HealthReports>()?;
    let wake = station.wake(Topic::Health)?;
    let (began, mut board) = (Instant::now(), Board::default());
    attend(&[&wake], &Watchdog::new(&running, "status"), || -> anyhow::Result<Flow> {
        while let Some(report) = health.receive()? {
            report.elements().iter().for_each(|health| board.take(health));
        }
        Ok(if began.elapsed() > LISTEN { Flow::End } else { Flow::Wait })
    })?;
    if json {
        let processes: serde_json::Map<_, _> = board
            .all()
            .map(|(name, health, cpu_share)| {
                let mut value = serde_json::to_value(health)?;
                value["name"] = name.into();
                value["cpu_share"] = cpu_share.into();
                Ok((name.to_string(), value))
            })
            .collect::<serde_json::Result<_>>()?;
        println!("{}", serde_json::to_string_pretty(&processes)?);
    } else {
        print!("{}", picture(&running, &board));
    }
    Ok(ExitCode::SUCCESS)
}

/// The configuration that the running chain has, where its launcher has left it.
fn running_configuration(chain: &ChainConfig) -> anyhow::Result<ChainConfig> {
    let file = Domain::root(&chain.ipc).join("chain.toml");
    if file.exists() { Ok(common::config::load(Some(&file), &[])?) } else { Ok(chain.clone()) }
}
