//! What radars do differently, learnt from what they send.
//!
//! The number that a radar's own tracker gives tells which reports are of one target. It is used for this alone: no plot
//! carries it.

use std::collections::{HashMap, HashSet};

use asterix::report::TargetReport;

/// Time over which range rates are compared with the change of the range, ns.
const COMPARED_NS: i64 = 20_000_000_000;
/// Reports of one track that are farther apart in time are not compared, ns.
const LONGEST_NS: i64 = 30_000_000_000;
/// Comparisons after which they are believed.
const ENOUGH: u64 = 3;
/// Standard errors within which both agree, and the share of a range rate by which it may change meanwhile.
const STANDARD_ERRORS: f64 = 3.0;
const CHANGE: f64 = 0.1;

/// What the range rates of a radar mean.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
pub enum RangeRates {
    /// Positive for receding targets, as is recommended, or nothing is known of them.
    #[default]
    Receding,
    /// Positive for approaching targets.
    Approaching,
    /// They do not fit the ranges, whatever their sign.
    Unfit,
}

impl RangeRates {
    /// Range rate of a report, m/s, positive when receding, if it can be used.
    pub fn of(self, report: &TargetReport) -> Option<f64> {
        match self {
            Self::Receding => report.radial_velocity_mps,
            Self::Approaching => report.radial_velocity_mps.map(|rate_mps| -rate_mps),
            Self::Unfit => None,
        }
    }
}

/// What is known of a radar's habits.
#[derive(Debug, Clone)]
pub struct Habits {
    sigma_range_m: f64,
    sigma_range_rate_mps: f64,
    /// By track number.
    tracks: HashMap<u16, Stretch>,
    comparisons: u64,
    receding: u64,
    approaching: u64,
    /// Track numbers of which a report says that it was detected.
    detected: HashSet<u16>,
}

/// The reports of a track since the last comparison.
#[derive(Debug, Clone, Copy)]
struct Stretch {
    begin_ns: i64,
    begin_m: f64,
    last_ns: i64,
    last_rate_mps: f64,
    /// Range rates summed over time, m.
    summed_m: f64,
}

impl Habits {
    /// Of a radar with these standard errors of range, m, and range rate, m/s.
    pub fn new(sigma_range_m: f64, sigma_range_rate_mps: f64) -> Self {
        Self {
            sigma_range_m,
            sigma_range_rate_mps,
            tracks: HashMap::new(),
            comparisons: 0,
            receding: 0,
            approaching: 0,
            detected: HashSet::new(),
        }
    }

    /// Learns from a report, made at `clock_ns`.
    pub fn learn(&mut self, report: &TargetReport, clock_ns: Option<i64>) {
        let Some(number) = report.track_number else { return };
        if !report.extrapolated {
            self.detected.insert(number);
        }
        let (Some(now_ns), Some((range_m, _)), Some(rate_mps)) = (clock_ns, report.polar, report.radial_velocity_mps)
        else {
            return;
        };
        let begun =
            Stretch { begin_ns: now_ns, begin_m: range_m, last_ns: now_ns, last_rate_mps: rate_mps, summed_m: 0.0 };
        let stretch = self.tracks.entry(number).or_insert(begun);
        let passed_ns = now_ns - stretch.last_ns;
        if !(0..=LONGEST_NS).contains(&passed_ns) {
            *stretch = begun;
            return;
        }
        stretch.summed_m += 0.5 * (stretch.last_rate_mps + rate_mps) * passed_ns as f64 * 1e-9;
        (stretch.last_ns, stretch.last_rate_mps) = (now_ns, rate_mps);
        if now_ns - stretch.begin_ns >= COMPARED_NS {
            let stretch = std::mem::replace(stretch, begun);
            self.compare(range_m - stretch.begin_m, stretch.summed_m, (now_ns - stretch.begin_ns) as f64 * 1e-9);
        }
    }

    /// Compares the change of a range with the sum of range rates, m, over `passed_s`.
    fn compare(&mut self, changed_m: f64, summed_m: f64, passed_s: f64) {
        let range_error_m = std::f64::consts::SQRT_2 * self.sigma_range_m;
        let tolerance_m =
            STANDARD_ERRORS * (range_error_m + self.sigma_range_rate_mps * passed_s) + CHANGE * summed_m.abs();
        self.comparisons += 1;
        self.receding += u64::from((changed_m - summed_m).abs() <= tolerance_m);
        self.approaching += u64::from((changed_m + summed_m).abs() <= tolerance_m);
    }

    /// Whether enough is known of range rates, or nothing can be: the radar numbers no tracks.
    pub fn knows_range_rates(&self) -> bool {
        self.comparisons >= ENOUGH || (self.tracks.is_empty() && self.detected.is_empty())
    }

    /// What range rates mean, so far.
    pub fn range_rates(&self) -> RangeRates {
        let fits = |agreeing: u64| 4 * self.comparisons <= 5 * agreeing;
        if self.comparisons < ENOUGH || (fits(self.receding) && self.receding >= self.approaching) {
            RangeRates::Receding
        } else if fits(self.approaching) {
            RangeRates::Approaching
        } else {
            RangeRates::Unfit
        }
    }

    /// Whether a report is of a target that was not seen: the radar's own tracker expects it there. One that says so of a
    /// track that was never seen is of a radar that leaves the item at its default.
    pub fn is_extrapolated(&self, report: &TargetReport) -> bool {
        report.extrapolated && report.track_number.is_some_and(|number| self.detected.contains(&number))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn report(number: u16, range_m: f64, rate_mps: f64, extrapolated: bool) -> TargetReport {
        TargetReport {
            track_number: Some(number),
            polar: Some((range_m, 1.0)),
            radial_velocity_mps: Some(rate_mps),
            extrapolated,
            ..TargetReport::default()
        }
    }

    /// Two targets, of which the second may report another range rate than it has, m/s.
    fn habits(sign: f64, second_mps: f64) -> Habits {
        let mut habits = Habits::new(10.0, 1.0);
        for scan in 0..40 {
            let range_m = |speed_mps: f64| 20_000.0 + speed_mps * 2.0 * f64::from(scan);
            let now_ns = Some(i64::from(scan) * 2_000_000_000);
            habits.learn(&report(1, range_m(90.0), 90.0 * sign, false), now_ns);
            habits.learn(&report(2, range_m(-40.0), second_mps * sign, false), now_ns);
        }
        habits
    }

    #[test]
    fn range_rates_are_understood_by_the_ranges() {
        assert_eq!(habits(1.0, -40.0).range_rates(), RangeRates::Receding);
        assert_eq!(habits(-1.0, -40.0).range_rates(), RangeRates::Approaching);
        assert_eq!(habits(1.0, 0.0).range_rates(), RangeRates::Unfit);
        assert_eq!(Habits::new(10.0, 1.0).range_rates(), RangeRates::Receding);
    }

    #[test]
    fn only_what_was_seen_can_be_extrapolated() {
        let mut habits = Habits::new(10.0, 1.0);
        habits.learn(&report(1, 1000.0, 0.0, false), None);
        habits.learn(&report(2, 1000.0, 0.0, true), None);
        assert!(habits.is_extrapolated(&report(1, 1010.0, 0.0, true)));
        assert!(!habits.is_extrapolated(&report(1, 1010.0, 0.0, false)));
        assert!(!habits.is_extrapolated(&report(2, 1010.0, 0.0, true)));
    }
}
