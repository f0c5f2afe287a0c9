//! Where the antenna of a live radar is, from the messages and reports that arrive.
//!
//! The antenna passes the azimuth β of turn k at t₀ + T (k + β / 2π). A *fix* says that it passed an azimuth at a time:
//! north markers and sector messages do. Fixes near what is expected correct t₀ and T a little; several in a row that agree
//! with each other and not with what is expected replace both: the antenna was stopped, or its clock was set.

use std::f64::consts::TAU;

/// Shares of a residual that correct t₀ and T, for each turn between two fixes.
const PHASE_GAIN: f64 = 0.5;
const TURN_GAIN: f64 = 0.15;
/// A fix farther from what is expected, as a share of a turn, is an outlier.
pub(crate) const FARTHEST: f64 = 0.1;
/// So many outliers in a row replace what is known.
const OUTLIERS: u32 = 3;
/// Share of a turn between the first fixes that tell the time of a turn.
const LEAST_TURNED: f64 = 0.25;
/// A turn is another one that differs by this share.
const OTHER_TURN: f64 = 0.05;
/// Azimuths that differ by less are the same, as a share of a turn.
const ROUNDING: f64 = 1e-6;
/// Turns that are possible, ns.
const TURNS_NS: std::ops::RangeInclusive<f64> = 1e8..=1.2e11;

/// A passage of the antenna: when, ns UTC, and the azimuth as a share of a turn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fix {
    /// When.
    pub time_ns: i64,
    /// Azimuth, in [0, 1).
    pub turned: f64,
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
}

/// The antenna: turn k begins at `begin_ns` + k · `turn_ns`.
#[derive(Debug, Clone)]
pub struct Antenna {
    begin_ns: i64,
    turn_ns: f64,
    /// The radar's own word for it.
    told_ns: f64,
    is_locked: bool,
    last: Option<Fix>,
    /// Turned since the first fix, until that is enough to tell the time of a turn.
    first: Option<(Fix, f64)>,
    outliers: u32,
}

impl Antenna {
    /// An antenna that may take `nominal_ns` for a turn, and whose place is not known.
    pub fn new(nominal_ns: f64) -> Self {
        Self {
            begin_ns: 0,
            turn_ns: nominal_ns,
            told_ns: nominal_ns,
            is_locked: false,
            last: None,
            first: None,
            outliers: 0,
        }
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
    pub fn lock(&mut self, north_ns: i64, turn_ns: f64) {
        (self.begin_ns, self.turn_ns, self.is_locked) = (north_ns, turn_ns, true);
    }

    /// Takes a fix.
    pub fn fix(&mut self, fix: Fix) -> Change {
        let Some(last) = self.last.replace(fix) else { return Change::Followed };
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
}

/// Time of a turn of an antenna that has come from one fix to the next in half a turn at most, or in a whole one. Between
/// half a turn and a whole one it may as well have turned counter-clockwise.
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

/// An azimuth as a share of a turn, in [0, 1).
pub fn turned(azimuth_rad: f64) -> f64 {
    (azimuth_rad / TAU).rem_euclid(1.0)
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
            let mut antenna = Antenna::new(1.5 * S);
            let error = largest_error(&mut antenna, &fixes(per_turn, 50, |_| turn_s, 0.008), 3 * per_turn as usize);
            assert!(error < 0.02, "{per_turn} {turn_s}: {error}");
            assert!((antenna.turn_ns() / S - turn_s).abs() < 0.01 * turn_s, "{}", antenna.turn_ns());
        }
    }

    #[test]
    fn a_turn_that_changes_is_followed() {
        for per_turn in [1, 32] {
            let mut antenna = Antenna::new(S);
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
            let mut antenna = Antenna::new(4.0 * S);
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
        let mut antenna = Antenna::new(4.0 * S);
        for fix in fixes(1, 40, |_| 4.0, 0.0) {
            antenna.set_turn(5.0 * S);
            assert_ne!(antenna.fix(fix), Change::Moved);
        }
        assert!((antenna.turn_ns() - 4.0 * S).abs() < 0.01 * S, "{}", antenna.turn_ns());
    }
}
