//! When each turn of the antenna began, and by how much the radar's clock was wrong.
//!
//! A start-of-update-cycle message is sent as the antenna passes north: in the Barcelona
//! recording azimuth is 2π (t − t₀)/T to within 8° throughout, where t₀ is the time of the
//! message and T the time to the next. The antenna is the better clock: it turns on evenly while a clock may be set.
//!
//! Messages and reports are taken in the order of the file, never sorted by their times. T is the median of the times
//! between messages nearby, so it may differ from the configured one and change. Between two messages lies
//!
//! - **one turn**, if their times differ by T to within what the radar's turns differ by;
//! - **several**, if reports went on meanwhile: messages are missing;
//! - **a pause** of the recording, if the clock has gone on and nothing speaks against it. Its turns are without plots. Of
//!   a long one [`LONGEST_PAUSE`] turns are made, enough for every track to end, and time jumps over the rest;
//! - **a step of the clock**, if its time went back, or on by no whole number of turns, or if the targets are where one
//!   turn would have brought them ([`crate::continuity`]). One turn has passed, whatever the clock says.
//!
//! Measurement time is the radar's clock up to its first step; from there on it runs on at the turn's pace, as if the
//! clock had not been set. So it never goes back, tracks live on through a step, and differences of time are right
//! everywhere. What the clock says after its steps is measurement time less their sum.

use std::f64::consts::TAU;

use asterix::clock::STEP_NS;
use common::turning::Turning;
use common::units::NS_PER_S;

use crate::antenna::{FARTHEST, STANDING_AT};
use crate::continuity::Gap;
use crate::radar::{Cycle, Report};

/// Turns made of a pause at most, all without plots.
pub const LONGEST_PAUSE: i64 = 60;
/// Times between messages on each side from which T is taken.
const NEARBY: usize = 5;
/// A time between two messages differs from T by this many typical differences at most.
const TYPICAL_DIFFERENCES: i64 = 6;
/// T itself is uncertain by T over this.
const TURN_OVER_ERROR: i64 = 200;
/// Up to so many turns, T is known well enough to tell whether their number is a whole one.
const COUNTED_TURNS: i64 = 30;

/// The clock was set between two turns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClockStep {
    /// The turn after it.
    pub scan: usize,
    /// Set ahead by this, s; negative: back.
    pub by_s: f64,
}

/// Nothing was recorded between two turns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pause {
    /// The first turn without reports.
    pub scan: usize,
    /// How long, s.
    pub lasted_s: f64,
}

/// The turns of a recording: turn k lasts from begin to end of `turns_ns[k]`, in measurement time.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Rotations {
    turning: Turning,
    turns_ns: Vec<(i64, i64)>,
    /// Steps of the clock.
    pub steps: Vec<ClockStep>,
    /// Pauses of the recording.
    pub pauses: Vec<Pause>,
    /// North passages: number of reports before it in the file, time, what is added to the clock from here on.
    norths: Vec<North>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct North {
    reports_before: usize,
    time_ns: i64,
    offset_ns: i64,
    turn_ns: i64,
}

/// What happened between two messages.
enum Between {
    /// So many turns.
    Turns(i64),
    /// Nothing was recorded for so many turns.
    Pause(i64),
    /// One turn, and the clock was set.
    Step,
}

