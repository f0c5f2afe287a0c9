//! A bias far beyond what registration expects, from tracks that fit nobody: a radar that is turned or set up elsewhere, a clock that is wrong (F7a).
//!
//! ```text
//! d_k = x_local − x_system of pairs near each other,   S_k = P_local + P_system
//! hypotheses of one pair:   range, azimuth, elevation  b = J_p⁻¹ d,  Σ = J_p⁻¹ S J_p⁻ᵀ
//!                           time                       b_t = (vᵀ S⁻¹ d) / (vᵀ S⁻¹ v),  Σ = 1 / (vᵀ S⁻¹ v)
//! votes(b):  local tracks that have a pair with (d − J b)ᵀ (S + J Σ Jᵀ)⁻¹ (d − J b) within the gate
//! of the hypothesis with most votes:  b = (Σ Jᵀ S⁻¹ J + B⁻¹)⁻¹ Σ Jᵀ S⁻¹ d over its best pairs, again and again
//! ```
//!
//! One pair says what the bias would be if both were one target; that of a wrong pair suits no other.

use nalgebra::{Matrix3, SMatrix, Vector3};

use crate::comparison::{chi_squared, gate};
use crate::registration::{BIASES, Bias, BiasJacobian};

/// Probability that what is left of the difference of one target is within the gate.
const WITHIN: f64 = 0.999;
/// Standard deviations of what is looked for: range m, azimuth rad, elevation rad, time s.
pub(crate) const ANY: [f64; BIASES] = [5000.0, 0.1, 0.1, 10.0];
/// Pairs that hypotheses are made of.
const HYPOTHESES: usize = 60;
/// Rounds of fitting.
const ROUNDS: usize = 3;

/// A local track of the site and a system track that may be the same target.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pair {
    /// Number of the local track.
    pub local: u32,
    /// d, in the axes of the centre; m.
    pub difference_m: Vector3<f64>,
    /// S, m².
    pub spread: Matrix3<f64>,
    /// J of the local track, in the axes of the centre.
    pub jacobian: BiasJacobian,
}

/// A bias and how many local tracks it explains.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Explanation {
    /// What the radar measures too much.
    pub bias: Bias,
    /// Covariance of its error.
    pub covariance: SMatrix<f64, BIASES, BIASES>,
    /// Local tracks that have a pair with it.
    pub votes: usize,
}

/// Local tracks that have a pair without any bias but what is `known` of it as a covariance. `pairs` are in order of their local tracks.
pub fn votes_without(pairs: &[Pair], known: &SMatrix<f64, BIASES, BIASES>) -> usize {
    best_pairs(pairs, &Bias::zeros(), known, gate(3, WITHIN)).count()
}

/// The bias that explains most local tracks; `None` without a pair. `pairs` are in order of their local tracks.
pub fn explain(pairs: &[Pair]) -> Option<Explanation> {
    let gate = gate(3, WITHIN);
    let every = pairs.len().div_ceil(HYPOTHESES).max(1);
    let hypotheses = pairs.iter().step_by(every).flat_map(|pair| [of_place(pair), of_time(pair)]).flatten();
    let votes =
        |(bias, covariance): &(Bias, SMatrix<f64, BIASES, BIASES>)| best_pairs(pairs, bias, covariance, gate).count();
    let (mut bias, mut covariance) = hypotheses
        .map(|hypothesis| (votes(&hypothesis), hypothesis))
        .reduce(|best, other| if other.0 > best.0 { other } else { best })?
        .1;
    for _ in 0..ROUNDS {
        (bias, covariance) = fitted(best_pairs(pairs, &bias, &covariance, gate))?;
    }
    Some(Explanation { bias, covariance, votes: best_pairs(pairs, &bias, &covariance, gate).count() })
}

/// If the pair is one target, and the clock is right.
fn of_place(pair: &Pair) -> Option<(Bias, SMatrix<f64, BIASES, BIASES>)> {
    let inverse = pair.jacobian.fixed_columns::<3>(0).into_owned().try_inverse()?;
    let place = inverse * pair.difference_m;
    let mut covariance = SMatrix::<f64, BIASES, BIASES>::zeros();
    covariance.fixed_view_mut::<3, 3>(0, 0).copy_from(&(inverse * pair.spread * inverse.transpose()));
    let bias = Bias::new(place[0], place[1], place[2], 0.0);
    is_possible(&bias).then_some((bias, covariance))
}

/// If the pair is one target, and only the clock is wrong.
fn of_time(pair: &Pair) -> Option<(Bias, SMatrix<f64, BIASES, BIASES>)> {
    let velocity = pair.jacobian.column(3).into_owned();
    let weighted = pair.spread.cholesky()?.solve(&velocity);
    let information = velocity.dot(&weighted);
    if information <= 0.0 {
        return None;
    }
    let bias = Bias::new(0.0, 0.0, 0.0, pair.difference_m.dot(&weighted) / information);
    let mut covariance = SMatrix::<f64, BIASES, BIASES>::zeros();
    covariance[(3, 3)] = 1.0 / information;
    is_possible(&bias).then_some((bias, covariance))
}

