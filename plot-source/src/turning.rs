//! North passages of a radar that does not send any, from times and azimuths of its reports.
//!
//! An antenna that turns evenly passes the azimuth β at t₀ + k T + T β / 2π. T is searched for where the directions
//!
//! ```text
//! exp i (2π t / T − β)
//! ```
//!
//! of the first reports agree best, from half to twice the configured time of a turn; from there on a loop of second order
//! follows t₀ and T report by report.

use std::f64::consts::TAU;
use std::ops::RangeInclusive;

use crate::radar::{Cycle, Report};
use crate::rotation::LONGEST_PAUSE;

/// Reports from which the turn is searched, and the least that can tell it.
const SEARCHED: usize = 100;
const FEWEST: usize = 10;
/// Nominal turns within which they are.
const LONGEST_SEARCHED: f64 = 1000.0;
/// Step of the search, as a share of what would turn the last direction once relative to the first.
const FINENESS: f64 = 0.1;
/// Length of the mean direction that is agreement, and what is as good as the best.
const AGREEMENT: f64 = 0.9;
const AS_GOOD: f64 = 0.02;
/// Shares of a residual that correct t₀, and T.
const PHASE_GAIN: f64 = 0.1;
const TURN_GAIN: f64 = 0.005;
/// A report farther from the beam, as a share of a turn, is of another clock or azimuth: not followed.
const FARTHEST: f64 = 0.2;

/// The north passages between the reports; `None` if no even turn fits them.
pub fn norths(reports: &[Report], nominal_ns: i64) -> Option<Vec<Cycle>> {
    let sightings: Vec<(usize, f64, f64)> = reports
        .iter()
        .enumerate()
        .filter_map(|(index, report)| Some((index, report.clock_ns? as f64, report.azimuth_rad / TAU)))
        .collect();
    let &(_, first_ns, _) = sightings.first()?;
    let is_near = |time_ns: f64| (time_ns - first_ns).abs() < LONGEST_SEARCHED * nominal_ns as f64;
    let searched: Vec<(f64, f64)> = sightings
        .iter()
        .take(SEARCHED)
        .filter(|&&(_, time_ns, _)| is_near(time_ns))
        .map(|&(_, time_ns, turned)| (time_ns, turned))
        .collect();
    let roughly_ns = search(&searched, first_ns, nominal_ns as f64)?;
    let (mut north_ns, mut turn_ns) = refine(&searched, first_ns, roughly_ns);
    north_ns -= turn_ns * ((north_ns - first_ns) / turn_ns).ceil(); // at the first report or before
    let mut cycles = vec![Cycle { clock_ns: north_ns as i64, reports_before: 0 }];
    for (index, time_ns, turned) in sightings {
        let ahead_ns = time_ns - turned * turn_ns - north_ns;
        let turns = (ahead_ns / turn_ns).round();
        let residual_ns = ahead_ns - turns * turn_ns;
        if residual_ns.abs() > FARTHEST * turn_ns {
            continue;
        }
        for turn in norths_after(turns as i64) {
            let clock_ns = (north_ns + turn as f64 * turn_ns) as i64;
            cycles.push(Cycle { clock_ns, reports_before: index });
        }
        if turns >= 0.0 {
            north_ns += turns * turn_ns + PHASE_GAIN * residual_ns;
            turn_ns += TURN_GAIN * residual_ns;
        }
    }
    Some(cycles)
}

/// Which of so many turns are told one by one: of a long pause, the last alone.
pub(crate) fn norths_after(turns: i64) -> RangeInclusive<i64> {
    if turns > LONGEST_PAUSE { turns..=turns } else { 1..=turns }
}

/// The time of a turn on which the first reports agree, ns.
fn search(searched: &[(f64, f64)], first_ns: f64, nominal_ns: f64) -> Option<f64> {
    let longest_ns = searched.iter().map(|&(time_ns, _)| (time_ns - first_ns).abs()).fold(0.0, f64::max);
    if searched.len() < FEWEST || longest_ns < nominal_ns {
        return None;
    }
    let (least, most) = (longest_ns / (2.0 * nominal_ns), longest_ns / (0.5 * nominal_ns));
    let steps = ((most - least) / FINENESS).ceil() as usize;
    let candidates: Vec<(f64, f64)> = (0..=steps)
        .map(|step| longest_ns / (least + step as f64 * FINENESS))
        .map(|turn_ns| (turn_ns, mean_direction(searched, first_ns, turn_ns).1))
        .collect();
    let best = candidates.iter().map(|&(_, agreement)| agreement).fold(0.0, f64::max);
    let from_nominal = |turn_ns: f64| (turn_ns / nominal_ns).ln().abs();
    let as_good = candidates.into_iter().filter(|&(_, agreement)| best >= AGREEMENT && agreement > best - AS_GOOD);
    let chosen = as_good.min_by(|a, b| from_nominal(a.0).total_cmp(&from_nominal(b.0)))?;
    Some(chosen.0)
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
        let found = norths(&reports, (nominal_s * S) as i64).expect("an even turn");
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
            for nominal in [0.6, 0.97, 1.0, 1.6] {
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
        assert_eq!(norths(&still, 1_000_000_000), None);
        assert_eq!(norths(&still[..3], 1_000_000_000), None);
    }
}
