//! What the formats have in common: messages of the chain in, frames out.

use std::time::SystemTime;

use common::plots::{Plot, PlotsHeader};

use crate::origins::Origins;
use crate::targets::{Site, Target};

/// Frames for one peer: whole datagrams, or pieces of a stream that are sent wholly or not at all.
#[derive(Debug, Default)]
pub struct Frames {
    octets: Vec<u8>,
    ends: Vec<usize>,
}

impl Frames {
    /// Appends the frame that `write` writes; nothing if it fails.
    ///
    /// # Errors
    /// Those of `write`.
    pub fn frame<E>(&mut self, write: impl FnOnce(&mut Vec<u8>) -> Result<(), E>) -> Result<(), E> {
        let start = self.octets.len();
        let written = write(&mut self.octets);
        if written.is_err() {
            self.octets.truncate(start);
        } else if self.octets.len() > start {
            self.ends.push(self.octets.len());
        }
        written
    }

    /// Appends a frame.
    pub fn push(&mut self, frame: &[u8]) {
        self.octets.extend_from_slice(frame);
        self.ends.push(self.octets.len());
    }

    /// The frames in order.
    pub fn iter(&self) -> impl Iterator<Item = &[u8]> {
        let starts = std::iter::once(0).chain(self.ends.iter().copied());
        starts.zip(&self.ends).map(|(start, &end)| &self.octets[start..end])
    }

    /// Takes all frames away, and keeps the room.
    pub fn clear(&mut self) {
        self.octets.clear();
        self.ends.clear();
    }
}

/// What one message of tracks brings.
#[derive(Debug, Clone, Copy)]
pub struct Update<'a> {
    /// Where the tracks are from.
    pub site: &'a Site,
    /// Measurement time at the end of the sector, ns UTC.
    pub time_ns: u64,
    /// A scan is complete.
    pub ends_scan: bool,
    /// The tracks to report.
    pub targets: &'a [Target<'a>],
    /// What they were made of, and what they are called.
    pub origins: &'a Origins,
    /// From the source's sending of the sector to now, ns; 0 where it is not known.
    pub latency_ns: u64,
}

/// A format of a system outside. What it cannot say it counts.
pub trait Format {
    /// Reports tracks.
    fn tracks(&mut self, update: &Update<'_>, out: &mut Frames);

    /// Reports the plots of a sector.
    fn plots(&mut self, _site: &Site, _header: &PlotsHeader, _plots: &[Plot], _out: &mut Frames) {}

    /// A peer has been connected to.
    fn opened(&mut self) {}

    /// The peer has said something.
    fn heard(&mut self, _octets: &[u8]) {}

    /// Why the connection is of no more use, if it is not.
    fn is_useless(&self, _now: SystemTime) -> Option<&'static str> {
        None
    }

    /// Says what is due without news of the chain: greetings, answers, signs of life.
    fn tick(&mut self, _now: SystemTime, _out: &mut Frames) {}

    /// The last frames before the connection is closed.
    fn close(&mut self, _now: SystemTime, _out: &mut Frames) {}

    /// Tracks and plots so far that were not for a peer that had not agreed to take them.
    fn held_back(&self) -> u64 {
        0
    }

    /// Tracks and plots so far that the format cannot say.
    fn not_said(&self) -> u64;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frame_is_whole_or_not_there() {
        let mut frames = Frames::default();
        frames.push(b"one");
        let failed = frames.frame(|out| {
            out.extend_from_slice(b"half");
            Err("no")
        });
        assert_eq!(failed, Err("no"));
        let written = frames.frame(|out| {
            out.extend_from_slice(b"two");
            Ok::<(), ()>(())
        });
        assert_eq!(written, Ok(()));
        assert_eq!(frames.frame(|_| Ok::<(), ()>(())), Ok(()), "nothing is no frame");
        assert_eq!(frames.iter().collect::<Vec<_>>(), [&b"one"[..], b"two"]);
        frames.clear();
        assert_eq!(frames.iter().count(), 0);
    }
}
