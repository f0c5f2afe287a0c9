//! The last `tracks` messages of a site in shared memory: a tracker that is started again goes on with the tracks of the one before (ADR 0029).
//!
//! Three files take turns, one for each turn of the beam, and are written over: no disk is waited for, and no memory is freed or taken once
//! they have their size. They hold messages as recordings do, without tentative tracks:
//!
//! ```text
//! length | turn | its mark | trackers that have begun since a whole turn | session of the numbers | message
//! ```
//!
//! A head is written after its message, and messages of an earlier turn have another mark, so that what a kill has cut off is not read.

use std::collections::BTreeMap;
use std::fs::File;
use std::io;
use std::os::unix::fs::FileExt;
use std::path::PathBuf;

use common::config::ChainConfig;
use common::ipc::Domain;
use common::message::{END_OF_SCAN, END_OF_STREAM};
use common::messages::{Message, RecordedRef, Tracks};
use common::process::{say, tell};
use common::recording::container::{decode, encode};
use common::tracks::{TERMINATED, Track, TracksHeader};

/// Files that take turns: the last two turns are whole.
const FILES: usize = 3;
/// Words of a head, and octets.
const WORDS: usize = 5;
const HEAD: usize = WORDS * size_of::<u64>();
/// A turn is taken to be over when its file has so many octets.
const LONGEST: u64 = 16 << 20;
/// So many trackers may begin with the same tracks. If they all die before a turn is over, it may be for these.
const TRIES: u64 = 3;
/// Spreads numbers of turns: no mark is found in a message by chance.
const SPREAD: u64 = 0x9e37_79b9_7f4a_7c15;

/// What a tracker begins with.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct Before {
    /// What was last published of each confirmed track that was alive, by number.
    pub(crate) tracks: Vec<Track>,
    /// The session whose numbers they have, as [`TracksHeader::continued_session`]; 0 without tracks.
    pub(crate) continued_session: u64,
}

/// The files of a site.
pub(crate) struct LastTracks {
    paths: [PathBuf; FILES],
    /// Open while they can be written.
    files: Vec<File>,
    turn: u64,
    /// Octets of the turn so far.
    length: u64,
    /// Trackers that have begun since a turn was whole, this one among them.
    begun: u64,
    kept: Vec<Track>,
    room: Vec<u8>,
}

impl LastTracks {
    /// Those of the site of `chain`, in the shared memory of its domain.
    pub(crate) fn of(chain: &ChainConfig) -> Self {
        let path = |place: usize| Domain::memory_file(&chain.ipc, &format!("{}-tracks.{place}", chain.site.name));
        Self::at(std::array::from_fn(path))
    }

    fn at(paths: [PathBuf; FILES]) -> Self {
        Self { paths, files: Vec::new(), turn: 0, length: 0, begun: 1, kept: Vec::new(), room: Vec::new() }
    }

    /// Begins with the tracks of the tracker before whose numbers are lower than `first`: those of this tracker must be others.
    pub(crate) fn begin(&mut self, first: u64) -> Before {
        let mut turns: Vec<Vec<Kept>> = self.paths.iter().map(read).collect();
        turns.sort_by_key(|turn| turn.first().map(|kept| kept.turn));
        let (mut before, mut alive) = (Before::default(), BTreeMap::new());
        for kept in turns.into_iter().flatten() {
            (self.begun, before.continued_session) = (kept.begun + 1, kept.numbering);
            for track in kept.tracks {
                match track.state_code {
                    TERMINATED => drop(alive.remove(&track.id)),
                    _ => drop(alive.insert(track.id, track)),
                }
            }
        }
        alive.retain(|id, _| *id < first);
        if self.begun > TRIES {
            say(&format!(
                "tracker: {TRIES} trackers have died with the tracks that they went on with: beginning without them"
            ));
            (self.begun, alive) = (1, BTreeMap::new());
        }
        if let confirmed @ 1.. = alive.len() {
            tell(&format!("tracker goes on with {confirmed} confirmed tracks of the one before"));
            before.tracks = alive.into_values().collect();
        } else {
            before = Before::default();
        }
        match self.paths.iter().map(File::create).collect() {
            Ok(files) => self.files = files,
            Err(error) => self.give_up(&error),
        }
        let header = TracksHeader { session: before.continued_session, ..TracksHeader::default() };
        self.append(&header, &before.tracks);
        before
    }

