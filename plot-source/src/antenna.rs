//! Where the antenna of a live radar is, from the messages and reports that arrive.
//!
//! The antenna passes the beam angle β ([`common::turning`]) of turn k at t₀ + T (k + β / 2π). A *fix* says that it passed an
//! angle at a time: north markers and sector messages do. Fixes near what is expected correct t₀ and T a little; several in a row that agree
//! with each other and not with what is expected replace both: the antenna was stopped, or its clock was set. Fixes that go
//! back by less than half a turn, one after the other, are of an antenna that turns the other way.
//!
//! Reports of an antenna that stands are taken for fixes in the middle of its period, whatever their azimuth.

use common::turning::Turning;

/// Shares of a residual that correct t₀ and T, for each turn between two fixes.
const PHASE_GAIN: f64 = 0.5;
const TURN_GAIN: f64 = 0.15;
/// A fix farther from what is expected, as a share of a turn, is an outlier.
pub(crate) const FARTHEST: f64 = 0.1;
/// So many outliers in a row replace what is known.
const OUTLIERS: u32 = 3;
/// So many steps back in a row are of an antenna that turns the other way.
const STEPS_BACK: u32 = 3;
/// Where in a period the reports of an antenna lie that stands.
pub(crate) const STANDING_AT: f64 = 0.5;
/// Share of a turn between the first fixes that tell the time of a turn.
const LEAST_TURNED: f64 = 0.25;
/// A turn is another one that differs by this share.
const OTHER_TURN: f64 = 0.05;
/// Azimuths that differ by less are the same, as a share of a turn.
const ROUNDING: f64 = 1e-6;
/// An antenna at the azimuth of the last fix has turned once if this share of a turn has gone by, and else not at all.
const LEAST_PASSED: f64 = 0.1;
/// Turns that are possible, ns.
const TURNS_NS: std::ops::RangeInclusive<f64> = 1e8..=1.2e11;

/// A passage of the antenna: when, ns UTC, and the beam angle as a share of a turn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fix {
    /// When.
    pub time_ns: i64,
    /// Beam angle, in [0, 1).
    pub turned: f64,
}

impl Fix {
    /// What it is of an antenna that turns the other way.
    #[must_use]
    pub fn mirrored(self) -> Self {
        Self { turned: (1.0 - self.turned).rem_euclid(1.0), ..self }
    }
}

/// What a fix has done.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Change {
    /// Nothing, or a correction.
    Followed,
    /// Nothing: it is far from what is expected, and may be wrong.
    Outlier,
    /// The first phase of the antenna is known.
    Locked,
    /// The antenna is elsewhere than was expected.
    Moved,
    /// It turns the other way than was believed: its place is not known.
    Reversed,
}

/// The antenna: turn k begins at `begin_ns` + k · `turn_ns`.
#[derive(Debug, Clone)]
pub struct Antenna {
    turning: Turning,
    /// Whether it is known beforehand how the antenna turns.
    is_given: bool,
    begin_ns: i64,
    turn_ns: f64,
    /// The radar's own word for it.
    told_ns: f64,
    is_locked: bool,
    last: Option<Fix>,
    /// Turned since the first fix, until that is enough to tell the time of a turn.
    first: Option<(Fix, f64)>,
    outliers: u32,
    steps_back: u32,
}

impl Antenna {
    /// An antenna that may take `nominal_ns` for a turn, that turns as is `given`, if it is, and whose place is not known.
    pub fn new(nominal_ns: f64, given: Option<Turning>) -> Self {
        Self {
            turning: given.unwrap_or_default(),
            is_given: given.is_some(),
            begin_ns: 0,
            turn_ns: nominal_ns,
            told_ns: nominal_ns,
            is_locked: false,
            last: None,
            first: None,
            outliers: 0,
            steps_back: 0,
        }
    }

    /// How it turns, as far as is known.
    pub fn turning(&self) -> Turning {
        self.turning
    }

    /// Beam angle at an azimuth (rad) as a share of a turn, in [0, 1).
    pub fn turned(&self, azimuth_rad: f64) -> f64 {
        if self.turning == Turning::Standing { STANDING_AT } else { self.turning.turned(azimuth_rad) }
    }

