//! Scans of a radar on a moving ship as JSON lines, with the boats that carried satellite receivers.
//!
//! One line per scan:
//!
//! | name | what | unit |
//! |---|---|---|
//! | `time_s` | time of the scan: UTC since 1970 | s |
//! | `own_ship_ne_m` | radar, north and east in a local frame that does not move | m |
//! | `plots_ne_m` | plots relative to the radar, north and east | m |
//! | `truth` | boats: `id`, `time_s`, `ne_m` in the frame that does not move; may be absent | s, m |
//! | `scenario` | number of the scenario; not used | |
//!
//! Plots, tracks and truth of the chain are about the radar, so the frame of the chain moves with the ship: errors of plots are
//! those of range and azimuth, exactly, and a course at constant speed is one in either frame. What the ship accelerates,
//! all targets seem to accelerate: the format is for ships that manoeuvre more gently than their targets.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

use common::truth::{MODE_UNKNOWN, PLANAR, TruthTarget, VISIBLE};
use common::units::NS_PER_S;
use serde::Deserialize;

use crate::table::Unread;

/// Largest values that are possible: s since 1970, and m.
const LAST_S: f64 = 3e9;
const FARTHEST_M: f64 = 1e7;
/// Nearest plot that has a direction, m.
const NEAREST_M: f64 = 1e-3;

/// One scan.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ScanLine {
    time_s: f64,
    own_ship_ne_m: [f64; 2],
    plots_ne_m: Vec<[f64; 2]>,
    #[serde(default)]
    truth: Vec<Fix>,
    /// Number of the scenario, where the recording has several.
    #[serde(default)]
    pub scenario: Option<u32>,
}

/// Where a boat was.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct Fix {
    id: u32,
    time_s: f64,
    ne_m: [f64; 2],
}

impl ScanLine {
    /// Time of the scan, ns since 1970.
    pub fn time_ns(&self) -> i64 {
        ns(self.time_s)
    }

    /// Range (m) and azimuth (rad, clockwise from north) of its plots.
    pub fn polar(&self) -> impl Iterator<Item = (f64, f64)> {
        self.plots_ne_m.iter().map(|&[north, east]| (north.hypot(east), east.atan2(north)))
    }

    fn is_possible(&self) -> bool {
        let is_time = |time_s: f64| (0.0..LAST_S).contains(&time_s);
        let is_place = |place: &[f64; 2]| place.iter().all(|along| along.abs() <= FARTHEST_M);
        is_time(self.time_s)
            && is_place(&self.own_ship_ne_m)
            && self.plots_ne_m.iter().all(|plot| is_place(plot) && plot[0].hypot(plot[1]) >= NEAREST_M)
            && self.truth.iter().all(|fix| is_time(fix.time_s) && is_place(&fix.ne_m))
    }
}

/// A recording of scans, in the order of time.
#[derive(Debug, Default, Clone, PartialEq)]
pub struct ScanLines {
    /// Scans; no two of one time.
    pub scans: Vec<ScanLine>,
    /// Lines that could not be read, and why the first of them could not.
    pub unread: Option<Unread>,
}