    /// Keeps a message that has been published.
    pub(crate) fn keep(&mut self, header: &TracksHeader, tracks: &[Track]) {
        self.append(header, tracks);
        if header.has(END_OF_STREAM) {
            self.forget();
        } else if self.length > LONGEST || header.has(END_OF_SCAN) && self.length > 0 {
            (self.turn, self.length) = (self.turn + 1, 0);
            self.begun = if self.turn > 1 { 0 } else { self.begun }; // the first may be a part of one
        }
    }

    /// No room is no reason to track no more.
    fn append(&mut self, header: &TracksHeader, tracks: &[Track]) {
        let is_kept = |track: &&Track| track.is_confirmed() || track.state_code == TERMINATED;
        self.kept.clear();
        self.kept.extend(tracks.iter().filter(is_kept));
        let Some(file) = self.files.get((self.turn % FILES as u64) as usize).filter(|_| !self.kept.is_empty()) else {
            return;
        };
        self.room.clear();
        let encoded = encode(RecordedRef::Tracks(header, &self.kept), &mut self.room).map_err(io::Error::other);
        let words: [u64; WORDS] = [self.room.len() as u64, self.turn, mark(self.turn), self.begun, header.numbering()];
        let head: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
        let written = encoded
            .and_then(|()| file.write_all_at(&self.room, self.length + HEAD as u64))
            .and_then(|()| file.write_all_at(&head, self.length));
        match written {
            Ok(()) => self.length += (HEAD + self.room.len()) as u64,
            Err(error) => self.give_up(&error),
        }
    }

    /// Removes the files.
    fn forget(&mut self) {
        self.files.clear();
        for path in &self.paths {
            let _ = std::fs::remove_file(path); // there may be none
        }
    }

    fn give_up(&mut self, error: &io::Error) {
        self.forget();
        let path = self.paths[0].display();
        tracing::warn!("{path}: {error}: a tracker that is started again will not have the tracks");
    }
}

/// How messages of a turn are marked, by this version of the messages.
fn mark(turn: u64) -> u64 {
    let version = Tracks::SCHEMA.bytes().fold(0, |hash: u64, octet| (hash ^ u64::from(octet)).wrapping_mul(SPREAD));
    version ^ turn.wrapping_add(1).wrapping_mul(SPREAD)
}

/// A message as it was kept.
struct Kept {
    turn: u64,
    begun: u64,
    numbering: u64,
    tracks: Vec<Track>,
}

