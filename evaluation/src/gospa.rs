//! Generalised optimal sub-pattern assignment: localisation, missed and false targets in one distance.

use crate::assignment::cheapest;
use crate::mean::Moments;

/// GOSPA with its parts, all in the unit of the distances. The p-th powers of the parts add up to that of the distance.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Gospa {
    /// The metric.
    pub distance: f64,
    /// (Σ d^p over the pairs)^(1/p).
    pub localisation: f64,
    /// (c^p/2 · number missed)^(1/p).
    pub missed: f64,
    /// (c^p/2 · number false)^(1/p).
    pub spurious: f64,
    /// Targets without a track.
    pub missed_targets: usize,
    /// Tracks without a target.
    pub false_tracks: usize,
}

/// The means of the distance and its parts over scans. The powers of the parts add up in each scan, not in the mean.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct MeanGospa {
    /// Of the metric.
    pub distance: Moments,
    /// Of the part of the pairs.
    pub localisation: Moments,
    /// Of the part of targets without a track.
    pub missed: Moments,
    /// Of the part of tracks without a target.
    pub spurious: Moments,
}

impl MeanGospa {
    /// Takes a scan.
    pub fn add(&mut self, scan: &Gospa) {
        self.distance.add(scan.distance);
        self.localisation.add(scan.localisation);
        self.missed.add(scan.missed);
        self.spurious.add(scan.spurious);
    }
}

/// Generalised optimal sub-pattern assignment distance with α = 2:
///
/// ```text
/// GOSPA = (min Σ d(x, y)^p over pairs + c^p/2 · (number missed + number false))^(1/p)
/// ```
///
/// | argument    | symbol  | shape                   | unit        |
/// |-------------|---------|-------------------------|-------------|
/// | `targets`   | \|X\|   | number                  |             |
/// | `tracks`    | \|Y\|   | number                  |             |
/// | `distances` | d(x, y) | (target, track, d), d < c | follows the states |
/// | `cutoff`    | c       | > 0                     | as d        |
/// | `order`     | p       | ≥ 1                     |             |
///
/// Pairs at the cutoff or beyond may be left out. It grows with the number of targets: compare only runs of one scenario.
/// Two empty sets are at distance 0.
///
/// Source: Rahmathullah, García-Fernández & Svensson (2017).
pub fn gospa(targets: usize, tracks: usize, distances: &[(usize, usize, f64)], cutoff: f64, order: f64) -> Gospa {
    let limit = cutoff.powf(order);
    let costs: Vec<_> = distances.iter().map(|&(x, y, d)| (x, y, d.powf(order))).collect();
    // A pair that costs more than missing its target and having a false track is none.
    let pairs = cheapest(targets, tracks, &costs, limit);
    let (mut sum, mut paired) = (0.0, 0);
    for (target, track) in pairs.iter().enumerate() {
        if let Some(track) = *track {
            sum += costs.iter().find(|&&(x, y, _)| (x, y) == (target, track)).map_or(0.0, |&(_, _, cost)| cost);
            paired += 1;
        }
    }
    let (missed_targets, false_tracks) = (targets - paired, tracks - paired);
    let unpaired = |count: usize| limit / 2.0 * count as f64;
    let root = |power: f64| power.powf(order.recip());
    Gospa {
        distance: root(sum + unpaired(missed_targets + false_tracks)),
        localisation: root(sum),
        missed: root(unpaired(missed_targets)),
        spurious: root(unpaired(false_tracks)),
        missed_targets,
        false_tracks,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use proptest::prelude::*;

    type Points = Vec<[f64; 2]>;

    fn between(x: &Points, y: &Points, cutoff: f64, order: f64) -> Gospa {
        let distance = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
        let pairs = x.iter().enumerate().flat_map(|(i, &a)| {
            y.iter().enumerate().map(move |(j, &b)| (i, j, distance(a, b))).filter(|pair| pair.2 < cutoff)
        });
        gospa(x.len(), y.len(), &pairs.collect::<Vec<_>>(), cutoff, order)
    }

    fn points() -> impl Strategy<Value = Points> {
        prop::collection::vec([-10.0..10.0_f64, -10.0..10.0_f64], 0..5)
    }

    /// The definition over every assignment there is: each x takes a free y or none.
    fn by_enumeration(x: &[[f64; 2]], y: &Points, used: u32, cutoff: f64, order: f64) -> f64 {
        let half = cutoff.powf(order) / 2.0;
        let Some((first, rest)) = x.split_first() else {
            return half * (y.len() as f64 - f64::from(used.count_ones()));
        };
        let mut best = half + by_enumeration(rest, y, used, cutoff, order);
        for (j, b) in y.iter().enumerate().filter(|(j, _)| used & 1 << j == 0) {
            let d = (first[0] - b[0]).hypot(first[1] - b[1]);
            best = best.min(d.powf(order) + by_enumeration(rest, y, used | 1 << j, cutoff, order));
        }
        best
    }

    #[test]
    fn misses_and_false_tracks_count_half_each() {
        assert_relative_eq!(gospa(1, 1, &[(0, 0, 3.0)], 10.0, 2.0).distance, 3.0);
        assert_relative_eq!(gospa(1, 0, &[], 10.0, 2.0).distance, 50.0_f64.sqrt());
        assert_relative_eq!(gospa(0, 0, &[], 10.0, 2.0).distance, 0.0);
        let mixed = gospa(2, 3, &[(0, 1, 3.0), (0, 0, 1.0)], 10.0, 2.0);
        assert_relative_eq!(mixed.distance, (1.0 + 150.0_f64).sqrt());
        assert_eq!((mixed.missed_targets, mixed.false_tracks), (1, 2));
        assert_relative_eq!(mixed.localisation, 1.0);
        assert_relative_eq!(mixed.missed, 50.0_f64.sqrt());
        assert_relative_eq!(mixed.spurious, 10.0);
    }

    proptest! {
        #[test]
        fn it_is_the_least_over_all_assignments(x in points(), y in points(), cutoff in 0.5..12.0_f64, order in 1.0..3.0_f64) {
            let found = between(&x, &y, cutoff, order);
            let least = by_enumeration(&x, &y, 0, cutoff, order);
            prop_assert!((found.distance.powf(order) - least).abs() < 1e-9 * (1.0 + least));
            let parts = [found.localisation, found.missed, found.spurious].map(|part| part.powf(order)).iter().sum::<f64>();
            prop_assert!((parts - least).abs() < 1e-9 * (1.0 + least));
        }

        #[test]
        fn it_is_a_metric(x in points(), y in points(), z in points(), cutoff in 0.5..12.0_f64, order in 1.0..3.0_f64) {
            let d = |a: &Points, b: &Points| between(a, b, cutoff, order).distance;
            prop_assert!(d(&x, &x).abs() < 1e-12);
            prop_assert!((d(&x, &y) - d(&y, &x)).abs() < 1e-9);
            prop_assert!(d(&x, &z) <= d(&x, &y) + d(&y, &z) + 1e-9);
        }
    }
}
