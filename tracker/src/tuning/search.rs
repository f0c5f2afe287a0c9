//! The greatest value of a function of few variables by the simplex of Nelder and Mead, and how sharp it is.

use nalgebra::DMatrix;

/// Differences of the function that mean nothing: a hundredth of a natural logarithm of likelihood.
const SAME: f64 = 0.01;
/// Extent of the simplex, along every variable, that is a point.
const POINT: f64 = 0.01;
/// Most evaluations by variable.
const MOST: usize = 150;
/// Step of differences for the curvature.
const DIFFERENCE: f64 = 0.04;

/// Where `of` is greatest near `start`, about which the first simplex extends by `step`; −∞ marks what cannot be.
///
/// Source: J. A. Nelder, R. Mead, *A simplex method for function minimization*, Computer Journal 7, 308-313, 1965.
pub(super) fn greatest(start: &[f64], step: f64, of: impl Fn(&[f64]) -> f64) -> Vec<f64> {
    let n = start.len();
    if n == 0 {
        return Vec::new();
    }
    let mut simplex: Vec<(f64, Vec<f64>)> = (0..=n)
        .map(|corner| {
            let mut at = start.to_vec();
            if corner > 0 {
                at[corner - 1] += step;
            }
            (of(&at), at)
        })
        .collect();
    for _ in 0..MOST * n {
        simplex.sort_by(|a, b| b.0.total_cmp(&a.0));
        let (best, worst) = (simplex[0].0, simplex[n].0);
        let extent = simplex.iter().flat_map(|(_, at)| at.iter().zip(&simplex[0].1)).map(|(a, b)| (a - b).abs());
        if best - worst < SAME && extent.fold(0.0, f64::max) < POINT {
            break;
        }
        let centre: Vec<f64> =
            (0..n).map(|i| simplex[..n].iter().map(|(_, at)| at[i]).sum::<f64>() / n as f64).collect();
        let along = |by: f64| -> (f64, Vec<f64>) {
            let at: Vec<f64> = centre.iter().zip(&simplex[n].1).map(|(c, w)| c + by * (w - c)).collect();
            (of(&at), at)
        };
        let reflected = along(-1.0);
        let next = if reflected.0 > best {
            let expanded = along(-2.0);
            if expanded.0 > reflected.0 { Some(expanded) } else { Some(reflected) }
        } else if reflected.0 > simplex[n - 1].0 {
            Some(reflected)
        } else {
            let contracted = along(if reflected.0 > worst { -0.5 } else { 0.5 });
            Some(contracted).filter(|contracted| contracted.0 > worst.max(reflected.0))
        };
        if let Some(corner) = next {
            simplex[n] = corner;
        } else {
            let best = simplex[0].1.clone();
            for (value, at) in &mut simplex[1..] {
                at.iter_mut().zip(&best).for_each(|(a, b)| *a = 0.5 * (*a + b));
                *value = of(at);
            }
        }
    }
    simplex.sort_by(|a, b| b.0.total_cmp(&a.0));
    simplex.swap_remove(0).1
}

/// Standard errors by the curvature of a logarithm of likelihood at its greatest value (ML2); `None` of a variable that it does not depend
/// on, or depends on so little that it has no peak there.
pub(super) fn errors(point: &[f64], of: impl Fn(&[f64]) -> f64) -> Vec<Option<f64>> {
    let n = point.len();
    let moved = |steps: &[(usize, f64)]| {
        let mut at = point.to_vec();
        for &(i, by) in steps {
            at[i] += by;
        }
        of(&at)
    };
    let (h, here) = (DIFFERENCE, of(point));
    let mut curvature = DMatrix::zeros(n, n);
    for i in 0..n {
        curvature[(i, i)] = (2.0 * here - moved(&[(i, h)]) - moved(&[(i, -h)])) / (h * h);
        for j in 0..i {
            let mixed = moved(&[(i, h), (j, h)]) + moved(&[(i, -h), (j, -h)])
                - moved(&[(i, h), (j, -h)])
                - moved(&[(i, -h), (j, h)]);
            curvature[(i, j)] = -mixed / (4.0 * h * h);
            curvature[(j, i)] = curvature[(i, j)];
        }
    }
    // Variables without a peak of their own are left out one after the other, the flattest first, until the others have one together.
    let mut kept: Vec<usize> = (0..n).filter(|&i| curvature[(i, i)] > 0.0 && curvature[(i, i)].is_finite()).collect();
    let covariance = loop {
        let of_kept = DMatrix::from_fn(kept.len(), kept.len(), |a, b| curvature[(kept[a], kept[b])]);
        if let Some(factor) = of_kept.cholesky() {
            break factor.inverse();
        }
        let flattest =
            (0..kept.len()).min_by(|&a, &b| curvature[(kept[a], kept[a])].total_cmp(&curvature[(kept[b], kept[b])]));
        match flattest {
            Some(flattest) => kept.remove(flattest),
            None => return vec![None; n],
        };
    };
    (0..n).map(|i| kept.iter().position(|&k| k == i).map(|k| covariance[(k, k)].sqrt())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A correlated normal density, and a variable that does nothing.
    fn hill(at: &[f64]) -> f64 {
        let (x, y) = ((at[0] - 1.0) / 0.1, (at[1] + 0.5) / 0.2);
        -0.5 * (x * x - 2.0 * 0.6 * x * y + y * y) / (1.0 - 0.36)
    }

    #[test]
    fn the_top_of_a_hill_is_found_with_its_width() {
        let top = greatest(&[0.0, 0.0], 0.3, hill);
        assert!((top[0] - 1.0).abs() < 0.02 && (top[1] + 0.5).abs() < 0.03, "{top:?}");
        let errors: Vec<f64> = errors(&[1.0, -0.5], hill).into_iter().flatten().collect();
        assert!((errors[0] - 0.1).abs() < 1e-6 && (errors[1] - 0.2).abs() < 1e-6, "{errors:?}");
    }

    #[test]
    fn what_does_not_matter_is_not_told() {
        let found = errors(&[1.0, -0.5, 3.0], hill);
        assert!(found[0].is_some() && found[1].is_some() && found[2].is_none(), "{found:?}");
    }

    #[test]
    fn a_curved_ridge_is_followed() {
        let ridge = |at: &[f64]| -(100.0 * (at[1] - at[0] * at[0]).powi(2) + (1.0 - at[0]).powi(2)) * 100.0;
        let top = greatest(&[-1.2, 1.0], 0.3, ridge);
        assert!((top[0] - 1.0).abs() < 0.05 && (top[1] - 1.0).abs() < 0.1, "{top:?}");
    }
}