/// The whole messages of the turn that a file begins with; none of another version.
fn read(path: &PathBuf) -> Vec<Kept> {
    let content = std::fs::read(path).unwrap_or_default();
    let (mut rest, mut messages) = (&content[..], Vec::<Kept>::new());
    while let Some((head, after)) = rest.split_first_chunk::<HEAD>() {
        let word =
            |place: usize| u64::from_le_bytes(std::array::from_fn(|octet| head[size_of::<u64>() * place + octet]));
        let [length, turn, marked, begun, numbering]: [u64; WORDS] = std::array::from_fn(word);
        let goes_on = marked == mark(turn) && messages.first().is_none_or(|first| first.turn == turn);
        let Some((message, after)) = after.split_at_checked(length as usize).filter(|_| goes_on) else { break };
        let Ok((_, tracks)) = decode::<Tracks>(message) else { break };
        messages.push(Kept { turn, begun, numbering, tracks });
        rest = after;
    }
    messages
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::tracks::CONFIRMED;
    use tempfile::TempDir;

    /// Number of the first track of a tracker that is started again.
    const NEXT: u64 = 1000;

    fn files(folder: &TempDir) -> LastTracks {
        LastTracks::at(std::array::from_fn(|place| folder.path().join(place.to_string())))
    }

    fn track(id: u64, time_ns: u64, state_code: u32) -> Track {
        Track { id, time_ns, state_code, ..Track::EMPTY }
    }

    fn header(session: u64, flags: u32) -> TracksHeader {
        TracksHeader { session, flags, ..TracksHeader::default() }
    }

    fn ids(before: &Before) -> Vec<(u64, u64)> {
        before.tracks.iter().map(|track| (track.id, track.time_ns)).collect()
    }

    #[test]
    fn the_last_message_of_each_living_track_is_read_back() {
        let folder = tempfile::tempdir().expect("a folder");
        let mut kept = files(&folder);
        assert_eq!(kept.begin(1), Before::default());
        for turn in 0..8 {
            let second = if turn == 7 { TERMINATED } else { CONFIRMED };
            kept.keep(&header(5, 0), &[track(1, turn, CONFIRMED), track(2, turn, second), track(9, turn, 0)]);
            // The tracker is killed in the middle of a turn.
            kept.keep(&header(5, if turn == 7 { 0 } else { END_OF_SCAN }), &[track(20 + turn, turn, CONFIRMED)]);
        }
        // Two whole turns and what there is of the last; track 2 has ended, and one has a number that the next tracker will give.
        let expected = [(1, 7), (25, 5), (26, 6)];
        let before = files(&folder).begin(27);
        assert_eq!((ids(&before), before.continued_session), (expected.to_vec(), 5));
        // That one dies at once: what it has taken over is still there.
        let mut last = files(&folder);
        assert_eq!(last.begin(NEXT), before);
        last.keep(&header(6, END_OF_SCAN | END_OF_STREAM), &[track(1, 9, CONFIRMED)]);
        assert_eq!(std::fs::read_dir(folder.path()).expect("the folder").count(), 0, "the stream has ended");
    }

    #[test]
    fn tracks_that_three_trackers_have_died_with_are_left() {
        let folder = tempfile::tempdir().expect("a folder");
        let mut kept = files(&folder);
        kept.begin(1);
        let live = |kept: &mut LastTracks, turns: u64| {
            (0..turns).for_each(|turn| kept.keep(&header(5, END_OF_SCAN), &[track(1, turn, CONFIRMED)]));
        };
        live(&mut kept, 4);
        for try_of in 1..=3 {
            let mut next = files(&folder);
            assert_eq!(next.begin(NEXT).tracks.len(), 1, "{try_of}");
            live(&mut next, 1);
        }
        assert_eq!(files(&folder).begin(NEXT), Before::default());
        // One that lives ends the count.
        let mut next = files(&folder);
        next.begin(NEXT);
        live(&mut next, 4);
        assert_eq!(files(&folder).begin(NEXT).tracks.len(), 1);
    }

    #[test]
    fn what_is_cut_off_or_of_another_version_is_not_read() {
        let folder = tempfile::tempdir().expect("a folder");
        let mut kept = files(&folder);
        kept.begin(1);
        kept.keep(&header(5, 0), &[track(1, 1, CONFIRMED)]);
        let whole = kept.length as usize;
        kept.keep(&header(5, 0), &[track(1, 2, CONFIRMED), track(2, 2, CONFIRMED)]);
        let all = std::fs::read(&kept.paths[0]).expect("a file");
        for length in 0..all.len() {
            std::fs::write(&kept.paths[0], &all[..length]).expect("written");
            let found: usize = read(&kept.paths[0]).iter().map(|kept| kept.tracks.len()).sum();
            assert_eq!(found, usize::from(length >= whole), "{length} of {} octets", all.len());
        }
        for octet in 8..24 {
            let mut other = all.clone();
            other[octet] ^= 1;
            std::fs::write(&kept.paths[0], other).expect("written");
            assert!(read(&kept.paths[0]).is_empty(), "another turn, or another version");
        }
    }

    #[test]
    fn a_folder_that_cannot_be_written_stops_nothing() {
        let mut kept = LastTracks::at(std::array::from_fn(|place| PathBuf::from(format!("/nonexistent/{place}"))));
        assert_eq!(kept.begin(1), Before::default());
        kept.keep(&header(5, END_OF_SCAN), &[track(1, 1, CONFIRMED)]);
        assert_eq!(kept.begin(1), Before::default());
    }
}
