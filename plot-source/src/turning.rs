//! How an antenna turns, and north passages of a radar that does not send any, from times and azimuths of its reports.
//!
//! An antenna that turns evenly passes the beam angle β at t₀ + k T + T β / 2π. T is searched for where the directions
//!
//! ```text
//! exp i (2π t / T − β)
//! ```
//!
//! of the first reports agree best, for both ways in which it may turn: from half to twice the configured time of a turn, else
//! from a quarter to 16 times, if two thirds of the reports' time hold a turn; from there on a loop of second order follows t₀ and T
//! report by report.
//!
//! Reports that no longer fit, but agree on another passage of north, are of a clock that was set: from the first of them on that
//! passage is followed. What a step of the clock or a pause is, [`crate::rotation`] tells.
//!
//! Where neither way fits, the antenna stands if its reports come in a rhythm, whatever their azimuth: β is that of the middle
//! of a period, and T the longest on which the directions agree. It stands as well if all reports are of about one azimuth: it
//! was stopped.

use std::collections::VecDeque;
use std::f64::consts::TAU;
use std::ops::RangeInclusive;

use common::turning::Turning;

use crate::antenna::{FARTHEST as SPREAD, STANDING_AT};
use crate::radar::{Cycle, Report};
use crate::rotation::LONGEST_PAUSE;

/// Reports from which the turn is searched, and the least that can tell it.
pub(crate) const SEARCHED: usize = 100;
const FEWEST: usize = 10;
/// Nominal turns within which they are, and over which they are at least where there are so many.
const LONGEST_SEARCHED: f64 = 1000.0;
pub(crate) const SHORTEST_SEARCHED: f64 = 2.0;
/// Step of the search, as a share of what would turn the last direction once relative to the first.
const FINENESS: f64 = 0.1;
/// Length of the mean direction that is agreement, and what is as good as the best.
const AGREEMENT: f64 = 0.9;
const AS_GOOD: f64 = 0.02;
/// A turn over the nominal one: as it probably is, and as it may be.
const TURNS: [f64; 2] = [0.5, 2.0];
const ANY_TURNS: [f64; 2] = [0.25, 16.0];
/// Turns in which reports must agree that is not probable, and periods in which an antenna must have kept a rhythm.
const LEAST_TURNS: f64 = 1.5;
const LEAST_PERIODS: f64 = 3.0;
/// Nominal turns within which reports are looked at for these, and the least that tell that an antenna was stopped.
const LONGEST_DOUBTED: f64 = 64.0;
pub(crate) const LEAST_STOPPED: f64 = 16.0;
/// The least reports that tell a turn that is not probable: so many agree nowhere by chance.
const FEWEST_DOUBTED: usize = 30;
/// Steps by this share of a circle come back to no place.
const GOLDEN: f64 = 0.618_033_988_749_894_9;
/// Shares of a residual that correct t₀, and T.
const PHASE_GAIN: f64 = 0.1;
const TURN_GAIN: f64 = 0.005;
/// A report farther from the beam, as a share of a turn, is of another clock or azimuth: not followed.
const FARTHEST: f64 = 0.2;
/// So many reports that fit another passage of north, but not the followed one, tell that the clock was set; the last so many are
/// looked at.
const FEWEST_LOST: usize = 8;
const MOST_LOST: usize = 32;

/// What reports tell of an antenna.
#[derive(Debug, Clone, PartialEq)]
pub struct Learnt {
    /// How it turns.
    pub turning: Turning,
    /// When it passed north, or a period of one that stands began; the first at the first report or before.
    pub norths: Vec<Cycle>,
}

impl Learnt {
    /// Time of the last turn, ns; `nominal_ns` where there was one alone.
    pub fn last_turn_ns(&self, nominal_ns: i64) -> i64 {
        match self.norths[..] {
            [.., before, last] => last.clock_ns - before.clock_ns,
            _ => nominal_ns,
        }
    }
}

