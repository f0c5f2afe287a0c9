//! The last `tracks` messages of a site in files of its domain: a tracker that is started again goes on with the tracks of the one before.
//!
//! Three files take turns, one turn of the beam each, so that the last two whole turns are at hand: a track is told of once in about one. Each
//! begins with the version of the messages and a number that grows from file to file; then follow the messages as recordings hold them, each
//! after its length. What a kill has cut off is not read.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use common::message::{END_OF_SCAN, END_OF_STREAM};
use common::messages::{Message, RecordedRef, Tracks};
use common::process::tell;
use common::recording::container::{decode, encode};
use common::tracks::{TERMINATED, Track, TracksHeader};

/// Files that take turns.
const FILES: u64 = 3;

/// The files of a site.
pub(crate) struct LastTracks {
    /// Of all of them but for a number.
    stem: PathBuf,
    turn: u64,
    /// That of this turn; none where it could not be written.
    file: Option<File>,
    room: Vec<u8>,
}

impl LastTracks {
    /// Those of a site, in the folder of the domain.
    pub(crate) fn of(folder: &Path, site: &str) -> Self {
        Self { stem: folder.join(format!("{site}-tracks.0")), turn: 0, file: None, room: Vec::new() }
    }

    /// Begins with the tracks of the tracker before, by number, of each what was last told; none where no tracker has been.
    pub(crate) fn begin(&mut self) -> Vec<Track> {
        let before = self.read();
        self.forget();
        self.open();
        self.append(&TracksHeader::default(), &before);
        match before.iter().filter(|track| track.is_confirmed()).count() {
            0 => {}
            confirmed => tell(&format!("tracker goes on with {confirmed} confirmed tracks of the one before")),
        }
        before
    }

    /// Keeps a message.
    pub(crate) fn keep(&mut self, header: &TracksHeader, tracks: &[Track]) {
        self.append(header, tracks);
        if header.has(END_OF_STREAM) {
            self.forget();
        } else if header.has(END_OF_SCAN) && self.file.is_some() {
            self.turn += 1;
            self.open();
        }
    }

    fn read(&self) -> Vec<Track> {
        let mut turns: Vec<(u64, Vec<u8>)> = (0..FILES).filter_map(|place| turn_of(&self.path(place))).collect();
        turns.sort_unstable_by_key(|(turn, _)| *turn);
        let mut alive = BTreeMap::new();
        for track in turns.iter().flat_map(|(_, messages)| tracks_of(messages)) {
            match track.state_code {
                TERMINATED => drop(alive.remove(&track.id)),
                _ => drop(alive.insert(track.id, track)),
            }
        }
        alive.into_values().collect()
    }

    /// A full disk is no reason to track no more.
    fn append(&mut self, header: &TracksHeader, tracks: &[Track]) {
        let Some(file) = self.file.as_mut().filter(|_| !tracks.is_empty()) else { return };
        self.room.clear();
        self.room.extend([0; size_of::<u32>()]);
        let encoded = encode(RecordedRef::Tracks(header, tracks), &mut self.room).map_err(io::Error::other);
        let length = (self.room.len() - size_of::<u32>()) as u32;
        self.room[..size_of::<u32>()].copy_from_slice(&length.to_le_bytes());
        if let Err(error) = encoded.and_then(|()| file.write_all(&self.room)) {
            self.give_up(&error);
        }
    }

    /// Removes the files.
    fn forget(&mut self) {
        self.file = None;
        for place in 0..FILES {
            let _ = std::fs::remove_file(self.path(place)); // there may be none
        }
    }

    fn open(&mut self) {
        let opened = File::create(self.path(self.turn % FILES)).and_then(|mut file| {
            file.write_all(&start(self.turn))?;
            Ok(file)
        });
        match opened {
            Ok(file) => self.file = Some(file),
            Err(error) => self.give_up(&error),
        }
    }

    fn give_up(&mut self, error: &io::Error) {
        self.forget();
        let stem = self.stem.display();
        tracing::warn!("{stem}: {error}: a tracker that is started again will not have the tracks");
    }

    fn path(&self, place: u64) -> PathBuf {
        self.stem.with_extension(place.to_string())
    }
}

/// How the file of a turn begins.
fn start(turn: u64) -> Vec<u8> {
    [Tracks::SCHEMA.as_bytes(), &turn.to_le_bytes()].concat()
}

