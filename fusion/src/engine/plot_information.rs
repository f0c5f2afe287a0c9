//! What a plot brings to a local track, and how to tell it from what the track's filter has changed its mind on (F6).

use nalgebra::Matrix3;

use crate::comparison::gate;
use crate::gaussian::Gaussian;
use crate::measurement::Measurement;

/// Updates that the usual information is the mean of.
const MEMORY: f64 = 10.0;
/// Updates after which it is known.
const KNOWN: u32 = 3;
/// An update that brings more than this many times the usual information has not got it from a plot.
const MORE: f64 = 1.1;
/// It counts as so many times the usual at most in the mean, which follows a radar that sees better.
const MOST: f64 = 1.5;
/// Share of the information after an update that is rounding.
const ROUNDING: f64 = 1e-6;
/// Probability that a plot is no greater surprise.
const WITHIN: f64 = 0.999;

/// What the updates of a local track usually bring.
#[derive(Debug, Default, Clone, Copy)]
pub(super) struct Usual {
    /// Of range, azimuth, elevation, which stays when the target moves.
    information: Matrix3<f64>,
    updates: u32,
}

impl Usual {
    /// What an update has brought; `polar` is how the position moves with range, azimuth, elevation. Where a filter of several models changes
    /// their probabilities, it seems to have gained or lost information that no plot has given: then the plot is taken to have brought what
    /// plots usually do.
    pub(super) fn measurement(
        &mut self,
        after: &Gaussian,
        before: &Gaussian,
        polar: &Matrix3<f64>,
    ) -> Option<Measurement> {
        let gained = Measurement::of_position(after, before);
        let plain = gained.and_then(|gained| self.learn(&gained, after, before, polar));
        if self.updates < KNOWN || plain == Some(true) {
            return gained;
        }
        let inverse = polar.try_inverse()?;
        Measurement::of_usual_information(after, before, &(inverse.tr_mul(&(self.information * inverse))))
    }

    /// Learns from what an update has brought, unless it is a surprise (`None`). Returns whether it is no more than usual.
    fn learn(
        &mut self,
        gained: &Measurement,
        after: &Gaussian,
        before: &Gaussian,
        polar: &Matrix3<f64>,
    ) -> Option<bool> {
        let information = polar.tr_mul(&(gained.information() * polar));
        let known = self.updates >= KNOWN;
        if known && gained.surprise(before) > gate(gained.count.max(1), WITHIN) {
            return None;
        }
        // What a radar does not measure is rounding.
        let scale = polar.tr_mul(&(after.position_covariance().try_inverse()? * polar));
        let usual = |i: usize| self.information[(i, i)].max(0.0) + ROUNDING * scale[(i, i)];
        let excess = (0..3).map(|i| information[(i, i)] / usual(i)).fold(0.0, f64::max);
        if gained.count > 0 {
            self.updates = self.updates.saturating_add(1);
            let counted = if known { information * (MOST / excess).min(1.0) } else { information };
            self.information += (counted - self.information) / f64::from(self.updates).min(MEMORY);
        }
        Some(excess <= MORE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gaussian::{Matrix, STATE, Vector};
    use approx::assert_relative_eq;

    /// Known to `sigma_m` in each axis.
    fn known(place_m: f64, sigma_m: f64) -> Gaussian {
        Gaussian { mean: Vector::repeat(place_m), covariance: Matrix::identity() * (sigma_m * sigma_m) }
    }

    /// The update of an estimate by a plot of 50 m.
    fn updated(before: &Gaussian, plot_m: f64) -> Gaussian {
        let (mut after, variance) = (*before, before.covariance[(0, 0)]);
        let gain = variance / (variance + 2500.0);
        for axis in 0..STATE {
            after.mean[axis] += gain * (plot_m - before.mean[axis]);
        }
        after.covariance *= 1.0 - gain;
        after
    }

    #[test]
    fn a_filter_that_changes_its_mind_gives_its_plot_and_not_its_mind() {
        let mut usual = Usual::default();
        let before = known(0.0, 40.0);
        for _ in 0..5 {
            let plain = usual.measurement(&updated(&before, 30.0), &before, &Matrix3::identity()).expect("a plot");
            assert_relative_eq!(plain.information()[(0, 0)], 1.0 / 2500.0, max_relative = 1e-9);
        }
        // 400 m away; the filter takes up a manoeuvre, as if it had never known more than to 200 m.
        let after = updated(&known(0.0, 200.0), 400.0);
        let mut at_once = known(0.0, 200.0);
        usual.measurement(&after, &before, &Matrix3::identity()).expect("a plot").absorb(&mut at_once);
        assert_relative_eq!(at_once.mean[0], after.mean[0], max_relative = 1e-6);
        assert_relative_eq!(at_once.covariance[(0, 0)], after.covariance[(0, 0)], max_relative = 1e-6);
        // It is sure again, for no plot: what it says is worth a plot.
        let sure = updated(&known(0.0, 20.0), 30.0);
        let gained = usual.measurement(&sure, &before, &Matrix3::identity()).expect("a plot");
        assert_relative_eq!(gained.information()[(0, 0)], 1.0 / 2500.0, max_relative = 0.1);
    }

    /// Mean share of the information of plots that is taken, of plots `worth` so many times those before.
    fn taken(usual: &mut Usual, worth: impl Fn(u32) -> f64) -> f64 {
        let before = known(0.0, 40.0);
        let share = |update: u32| {
            let mut after = before;
            let information = worth(update) / 2500.0;
            after.covariance = Matrix::identity() / (1.0 / 1600.0 + information);
            let gained = usual.measurement(&after, &before, &Matrix3::identity()).expect("a plot");
            gained.information()[(0, 0)] / information
        };
        (0..40).map(share).skip(20).sum::<f64>() / 20.0
    }

    #[test]
    fn plots_that_differ_or_become_better_count_in_full() {
        let mut usual = Usual::default();
        let scattered = taken(&mut usual, |update| [0.6, 1.4, 1.0, 1.2, 0.8][update as usize % 5]);
        assert!((0.9..1.1).contains(&scattered), "{scattered}");
        let better = taken(&mut usual, |_| 2.0);
        assert!((0.95..1.05).contains(&better), "{better}");
    }

    #[test]
    fn what_a_radar_does_not_measure_makes_no_update_unusual() {
        let mut usual = Usual::default();
        let polar = Matrix3::new(0.8, -0.6, 0.0, 0.6, 0.8, 0.0, 0.0, 0.0, 1.0) * 1.1;
        let mut before = known(0.0, 40.0);
        for axis in [2, STATE - 1] {
            before.covariance[(axis, axis)] = 1.6e7;
        }
        for _ in 0..30 {
            let mut information = before.information().expect("a covariance");
            for axis in 0..2 {
                information.matrix[(axis, axis)] += 1.0 / 2500.0;
            }
            let after = information.moments().expect("positive definite");
            let gained = usual.measurement(&after, &before, &polar).expect("a plot");
            assert_relative_eq!(gained.information()[(0, 0)], 1.0 / 2500.0, max_relative = 1e-6);
        }
    }

    #[test]
    fn a_scan_without_a_plot_brings_nothing() {
        let mut usual = Usual::default();
        let before = known(0.0, 40.0);
        for _ in 0..5 {
            usual.measurement(&updated(&before, 30.0), &before, &Matrix3::identity());
        }
        let nothing = usual.measurement(&before, &before, &Matrix3::identity()).expect("no loss");
        assert_eq!(nothing.count, 0);
    }
}