/// A report as the search takes it: time, ns, and azimuth, rad.
type Seen = (f64, f64);

/// How an antenna turns, as is `given` if it is, and its north passages between the reports; `None` if nothing fits them.
pub fn learn(reports: &[Report], nominal_ns: i64, given: Option<Turning>) -> Option<Learnt> {
    let may_be = |turning: Turning| given.is_none_or(|given| given == turning);
    let turns = |seen: &[Seen], range: Range| {
        let ways = [Turning::Clockwise, Turning::CounterClockwise].into_iter().filter(|&turning| may_be(turning));
        let found = ways.filter_map(|turning| {
            let points = turned(seen, turning);
            let found = search(&points, nominal_ns as f64, range)?;
            Some((turning, points, found))
        });
        // Few targets may fit both ways: then it is the usual one.
        let better =
            found.reduce(|usual, other| if other.2.agreement > usual.2.agreement + AS_GOOD { other } else { usual });
        better.map(|(turning, points, found)| follow(reports, &points, turning, found.turn_ns))
    };
    let first = sample(reports, SEARCHED, [SHORTEST_SEARCHED, LONGEST_SEARCHED].map(|turns| turns * nominal_ns as f64));
    if let Some(learnt) = turns(&first, Range::Probable) {
        return Some(learnt);
    }
    let seen = sample(reports, usize::MAX, [0.0, LONGEST_DOUBTED * nominal_ns as f64]);
    if seen.len() >= FEWEST_DOUBTED
        && let Some(learnt) = turns(&seen, Range::Possible)
    {
        return Some(learnt);
    }
    if !may_be(Turning::Standing) {
        return None;
    }
    let points = turned(&seen, Turning::Standing);
    if let Some(found) = search(&points, nominal_ns as f64, Range::Periods) {
        return Some(follow(reports, &points, Turning::Standing, found.turn_ns));
    }
    let directions = seen.iter().map(|&(_, azimuth_rad)| (0.0, azimuth_rad / TAU)).collect::<Vec<_>>();
    let is_stopped = seen.len() >= FEWEST && length_ns(&points) >= LEAST_STOPPED * nominal_ns as f64 && {
        let (mean, agreement) = mean_direction(&directions, 0.0, 1.0);
        let from_mean = |turned: f64| (turned + mean - (turned + mean).round()).abs();
        agreement > AGREEMENT && directions.iter().all(|&(_, turned)| from_mean(turned) <= SPREAD)
    };
    (is_stopped || given.is_some()).then(|| periods(reports, nominal_ns))
}

/// The first reports, `enough` of them if they last for `least_ns`, no longer than `most_ns`; of many some.
fn sample(reports: &[Report], enough: usize, [least_ns, most_ns]: [f64; 2]) -> Vec<Seen> {
    let mut seen: Vec<Seen> = Vec::new();
    for (time_ns, azimuth_rad) in reports.iter().filter_map(|it| Some((it.clock_ns? as f64, it.azimuth_rad))) {
        let &(first_ns, _) = seen.first().unwrap_or(&(time_ns, azimuth_rad));
        let passed_ns = (time_ns - first_ns).abs();
        if seen.len() >= enough && passed_ns > least_ns {
            break;
        }
        if passed_ns < most_ns {
            seen.push((time_ns, azimuth_rad));
        } else if seen.len() >= FEWEST_DOUBTED {
            break; // a clock that is set back later would come here again
        }
    }
    // Every third, say, would be the same two of six targets again and again.
    let share = (2 * SEARCHED) as f64 / seen.len().max(1) as f64;
    let is_taken = |index: usize| (index as f64 * GOLDEN).fract() < share;
    seen.into_iter().enumerate().filter(|&(index, _)| is_taken(index)).map(|(_, seen)| seen).collect()
}

/// Reports with their beam angles, as shares of a turn.
fn turned(seen: &[Seen], turning: Turning) -> Vec<(f64, f64)> {
    seen.iter().map(|&(time_ns, azimuth_rad)| (time_ns, beam(turning, azimuth_rad))).collect()
}