    /// Believes that it turns the other way, unless it is known how it turns; north is where it was. Whether it does so.
    pub fn reverse(&mut self) -> bool {
        let other = match self.turning {
            Turning::Clockwise => Turning::CounterClockwise,
            Turning::CounterClockwise => Turning::Clockwise,
            Turning::Standing => return false,
        };
        if self.is_given {
            return false;
        }
        self.turning = other;
        (self.last, self.first, self.steps_back) = (self.last.map(Fix::mirrored), None, 0);
        true
    }

    /// Whether its place is known.
    pub fn is_locked(&self) -> bool {
        self.is_locked
    }

    /// Time of a turn, ns.
    pub fn turn_ns(&self) -> f64 {
        self.turn_ns
    }

    /// When turn `turn` has come to an azimuth, a share of a turn; ns UTC.
    pub fn time_of(&self, turn: i64, turned: f64) -> i64 {
        self.begin_ns + (self.turn_ns * (turn as f64 + turned)) as i64
    }

    /// The turn in which the antenna passed an azimuth nearest to a time.
    pub fn turn_of(&self, fix: Fix) -> i64 {
        self.turns(fix).round() as i64
    }

    fn turns(&self, fix: Fix) -> f64 {
        (fix.time_ns - self.begin_ns) as f64 / self.turn_ns - fix.turned
    }

    /// How far it has come in its turn at a time, as a share of it, in [0, 1).
    pub fn passed(&self, time_ns: i64) -> f64 {
        ((time_ns - self.begin_ns) as f64 / self.turn_ns).rem_euclid(1.0).min(1.0 - ROUNDING)
    }

    /// Takes the radar's own word for the time of a turn, if it is news: what fixes have told since then is better.
    pub fn set_turn(&mut self, turn_ns: f64) {
        let is_other = |known_ns: f64| (known_ns / turn_ns - 1.0).abs() > OTHER_TURN;
        if TURNS_NS.contains(&turn_ns) && is_other(self.told_ns) && is_other(self.turn_ns) {
            // Turns keep their numbers from the last fix on.
            if let Some(last) = self.last {
                let turn = self.turns(last);
                self.begin_ns = last.time_ns - (turn_ns * (turn + last.turned)) as i64;
            }
            (self.turn_ns, self.told_ns) = (turn_ns, turn_ns);
        }
    }

    /// Whether the antenna passed an azimuth at about the time of a fix.
    pub fn fits(&self, fix: Fix) -> bool {
        let turns = self.turns(fix);
        (turns - turns.round()).abs() <= FARTHEST
    }

    /// Its place is no longer known; the time of a turn still is.
    pub fn unlock(&mut self) {
        (self.is_locked, self.first) = (false, None);
    }

    /// Starts from what a search in reports has found.
    pub fn start(&mut self, turning: Turning, north_ns: i64, turn_ns: f64) {
        self.turning = turning;
        self.last = None;
        self.lock(north_ns, turn_ns);
    }

    fn lock(&mut self, north_ns: i64, turn_ns: f64) {
        (self.begin_ns, self.turn_ns, self.is_locked) = (north_ns, turn_ns, true);
        (self.outliers, self.steps_back) = (0, 0);
    }

    /// Takes a fix.
    pub fn fix(&mut self, fix: Fix) -> Change {
        if self.last.is_some_and(|last| self.has_not_moved(last, fix)) {
            return Change::Outlier;
        }
        let Some(last) = self.last.replace(fix) else { return Change::Followed };
        let is_back = (0.5 + ROUNDING..1.0 - ROUNDING).contains(&turned_between(last, fix));
        self.steps_back = if is_back { self.steps_back + 1 } else { 0 };
        if self.steps_back >= STEPS_BACK && self.reverse() {
            self.unlock();
            return Change::Reversed;
        }
        if !self.is_locked {
            return self.first_turn(last, fix);
        }
        let turns = self.turns(fix);
        let residual = turns - turns.round();
        if residual.abs() <= FARTHEST {
            self.outliers = 0;
            let passed = ((fix.time_ns - last.time_ns) as f64 / self.turn_ns).clamp(0.0, 1.0);
            let old_ns = self.turn_ns;
            self.turn_ns += TURN_GAIN * passed * residual * old_ns;
            // t₀ is moved so that at this fix the correction is that of the phase alone.
            let here = turns + fix.turned;
            self.begin_ns += (PHASE_GAIN * passed * residual * old_ns - (self.turn_ns - old_ns) * here) as i64;
            return Change::Followed;
        }
        self.outliers += 1;
        if self.outliers < OUTLIERS {
            return Change::Outlier;
        }
        self.outliers = 0;
        let turn = turns.round();
        if let Some(turn_ns) = turn_between(last, fix) {
            self.turn_ns = turn_ns;
        }
        self.begin_ns = fix.time_ns - (self.turn_ns * (turn + fix.turned)) as i64;
        Change::Moved
    }

