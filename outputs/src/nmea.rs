//! Tracks as NMEA 0183 sentences: TTM relative to the radar, TLL where the place of the radar is known.
//!
//! ```text
//! $RATTM,nn,distance,bearing,T,speed,course,T,CPA,TCPA,N,name,status,,hhmmss.ss,A*hh
//! $RATLL,nn,ddmm.mmmm,N,dddmm.mmmm,E,name,hhmmss.ss,status,*hh
//! ```
//!
//! Distances in nautical miles, speeds in knots, TCPA in minutes. A sentence has at most 82 characters. There are a hundred
//! numbers: a track keeps its own while it lives, and while all are taken further tracks are counted.

use std::collections::HashMap;
use std::fmt::Write;

use crate::format::{Format, Frames, Update};
use crate::targets::{Target, degrees_of_turn};

const NM_M: f64 = 1852.0;
const KNOT_MPS: f64 = NM_M / 3600.0;
/// Numbers of tracks.
const NUMBERS: usize = 100;
/// Names are the last digits of track numbers: four, so that the longest sentence fits.
const NAMES: u64 = 10_000;
/// Longest sentence, with `$` and the end of the line.
const LONGEST: usize = 82;
/// A closest approach that is farther away in time is left out, min.
const LONGEST_TCPA_MIN: f64 = 999.0;
/// A track without news for so long has given its number back, ns.
const FORGOTTEN_NS: u64 = 120_000_000_000;

/// Whose a number is: source of the site and track.
type Owner = (u16, u64);

/// Sentences for each report of a track.
#[derive(Debug, Default)]
pub struct Nmea {
    numbers: HashMap<Owner, (usize, u64)>,
    not_said: u64,
}

/// Closest approach of a target that goes straight on: distance, m, and time until then, s, negative if it is past.
fn closest_approach([x, y]: [f64; 2], [vx, vy]: [f64; 2]) -> Option<(f64, f64)> {
    let speed_squared = vx * vx + vy * vy;
    if speed_squared < 1e-6 {
        return None;
    }
    let time_s = -(x * vx + y * vy) / speed_squared;
    Some(((x + vx * time_s).hypot(y + vy * time_s), time_s))
}

/// Degrees and minutes, with so many digits of degrees.
fn degrees_minutes(angle_deg: f64, digits: usize) -> String {
    let ten_thousandths = (angle_deg.abs() * 600_000.0).round() as u64;
    let (degrees, rest) = (ten_thousandths / 600_000, ten_thousandths % 600_000);
    format!("{degrees:0digits$}{:02}.{:04}", rest / 10_000, rest % 10_000)
}

/// Hours, minutes and seconds of the day with hundredths.
fn hhmmss(time_ns: u64) -> String {
    let centiseconds = time_ns / 10_000_000;
    let (seconds, rest) = (centiseconds / 100 % 86_400, centiseconds % 100);
    format!("{:02}{:02}{:02}.{rest:02}", seconds / 3600, seconds / 60 % 60, seconds % 60)
}

impl Nmea {
    /// The number of a track; `None` while all are taken.
    fn number(&mut self, owner: Owner, time_ns: u64) -> Option<usize> {
        if let Some((number, news_ns)) = self.numbers.get_mut(&owner) {
            *news_ns = time_ns;
            return Some(*number);
        }
        self.numbers.retain(|_, (_, news_ns)| time_ns.saturating_sub(*news_ns) < FORGOTTEN_NS);
        let taken = |number: &usize| self.numbers.values().any(|(other, _)| other == number);
        let number = (0..NUMBERS).map(|offset| (owner.1 as usize + offset) % NUMBERS).find(|number| !taken(number))?;
        self.numbers.insert(owner, (number, time_ns));
        Some(number)
    }
}

fn status(target: &Target<'_>) -> char {
    match target.state() {
        "tentative" => 'Q',
        "ended" => 'L',
        _ => 'T',
    }
}

/// Everything of a TTM between `$` and `*`.
fn ttm(number: usize, target: &Target<'_>) -> String {
    let [east, north, _] = target.track.position_m();
    let [vx, vy, _] = target.track.velocity_mps();
    let closest = closest_approach([east, north], [vx, vy]);
    let (cpa, tcpa) = closest
        .filter(|(_, time_s)| time_s.abs() / 60.0 <= LONGEST_TCPA_MIN)
        .map_or_else(Default::default, |(distance_m, time_s)| {
            (format!("{:.2}", distance_m / NM_M), format!("{:.1}", time_s / 60.0))
        });
    format!(
        "RATTM,{number:02},{:.3},{:.2},T,{:.1},{:.1},T,{cpa},{tcpa},N,{},{},,{},A",
        east.hypot(north) / NM_M,
        degrees_of_turn(east.atan2(north)),
        target.speed_mps() / KNOT_MPS,
        target.course_deg(),
        target.track.id % NAMES,
        status(target),
        hhmmss(target.time_ns),
    )
}

