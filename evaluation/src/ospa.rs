//! Optimal sub-pattern assignment: an error per target, between 0 and the cutoff.

use crate::assignment::cheapest;

/// OSPA with its parts, all in the unit of the distances. The p-th powers of the parts add up to that of the distance.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Ospa {
    /// The metric, from 0 to c.
    pub distance: f64,
    /// Part of the pairs, those at the cutoff included.
    pub localisation: f64,
    /// Part of the difference in number.
    pub cardinality: f64,
}

/// Optimal sub-pattern assignment distance of two sets, m the smaller and n the larger number:
///
/// ```text
/// OSPA = ( (1/n) [ min Σ_(i ≤ m) min(c, d(x_i, y_π(i)))^p + c^p (n − m) ] )^(1/p)
/// localisation = ( (1/n) min Σ … )^(1/p),   cardinality = ( c^p (n − m)/n )^(1/p)
/// ```
///
/// | argument    | symbol   | shape                   | unit        |
/// |-------------|----------|-------------------------|-------------|
/// | `targets`   | \|X\|    | number                  |             |
/// | `tracks`    | \|Y\|    | number                  |             |
/// | `distances` | d(x, y)  | (target, track, d), d < c | follows the states |
/// | `cutoff`    | c        | > 0                     | as d        |
/// | `order`     | p        | ≥ 1                     |             |
///
/// Pairs at the cutoff or beyond may be left out. Two empty sets are at distance 0. A missed target with a false track elsewhere
/// counts like one bad track: [`crate::gospa`] tells these apart.
///
/// Source: Schuhmacher, Vo & Vo (2008).
pub fn ospa(targets: usize, tracks: usize, distances: &[(usize, usize, f64)], cutoff: f64, order: f64) -> Ospa {
    let (fewer, more) = (targets.min(tracks), targets.max(tracks));
    if more == 0 {
        return Ospa::default();
    }
    let limit = cutoff.powf(order);
    // Rows are the smaller set: a row left unpaired is one whose partner is at the cutoff.
    let costs: Vec<_> = distances
        .iter()
        .map(|&(x, y, d)| {
            let (row, column) = if targets <= tracks { (x, y) } else { (y, x) };
            (row, column, d.powf(order))
        })
        .collect();
    let pairs = cheapest(fewer, more, &costs, limit);
    let cost = |row: usize, column: usize| costs.iter().find(|&&(r, c, _)| (r, c) == (row, column)).map(|pair| pair.2);
    let sum: f64 = pairs
        .iter()
        .enumerate()
        .map(|(row, column)| column.and_then(|column| cost(row, column)).unwrap_or(limit))
        .sum();
    let surplus = limit * (more - fewer) as f64;
    let part = |power: f64| (power / more as f64).powf(order.recip());
    Ospa { distance: part(sum + surplus), localisation: part(sum), cardinality: part(surplus) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use proptest::prelude::*;

    type Points = Vec<f64>;

    fn between(x: &Points, y: &Points, cutoff: f64, order: f64) -> Ospa {
        let mut pairs = Vec::new();
        for (i, a) in x.iter().enumerate() {
            for (j, b) in y.iter().enumerate().filter(|(_, b)| (*b - a).abs() < cutoff) {
                pairs.push((i, j, (b - a).abs()));
            }
        }
        ospa(x.len(), y.len(), &pairs, cutoff, order)
    }

    /// The definition: the least sum over all permutations of the larger set.
    fn by_permutation(fewer: &[f64], more: &mut Points, cutoff: f64, order: f64) -> f64 {
        let Some((first, rest)) = fewer.split_first() else {
            return cutoff.powf(order) * more.len() as f64;
        };
        (0..more.len())
            .map(|place| {
                let y = more.remove(place);
                let sum = (y - first).abs().min(cutoff).powf(order) + by_permutation(rest, more, cutoff, order);
                more.insert(place, y);
                sum
            })
            .fold(f64::INFINITY, f64::min)
    }

    fn points() -> impl Strategy<Value = Points> {
        prop::collection::vec(-10.0..10.0_f64, 0..5)
    }

    /// By hand from the definition of Schuhmacher, Vo & Vo (2008), with the cutoffs they discuss (c = 100, p = 1 and 2).
    #[test]
    fn worked_cases() {
        let one_of_two = between(&vec![0.0, 500.0], &vec![30.0], 100.0, 1.0);
        assert_relative_eq!(one_of_two.distance, 65.0);
        assert_relative_eq!(one_of_two.localisation, 15.0);
        assert_relative_eq!(one_of_two.cardinality, 50.0);
        let both = between(&vec![0.0, 500.0], &vec![530.0, 40.0], 100.0, 2.0);
        assert_relative_eq!(both.distance, (0.5 * (900.0 + 1600.0_f64)).sqrt());
        assert_relative_eq!(between(&vec![], &vec![3.0], 100.0, 2.0).distance, 100.0);
        assert_relative_eq!(between(&vec![], &vec![], 100.0, 2.0).distance, 0.0);
        // A missed target and a false track far away are one bad track.
        assert_relative_eq!(between(&vec![0.0], &vec![900.0], 100.0, 2.0).localisation, 100.0);
    }

    proptest! {
        #[test]
        fn it_is_the_least_over_all_permutations(x in points(), y in points(), cutoff in 0.5..12.0_f64, order in 1.0..3.0_f64) {
            let found = between(&x, &y, cutoff, order);
            let (fewer, mut more) = if x.len() <= y.len() { (x, y) } else { (y, x) };
            let n = more.len().max(1) as f64;
            let least = by_permutation(&fewer, &mut more, cutoff, order) / n;
            prop_assert!((found.distance.powf(order) - least).abs() < 1e-9 * (1.0 + least));
            let parts = found.localisation.powf(order) + found.cardinality.powf(order);
            prop_assert!((parts - least).abs() < 1e-9 * (1.0 + least));
        }

        #[test]
        fn it_is_a_metric(x in points(), y in points(), z in points(), cutoff in 0.5..12.0_f64, order in 1.0..3.0_f64) {
            let d = |a: &Points, b: &Points| between(a, b, cutoff, order).distance;
            prop_assert!(d(&x, &x).abs() < 1e-12 && d(&x, &y) <= cutoff * (1.0 + 1e-12));
            prop_assert!((d(&x, &y) - d(&y, &x)).abs() < 1e-9);
            prop_assert!(d(&x, &z) <= d(&x, &y) + d(&y, &z) + 1e-9);
        }
    }
}
