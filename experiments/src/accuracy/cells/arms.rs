//! Ways from the target to a track, step by step from cells to drawn plots.
//!
//! ```text
//! cells      as the extractor found them
//! stated     the same plots, but the target's at the truth plus a normal error of the standard deviations that it states
//! nominal    the same, with those of a place uniform in its cell (C1), and stating these
//! unmapped   the same, to a tracker that takes all other plots for noise: no clutter map
//! alone      the same plots of the target to the filter alone, begun on it: false plots drawn in its gates, no other tracks
//! plots      the same, but the target's plots with the power of a target at 16 dB, and seen at whole seconds, when manoeuvres begin
//! ```
//!
//! All but the last have the same powers and detections from the third scan on, those before *alone* also the same false plots.

use std::f64::consts::TAU;

use common::angle;
use common::config::TrackerConfig;
use common::plots::Plot;
use common::random::{Purpose, generator};
use common::tracks::Track;
use radar_sim::motion::Segments;
use rand::Rng;
use tracker::Tracker;
use tracker::filter::gaussian::Gaussian;

use super::radar::{Flight, Look, stated_sigma};
use crate::accuracy::Score;
use crate::follow::{Follower, LOST_DISTANCE_M, errors_of};
use crate::trajectory::SCANS;
use crate::world::{Sight, kind_before, place, plot, scattered};

/// Ways from the target to a track.
pub(super) const ARMS: usize = 6;

/// A way from the target to a track.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Arm {
    Cells,
    Stated,
    Nominal,
    Unmapped,
    Alone,
    Plots,
}

impl Arm {
    pub(super) const ALL: [Self; ARMS] =
        [Self::Cells, Self::Stated, Self::Nominal, Self::Unmapped, Self::Alone, Self::Plots];

    /// As in the JSON.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Cells => "cells",
            Self::Stated => "stated",
            Self::Nominal => "nominal",
            Self::Unmapped => "unmapped",
            Self::Alone => "alone",
            Self::Plots => "plots",
        }
    }
}

/// The score of each scan k = 1 … 50 in which a confirmed track was within 150 m of the target.
pub(super) type Scores = Vec<Option<Score>>;

/// The scores of one arm that begins with the plots of a flight.
///
/// # Errors
/// If the tracker refuses its configuration.
pub(super) fn through_tracker(
    arm: Arm,
    flight: &Flight,
    motion: &Segments,
    seed: u64,
    run: u32,
) -> anyhow::Result<Scores> {
    let mut config = TrackerConfig::default();
    if arm == Arm::Unmapped {
        config.clutter_map_scans = 0;
    }
    let mut tracker = Tracker::new(&config, 1)?;
    let mut tracks = Vec::new();
    let mut scores: Vec<Option<(f64, Score)>> = vec![None; SCANS as usize];
    for (scan, look) in (0..).zip(&flight.looks) {
        let mut rng = generator(seed, Purpose::Measurement, run, scan);
        let plots = replaced(arm, flight, look, motion, &mut rng);
        for (header, plots) in flight.messages(scan, &plots) {
            tracker.process_plots(&header, &plots, &mut tracks);
            for track in tracks.iter().filter(|track| track.is_confirmed()) {
                let (distance_m, score) = score(track, motion, flight.seconds(track.time_ns));
                let Some(best) = (score.k as usize).checked_sub(1).and_then(|index| scores.get_mut(index)) else {
                    continue;
                };
                if distance_m <= LOST_DISTANCE_M && best.is_none_or(|(least, _)| distance_m < least) {
                    *best = Some((distance_m, score));
                }
            }
        }
    }
    Ok(scores.into_iter().map(|best| best.map(|(_, score)| score)).collect())
}

/// The scores of the filter alone.
pub(super) fn by_filter(follower: &mut Follower, sights: &[Sight], seed: u64, run: u32) -> Scores {
    let mut scores = Vec::new();
    follower.watch(sights, seed, run, |record, _| {
        let errors = [record.predicted_error_m, record.position_error_m, record.velocity_error_mps];
        let score = Score::new(record.k, errors, record.nees_position, record.correct);
        scores.push((record.position_error_m.norm() <= LOST_DISTANCE_M).then_some(score));
    });
    scores
}