impl Rotations {
    /// From the messages and reports of a recording. `nominal_ns` is the time of a turn where there are too few messages
    /// to tell; `errors` are the standard errors of reports, m and rad. The first turn is the one that the first message
    /// closes, unless there are no reports in it; the last one begins with the last message. `None` without messages.
    pub fn new(cycles: &[Cycle], reports: &[Report], nominal_ns: i64, errors: (f64, f64)) -> Option<Self> {
        let cycles = without_repetitions(cycles, nominal_ns);
        let first = *cycles.first()?;
        let intervals = Intervals::new(&cycles, nominal_ns);
        let mut this = Self::default();
        let mut north = North {
            reports_before: first.reports_before,
            time_ns: first.clock_ns,
            offset_ns: 0,
            turn_ns: intervals.turns_near(0).1,
        };
        if first.reports_before > 0 {
            this.turns_ns.push((first.clock_ns - north.turn_ns, first.clock_ns));
        }
        for (index, pair) in cycles.windows(2).enumerate() {
            let elapsed_ns = intervals.between[index];
            let between = match intervals.turns(index) {
                Some(one @ 1) => Between::Turns(one),
                fitting => {
                    let gap = Gap::widest(pair, reports, intervals.turns_near(index).1);
                    judge(&gap, fitting, errors)
                }
            };
            let turn_ns = intervals.turns_near(index).1;
            north.turn_ns = match between {
                Between::Turns(turns) => elapsed_ns / turns,
                _ => turn_ns,
            };
            this.norths.push(north);
            let passed_ns = match between {
                Between::Step => turn_ns,
                _ => elapsed_ns,
            };
            this.add_turns(north.time_ns, passed_ns, &between, turn_ns);
            let time_ns = north.time_ns + passed_ns;
            if let Between::Step = between {
                let by_s = (elapsed_ns - passed_ns) as f64 / NS_PER_S;
                this.steps.push(ClockStep { scan: this.turns_ns.len(), by_s });
            }
            let (offset_ns, reports_before) = (time_ns - pair[1].clock_ns, pair[1].reports_before);
            north = North { reports_before, time_ns, offset_ns, turn_ns: intervals.turns_near(index + 1).0 };
        }
        this.turns_ns.push((north.time_ns, north.time_ns + north.turn_ns));
        this.norths.push(north);
        Some(this)
    }

    /// From scans whose times are those of UTC: no clock is set, and each begins a turn. What lasts for several turns is a pause. `None`
    /// without scans.
    pub fn of_scans(scans: &[Cycle], turn_ns: i64) -> Option<Self> {
        let last = *scans.last()?;
        let mut this = Self::default();
        let north = |scan: &Cycle, turn_ns| North {
            reports_before: scan.reports_before,
            time_ns: scan.clock_ns,
            offset_ns: 0,
            turn_ns,
        };
        for pair in scans.windows(2) {
            let elapsed_ns = pair[1].clock_ns - pair[0].clock_ns;
            let between = match (elapsed_ns + turn_ns / 2) / turn_ns {
                0 | 1 => Between::Turns(1),
                turns => Between::Pause(turns),
            };
            let is_pause = matches!(between, Between::Pause(_));
            this.norths.push(north(&pair[0], if is_pause { turn_ns } else { elapsed_ns }));
            this.add_turns(pair[0].clock_ns, elapsed_ns, &between, turn_ns);
        }
        this.turns_ns.push((last.clock_ns, last.clock_ns + turn_ns));
        this.norths.push(north(&last, turn_ns));
        Some(this)
    }

    /// The same turns of an antenna that turns so.
    #[must_use]
    pub fn turning(self, turning: Turning) -> Self {
        Self { turning, ..self }
    }

    /// Time from north to an azimuth in a turn of `turn_ns`, ns; of an antenna that stands, to the middle of its period.
    fn after_north_ns(&self, turn_ns: f64, azimuth_rad: f64) -> f64 {
        match self.turning {
            Turning::Clockwise => turn_ns * azimuth_rad / TAU,
            Turning::CounterClockwise => turn_ns * self.turning.turned(azimuth_rad),
            Turning::Standing => turn_ns * STANDING_AT,
        }
    }