fn beam(turning: Turning, azimuth_rad: f64) -> f64 {
    if turning == Turning::Standing { STANDING_AT } else { turning.turned(azimuth_rad) }
}

/// The north passages between the reports, from a rough time of a turn.
fn follow(reports: &[Report], points: &[(f64, f64)], turning: Turning, roughly_ns: f64) -> Learnt {
    let first_ns = points[0].0;
    let (mut north_ns, mut turn_ns) = refine(points, first_ns, roughly_ns);
    north_ns -= turn_ns * ((north_ns - first_ns) / turn_ns).ceil(); // at the first report or before
    let mut norths = vec![Cycle { clock_ns: north_ns as i64, reports_before: 0 }];
    let timed: Vec<Timed> = reports.iter().enumerate().filter_map(|report| Timed::of(report, turning)).collect();
    let mut lost = Lost::default();
    let (mut next, mut may_step_from) = (0, 0);
    while let Some(report) = timed.get(next) {
        next += 1;
        let ahead_ns = report.time_ns - report.turned * turn_ns - north_ns;
        let turns = (ahead_ns / turn_ns).round();
        let residual_ns = ahead_ns - turns * turn_ns;
        // A report may be of the turn before, but not of one before that.
        if residual_ns.abs() > FARTHEST * turn_ns || turns < -1.0 {
            lost.take(next - 1, *report, norths.len());
            if next > may_step_from && lost.agree(turn_ns) {
                may_step_from = next;
                next = lost.begin().map_or(next, |begin| begin.place);
                norths.truncate(lost.begin().map_or(norths.len(), |begin| begin.norths));
                north_ns = lost.north_ns(turn_ns);
                let is_of_next_turn = next > 0 && timed[next - 1].turned > timed[next].turned + FARTHEST;
                if is_of_next_turn {
                    norths.push(Cycle { clock_ns: north_ns as i64, reports_before: timed[next].index });
                }
                lost = Lost::default();
            }
            continue;
        }
        lost.miss();
        for turn in norths_after(turns as i64) {
            let clock_ns = (north_ns + turn as f64 * turn_ns) as i64;
            norths.push(Cycle { clock_ns, reports_before: report.index });
        }
        if turns >= 0.0 {
            north_ns += turns * turn_ns + PHASE_GAIN * residual_ns;
            turn_ns += TURN_GAIN * residual_ns;
        }
    }
    Learnt { turning, norths }
}

/// A report with a time: its number, time, ns, and beam angle as a share of a turn.
#[derive(Debug, Clone, Copy)]
struct Timed {
    index: usize,
    time_ns: f64,
    turned: f64,
}

impl Timed {
    fn of((index, report): (usize, &Report), turning: Turning) -> Option<Self> {
        Some(Self { index, time_ns: report.clock_ns? as f64, turned: beam(turning, report.azimuth_rad) })
    }
}

/// The last reports that did not fit the turn that is followed, and how many did since the first of them.
#[derive(Debug, Default)]
struct Lost {
    reports: VecDeque<Begin>,
    fitting: usize,
}

/// A report that did not fit: its place among those with times, and the north passages before it.
#[derive(Debug, Clone, Copy)]
struct Begin {
    place: usize,
    report: Timed,
    norths: usize,
}

impl Lost {
    fn take(&mut self, place: usize, report: Timed, norths: usize) {
        if self.reports.len() == MOST_LOST {
            self.reports.pop_front();
        }
        self.reports.push_back(Begin { place, report, norths });
    }

    /// A report fitted: as many of them as were lost, and the lost ones were strays.
    fn miss(&mut self) {
        self.fitting += 1;
        if self.fitting >= self.reports.len() {
            *self = Self::default();
        }
    }

    fn begin(&self) -> Option<Begin> {
        self.reports.front().copied()
    }

