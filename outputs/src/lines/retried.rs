//! A line that may not be there yet: its port is taken, or its interface is down.

use std::io;
use std::time::{Duration, Instant};

use common::process::{say, tell};

use super::{Counts, Event, Line};

/// Between two attempts.
const PAUSE: Duration = Duration::from_secs(5);

type Open = Box<dyn Fn() -> io::Result<Box<dyn Line>>>;

/// Opens a line, and tries again while it cannot be opened. Until then frames are dropped.
pub(super) struct Retried {
    /// Of the output, and where it sends to, for the user.
    what: String,
    open: Open,
    line: Option<Box<dyn Line>>,
    tried: Instant,
    dropped: u64,
}

impl Retried {
    /// The line that `open` opens; `what` names it.
    pub(super) fn new(what: String, open: impl Fn() -> io::Result<Box<dyn Line>> + 'static) -> Self {
        let mut line = Self { what, open: Box::new(open), line: None, tried: Instant::now(), dropped: 0 };
        if let Err(error) = line.try_to_open() {
            say(&format!("{}: {error}: trying again, frames are dropped", line.what));
        }
        line
    }

    fn try_to_open(&mut self) -> io::Result<()> {
        self.line = Some((self.open)()?);
        Ok(())
    }
}

impl Line for Retried {
    fn send(&mut self, frame: &[u8]) {
        match &mut self.line {
            Some(line) => line.send(frame),
            None => self.dropped += 1,
        }
    }

    fn attend(&mut self, now: Instant, events: &mut Vec<Event>) {
        if self.line.is_none() && now.saturating_duration_since(self.tried) > PAUSE {
            self.tried = now;
            if self.try_to_open().is_ok() {
                tell(&format!("{}: opened", self.what));
            }
        }
        if let Some(line) = &mut self.line {
            line.attend(now, events);
        }
    }

    fn counts(&self) -> Counts {
        let Counts { sent, dropped } = self.line.as_ref().map_or_else(Counts::default, |line| line.counts());
        Counts { sent, dropped: dropped + self.dropped }
    }

    fn is_waiting(&self) -> bool {
        self.line.as_ref().is_some_and(|line| line.is_waiting())
    }
}

#[cfg(test)]
mod tests {
    use super::super::Listeners;
    use super::*;
    use std::net::{TcpListener, TcpStream};

    #[test]
    fn a_port_that_is_free_again_is_taken() {
        let taken = TcpListener::bind("127.0.0.1:0").expect("a port");
        let at = taken.local_addr().expect("an address");
        let open = move || Ok(Box::new(Listeners::open("x", at, 1 << 16)?) as Box<dyn Line>);
        let (mut line, mut now) = (Retried::new("output `x`".into(), open), Instant::now());
        line.send(b"old");
        line.attend(now, &mut Vec::new());
        assert!(line.line.is_none());
        drop(taken);
        while line.line.is_none() {
            now += PAUSE; // the clock of the test
            line.attend(now, &mut Vec::new());
        }
        let _peer = TcpStream::connect(at).expect("it is served");
        while line.counts().sent == 0 {
            line.send(b"news");
            line.attend(now, &mut Vec::new());
        }
        assert_eq!(line.counts().dropped, 1);
    }
}