    /// The turns between one north passage and the next.
    fn add_turns(&mut self, from_ns: i64, passed_ns: i64, between: &Between, turn_ns: i64) {
        let turns = match *between {
            Between::Step => 1,
            Between::Turns(turns) => turns,
            Between::Pause(turns) => {
                let lasted_s = (passed_ns - turn_ns) as f64 / NS_PER_S;
                self.pauses.push(Pause { scan: self.turns_ns.len() + 1, lasted_s });
                turns
            }
        };
        if turns <= LONGEST_PAUSE {
            let at = |turn: i64| from_ns + passed_ns * turn / turns;
            self.turns_ns.extend((0..turns).map(|turn| (at(turn), at(turn + 1))));
        } else {
            let at = |turn: i64| from_ns + turn_ns * turn;
            self.turns_ns.extend((0..LONGEST_PAUSE).map(|turn| (at(turn), at(turn + 1))));
            let to_ns = from_ns + passed_ns;
            self.turns_ns.push((to_ns - turn_ns, to_ns));
        }
    }

    /// Number of turns.
    pub fn scans(&self) -> usize {
        self.turns_ns.len()
    }

    /// Begin and end of a turn, ns UTC.
    pub fn bounds_ns(&self, scan: usize) -> (u64, u64) {
        let (begin, end) = self.turns_ns[scan];
        (begin.max(0) as u64, end.max(0) as u64)
    }

    /// Shortest and longest of the turns but for the tenth at each end, s.
    pub fn typical_turns_s(&self) -> (f64, f64) {
        let mut turns: Vec<i64> = self.turns_ns.iter().map(|(begin, end)| end - begin).collect();
        turns.sort_unstable();
        let seconds = |index: usize| turns[index] as f64 / NS_PER_S;
        (seconds(turns.len() / 10), seconds(turns.len() - 1 - turns.len() / 10))
    }

    /// Measurement time of a report, ns since 1970, given how many reports are before it in the file. One without a time
    /// of its own has that of the antenna at its azimuth.
    pub fn time_of(&self, reports_before: usize, report: &Report) -> i64 {
        let last = self.norths.partition_point(|north| north.reports_before <= reports_before).saturating_sub(1);
        let (north, next) = (self.norths[last], self.norths.get(last + 1));
        let turned_ns = self.after_north_ns(north.turn_ns as f64, report.azimuth_rad) as i64;
        let is_before_all = reports_before < north.reports_before;
        let expected_ns = north.time_ns + turned_ns - if is_before_all { north.turn_ns } else { 0 };
        let Some(clock_ns) = report.clock_ns else { return expected_ns };
        // Where the clock was set between two messages, that side of the step is right which fits the antenna better.
        let sides = [north.offset_ns, next.map_or(north.offset_ns, |next| next.offset_ns)];
        let times = sides.map(|offset_ns| clock_ns + offset_ns);
        if is_before_all || times[0].abs_diff(expected_ns) <= times[1].abs_diff(expected_ns) {
            times[0]
        } else {
            times[1]
        }
    }

    /// Whether the antenna passed an azimuth at about a time in a turn; one that stands passes all at any time.
    pub fn fits(&self, scan: usize, time_ns: i64, azimuth_rad: f64) -> bool {
        let (begin, end) = self.turns_ns[scan];
        let turn_ns = (end - begin) as f64;
        let away_ns = ((time_ns - begin) as f64 - self.after_north_ns(turn_ns, azimuth_rad)).abs();
        self.turning == Turning::Standing || away_ns <= FARTHEST * turn_ns
    }

    /// The turn that a report belongs to: the one whose start is nearest to the time at which
    /// the antenna passed north before the report. Time alone would mistake reports near north.
    pub fn scan_of(&self, time_ns: i64, azimuth_rad: f64) -> Option<usize> {
        let roughly = self.turns_ns.partition_point(|&(begin, _)| begin <= time_ns).saturating_sub(1);
        let candidates = roughly.saturating_sub(1)..(roughly + 2).min(self.turns_ns.len());
        let distance = |scan: &usize| {
            let (begin, end) = self.turns_ns[*scan];
            let turned_ns = self.after_north_ns((end - begin) as f64, azimuth_rad) as i64;
            (time_ns - turned_ns).abs_diff(begin)
        };
        let nearest = candidates.min_by_key(distance)?;
        let (begin, end) = self.turns_ns[nearest];
        (distance(&nearest) <= (end - begin) as u64 / 2).then_some(nearest)
    }
}