fn is_possible(bias: &Bias) -> bool {
    bias.iter().zip(ANY).all(|(value, any)| value.abs() <= 2.0 * any)
}

/// Of each local track the pair that fits best, if one does.
fn best_pairs<'a>(
    pairs: &'a [Pair],
    bias: &Bias,
    covariance: &SMatrix<f64, BIASES, BIASES>,
    gate: f64,
) -> impl Iterator<Item = &'a Pair> {
    let (bias, covariance) = (*bias, *covariance);
    let misfit = move |pair: &Pair| {
        let spread = pair.spread + pair.jacobian * covariance * pair.jacobian.transpose();
        chi_squared(&(pair.difference_m - pair.jacobian * bias), spread)
    };
    pairs.chunk_by(|a, b| a.local == b.local).filter_map(move |of_local| {
        let best = of_local.iter().map(|pair| (misfit(pair), pair)).min_by(|a, b| a.0.total_cmp(&b.0))?;
        (best.0 <= gate).then_some(best.1)
    })
}

/// The bias that these pairs have in common.
fn fitted<'a>(pairs: impl Iterator<Item = &'a Pair>) -> Option<(Bias, SMatrix<f64, BIASES, BIASES>)> {
    let any = Bias::from(ANY);
    // In units of what is looked for.
    let (mut normal, mut right) = (SMatrix::<f64, BIASES, BIASES>::identity(), Bias::zeros());
    for pair in pairs {
        let jacobian = pair.jacobian * SMatrix::from_diagonal(&any);
        let weighted = pair.spread.cholesky()?.solve(&jacobian);
        normal += jacobian.tr_mul(&weighted);
        right += weighted.tr_mul(&pair.difference_m);
    }
    let root = normal.cholesky()?;
    let covariance = SMatrix::from_diagonal(&any) * root.inverse() * SMatrix::from_diagonal(&any);
    Some((root.solve(&right).component_mul(&any), covariance))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::registration::jacobian;
    use crate::simulation::normal;
    use rand::{Rng, RngExt, SeedableRng};

    /// Targets of a radar with this bias, each beside its own system track and those of others within 5 km.
    fn pairs(bias: &Bias, targets: usize, rng: &mut impl Rng) -> Vec<Pair> {
        let mut any = |half: f64| rng.random_range(-half..half);
        let tracks: Vec<(Vector3<f64>, Vector3<f64>)> = (0..targets)
            .map(|_| (Vector3::new(any(6e4), any(6e4), 6000.0), Vector3::new(any(300.0), any(300.0), 0.0)))
            .collect();
        let mut pairs = Vec::new();
        for (local, (place, velocity)) in tracks.iter().enumerate() {
            let jacobian = jacobian(place, velocity);
            let seen = place + jacobian * bias + Vector3::from_fn(|_, _| 60.0 * normal(rng));
            for (system, _) in &tracks {
                let difference_m = seen - system;
                if difference_m.norm() < 5000.0 {
                    let spread = Matrix3::identity() * 3600.0;
                    pairs.push(Pair { local: local as u32, difference_m, spread, jacobian });
                }
            }
        }
        pairs
    }

    #[test]
    fn biases_of_place_and_of_time_are_found_among_other_targets() {
        let mut rng = chacha20::ChaCha8Rng::seed_from_u64(1);
        for bias in [
            Bias::new(1000.0, 0.0, 0.0, 0.0),
            Bias::new(0.0, 0.02, 0.0, 0.0),
            Bias::new(0.0, 0.0, 0.0, -2.0),
            Bias::new(-1500.0, 0.03, 0.0, 0.0),
        ] {
            let pairs = pairs(&bias, 100, &mut rng);
            let found = explain(&pairs).expect("pairs");
            assert!(found.votes >= 95, "{bias}: {found:?}");
            let error = found.bias - bias;
            for i in 0..BIASES {
                assert!(error[i].abs() < 5.0 * found.covariance[(i, i)].sqrt(), "{bias} found as {}", found.bias);
            }
            assert!(votes_without(&pairs, &SMatrix::zeros()) < 40);
        }
    }

    #[test]
    fn pairs_of_nobody_are_explained_by_nothing() {
        let mut rng = chacha20::ChaCha8Rng::seed_from_u64(2);
        let mut pairs = pairs(&Bias::zeros(), 100, &mut rng);
        for pair in &mut pairs {
            pair.difference_m = Vector3::from_fn(|_, _| rng.random_range(-4000.0..4000.0));
        }
        assert!(explain(&pairs).is_none_or(|found| found.votes < 20));
        assert_eq!(explain(&[]), None);
    }
}