    fn points(&self) -> Vec<(f64, f64)> {
        self.reports.iter().map(|lost| (lost.report.time_ns, lost.report.turned)).collect()
    }

    /// Whether they are most of the last reports and tell a passage of north: those of one moment would tell any.
    fn agree(&self, turn_ns: f64) -> bool {
        let Some(begin) = self.begin().filter(|_| self.reports.len() >= FEWEST_LOST.max(2 * self.fitting)) else {
            return false;
        };
        let points = self.points();
        length_ns(&points) > 0.5 * turn_ns && mean_direction(&points, begin.report.time_ns, turn_ns).1 >= AGREEMENT
    }

    /// The last passage of north before the first of them, ns.
    fn north_ns(&self, turn_ns: f64) -> f64 {
        let Some(Begin { report: first, .. }) = self.begin() else { return 0.0 };
        let (after, _) = mean_direction(&self.points(), first.time_ns, turn_ns);
        let turns = (after + first.turned).round();
        first.time_ns + (after - turns) * turn_ns
    }
}

/// Periods of the configured length, of an antenna that stands and whose reports have no rhythm; the first report is in the
/// middle of one.
fn periods(reports: &[Report], period_ns: i64) -> Learnt {
    Learnt { turning: Turning::Standing, norths: at_pace(reports, period_ns, period_ns / 2) }
}

/// Passages at an even pace, the first so long before the first report, and anew where the clock goes back by more than a turn.
pub(crate) fn at_pace(reports: &[Report], turn_ns: i64, before_ns: i64) -> Vec<Cycle> {
    let mut norths: Vec<Cycle> = Vec::new();
    let times = reports.iter().enumerate().filter_map(|(index, report)| Some((index, report.clock_ns?)));
    for (reports_before, clock_ns) in times {
        let north_ns = norths.last().map_or(i64::MAX, |north| north.clock_ns);
        if clock_ns < north_ns.saturating_sub(turn_ns) {
            norths.push(Cycle { clock_ns: clock_ns - before_ns, reports_before });
            continue;
        }
        let after = norths_after((clock_ns - north_ns) / turn_ns.max(1));
        norths.extend(after.map(|turn| Cycle { clock_ns: north_ns + turn * turn_ns, reports_before }));
    }
    norths
}

/// Which of so many turns are told one by one: of a long pause, the last alone.
pub(crate) fn norths_after(turns: i64) -> RangeInclusive<i64> {
    if turns > LONGEST_PAUSE { turns..=turns } else { 1..=turns }
}

/// A time of a turn, ns, and how well reports agree on it.
#[derive(Debug, Clone, Copy)]
struct Found {
    turn_ns: f64,
    agreement: f64,
}

/// Which turns are searched.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Range {
    Probable,
    Possible,
    /// Of an antenna that stands.
    Periods,
}

/// How long reports last, ns.
fn length_ns(points: &[(f64, f64)]) -> f64 {
    let Some(&(first_ns, _)) = points.first() else { return 0.0 };
    points.iter().map(|&(time_ns, _)| (time_ns - first_ns).abs()).fold(0.0, f64::max)
}