/// What happened in a gap between two messages that are not one turn apart; `fitting` is the number of turns that it is
/// long, if it is a whole one.
fn judge(gap: &Gap<'_>, fitting: Option<i64>, errors: (f64, f64)) -> Between {
    let turns = (gap.elapsed_ns + gap.turn_ns / 2).div_euclid(gap.turn_ns);
    let reports_went_on = 2 * gap.widest_ns < 3 * gap.turn_ns;
    let may_be_right = turns >= 2 && (fitting.is_some() || turns > 2);
    if !may_be_right || (gap.widest_ns > gap.turn_ns && gap.targets_went_on(errors)) {
        Between::Step
    } else if reports_went_on {
        Between::Turns(turns)
    } else if fitting.is_none() && turns <= COUNTED_TURNS {
        Between::Step
    } else {
        Between::Pause(turns)
    }
}

/// Messages that say the same again are left out: no report lies between them, nor time.
fn without_repetitions(cycles: &[Cycle], nominal_ns: i64) -> Vec<Cycle> {
    let mut kept: Vec<Cycle> = Vec::with_capacity(cycles.len());
    for &cycle in cycles {
        let repeats = kept.last().is_some_and(|last| {
            last.reports_before == cycle.reports_before && (cycle.clock_ns - last.clock_ns).abs() < nominal_ns / 8
        });
        if !repeats {
            kept.push(cycle);
        }
    }
    kept
}

/// Times between successive messages.
struct Intervals {
    between: Vec<i64>,
    nominal_ns: i64,
    tolerance_ns: i64,
}

impl Intervals {
    fn new(cycles: &[Cycle], nominal_ns: i64) -> Self {
        let between: Vec<i64> = cycles.windows(2).map(|pair| pair[1].clock_ns - pair[0].clock_ns).collect();
        let nominal_ns = if between.len() < 3 { nominal_ns } else { median(&between).unwrap_or(nominal_ns) };
        let differences: Vec<i64> = between.windows(2).map(|pair| (pair[1] - pair[0]).abs().max(1)).collect();
        let typical_ns = median(&differences).unwrap_or(0).min(nominal_ns / 20);
        // Times are whole steps of the clock.
        let tolerance_ns = (2 * STEP_NS).max(TYPICAL_DIFFERENCES * typical_ns);
        Self { between, nominal_ns, tolerance_ns }
    }

    /// Time of a turn before and after an interval, ns.
    fn turns_near(&self, index: usize) -> (i64, i64) {
        let of = |range: std::ops::Range<usize>| {
            let nearby = &self.between[range];
            if nearby.len() < 2 { None } else { median(nearby) }
        };
        let end = self.between.len();
        let before = of(index.saturating_sub(NEARBY)..index.min(end));
        let after = of((index + 1).min(end)..(index + 1 + NEARBY).min(end));
        let either = before.or(after).unwrap_or(self.nominal_ns);
        (before.unwrap_or(either), after.unwrap_or(either))
    }

    /// How many turns fit into an interval, if it is a whole number.
    fn turns(&self, index: usize) -> Option<i64> {
        let elapsed_ns = self.between[index];
        let (before, after) = self.turns_near(index);
        let (short, long) = (before.min(after), before.max(after));
        let fits = |turns: i64| {
            let tolerance_ns = self.tolerance_ns + turns * short / TURN_OVER_ERROR;
            (turns * short - tolerance_ns..=turns * long + tolerance_ns).contains(&elapsed_ns)
        };
        let about = (elapsed_ns + after / 2).div_euclid(after);
        [1, about].into_iter().find(|&turns| turns > 0 && fits(turns))
    }
}

