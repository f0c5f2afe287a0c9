//! Commands of an operator between the plots: each is carried out before plots that the action then names, so that a replay of
//! the actions acts in the same places.

use std::collections::VecDeque;

use common::commands::{Command, CommandsHeader};
use common::plots::PlotsHeader;

use crate::Tracker;

/// Commands whose plots have not come yet, in the order in which they came.
#[derive(Debug, Default)]
pub struct Orders {
    waiting: VecDeque<Command>,
    told: u64,
}

impl Orders {
    /// A command that has come.
    pub fn take(&mut self, command: Command) {
        self.waiting.push_back(command);
    }

    /// Carries out, before the plots under `plots` are processed, what is due, and gives `tell` each action; whether there was
    /// anything.
    ///
    /// # Errors
    /// Those of `tell`.
    pub fn carry_out<E>(
        &mut self,
        tracker: &mut Tracker,
        plots: &PlotsHeader,
        mut tell: impl FnMut(&CommandsHeader, &Command) -> Result<(), E>,
    ) -> Result<bool, E> {
        let told = self.told;
        while let Some(&command) = self.waiting.front()
            && command.before_seq <= plots.seq
        {
            self.waiting.pop_front();
            let outcome = tracker.carry_out(&command);
            let action = Command { outcome, before_seq: plots.seq, ..command };
            self.tell(plots, &action, &mut tell)?;
        }
        Ok(self.told > told)
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
        tracker.take_told().try_for_each(|action| self.tell(plots, &action, &mut tell))
    }

    fn tell<E>(
        &mut self,
        plots: &PlotsHeader,
        action: &Command,
        tell: &mut impl FnMut(&CommandsHeader, &Command) -> Result<(), E>,
    ) -> Result<(), E> {
        let header = CommandsHeader { seq: self.told, time_ns: plots.time_ns, ..CommandsHeader::default() };
        self.told += 1;
        tell(&header, action)
    }
}