impl ScanLines {
    /// The scans that `bytes` are, if at least one line holds one.
    pub fn of(bytes: &[u8]) -> Option<Self> {
        let text = std::str::from_utf8(bytes).ok()?;
        if !text.starts_with('{') {
            return None;
        }
        let mut this = Self::default();
        let mut scans = BTreeMap::new();
        for (index, line) in text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty()) {
            let why = match serde_json::from_str::<ScanLine>(line) {
                Ok(scan) if scan.is_possible() => match scans.entry(scan.time_ns()) {
                    Entry::Vacant(place) => {
                        place.insert(scan);
                        continue;
                    }
                    Entry::Occupied(_) => "a second scan of one time".to_string(),
                },
                Ok(_) => "impossible values".to_string(),
                Err(error) => error.to_string(),
            };
            this.unread.get_or_insert(Unread { lines: 0, first: index + 1, why }).lines += 1;
        }
        this.scans = scans.into_values().collect();
        (!this.scans.is_empty()).then_some(this)
    }

    /// The boats about the radar, by time: `visible_m` is how far it sees. Velocities are from one position to the next.
    pub fn truth(&self, visible_m: f64) -> Vec<TruthTarget> {
        let mut fixes: BTreeMap<u32, Vec<Fix>> = BTreeMap::new();
        for fix in self.scans.iter().flat_map(|scan| &scan.truth) {
            fixes.entry(fix.id).or_default().push(*fix);
        }
        let mut targets = Vec::new();
        for (id, mut fixes) in fixes {
            fixes.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
            fixes.dedup_by(|a, b| a.time_s <= b.time_s);
            let places: Vec<[f64; 2]> = fixes.iter().map(|fix| self.about_the_radar(fix)).collect();
            for (index, (fix, &[north, east])) in fixes.iter().zip(&places).enumerate() {
                let other = if index > 0 { index - 1 } else { (index + 1).min(fixes.len() - 1) };
                let step_s = fix.time_s - fixes[other].time_s;
                let velocity = |now: f64, then: f64| if step_s == 0.0 { 0.0 } else { (now - then) / step_s };
                let [was_north, was_east] = places[other];
                let visible = if north.hypot(east) <= visible_m { VISIBLE } else { 0 };
                targets.push(TruthTarget {
                    time_ns: ns(fix.time_s).max(0) as u64,
                    target_id: id,
                    mode: MODE_UNKNOWN,
                    state: [east, velocity(east, was_east), 0.0, north, velocity(north, was_north), 0.0, 0.0, 0.0, 0.0],
                    snr_db: f32::NAN,
                    flags: visible | PLANAR,
                });
            }
        }
        targets.sort_by_key(|target| (target.time_ns, target.target_id));
        targets
    }

    /// The place of the radar at a time: on the straight line between its places in two scans, or that of the first or last.
    pub fn own_ship_ne_m(&self, time_s: f64) -> [f64; 2] {
        let next = self.scans.partition_point(|scan| scan.time_s <= time_s);
        let after = &self.scans[next.min(self.scans.len() - 1)];
        let before = &self.scans[next.saturating_sub(1)];
        let step_s = after.time_s - before.time_s;
        let share = if step_s > 0.0 { (time_s - before.time_s) / step_s } else { 0.0 };
        [0, 1].map(|axis| before.own_ship_ne_m[axis] + share * (after.own_ship_ne_m[axis] - before.own_ship_ne_m[axis]))
    }

    fn about_the_radar(&self, fix: &Fix) -> [f64; 2] {
        let own = self.own_ship_ne_m(fix.time_s);
        [fix.ne_m[0] - own[0], fix.ne_m[1] - own[1]]
    }
}

fn ns(time_s: f64) -> i64 {
    (time_s * NS_PER_S).round() as i64
}

#[cfg(test)]
mod tests {
    use super::*;

    const LINES: &str = r#"{"time_s":102.0,"own_ship_ne_m":[14.0,0.0],"plots_ne_m":[],"truth":[{"id":1,"time_s":102.0,"ne_m":[114.0,40.0]}]}
{"time_s":100.0,"own_ship_ne_m":[10.0,0.0],"plots_ne_m":[[0.0,50.0],[-30.0,0.0]],"truth":[{"id":1,"time_s":101.0,"ne_m":[112.0,30.0]}]}
"#;

    #[test]
    fn plots_and_boats_are_about_the_radar() {
        let lines = ScanLines::of(LINES.as_bytes()).expect("scans");
        assert_eq!((lines.scans.len(), &lines.unread), (2, &None));
        let polar: Vec<(f64, f64)> = lines.scans[0].polar().collect();
        assert_eq!(polar, [(50.0, std::f64::consts::FRAC_PI_2), (30.0, std::f64::consts::PI)]);
        let boats = lines.truth(105.0);
        // At 101 s the radar was at 12 m north.
        assert_eq!(
            boats.iter().map(|boat| (boat.time_ns, boat.position_m())).collect::<Vec<_>>(),
            [(101_000_000_000, [30.0, 100.0, 0.0]), (102_000_000_000, [40.0, 100.0, 0.0])]
        );
        assert!(
            boats
                .iter()
                .all(|boat| (boat.velocity_mps()[0] - 10.0).abs() < 1e-9 && boat.velocity_mps()[1].abs() < 1e-9)
        );
        assert_eq!(boats.iter().map(|boat| boat.has(VISIBLE)).collect::<Vec<_>>(), [true, false]);
    }

    #[test]
    fn lines_that_cannot_be_read_are_counted() {
        let spoilt = LINES.replace("[0.0,50.0]", "[1e9,50.0]");
        let lines = ScanLines::of(spoilt.as_bytes()).expect("one scan");
        let unread = lines.unread.expect("one line");
        assert_eq!((lines.scans.len(), unread.lines, unread.first), (1, 1, 2));
        let twice = ScanLines::of(LINES.repeat(2).as_bytes()).expect("two scans");
        let unread = twice.unread.expect("two lines");
        assert_eq!((twice.scans.len(), unread.lines, unread.first), (2, 2, 3));
        for other in [&b"{\"time_s\":10.5,\"range_m\":1000,\"azimuth_deg\":90}\n"[..], b"", b"time_s\n", b"\xff"] {
            assert_eq!(ScanLines::of(other), None);
        }
    }
}