/// Median of the positive values, the lower of two.
fn median(values: &[i64]) -> Option<i64> {
    let mut sorted: Vec<i64> = values.iter().copied().filter(|&value| value > 0).collect();
    sorted.sort_unstable();
    sorted.get(sorted.len().saturating_sub(1) / 2).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    const T: i64 = 1_000_000_000;
    const ERRORS: (f64, f64) = (2.0, 0.002);

    fn rotations(cycles_ns: &[i64], reports: &[Report]) -> Rotations {
        let before =
            |time_ns: i64| reports.iter().filter(|report| report.clock_ns.is_some_and(|it| it < time_ns)).count();
        let cycles: Vec<Cycle> =
            cycles_ns.iter().map(|&clock_ns| Cycle { clock_ns, reports_before: before(clock_ns) }).collect();
        Rotations::new(&cycles, reports, T, ERRORS).expect("cycles")
    }

    fn report(time_ns: i64) -> Report {
        Report {
            clock_ns: Some(time_ns),
            range_m: 1000.0,
            azimuth_rad: TAU * (time_ns % T) as f64 / T as f64,
            ..Report::default()
        }
    }

    #[test]
    fn a_missing_message_is_made_up_for() {
        let reports: Vec<Report> = (0..70).map(|k| report(k * T / 10 + T / 3)).collect();
        let rotations = rotations(&[T, 2 * T, 4 * T, 5 * T, 6 * T], &reports);
        assert_eq!(rotations.turns_ns, (0..7).map(|turn| (turn * T, (turn + 1) * T)).collect::<Vec<_>>());
        assert!(rotations.steps.is_empty() && rotations.pauses.is_empty());
        assert_eq!(Rotations::new(&[], &reports, T, ERRORS), None);
    }

    #[test]
    fn a_repeated_message_is_no_turn_and_a_long_pause_has_few() {
        let repeated = rotations(&[T, 2 * T, 2 * T, 3 * T], &[]);
        assert_eq!(repeated.turns_ns, [(T, 2 * T), (2 * T, 3 * T), (3 * T, 4 * T)]);
        let paused = rotations(&[T, 2 * T, 3 * T, 4 * T, 1000 * T, 1001 * T, 1002 * T], &[]);
        assert_eq!(paused.pauses, [Pause { scan: 4, lasted_s: 995.0 }]);
        assert_eq!(paused.scans(), 3 + LONGEST_PAUSE as usize + 1 + 3);
        assert!(paused.turns_ns.windows(2).all(|pair| pair[0].1 <= pair[1].0));
        assert_eq!(paused.turns_ns[paused.scans() - 4], (999 * T, 1000 * T));
    }

    #[test]
    fn reports_near_north_belong_to_the_turn_that_their_azimuth_tells() {
        let rotations = rotations(&[T, 2 * T, 3 * T], &[]);
        let scan_of = |time_ns: i64, turned: f64| rotations.scan_of(time_ns, turned * TAU);
        assert_eq!(scan_of(T / 100 * 199, 0.01), Some(1)); // early, just past north
        assert_eq!(scan_of(T / 100 * 201, 0.99), Some(0)); // late, just before north
        assert_eq!(scan_of(T / 10 * 25, 0.5), Some(1));
        assert_eq!(scan_of(T / 100 * 399, 0.99), Some(2));
        assert_eq!(scan_of(T / 5, 0.0), None); // before the first turn
        assert_eq!(scan_of(5 * T, 0.0), None); // after the last
    }

    #[test]
    fn a_report_without_time_has_that_of_the_antenna() {
        let rotations = rotations(&[T, 2 * T, 3 * T], &[]);
        let timeless = Report { clock_ns: None, range_m: 1000.0, azimuth_rad: TAU / 4.0, ..Report::default() };
        assert_eq!(rotations.time_of(0, &timeless), 3 * T + T / 4);
    }
}
