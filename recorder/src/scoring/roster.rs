//! The tracks themselves, whether there is truth or not: how many, how long they lived, how often they were seen, where they are.

use std::collections::BTreeMap;

use common::message::END_OF_STREAM;
use common::report::{TRACKS_LISTED, TrackLine, TrackSummary};
use common::tracks::{CONFIRMED, Track, TracksHeader};
use common::units::seconds_between;
use hdrhistogram::Histogram;

/// A track that has not been reported for so long has ended, scans.
const ENDED_SCANS: f64 = 2.5;

/// The fold of confirmed tracks.
#[derive(Debug)]
pub(super) struct Roster {
    scan_period_s: f64,
    now_ns: u64,
    alive: BTreeMap<u64, Entry>,
    /// Those of the longest lives that have ended, at most [`TRACKS_LISTED`].
    ended: Vec<TrackLine>,
    count: u64,
    looks: u64,
    hits: u64,
    /// Of tracks that have ended, ms.
    lives: Histogram<u64>,
}

/// A track since its confirmation.
#[derive(Debug, Clone, Copy)]
struct Entry {
    first_ns: u64,
    last: Track,
    looks: u64,
    hits: u64,
}

impl Roster {
    pub(super) fn new(scan_period_s: f64) -> Self {
        Self {
            scan_period_s,
            now_ns: 0,
            alive: BTreeMap::new(),
            ended: Vec::new(),
            count: 0,
            looks: 0,
            hits: 0,
            lives: Histogram::new_with_max(u64::MAX / 2, 3).expect("constant bounds are valid"),
        }
    }

    /// Takes note of the radar's scan period, s.
    pub(super) fn see(&mut self, scan_period_s: f64) {
        self.scan_period_s = scan_period_s;
    }

    /// Takes the tracks of a sector.
    pub(super) fn tracks(&mut self, header: &TracksHeader, tracks: &[Track]) {
        for track in tracks.iter().filter(|track| track.is_confirmed()) {
            let new = Entry { first_ns: track.time_ns, last: *track, looks: 0, hits: 0 };
            let entry = self.alive.entry(track.id).or_insert_with(|| {
                self.count += 1;
                new
            });
            let hit = u64::from(track.state_code == CONFIRMED);
            entry.last = *track;
            entry.looks += 1;
            entry.hits += hit;
            self.looks += 1;
            self.hits += hit;
        }
        self.now_ns = self.now_ns.max(header.time_ns);
        if header.flags & END_OF_STREAM == 0 {
            let longest = self.scan_period_s * ENDED_SCANS;
            let now_ns = self.now_ns;
            let has_ended = |entry: &Entry| seconds_between(entry.last.time_ns, now_ns) > longest;
            let (ended, alive) = std::mem::take(&mut self.alive).into_iter().partition(|(_, entry)| has_ended(entry));
            self.alive = alive;
            for entry in BTreeMap::into_values(ended) {
                self.end(&entry);
            }
        }
    }

    fn end(&mut self, entry: &Entry) {
        let line = entry.line(false);
        self.lives.saturating_record((line.life_s * 1000.0) as u64);
        let place = self.ended.partition_point(|other| other.life_s >= line.life_s);
        if place < TRACKS_LISTED {
            self.ended.insert(place, line);
            self.ended.truncate(TRACKS_LISTED);
        }
    }

    /// The tracks so far; `None` if there was no confirmed one.
    pub(super) fn finish(&self) -> Option<TrackSummary> {
        if self.count == 0 {
            return None;
        }
        let mut lives = self.lives.clone();
        let mut list: Vec<TrackLine> = self.alive.values().map(|entry| entry.line(true)).collect();
        for line in &list {
            lives.saturating_record((line.life_s * 1000.0) as u64);
        }
        list.sort_by(|a, b| b.life_s.total_cmp(&a.life_s));
        list.extend_from_slice(&self.ended);
        list.truncate(TRACKS_LISTED);
        let life_s = |quantile| lives.value_at_quantile(quantile) as f64 / 1000.0;
        Some(TrackSummary {
            count: self.count,
            alive: self.alive.len() as u64,
            life_p50_s: life_s(0.5),
            life_p95_s: life_s(0.95),
            hit_share: self.hits as f64 / self.looks as f64,
            list,
        })
    }
}

impl Entry {
    fn line(&self, alive: bool) -> TrackLine {
        let ([x, y, z], [vx, vy, _]) = (self.last.position_m(), self.last.velocity_mps());
        let bearing_deg = |east: f64, north: f64| common::angle::wrap(east.atan2(north)).to_degrees();
        TrackLine {
            id: self.last.id,
            alive,
            life_s: seconds_between(self.first_ns, self.last.time_ns),
            looks: self.looks,
            hits: self.hits,
            position_m: [x, y, z],
            range_m: x.hypot(y).hypot(z),
            azimuth_deg: bearing_deg(x, y),
            speed_mps: vx.hypot(vy),
            course_deg: bearing_deg(vx, vy),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::tracks::COASTING;

    #[test]
    fn tracks_are_counted_with_their_lives_and_hits() {
        let mut roster = Roster::new(1.0);
        for second in 0..20_u64 {
            let time_ns = second * 1_000_000_000;
            let of = |id, state_code| {
                let mut track = Track { id, time_ns, state_code, ..Track::default() };
                (track.state[0], track.state[1]) = (-1000.0, 30.0);
                track
            };
            let mut tracks = vec![of(7, if second % 4 == 3 { COASTING } else { CONFIRMED })];
            if second < 5 {
                tracks.push(of(8, CONFIRMED));
            }
            roster.tracks(&TracksHeader { time_ns, ..TracksHeader::default() }, &tracks);
        }
        let summary = roster.finish().expect("tracks");
        assert_eq!((summary.count, summary.alive), (2, 1));
        assert!((summary.hit_share - 20.0 / 25.0).abs() < 1e-12);
        assert!((summary.life_p50_s - 4.0).abs() < 0.01 && (summary.life_p95_s - 19.0).abs() < 0.02);
        let line = summary.list[0];
        assert_eq!((line.id, line.alive, line.looks, line.hits), (7, true, 20, 15));
        assert!((line.azimuth_deg - 270.0).abs() < 1e-9 && (line.course_deg - 90.0).abs() < 1e-9);
        assert!((line.range_m - 1000.0).abs() < 1e-9 && (line.speed_mps - 30.0).abs() < 1e-9);
        assert_eq!((summary.list[1].id, summary.list[1].alive), (8, false));
    }
}