/// The time of a turn on which reports agree: next to the nominal one of those on which they agree best, and of periods the
/// longest.
fn search(points: &[(f64, f64)], nominal_ns: f64, range: Range) -> Option<Found> {
    let (longest_ns, &(first_ns, _)) = (length_ns(points), points.first()?);
    if points.len() < FEWEST || longest_ns < nominal_ns {
        return None;
    }
    let [least_ns, most_ns] = match range {
        Range::Probable => TURNS.map(|turns| turns * nominal_ns),
        Range::Possible => [ANY_TURNS[0] * nominal_ns, (ANY_TURNS[1] * nominal_ns).min(longest_ns / LEAST_TURNS)],
        Range::Periods => [TURNS[0] * nominal_ns, (ANY_TURNS[1] * nominal_ns).min(longest_ns / LEAST_PERIODS)],
    };
    let (fewest, most) = (longest_ns / most_ns, longest_ns / least_ns);
    let steps = ((most - fewest).max(0.0) / FINENESS).ceil() as usize;
    let candidates: Vec<Found> = (0..=steps)
        .map(|step| longest_ns / (fewest + step as f64 * FINENESS))
        .map(|turn_ns| Found { turn_ns, agreement: mean_direction(points, first_ns, turn_ns).1 })
        .collect();
    let best = candidates.iter().map(|found| found.agreement).fold(0.0, f64::max);
    let as_good = candidates.into_iter().filter(|it| best >= AGREEMENT && it.agreement > best - AS_GOOD);
    let aim_ns = if range == Range::Periods { most_ns } else { nominal_ns };
    let distance = |found: &Found| (found.turn_ns / aim_ns).ln().abs();
    as_good.min_by(|a, b| distance(a).total_cmp(&distance(b)))
}

/// t₀ and T by least squares over the first reports, ns, from a T so good that none of them is half a turn off.
fn refine(searched: &[(f64, f64)], first_ns: f64, turn_ns: f64) -> (f64, f64) {
    let start = mean_direction(searched, first_ns, turn_ns).0;
    let count = searched.len() as f64;
    let points = searched.iter().map(|&(time_ns, turned)| {
        let passed = (time_ns - first_ns) / turn_ns;
        let residual = passed - turned - start;
        (passed, residual - residual.round())
    });
    let (sum_x, sum_y) = points.clone().fold((0.0, 0.0), |(sum_x, sum_y), (x, y)| (sum_x + x, sum_y + y));
    let (mean_x, mean_y) = (sum_x / count, sum_y / count);
    let (xy, xx) = points
        .fold((0.0, 0.0), |(xy, xx), (x, y)| (xy + (x - mean_x) * (y - mean_y), xx + (x - mean_x) * (x - mean_x)));
    let slope = xy / xx;
    let better_ns = turn_ns / (1.0 - slope);
    (first_ns + better_ns * (start + mean_y - slope * mean_x), better_ns)
}

