//! The way of operators' commands to the trackers of the sites.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use common::commands::{Command, CommandsHeader, UNANSWERED};
use common::config::Sites;
use common::ipc::{IpcError, Publisher, Station};
use common::messages::{Commands, Message};
use common::time::monotonic_ns;
use common::topology::{TRACKER, runs};

use crate::serve::Served;

/// Commands that a tracker may have before it, so that no publisher waits for one.
const BEFORE_IT: usize = Commands::QUEUE / 2;
/// A command that cannot be sent for so long is given up: nobody wants it done much later.
const UNSENT: Duration = Duration::from_secs(10);
/// A command that is not answered for so long is not waited for: the slowest antennas turn in less.
const SILENCE: Duration = Duration::from_secs(60);

/// Commands on their way, where viewers may act.
pub(crate) struct Outbox {
    sites: Vec<Option<Desk>>,
    session: u64,
}

/// Commands to one tracker, each with the time when it came here.
struct Desk {
    publisher: Publisher<Commands>,
    sent: u64,
    waiting: VecDeque<(Instant, Command)>,
    unanswered: Vec<(Instant, Command)>,
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
            let desk = |publisher| Desk { publisher, sent: 0, waiting: VecDeque::new(), unanswered: Vec::new() };
            Ok(publisher.transpose()?.map(desk))
        });
        Ok(Self { sites: desks.collect::<Result<_, IpcError>>()?, session })
    }

    /// Sends what waits, as far as it keeps nobody waiting.
    ///
    /// # Errors
    /// [`IpcError`].
    pub(crate) fn send_waiting(&mut self, served: &Served) -> Result<(), IpcError> {
        while let Some((site, command)) = served.next_command() {
            if let Some(desk) = &mut self.sites[site] {
                desk.waiting.push_back((Instant::now(), command));
            }
        }
        let desks = self.sites.iter_mut().enumerate().filter_map(|(site, desk)| Some((site, desk.as_mut()?)));
        for (site, desk) in desks.filter(|(_, desk)| !desk.waiting.is_empty() || !desk.unanswered.is_empty()) {
            desk.send(site, self.session, served)?;
        }
        Ok(())
    }
}

impl Desk {
    fn send(&mut self, site: usize, session: u64, served: &Served) -> Result<(), IpcError> {
        self.unanswered.retain(|(sent, command)| !served.has_answered(site, command) && sent.elapsed() < SILENCE);
        while let Some((came, command)) = self.waiting.pop_front() {
            if self.unanswered.len() < BEFORE_IT && self.publisher.is_heard() {
                let header = CommandsHeader { seq: self.sent, session, ..CommandsHeader::default() };
                self.publisher.publish(&header, &[command], |header| header.out_ns = monotonic_ns())?;
                self.sent += 1;
                self.unanswered.push((Instant::now(), command));
            } else if came.elapsed() > UNSENT {
                served.answer(site, &Command { outcome: UNANSWERED, ..command });
            } else {
                self.waiting.push_front((came, command));
                break;
            }
        }
        Ok(())
    }
}