/// The target as the filter alone sees it in a flight: its plots of [`Arm::Nominal`]. Detection of the first two is certain.
pub(super) fn sights_of(flight: &Flight, motion: &Segments, seed: u64, run: u32) -> Vec<Sight> {
    let sight = |(scan, look): (u32, &Look)| {
        let truth = motion.at(look.time_s);
        let mut rng = generator(seed, Purpose::Measurement, run, scan);
        let polar = scattered(&place(&truth), &flight.nominal_sigma(), &mut rng);
        let power = look.own.map_or(0.0, |own| f64::from(look.plots[own].statistic).powi(2));
        Sight {
            time_s: look.time_s,
            truth,
            plot: plot(polar, power),
            detected: look.own.is_some() || scan < 2,
            kind: kind_before(motion, look.time_s),
        }
    };
    (0..).zip(&flight.looks).map(sight).collect()
}

/// The plots of a turn as an arm has them.
fn replaced(arm: Arm, flight: &Flight, look: &Look, motion: &Segments, rng: &mut impl Rng) -> Vec<Plot> {
    let mut plots = look.plots.clone();
    let Some(own) = look.own.map(|own| &mut plots[own]) else { return plots };
    let sigma = match arm {
        Arm::Stated => stated_sigma(own),
        Arm::Nominal | Arm::Unmapped => flight.nominal_sigma(),
        Arm::Cells | Arm::Alone | Arm::Plots => return plots,
    };
    let [range_m, azimuth_rad, elevation_rad, range_rate_mps] = scattered(&place(&motion.at(look.time_s)), &sigma, rng);
    // A plot is as old as the beam at its azimuth.
    let later_s = angle::difference(azimuth_rad, own.azimuth_rad) / TAU * flight.period_s();
    *own = Plot {
        time_ns: own.time_ns.saturating_add_signed((later_s * common::units::NS_PER_S) as i64),
        range_m,
        azimuth_rad,
        elevation_rad,
        range_rate_mps,
        sigma_range_m: sigma[0] as f32,
        sigma_azimuth_rad: sigma[1] as f32,
        sigma_elevation_rad: sigma[2] as f32,
        sigma_range_rate_mps: sigma[3] as f32,
        ..*own
    };
    plots
}

/// Distance of a track from the truth at its time, and the errors of its last update. The beam passes at a fraction of a second after
/// the start of a turn: k is the scan that it is nearest to.
fn score(track: &Track, motion: &Segments, time_s: f64) -> (f64, Score) {
    let truth = motion.at(time_s);
    let predicted = Gaussian::from_message(&track.predicted_state, &track.predicted_covariance);
    let estimate = Gaussian::from_message(&track.state, &track.covariance);
    let errors = errors_of(&predicted, &estimate, &truth);
    let k = time_s.round() as i64 - 1;
    let correct = track.most_probable_kind() == kind_before(motion, (k + 1) as f64);
    let all = [errors.predicted_m, errors.position_m, errors.velocity_mps];
    (errors.position_m.norm(), Score::new(k.max(0) as u32, all, errors.nees_position, correct))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trajectory::Trajectory;
    use crate::world::offset;
    use common::config::Swerling;
    use tracker::plots::measurement::Measurement;

    /// The filter alone is given what the tracker without a map is: a difference between them is none of the target's plots.
    #[test]
    fn the_filter_alone_sees_the_plots_of_the_tracker() {
        let motion = Trajectory::B.motion(1, 0);
        let flight = Flight::simulate(&motion, 1, 0, Swerling::One, 1e-3).expect("possible");
        let sights = sights_of(&flight, &motion, 1, 0);
        let mut seen = 0;
        for (scan, (look, sight)) in (0..).zip(flight.looks.iter().zip(&sights)) {
            let Some(own) = look.own else { continue };
            let mut rng = generator(1, Purpose::Measurement, 0, scan);
            let plot = replaced(Arm::Unmapped, &flight, look, &motion, &mut rng)[own];
            let given = Measurement::from_plot(&plot).expect("possible");
            assert!(sight.detected && (sight.plot.power - given.power).abs() < 1e-9);
            for i in 0..4 {
                assert!(offset(sight.plot.polar[i], given.polar[i], i).abs() < 1e-9);
                // (C1) is rounded: 20 m and 0.1° for cells of 69.3 m and 0.346°.
                assert!((sight.plot.variance[i] / given.variance[i] - 1.0).abs() < 5e-3);
            }
            assert!((sight.time_s - flight.seconds(plot.time_ns)).abs() < 2e-3);
            seen += 1;
        }
        assert!(seen > 30, "{seen} of {}", sights.len());
    }
}
