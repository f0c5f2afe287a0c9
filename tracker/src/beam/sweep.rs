//! Where the beam is, when it was there, and what it has covered.
//!
//! Angles here are *unwrapped*: 2π · scan + beam angle ([`common::turning`]). They grow with time, so "before" and "after"
//! need no care at north, and the same target's successive passages lie about 2π apart.
//!
//! An antenna that stands sees every azimuth at once: all plots of a scan lie at one angle, half a turn after its beginning,
//! and a target's successive passages exactly 2π apart, whatever its azimuth does.

use std::collections::VecDeque;
use std::f64::consts::{PI, TAU};

use common::angle;
use common::plots::PlotsHeader;
use common::turning::Turning;
use common::units::{NS_PER_S, seconds_between};

/// Turns of coverage that are remembered.
const REMEMBERED_TURNS: f64 = 2.0;
/// Covered intervals kept at most; a stream with more gaps than that has other worries.
const INTERVALS: usize = 256;
/// Intervals closer than this belong together, rad.
const SEAM_RAD: f64 = 1e-9;

/// How a header continues the stream.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Continuation {
    /// The first message, or the next one, possibly after a gap.
    Onwards,
    /// Already taken, or older than what was taken.
    Late,
    /// The next one, and the antenna turns otherwise than before.
    Otherwise,
    /// Measurement time went back: a new recording or a restarted simulation.
    Anew,
}

/// State of the beam.
#[derive(Debug, Default)]
pub struct Sweep {
    started: bool,
    session: u64,
    last_seq: u64,
    /// Added to the scan numbers of the session to continue those before.
    turns: f64,
    /// Unwrapped beam angle at `time_ns`.
    beam_rad: f64,
    time_ns: u64,
    period_s: f64,
    turning: Turning,
    covered: VecDeque<(f64, f64)>,
}

impl Sweep {
    /// Takes note of the next message.
    pub fn advance(&mut self, header: &PlotsHeader) -> Continuation {
        let mut continuation = Continuation::Onwards;
        if self.started && header.session == self.session {
            if header.seq <= self.last_seq {
                return Continuation::Late;
            }
        } else if self.started {
            if seconds_between(self.time_ns, header.time_ns) < -self.period_s {
                *self = Self::default();
                continuation = Continuation::Anew;
            } else {
                // The new session may count scans from anywhere: time tells how many turns have passed.
                let here = within_stream(header);
                let turned = seconds_between(self.time_ns, header.time_ns) / header.scan_period_s * TAU;
                self.turns = ((self.beam_rad + turned - here) / TAU).round();
            }
        }
        if self.started && header.turning() != self.turning {
            continuation = Continuation::Otherwise;
            self.covered.clear();
        }
        self.turning = header.turning();
        self.started = true;
        self.session = header.session;
        self.last_seq = header.seq;
        self.beam_rad = TAU * self.turns + within_stream(header);
        self.time_ns = header.time_ns;
        self.period_s = header.scan_period_s;
        let north = TAU * (self.turns + f64::from(header.scan));
        self.cover(north + header.covered_from_rad, north + header.covered_to_rad);
        continuation
    }

    fn cover(&mut self, from: f64, to: f64) {
        match self.covered.back_mut() {
            Some((begin, end)) if from <= *end + SEAM_RAD => {
                *begin = begin.min(from);
                *end = end.max(to);
            }
            _ => self.covered.push_back((from, to)),
        }
        let oldest = self.covered_to_rad() - REMEMBERED_TURNS * TAU;
        while self.covered.len() > INTERVALS || self.covered.front().is_some_and(|(_, end)| *end < oldest) {
            self.covered.pop_front();
        }
    }

    /// Every plot before this angle has arrived or is lost.
    pub fn covered_to_rad(&self) -> f64 {
        self.covered.back().map_or(0.0, |(_, end)| *end)
    }

    /// Whether the results at an angle have arrived, rather than been lost.
    pub fn has_seen(&self, angle_rad: f64) -> bool {
        self.covered.iter().rev().any(|(begin, end)| (*begin..=*end).contains(&angle_rad))
    }

    /// Time of one turn, s.
    pub fn period_s(&self) -> f64 {
        self.period_s
    }

    /// When the beam passes an angle, ns UTC; the rotation is taken to be uniform.
    pub fn time_at(&self, angle_rad: f64) -> u64 {
        shift(self.time_ns, (angle_rad - self.beam_rad) / TAU * self.period_s)
    }