/// North after the first report as a share of a turn, and how well reports agree on it.
fn mean_direction(searched: &[(f64, f64)], first_ns: f64, turn_ns: f64) -> (f64, f64) {
    let (mut sin, mut cos) = (0.0, 0.0);
    for &(time_ns, turned) in searched {
        let angle = TAU * ((time_ns - first_ns) / turn_ns - turned);
        sin += angle.sin();
        cos += angle.cos();
    }
    (f64::atan2(sin, cos).rem_euclid(TAU) / TAU, f64::hypot(sin, cos) / searched.len() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    const S: f64 = 1e9;

    /// Reports of targets at fixed azimuths, as shares of a turn, from an antenna whose turn k takes `turn_s(k)`.
    fn reports(targets: &[f64], turns: u32, turn_s: impl Fn(u32) -> f64) -> (Vec<Report>, Vec<f64>) {
        let (mut reports, mut norths, mut north_s) = (Vec::new(), Vec::new(), 36_000.3);
        for turn in 0..turns {
            norths.push(north_s);
            for &turned in targets {
                let clock_ns = Some(((north_s + turned * turn_s(turn)) * S) as i64);
                reports.push(Report { clock_ns, range_m: 5000.0, azimuth_rad: turned * TAU, ..Report::default() });
            }
            north_s += turn_s(turn);
        }
        (reports, norths)
    }

    #[track_caller]
    fn assert_norths(targets: &[f64], turn_s: impl Fn(u32) -> f64, nominal_s: f64) {
        let (reports, expected) = reports(targets, 100, &turn_s);
        let learnt = learn(&reports, (nominal_s * S) as i64, None).expect("an even turn");
        assert_eq!(learnt.turning, Turning::Clockwise);
        let mirrored: Vec<Report> =
            reports.iter().map(|it| Report { azimuth_rad: TAU - it.azimuth_rad, ..*it }).collect();
        // One target alone turns either way.
        if targets.len() > 1 {
            let other = learn(&mirrored, (nominal_s * S) as i64, None).expect("an even turn");
            assert_eq!((other.turning, other.norths.len()), (Turning::CounterClockwise, learnt.norths.len()));
            assert_eq!(learn(&mirrored, (nominal_s * S) as i64, Some(Turning::Clockwise)), None);
        }
        let found = learnt.norths;
        assert_eq!(found.len(), expected.len());
        for (index, (found, expected_s)) in found.iter().zip(expected).enumerate() {
            let error_s = found.clock_ns as f64 / S - expected_s;
            assert!(error_s.abs() < 0.03 * turn_s(0), "turn {index}: {error_s} s");
            assert!(found.reports_before.abs_diff(index * targets.len()) <= 1, "turn {index}: {found:?}");
        }
    }

    #[test]
    fn the_turn_is_found_whatever_is_configured() {
        let targets = [0.05, 0.2, 0.22, 0.5, 0.61, 0.93];
        for turn_s in [1.0, 2.5, 4.0] {
            for nominal in [0.15, 0.6, 0.97, 1.0, 1.6, 3.5] {
                assert_norths(&targets, |_| turn_s, nominal * turn_s);
            }
        }
        assert_norths(&[0.3], |_| 2.0, 2.01); // one target alone: the turn next to the configured one
    }

    #[test]
    fn a_turn_that_changes_is_followed() {
        assert_norths(&[0.1, 0.4, 0.45, 0.8], |turn| 2.0 + 0.001 * f64::from(turn), 2.0);
    }

    #[test]
    fn what_does_not_turn_has_no_north() {
        let (mut still, _) = reports(&[0.1, 0.7], 50, |_| 1.0);
        for (index, report) in still.iter_mut().enumerate() {
            report.azimuth_rad = (index * index * 37 % 101) as f64 / 101.0 * TAU;
        }
        assert_eq!(learn(&still, 1_000_000_000, None), None);
        assert_eq!(learn(&still[..3], 1_000_000_000, None), None);
        let periods = learn(&still, 1_000_000_000, Some(Turning::Standing)).expect("periods as configured");
        assert_eq!((periods.turning, periods.last_turn_ns(0)), (Turning::Standing, 1_000_000_000));
    }

    /// Reports of all azimuths come in bursts, of which some are missing, or from one azimuth at any time.
    #[test]
    fn an_antenna_that_stands_has_the_rhythm_of_its_reports() {
        for (period_s, nominal_s) in [(1.0, 1.0), (4.0, 1.0), (2.0, 3.0)] {
            let burst = |period: u32| {
                let reports = (0..7).filter(move |target| !(period + target).is_multiple_of(5));
                reports.map(move |target| Report {
                    clock_ns: Some(((100.0 + period_s * f64::from(period) + 0.01 * f64::from(target)) * S) as i64),
                    azimuth_rad: f64::from(target) * 0.83,
                    ..Report::default()
                })
            };
            let reports: Vec<Report> = (0..40).flat_map(burst).collect();
            let learnt = learn(&reports, (nominal_s * S) as i64, None).expect("a rhythm");
            assert_eq!((learnt.turning, learnt.norths.len()), (Turning::Standing, 40), "{period_s} {nominal_s}");
            let before_s = (reports[0].clock_ns.expect("a time") - learnt.norths[0].clock_ns) as f64 / S;
            assert!((before_s / period_s - 0.5).abs() < 0.05, "{before_s}");
        }
        let (mut stopped, _) = reports(&[0.1, 0.2, 0.47, 0.8], 50, |_| 1.0);
        stopped.iter_mut().enumerate().for_each(|(index, it)| it.azimuth_rad = 6.2 + 0.05 * (index % 5) as f64);
        assert_eq!(learn(&stopped, 1_000_000_000, None).map(|learnt| learnt.turning), Some(Turning::Standing));
    }
}