/// The number of the turn in a file, and its messages; `None` of a file of another version.
fn turn_of(path: &Path) -> Option<(u64, Vec<u8>)> {
    let content = std::fs::read(path).ok()?;
    let (turn, messages) = content.strip_prefix(Tracks::SCHEMA.as_bytes())?.split_first_chunk()?;
    Some((u64::from_le_bytes(*turn), messages.to_vec()))
}

/// The tracks of the whole messages.
fn tracks_of(mut messages: &[u8]) -> impl Iterator<Item = Track> {
    let next = move || {
        let (length, rest) = messages.split_first_chunk()?;
        let (message, rest) = rest.split_at_checked(u32::from_le_bytes(*length) as usize)?;
        messages = rest;
        decode::<Tracks>(message).ok().map(|(_, tracks)| tracks)
    };
    std::iter::from_fn(next).flatten()
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::tracks::CONFIRMED;

    fn track(id: u64, time_ns: u64, state_code: u32) -> Track {
        Track { id, time_ns, state_code, ..Track::EMPTY }
    }

    fn ids(tracks: &[Track]) -> Vec<(u64, u64)> {
        tracks.iter().map(|track| (track.id, track.time_ns)).collect()
    }

    /// Of a sector, with these flags.
    fn header(flags: u32) -> TracksHeader {
        TracksHeader { flags, ..TracksHeader::default() }
    }

    #[test]
    fn the_last_message_of_each_living_track_is_read_back() {
        let folder = tempfile::tempdir().expect("a folder");
        let of = |site: &str| LastTracks::of(folder.path(), site);
        let mut kept = of("north");
        assert!(kept.begin().is_empty());
        for turn in 0..6 {
            let second = if turn == 5 { TERMINATED } else { CONFIRMED };
            kept.keep(&header(0), &[track(1, turn, CONFIRMED), track(2, turn, second)]);
            // The tracker is killed in the middle of the sixth turn.
            kept.keep(&header(if turn == 5 { 0 } else { END_OF_SCAN }), &[track(3 + turn, turn, CONFIRMED)]);
        }
        // Two whole turns and what there is of the last; track 2 has ended.
        let expected = [(1, 5), (6, 3), (7, 4), (8, 5)];
        assert!(of("south").read().is_empty());
        let mut next = of("north");
        assert_eq!(ids(&next.begin()), expected);
        // That one dies at once: what it has taken over is still there.
        let mut last = of("north");
        assert_eq!(ids(&last.begin()), expected);
        last.keep(&header(END_OF_SCAN | END_OF_STREAM), &[track(1, 9, CONFIRMED)]);
        assert_eq!(std::fs::read_dir(folder.path()).expect("the folder").count(), 0, "the stream has ended");
    }

    #[test]
    fn what_is_cut_off_or_of_another_version_is_not_read() {
        let folder = tempfile::tempdir().expect("a folder");
        let mut kept = LastTracks::of(folder.path(), "north");
        kept.begin();
        kept.keep(&header(0), &[track(1, 1, CONFIRMED)]);
        let whole = std::fs::metadata(kept.path(0)).expect("a file").len();
        kept.keep(&header(0), &[track(1, 2, CONFIRMED), track(2, 2, CONFIRMED)]);
        let all = std::fs::read(kept.path(0)).expect("a file");
        for length in 0..all.len() {
            std::fs::write(kept.path(0), &all[..length]).expect("written");
            let expected: &[(u64, u64)] = if (length as u64) < whole { &[] } else { &[(1, 1)] };
            assert_eq!(ids(&kept.read()), expected, "{length} of {} bytes", all.len());
        }
        let mut other = all;
        other[0] ^= 1;
        std::fs::write(kept.path(0), other).expect("written");
        assert!(kept.read().is_empty());
    }

    #[test]
    fn a_folder_that_cannot_be_written_stops_nothing() {
        let mut kept = LastTracks::of(Path::new("/nonexistent"), "north");
        assert!(kept.begin().is_empty());
        kept.keep(&header(0), &[track(1, 1, CONFIRMED)]);
        kept.keep(&header(END_OF_SCAN), &[track(1, 1, CONFIRMED)]);
        assert!(kept.begin().is_empty());
    }
}