    /// The first fixes tell the time of a turn, unless they are implausible.
    fn first_turn(&mut self, last: Fix, fix: Fix) -> Change {
        if turn_between(last, fix).is_none() {
            self.first = None;
            return Change::Followed;
        }
        let (first, so_far) = self.first.unwrap_or((last, 0.0));
        let turned = so_far + turned_between(last, fix);
        self.first = Some((first, turned));
        if turned < LEAST_TURNED {
            return Change::Followed;
        }
        let turn_ns = (fix.time_ns - first.time_ns) as f64 / turned;
        self.lock(fix.time_ns - (turn_ns * fix.turned) as i64, turn_ns);
        Change::Locked
    }

    /// Whether an antenna that is at the same angle again cannot have turned meanwhile: it stands, and says so again and again.
    fn has_not_moved(&self, last: Fix, fix: Fix) -> bool {
        let passed_ns = (fix.time_ns - last.time_ns) as f64;
        turned_between(last, fix) > 1.0 - ROUNDING && (0.0..LEAST_PASSED * self.told_ns).contains(&passed_ns)
    }
}

/// Time of a turn of an antenna that has come from one fix to the next in half a turn at most, or in a whole one. Between
/// half a turn and a whole one it may as well have turned the other way.
fn turn_between(last: Fix, fix: Fix) -> Option<f64> {
    let turned = turned_between(last, fix);
    let turn_ns = (fix.time_ns - last.time_ns) as f64 / turned;
    let is_certain = turned <= 0.5 + ROUNDING || turned > 1.0 - ROUNDING;
    (is_certain && TURNS_NS.contains(&turn_ns)).then_some(turn_ns)
}

/// Share of a turn from one fix to the next, above 0.
fn turned_between(last: Fix, fix: Fix) -> f64 {
    let turned = (fix.turned - last.turned).rem_euclid(1.0);
    if turned < ROUNDING { 1.0 } else { turned }
}

#[cfg(test)]
mod tests {
    use super::*;

    const S: f64 = 1e9;

    /// Fixes of `per_turn` sectors, whose turn k takes `turn_s(k)`, with a jitter of ± `jitter_s`.
    fn fixes(per_turn: u32, turns: u32, turn_s: impl Fn(u32) -> f64, jitter_s: f64) -> Vec<Fix> {
        let (mut fixes, mut north_s) = (Vec::new(), 50_000.0);
        for turn in 0..turns {
            for sector in 0..per_turn {
                let turned = f64::from(sector) / f64::from(per_turn);
                let jitter_s = jitter_s * f64::from((turn * 31 + sector * 17) % 21) / 10.0 - jitter_s;
                let time_ns = ((north_s + turn_s(turn) * turned + jitter_s) * S) as i64;
                fixes.push(Fix { time_ns, turned });
            }
            north_s += turn_s(turn);
        }
        fixes
    }

    /// Follows the fixes and returns the largest error after the first `settled` of them, as a share of a turn.
    fn largest_error(antenna: &mut Antenna, fixes: &[Fix], settled: usize) -> f64 {
        let mut largest: f64 = 0.0;
        for (index, &fix) in fixes.iter().enumerate() {
            antenna.fix(fix);
            if index >= settled {
                let turns = antenna.turns(fix);
                largest = largest.max((turns - turns.round()).abs());
            }
        }
        largest
    }

