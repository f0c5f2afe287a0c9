//! The sockets of a source that listens.

use std::io::{self, ErrorKind};
use std::net::UdpSocket;
use std::time::{Duration, Instant};

use rustix::event::{PollFd, PollFlags, Timespec, poll};

use super::{Endpoint, LARGEST_DATAGRAM};
use crate::process::{BadInput, say};

/// How long a source sleeps at most: signals are obeyed and health is reported meanwhile.
const LONGEST_SLEEP: Duration = Duration::from_millis(100);
/// Datagrams taken from one socket before the source looks after itself.
const MOST_AT_ONCE: usize = 256;
/// Nothing received for this long is worth a word.
const SILENCE: Duration = Duration::from_secs(10);

/// The sockets, and what is said of them.
#[derive(Debug)]
pub struct Ears {
    sockets: Vec<(Endpoint, UdpSocket)>,
    datagram: Vec<u8>,
    heard: Instant,
    is_silent: bool,
}

impl Ears {
    /// Opens the endpoints of these names, each with the key of the configuration that it is from.
    ///
    /// # Errors
    /// [`BadInput`]: nothing can be received there.
    pub fn open<'a>(names: impl IntoIterator<Item = (&'a str, &'a str)>) -> Result<Self, BadInput> {
        let mut sockets = Vec::new();
        for (key, name) in names {
            let endpoint: Endpoint = name.parse().map_err(|error| BadInput(format!("key `{key}`: {error}")))?;
            let refuse = |error: &dyn std::fmt::Display| BadInput(error.to_string());
            let socket = endpoint.open(LONGEST_SLEEP).map_err(|error| refuse(&error))?;
            socket.set_nonblocking(true).map_err(|error| refuse(&format!("listening at {endpoint}: {error}")))?;
            sockets.push((endpoint, socket));
        }
        Ok(Self { sockets, datagram: vec![0; LARGEST_DATAGRAM], heard: Instant::now(), is_silent: false })
    }

    /// Sleeps until a datagram has come, for `longest` at most.
    ///
    /// # Errors
    /// Waiting fails.
    pub fn sleep(&self, longest: Option<Duration>) -> io::Result<()> {
        let longest = longest.unwrap_or(LONGEST_SLEEP).min(LONGEST_SLEEP);
        let timeout = Timespec { tv_sec: 0, tv_nsec: longest.as_nanos() as i64 };
        let mut sockets: Vec<PollFd<'_>> =
            self.sockets.iter().map(|(_, socket)| PollFd::new(socket, PollFlags::IN)).collect();
        match poll(&mut sockets, Some(&timeout)) {
            Err(error) if error != rustix::io::Errno::INTR => Err(error.into()),
            _ => Ok(()),
        }
    }

    /// Hands over what has come, with the number of the socket.
    ///
    /// # Errors
    /// Receiving fails.
    pub fn hear(&mut self, mut take: impl FnMut(usize, &[u8])) -> io::Result<()> {
        let mut heard = false;
        for (line, (endpoint, socket)) in self.sockets.iter().enumerate() {
            for _ in 0..MOST_AT_ONCE {
                match socket.recv(&mut self.datagram) {
                    Ok(length) => take(line, &self.datagram[..length]),
                    Err(error) if error.kind() == ErrorKind::WouldBlock => break,
                    Err(error) if error.kind() == ErrorKind::Interrupted => continue,
                    Err(error) => {
                        return Err(io::Error::new(error.kind(), format!("receiving at {endpoint}: {error}")));
                    }
                }
                heard = true;
            }
        }
        if heard {
            self.heard = Instant::now();
        }
        let becomes_silent = !self.is_silent && self.heard.elapsed() >= SILENCE;
        if becomes_silent || (self.is_silent && heard) {
            self.is_silent = becomes_silent;
            let names: Vec<String> = self.sockets.iter().map(|(endpoint, _)| endpoint.to_string()).collect();
            let names = names.join(", ");
            say(&if heard {
                format!("{names}: receiving again")
            } else {
                format!("{names}: nothing received for {} s", SILENCE.as_secs())
            });
        }
        Ok(())
    }
}