/// Everything of a TLL between `$` and `*`.
fn tll(number: usize, target: &Target<'_>) -> Option<String> {
    let place = target.place?;
    Some(format!(
        "RATLL,{number:02},{},{},{},{},{},{},{},",
        degrees_minutes(place.latitude_deg, 2),
        if place.latitude_deg < 0.0 { 'S' } else { 'N' },
        degrees_minutes(place.longitude_deg, 3),
        if place.longitude_deg < 0.0 { 'W' } else { 'E' },
        target.track.id % NAMES,
        hhmmss(target.time_ns),
        status(target),
    ))
}

/// A sentence with its checksum; `None` if it is too long.
fn sentence(body: &str) -> Option<String> {
    let checksum = body.bytes().fold(0, |sum, byte| sum ^ byte);
    let mut text = format!("${body}");
    let _ = write!(text, "*{checksum:02X}\r\n");
    (text.len() <= LONGEST).then_some(text)
}

impl Format for Nmea {
    fn tracks(&mut self, update: &Update<'_>, out: &mut Frames) {
        for target in update.targets {
            let owner = (update.site.source_id, target.track.id);
            let said = self.number(owner, target.time_ns).and_then(|number| {
                out.push(sentence(&ttm(number, target))?.as_bytes());
                if let Some(place) = tll(number, target) {
                    out.push(sentence(&place)?.as_bytes());
                }
                Some(())
            });
            self.not_said += u64::from(said.is_none());
            if target.has_ended() {
                self.numbers.remove(&owner);
            }
        }
    }

    fn not_said(&self) -> u64 {
        self.not_said
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::origins::Origins;
    use crate::targets::tests::{NOON_NS, site, targets, track, update};
    use common::tracks::{CONFIRMED, Track};

    fn said(nmea: &mut Nmea, tracks: &[Track]) -> Vec<String> {
        let (site, targets) = (site(), targets(tracks));
        let origins = Origins::default();
        let update = update(&site, &targets, &origins);
        let mut frames = Frames::default();
        nmea.tracks(&update, &mut frames);
        frames.iter().map(|frame| String::from_utf8(frame.to_vec()).expect("text")).collect()
    }

    #[test]
    fn sentences_are_those_of_the_book() {
        let mut straight = track(107, NOON_NS, CONFIRMED);
        straight.state = [1852.0, 0.0, 0.0, 1852.0, -1852.0 / 360.0, 0.0, 0.0, 0.0, 0.0];
        let lines = said(&mut Nmea::default(), &[straight]);
        // Ten knots south from a mile east and a mile north: abeam in six minutes, a mile away.
        assert_eq!(lines[0], "$RATTM,07,1.414,45.00,T,10.0,180.0,T,1.00,6.0,N,107,T,,120000.00,A*3B\r\n");
        assert!(lines[1].starts_with("$RATLL,07,5027.99") && lines[1].contains(",N,03032.7"), "{}", lines[1]);
        assert!(lines[1].ends_with("\r\n"));
    }

    #[test]
    fn times_are_of_the_day() {
        assert_eq!(hhmmss(NOON_NS + 2_096_789_999_999), "123456.78");
    }

    #[test]
    fn minutes_never_come_to_sixty() {
        assert_eq!(degrees_minutes(49.999_999_99, 2), "5000.0000");
        assert_eq!(degrees_minutes(-0.5, 3), "00030.0000");
    }

    #[test]
    fn the_longest_sentence_fits() {
        let mut far = track(9999, NOON_NS, CONFIRMED);
        // A closest approach 970 minutes ago, 300 nautical miles away.
        far.state = [-560_000.0, -9.62, 0.0, -560_000.0, 0.1, 0.0, 0.0, 0.0, 0.0];
        let said = said(&mut Nmea::default(), &[far]);
        assert!(said.len() == 2 && said[0].len() >= 80, "{said:?}");
    }

    #[test]
    fn a_hundred_tracks_have_numbers_and_others_are_counted() {
        let mut nmea = Nmea::default();
        let tracks: Vec<Track> = (1000..1101).map(|id| track(id, NOON_NS, CONFIRMED)).collect();
        assert_eq!((said(&mut nmea, &tracks).len(), nmea.not_said()), (200, 1));
        let numbers: std::collections::BTreeSet<usize> = nmea.numbers.values().map(|(number, _)| *number).collect();
        assert_eq!(numbers.len(), NUMBERS);
        let later = track(1101, NOON_NS + FORGOTTEN_NS, CONFIRMED);
        assert_eq!(said(&mut nmea, &[later]).len(), 2, "numbers of tracks that are gone are given again");
    }

    #[test]
    fn a_target_that_stands_has_no_closest_approach() {
        let mut still = track(1, NOON_NS, CONFIRMED);
        (still.state[1], still.state[4]) = (0.0, 0.0);
        assert!(said(&mut Nmea::default(), &[still])[0].contains(",T,,,N,1,T,"));
    }
}
