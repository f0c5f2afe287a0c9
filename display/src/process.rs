//! The process `display`: an observer of all sites that serves their picture.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;

use common::health::{Reject, Rejected};
use common::ipc::{Domain, Flow, Station, attend};
use common::process::{HealthReporter, StageArgs, new_session, say, stop_requested, tell};
use common::realtime;
use common::topology::DISPLAY;

use crate::commands::Outbox;
use crate::feed::Feed;
use crate::serve::{Access, Served, bind, serve};

/// Name of the process.
pub const NAME: &str = DISPLAY;
/// File in the folder of the domain that says where the picture is.
pub const ADDRESS_FILE: &str = "picture";

/// Runs the process until the tracks of all sites have ended.
///
/// # Errors
/// Configuration, the address, or shared memory.
pub fn run(args: &StageArgs) -> anyhow::Result<ExitCode> {
    let sites = args.load_sites()?;
    let chain = sites.first();
    let refused = realtime::apply(chain.realtime.of(NAME));
    let access = Access::new(&chain.display.token_file)?;
    let listener = bind(chain.display.address())?;
    let address = listener.local_addr()?;
    let station = Station::enter(NAME, chain)?;
    let mut feed = Feed::open(&station, &sites)?;
    let served = Arc::new(Served::live(&sites, access));
    serve(listener, Arc::clone(&served))?;
    let _note = AddressNote::write(&Domain::root(&chain.ipc), &format!("http://{address}\n"));
    tell(&format!("picture: http://{address}"));
    if !address.ip().is_loopback() {
        say(&format!("display.listen = {address}: whoever reaches this address and has the token sees the picture"));
    }

    let wakes = feed.wakes()?;
    let wakes: Vec<_> = wakes.iter().collect();
    let session = new_session();
    let mut outbox = Outbox::open(&station, &sites, session)?;
    let mut reporter = HealthReporter::new(&station, chain, session, refused)?;
    attend(&wakes, &reporter.watchdog(), || -> anyhow::Result<Flow> {
        let flow = feed.take_waiting(&served)?;
        outbox.send_waiting(&served)?;
        let flow = if stop_requested() || feed.has_ended() { Flow::End } else { flow };
        if flow == Flow::End || reporter.is_due() {
            feed.describe(&mut reporter.health);
            let counts = served.counts();
            let mut rejected = Rejected::default();
            rejected.count_many(Reject::Full, counts.dropped + counts.refused);
            reporter.health.set_rejected(&rejected);
            reporter.health.messages_out = counts.sent;
            reporter.health.ended = u32::from(flow == Flow::End);
            reporter.publish()?;
        }
        Ok(flow)
    })?;
    Ok(ExitCode::SUCCESS)
}

/// The file that says where the picture is, while it is there.
struct AddressNote(PathBuf);

impl AddressNote {
    /// Writes it. Where that fails, the picture is there all the same.
    fn write(folder: &Path, text: &str) -> Self {
        let file = folder.join(ADDRESS_FILE);
        let _ = std::fs::write(&file, text);
        Self(file)
    }
}

impl Drop for AddressNote {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.0);
    }
}
