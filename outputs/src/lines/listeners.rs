//! Frames to all who connect.

use std::io;
use std::net::{SocketAddr, TcpListener};
use std::time::Instant;

use common::process::say;

use super::outbox::Outbox;
use super::{Counts, Event, Line};

/// Peers at once; those who come while there are so many are turned away.
const MOST: usize = 64;

/// A server that speaks and does not listen. Without anybody there, frames are nobody's and not counted.
#[derive(Debug)]
pub struct Listeners {
    name: String,
    listener: TcpListener,
    room: usize,
    peers: Vec<Outbox>,
    counts: Counts,
    full: bool,
}

impl Listeners {
    /// At `at`, with room for so many octets that wait, for each peer.
    ///
    /// # Errors
    /// The system refuses the address or the port.
    pub fn open(name: &str, at: SocketAddr, room: usize) -> io::Result<Self> {
        let listener = TcpListener::bind(at)?;
        listener.set_nonblocking(true)?;
        Ok(Self { name: name.into(), listener, room, peers: Vec::new(), counts: Counts::default(), full: false })
    }

    fn welcome(&mut self, now: Instant) {
        while let Ok((stream, _)) = self.listener.accept() {
            if self.peers.len() >= MOST {
                if !std::mem::replace(&mut self.full, true) {
                    say(&format!("output `{}`: {MOST} are connected: others are turned away", self.name));
                }
            } else if stream.set_nonblocking(true).is_ok() {
                self.peers.push(Outbox::new(stream, self.room, now));
                self.full = false;
            }
        }
    }
}

impl Line for Listeners {
    fn send(&mut self, frame: &[u8]) {
        for peer in &mut self.peers {
            self.counts.dropped += u64::from(!peer.push(frame));
        }
    }

    fn attend(&mut self, now: Instant, _: &mut Vec<Event>) {
        self.welcome(now);
        let counts = &mut self.counts;
        self.peers.retain_mut(|peer| {
            let goes_on = peer.read().is_ok() && peer.flush(now).is_ok();
            counts.sent += peer.take_sent();
            if !goes_on {
                counts.dropped += peer.waiting();
            }
            goes_on
        });
    }

    fn counts(&self) -> Counts {
        self.counts
    }

    fn is_waiting(&self) -> bool {
        self.peers.iter().any(|peer| peer.waiting() > 0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Read;
    use std::net::TcpStream;
    use std::time::Duration;

    #[test]
    fn all_who_are_connected_get_what_is_sent_then() {
        let mut line = Listeners::open("x", ([127, 0, 0, 1], 0).into(), 1 << 16).expect("a port");
        let at = line.listener.local_addr().expect("an address");
        line.send(b"nobody");
        let mut streams = [(); 2].map(|()| TcpStream::connect(at).expect("a connection"));
        let until = |line: &mut Listeners, done: &dyn Fn(&Listeners) -> bool| {
            let began = Instant::now();
            while !done(line) {
                assert!(began.elapsed() < Duration::from_secs(60));
                line.attend(Instant::now(), &mut Vec::new());
            }
        };
        until(&mut line, &|line| line.peers.len() == 2);
        line.send(b"tracks");
        until(&mut line, &|line| line.counts.sent == 2);
        for stream in &mut streams {
            let mut room = [0; 6];
            stream.read_exact(&mut room).expect("read");
            assert_eq!(&room, b"tracks");
        }
        drop(streams);
        until(&mut line, &|line| line.peers.is_empty());
        assert_eq!(line.counts(), Counts { sent: 2, dropped: 0 });
        assert!(Listeners::open("y", at, 1).is_err(), "the port is taken");
    }
}
