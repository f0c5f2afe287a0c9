//! Frames to a peer that is connected to, again and again.

use std::io;
use std::net::{SocketAddr, TcpStream};
use std::os::fd::OwnedFd;
use std::time::{Duration, Instant};

use common::process::{say, tell};
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::io::Errno;
use rustix::net::{AddressFamily, SocketFlags, SocketType, sockopt};

use super::outbox::Outbox;
use super::{Counts, Event, Line};

/// Pauses between attempts: the first, and the longest of those that double.
const PAUSE: Duration = Duration::from_millis(250);
const LONGEST_PAUSE: Duration = Duration::from_secs(5);
/// An attempt that takes longer has failed.
const PATIENCE: Duration = Duration::from_secs(5);
/// Reads at once, so that a peer that talks without end holds nobody up.
const READS: usize = 16;

/// A connection that is made again when it breaks. While there is none, frames are dropped: old tracks are no news.
#[derive(Debug)]
pub struct Peer {
    name: String,
    to: SocketAddr,
    room: usize,
    state: State,
    pause: Duration,
    counts: Counts,
    /// The user knows that the peer is away.
    told: bool,
}

#[derive(Debug)]
enum State {
    Apart { since: Option<Instant> },
    Connecting { socket: OwnedFd, since: Instant },
    Connected { outbox: Outbox, since: Instant },
}

impl Peer {
    /// To `to`, with room for so many octets that wait.
    pub fn new(name: &str, to: SocketAddr, room: usize) -> Self {
        let state = State::Apart { since: None };
        Self { name: name.into(), to, room, state, pause: PAUSE, counts: Counts::default(), told: false }
    }

    fn begin(&mut self, now: Instant) -> io::Result<()> {
        let family = if self.to.is_ipv4() { AddressFamily::INET } else { AddressFamily::INET6 };
        let flags = SocketFlags::NONBLOCK | SocketFlags::CLOEXEC;
        let socket = rustix::net::socket_with(family, SocketType::STREAM, flags, None)?;
        match rustix::net::connect(&socket, &self.to) {
            Ok(()) | Err(Errno::INPROGRESS) => {
                self.state = State::Connecting { socket, since: now };
                Ok(())
            }
            Err(error) => Err(error.into()),
        }
    }

    /// Goes on with an attempt; whether it has come to an end.
    fn has_answered(socket: &OwnedFd, since: Instant, now: Instant) -> io::Result<bool> {
        let mut asked = [PollFd::new(socket, PollFlags::OUT)];
        if poll(&mut asked, Some(&Timespec { tv_sec: 0, tv_nsec: 0 }))? > 0 {
            sockopt::socket_error(socket)??;
            return Ok(true);
        }
        if now.saturating_duration_since(since) > PATIENCE {
            return Err(io::Error::other(format!("no answer for {PATIENCE:?}")));
        }
        Ok(false)
    }

    fn hang_up(&mut self, error: &io::Error, now: Instant) {
        // A peer that hangs up at once is no better than one that is away.
        self.pause = (self.pause * 2).min(LONGEST_PAUSE);
        if let State::Connected { outbox, since } = &mut self.state {
            self.counts.sent += outbox.take_sent();
            self.counts.dropped += outbox.waiting();
            if now.saturating_duration_since(*since) > LONGEST_PAUSE {
                self.pause = PAUSE;
            }
        }
        self.state = State::Apart { since: Some(now) };
        if !std::mem::replace(&mut self.told, true) {
            say(&format!("output `{}`: tcp://{}: {error}: trying again, frames are dropped", self.name, self.to));
        }
    }

    fn step(&mut self, now: Instant, events: &mut Vec<Event>) -> io::Result<()> {
        match &mut self.state {
            State::Apart { since } => match since {
                Some(since) if now.saturating_duration_since(*since) < self.pause => Ok(()),
                _ => self.begin(now),
            },
            State::Connecting { socket, since } => {
                if Self::has_answered(socket, *since, now)? {
                    let stream = TcpStream::from(socket.try_clone()?);
                    self.state = State::Connected { outbox: Outbox::new(stream, self.room, now), since: now };
                    self.told = false;
                    events.push(Event::Opened);
                    tell(&format!("output `{}`: connected to tcp://{}", self.name, self.to));
                }
                Ok(())
            }
            State::Connected { outbox, .. } => {
                for _ in 0..READS {
                    match outbox.read()? {
                        Some(octets) => events.push(Event::Heard(octets)),
                        None => break,
                    }
                }
                outbox.flush(now)?;
                self.counts.sent += outbox.take_sent();
                Ok(())
            }
        }
    }
}

