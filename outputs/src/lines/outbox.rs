//! A connection that never waits, with a bounded room for what its peer has not taken yet.

use std::collections::VecDeque;
use std::io::{self, ErrorKind, Read, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

/// A peer that takes nothing for so long is given up.
const STALLED: Duration = Duration::from_secs(10);

/// Frames on their way to one peer.
#[derive(Debug)]
pub(super) struct Outbox {
    stream: TcpStream,
    room: usize,
    waiting: VecDeque<u8>,
    /// Lengths of the frames that wait; of the first, of what is left of it.
    lengths: VecDeque<usize>,
    moved: Instant,
    sent: u64,
}

impl Outbox {
    /// For a stream that does not block; at most `room` octets wait.
    pub(super) fn new(stream: TcpStream, room: usize, now: Instant) -> Self {
        // A frame is news: it is not held back to fill a packet.
        let _ = stream.set_nodelay(true);
        Self { stream, room, waiting: VecDeque::new(), lengths: VecDeque::new(), moved: now, sent: 0 }
    }

    /// Takes a frame, if there is room for it.
    pub(super) fn push(&mut self, frame: &[u8]) -> bool {
        let fits = self.waiting.len() + frame.len() <= self.room;
        if fits {
            if self.lengths.is_empty() {
                self.moved = Instant::now();
            }
            self.waiting.extend(frame);
            self.lengths.push_back(frame.len());
        }
        fits
    }

    /// Sends what the peer takes.
    ///
    /// # Errors
    /// The connection is broken, or the peer has taken nothing for too long.
    pub(super) fn flush(&mut self, now: Instant) -> io::Result<()> {
        while !self.waiting.is_empty() {
            match self.stream.write(self.waiting.as_slices().0) {
                Ok(0) => return Err(ErrorKind::WriteZero.into()),
                Ok(count) => {
                    self.moved = now;
                    self.waiting.drain(..count);
                    self.count_sent(count);
                }
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) if error.kind() == ErrorKind::WouldBlock => {
                    let stalled = now.saturating_duration_since(self.moved) > STALLED;
                    let cause = || io::Error::other(format!("it has taken nothing for {STALLED:?}"));
                    return if stalled { Err(cause()) } else { Ok(()) };
                }
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }

    fn count_sent(&mut self, mut octets: usize) {
        while let Some(length) = self.lengths.front_mut() {
            if octets < *length {
                *length -= octets;
                return;
            }
            octets -= *length;
            self.lengths.pop_front();
            self.sent += 1;
        }
    }

    /// What the peer has said; `None` if there is nothing.
    ///
    /// # Errors
    /// The connection is broken or closed by the peer.
    pub(super) fn read(&mut self) -> io::Result<Option<Vec<u8>>> {
        let mut octets = [0; 4096];
        match self.stream.read(&mut octets) {
            Ok(0) => Err(io::Error::other("it has closed the connection")),
            Ok(count) => Ok(Some(octets[..count].to_vec())),
            Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted) => Ok(None),
            Err(error) => Err(error),
        }
    }

    /// Frames sent since the last call.
    pub(super) fn take_sent(&mut self) -> u64 {
        std::mem::take(&mut self.sent)
    }

    /// Frames that wait.
    pub(super) fn waiting(&self) -> u64 {
        self.lengths.len() as u64
    }
}