    #[test]
    fn the_antenna_is_followed_whatever_is_configured() {
        for (per_turn, turn_s) in [(1, 4.0), (32, 4.0), (1, 1.0), (32, 12.0)] {
            let mut antenna = Antenna::new(1.5 * S, None);
            let error = largest_error(&mut antenna, &fixes(per_turn, 50, |_| turn_s, 0.008), 3 * per_turn as usize);
            assert!(error < 0.02, "{per_turn} {turn_s}: {error}");
            assert!((antenna.turn_ns() / S - turn_s).abs() < 0.01 * turn_s, "{}", antenna.turn_ns());
        }
    }

    #[test]
    fn a_turn_that_changes_is_followed() {
        for per_turn in [1, 32] {
            let mut antenna = Antenna::new(S, None);
            let fixes = fixes(per_turn, 100, |turn| 2.0 + 0.005 * f64::from(turn), 0.0);
            assert!(largest_error(&mut antenna, &fixes, 2 * per_turn as usize) < 0.05);
        }
    }

    #[test]
    fn an_antenna_that_was_stopped_is_found_again() {
        for per_turn in [1, 32] {
            let mut fixes = fixes(per_turn, 40, |_| 4.0, 0.0);
            for fix in &mut fixes[20 * per_turn as usize..] {
                fix.time_ns += 61_700_000_000;
            }
            let mut antenna = Antenna::new(4.0 * S, None);
            let changes: Vec<Change> = fixes.iter().map(|&fix| antenna.fix(fix)).collect();
            assert_eq!(changes.iter().filter(|&&change| change == Change::Moved).count(), 1);
            let turns = antenna.turns(fixes[fixes.len() - 1]);
            assert!((turns - turns.round()).abs() < 0.01, "{turns}");
            // A single wrong message is no reason to move.
            let mut wrong = fixes[fixes.len() - 1];
            wrong.time_ns += 1_000_000_000;
            let before = antenna.time_of(0, 0.0);
            assert_eq!((antenna.fix(wrong), antenna.time_of(0, 0.0)), (Change::Outlier, before));
        }
    }

    /// A radar that says a wrong turn again and again is believed once, and what its messages show after that.
    #[test]
    fn a_wrong_word_for_the_turn_does_not_move_the_antenna() {
        let mut antenna = Antenna::new(4.0 * S, None);
        for fix in fixes(1, 40, |_| 4.0, 0.0) {
            antenna.set_turn(5.0 * S);
            assert_ne!(antenna.fix(fix), Change::Moved);
        }
        assert!((antenna.turn_ns() - 4.0 * S).abs() < 0.01 * S, "{}", antenna.turn_ns());
    }

    /// Sector messages that run downwards are of an antenna that turns counter-clockwise, from the beginning or later on.
    #[test]
    fn an_antenna_that_turns_the_other_way_is_followed() {
        for turns_before in [0, 10] {
            for per_turn in [4, 32] {
                let mut fixes = fixes(per_turn, 40, |_| 4.0, 0.008);
                let (_, after) = fixes.split_at_mut((turns_before * per_turn) as usize);
                for fix in after {
                    *fix = fix.mirrored();
                }
                let mut antenna = Antenna::new(4.0 * S, None);
                let changes: Vec<Change> = fixes.iter().map(|fix| antenna.fix(as_taken(&antenna, *fix))).collect();
                assert_eq!(changes.iter().filter(|&&change| change == Change::Reversed).count(), 1, "{per_turn}");
                assert_eq!((antenna.turning(), antenna.is_locked()), (Turning::CounterClockwise, true), "{per_turn}");
                let last = antenna.turns(as_taken(&antenna, fixes[fixes.len() - 1]));
                assert!((last - last.round()).abs() < 0.02 && (antenna.turn_ns() / S - 4.0).abs() < 0.04, "{last}");
                let mut given = Antenna::new(4.0 * S, Some(Turning::Clockwise));
                assert!(fixes.iter().all(|&fix| given.fix(fix) != Change::Reversed));
            }
        }
    }

    /// A fix of a clockwise antenna as one that is believed to turn otherwise takes it.
    fn as_taken(antenna: &Antenna, fix: Fix) -> Fix {
        if antenna.turning() == Turning::CounterClockwise { fix.mirrored() } else { fix }
    }
}