impl Line for Peer {
    fn send(&mut self, frame: &[u8]) {
        let taken = if let State::Connected { outbox, .. } = &mut self.state { outbox.push(frame) } else { false };
        self.counts.dropped += u64::from(!taken);
    }

    fn attend(&mut self, now: Instant, events: &mut Vec<Event>) {
        if let Err(error) = self.step(now, events) {
            self.hang_up(&error, now);
        }
    }

    fn give_up(&mut self, why: &str, now: Instant) {
        if let State::Connected { .. } = self.state {
            self.hang_up(&io::Error::other(why), now);
        }
    }

    fn counts(&self) -> Counts {
        self.counts
    }

    fn is_waiting(&self) -> bool {
        matches!(&self.state, State::Connected { outbox, .. } if outbox.waiting() > 0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::{Read, Write};
    use std::net::TcpListener;

    fn attend_until(peer: &mut Peer, what: &str, mut done: impl FnMut(&mut Peer, &[Event]) -> bool) -> Vec<Event> {
        let (began, mut events) = (Instant::now(), Vec::new());
        while !done(peer, &events) {
            assert!(began.elapsed() < Duration::from_secs(60), "{what}");
            peer.attend(Instant::now(), &mut events);
            std::thread::yield_now();
        }
        events
    }

    #[test]
    fn a_peer_that_goes_is_connected_to_again() {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
        let mut peer = Peer::new("x", listener.local_addr().expect("an address"), 1 << 16);
        peer.send(b"nobody is there");
        assert_eq!(peer.counts(), Counts { sent: 0, dropped: 1 });
        for round in 1..=2 {
            attend_until(&mut peer, "opened", |_, events| events.contains(&Event::Opened));
            let (mut stream, _) = listener.accept().expect("a connection");
            peer.send(b"tracks");
            stream.write_all(b"task").expect("written");
            let events = attend_until(&mut peer, "heard", |_, events| !events.is_empty());
            assert_eq!(events, [Event::Heard(b"task".to_vec())]);
            attend_until(&mut peer, "sent", |peer, _| peer.counts().sent == round);
            let mut room = [0; 6];
            stream.read_exact(&mut room).expect("read");
            assert_eq!(&room, b"tracks");
            drop(stream);
            attend_until(&mut peer, "apart", |peer, _| matches!(peer.state, State::Apart { .. }));
        }
        assert_eq!(peer.counts(), Counts { sent: 2, dropped: 1 });
    }

    #[test]
    fn a_peer_that_takes_nothing_costs_its_frames_and_no_time() {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
        let mut peer = Peer::new("x", listener.local_addr().expect("an address"), 1 << 16);
        attend_until(&mut peer, "opened", |_, events| events.contains(&Event::Opened));
        let (stream, _) = listener.accept().expect("a connection");
        let frame = [7; 1000];
        let frames = 50_000;
        for _ in 0..frames {
            peer.send(&frame);
            peer.attend(Instant::now(), &mut Vec::new());
        }
        assert!(peer.counts().dropped > 0 && peer.is_waiting(), "more than the system keeps for it");
        drop(stream);
        attend_until(&mut peer, "apart", |peer, _| matches!(peer.state, State::Apart { .. }));
        assert_eq!(peer.counts().sent + peer.counts().dropped, frames, "every frame is accounted for");
    }

    #[test]
    fn a_connection_of_no_use_is_made_anew() {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
        let mut peer = Peer::new("x", listener.local_addr().expect("an address"), 1 << 16);
        for _ in 0..2 {
            attend_until(&mut peer, "opened", |_, events| events.contains(&Event::Opened));
            let (mut stream, _) = listener.accept().expect("a connection");
            peer.give_up("it says nothing of use", Instant::now());
            assert_eq!(stream.read(&mut [0]).expect("the end"), 0);
        }
    }

    #[test]
    fn a_peer_that_stalls_is_given_up() {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
        let mut peer = Peer::new("x", listener.local_addr().expect("an address"), 64 << 20);
        attend_until(&mut peer, "opened", |_, events| events.contains(&Event::Opened));
        let _stream = listener.accept().expect("a connection");
        peer.send(&vec![0; 64 << 20]);
        let mut now = Instant::now();
        peer.attend(now, &mut Vec::new());
        assert!(peer.is_waiting());
        while matches!(peer.state, State::Connected { .. }) {
            now += Duration::from_secs(11); // the clock of the test
            peer.attend(now, &mut Vec::new());
        }
        assert_eq!(peer.counts(), Counts { sent: 0, dropped: 1 });
    }
}
