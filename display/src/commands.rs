//! The way of operators' commands to the trackers of the sites.

use common::commands::{Command, CommandsHeader};
use common::config::Sites;
use common::ipc::{IpcError, Publisher, Station};
use common::messages::{Commands, Message};
use common::time::monotonic_ns;
use common::topology::{TRACKER, runs};

use crate::serve::Served;

/// Commands that a tracker may have before it, so that no publisher waits for one.
const UNANSWERED: usize = Commands::QUEUE / 2;

/// Publishers of commands, where viewers may act.
pub(crate) struct Outbox {
    sites: Vec<Option<Desk>>,
    session: u64,
    /// A command whose tracker is not there, or has much before it.
    held: Option<(usize, Command)>,
}

/// Commands to one tracker.
struct Desk {
    publisher: Publisher<Commands>,
    sent: u64,
    unanswered: Vec<Command>,
}

impl Outbox {
    /// For all sites with a tracker, from the station of the first one.
    ///
    /// # Errors
    /// [`IpcError`].
    pub(crate) fn open(first: &Station, sites: &Sites, session: u64) -> Result<Self, IpcError> {
        let may_act = sites.first().display.control;
        let desks = sites.all().iter().map(|site| {
            let publisher =
                (may_act && runs(site, TRACKER)).then(|| first.at(site).publisher::<Commands>(Commands::MOST));
            Ok(publisher.transpose()?.map(|publisher| Desk { publisher, sent: 0, unanswered: Vec::new() }))
        });
        Ok(Self { sites: desks.collect::<Result<_, IpcError>>()?, session, held: None })
    }

    /// Sends what waits, as far as it keeps nobody waiting.
    ///
    /// # Errors
    /// [`IpcError`].
    pub(crate) fn send_waiting(&mut self, served: &Served) -> Result<(), IpcError> {
        while let Some((site, command)) = self.held.take().or_else(|| served.next_command()) {
            let Some(desk) = &mut self.sites[site] else { continue };
            let picture = served.picture();
            desk.unanswered.retain(|sent| picture.sites[site].operated.answer(sent).is_none());
            drop(picture);
            if !desk.publisher.is_heard() || desk.unanswered.len() >= UNANSWERED {
                self.held = Some((site, command));
                break;
            }
            let header = CommandsHeader { seq: desk.sent, session: self.session, ..CommandsHeader::default() };
            desk.publisher.publish(&header, &[command], |header| header.out_ns = monotonic_ns())?;
            desk.sent += 1;
            desk.unanswered.push(command);
        }
        Ok(())
    }
}