    /// Unwrapped angle at which the beam has passed, or will pass, an azimuth at about a time; the rotation is taken to be uniform.
    pub fn angle_at(&self, time_ns: u64, azimuth_rad: f64) -> f64 {
        let about_rad = self.beam_rad + seconds_between(self.time_ns, time_ns) / self.period_s * TAU;
        if self.turning == Turning::Standing {
            // What a period has brought lies in its middle, what comes at its end, too.
            return TAU * ((about_rad - PI) / TAU - SEAM_RAD).round() + PI;
        }
        about_rad + angle::difference(self.turning.mirrored(azimuth_rad), about_rad)
    }

    /// Measurement time of the last message, ns UTC.
    pub fn time_ns(&self) -> u64 {
        self.time_ns
    }

    /// How the antenna turns.
    pub fn turning(&self) -> Turning {
        self.turning
    }

    /// Unwrapped angle of an azimuth in the last message: the turn nearest to what it covers.
    pub fn unwrap(&self, header: &PlotsHeader, azimuth_rad: f64) -> f64 {
        let north_rad = TAU * (self.turns + f64::from(header.scan));
        if self.turning == Turning::Standing {
            return north_rad + PI;
        }
        let middle = 0.5 * (header.covered_from_rad + header.covered_to_rad);
        north_rad + middle + angle::difference(self.turning.mirrored(azimuth_rad), middle)
    }

    /// Azimuth of a place, east and north, m, that the beam meets at an unwrapped angle; in [0, 2π).
    pub fn azimuth_at(&self, angle_rad: f64, position_m: [f64; 3]) -> f64 {
        angle::wrap(match self.turning {
            Turning::Standing => position_m[0].atan2(position_m[1]),
            turning => turning.mirrored(angle_rad),
        })
    }

    /// Angle at which the beam next meets a place, east and north, m, after what it has covered in the last message.
    pub fn next_at(&self, header: &PlotsHeader, position_m: [f64; 3]) -> f64 {
        let covered_rad = TAU * (self.turns + f64::from(header.scan)) + header.covered_from_rad;
        let angle_rad = self.unwrap(header, position_m[0].atan2(position_m[1]));
        if angle_rad < covered_rad { angle_rad + TAU } else { angle_rad }
    }
}

/// Beam angle at the end of the header's sector, in the session's own count.
fn within_stream(header: &PlotsHeader) -> f64 {
    TAU * (f64::from(header.scan) + f64::from(header.sector + 1) / f64::from(header.sectors_per_scan))
}

/// `time_ns` moved by `by_s`; stops at the ends of the clock.
pub(crate) fn shift(time_ns: u64, by_s: f64) -> u64 {
    let by_ns = (by_s.abs() * NS_PER_S).round() as u64;
    if by_s >= 0.0 { time_ns.saturating_add(by_ns) } else { time_ns.saturating_sub(by_ns) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn header(session: u64, scan: u32, sector: u32, time_s: f64) -> PlotsHeader {
        PlotsHeader {
            seq: u64::from(scan * 4 + sector),
            session,
            time_ns: (time_s * 1e9) as u64,
            covered_from_rad: TAU / 4.0 * f64::from(sector),
            covered_to_rad: TAU / 4.0 * f64::from(sector + 1),
            scan_period_s: 1.0,
            scan,
            sector,
            sectors_per_scan: 4,
            ..PlotsHeader::default()
        }
    }

    #[test]
    fn late_messages_and_gaps_are_noticed() {
        let mut sweep = Sweep::default();
        assert_eq!(sweep.advance(&header(1, 0, 0, 10.25)), Continuation::Onwards);
        assert_eq!(sweep.advance(&header(1, 0, 1, 10.5)), Continuation::Onwards);
        assert_eq!(sweep.advance(&header(1, 0, 1, 10.5)), Continuation::Late);
        assert_eq!(sweep.advance(&header(1, 0, 3, 11.0)), Continuation::Onwards);
        assert!(sweep.has_seen(0.1) && sweep.has_seen(TAU - 0.1));
        assert!(!sweep.has_seen(TAU * 0.6));
        assert_eq!(sweep.time_at(TAU * 0.25), 10_250_000_000);
    }

    #[test]
    fn a_new_session_continues_the_turns() {
        let mut sweep = Sweep::default();
        sweep.advance(&header(1, 7, 1, 17.5));
        assert_eq!(sweep.advance(&header(2, 0, 0, 20.25)), Continuation::Onwards);
        assert!((sweep.covered_to_rad() - TAU * 10.25).abs() < 1e-9);
        assert_eq!(sweep.advance(&header(3, 0, 0, 3.0)), Continuation::Anew);
        assert!((sweep.covered_to_rad() - TAU * 0.25).abs() < 1e-9);
    }
}
