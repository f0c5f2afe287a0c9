//! Commands of an operator between the plots: each is carried out before plots that the action then names, so that a replay of
//! the actions acts in the same places.

use common::commands::{Command, CommandsHeader};
use common::plots::PlotsHeader;

use crate::Tracker;

/// Commands whose plots have not come yet, in the order in which they came.
#[derive(Debug, Default)]
pub struct Orders {
    waiting: Vec<Command>,
    told: u64,
}

impl Orders {
    /// A command that has come; one that waits already, given again by a replay that was started again, is not taken twice.
    pub fn take(&mut self, command: Command) {
        let is_it = |other: &Command| (other.asked_ns, other.id) == (command.asked_ns, command.id);
        if !self.waiting.iter().any(is_it) {
            self.waiting.push(command);
        }
    }

    /// Carries out, before the plots under `plots` are processed, what is due, and gives `tell` each action and the tracker.
    ///
    /// # Errors
    /// Those of `tell`.
    pub fn carry_out<E>(
        &mut self,
        tracker: &mut Tracker,
        plots: &PlotsHeader,
        mut tell: impl FnMut(&CommandsHeader, &Command, &Tracker) -> Result<(), E>,
    ) -> Result<(), E> {
        let mut next = 0;
        while next < self.waiting.len() {
            if self.waiting[next].before_seq > plots.seq {
                next += 1;
                continue;
            }
            let command = Command { before_seq: plots.seq, ..self.waiting.remove(next) };
            let action = Command { outcome: tracker.carry_out(&command), ..command };
            tell(&self.header(plots), &action, tracker)?;
        }
        Ok(())
    }

    /// Gives `tell` what has become, with the plots under `plots`, of commands that take their time.
    ///
    /// # Errors
    /// Those of `tell`.
    pub fn follow_up<E>(
        &mut self,
        tracker: &mut Tracker,
        plots: &PlotsHeader,
        mut tell: impl FnMut(&CommandsHeader, &Command) -> Result<(), E>,
    ) -> Result<(), E> {
        tracker.take_told().try_for_each(|action| tell(&self.header(plots), &action))
    }

    /// Header of the next action.
    fn header(&mut self, plots: &PlotsHeader) -> CommandsHeader {
        self.told += 1;
        CommandsHeader { seq: self.told - 1, time_ns: plots.time_ns, ..CommandsHeader::default() }
    }
}
