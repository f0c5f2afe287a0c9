//! Plots that several tracks could have caused: the linear multi-target approximation.
//!
//! To a track τ a plot that is probably another target's is as good as clutter. With p_mσ the density of
//! plot m predicted by track σ,
//! ```text
//! P_mσ = r_σ D p_mσ λ_m/ρ_m / (1 − D P_G + D Σ_l p_lσ λ_l/ρ_l)        prior probability that m is σ's
//! Ω_m  = ρ_m + Σ_(σ≠τ) p_mσ λ_m P_mσ/(1 − P_mσ)                      density in place of ρ_m for τ
//! ```
//! at a cost that is linear in the number of tracks, where enumerating joint events is exponential.
//! Source: Mušicki & La Scala (2008). The predictions of all tracks are those before the scan, so the order
//! of processing does not matter.

use std::f64::consts::TAU;

use common::amplitude::TargetStatistics;

use crate::association::FalsePlots;
use crate::gate::Radar;
use crate::measurement::{COORDINATES, Expected, Measurement};
use crate::motion::{CONSTANT_VELOCITY, MODES};
use crate::track::{LiveTrack, Passage};

/// Largest P_mσ: a track is never quite sure of a plot.
const SUREST: f64 = 0.98;

/// Tracks nearer than this may want the same plots, cells of range.
const RIVAL_CELLS: f64 = 5.0;
/// Passages nearer than this belong to the same turn, turns.
const RIVAL_TURNS: f64 = 0.4;
/// A track that competes for plots.
#[derive(Debug, Clone, Copy)]
pub struct Rival<'a> {
    /// What it expects of this turn.
    pub passage: &'a Passage,
    /// r.
    pub existence: f64,
    /// D.
    pub detection_probability: f64,
    /// Statistics of its power; without, λ = 1.
    pub target: Option<&'a TargetStatistics>,
}

/// Turns `extra` (one per plot) into Σ_σ p_mσ λ_m/ρ_m · P_mσ/(1 − P_mσ) by adding the part of `rival`.
/// `scratch` is reused.
pub fn add_rival(
    rival: &Rival<'_>,
    plots: &[Measurement],
    clutter: impl Fn(&[f64; COORDINATES]) -> FalsePlots,
    inflation: f64,
    extra: &mut [f64],
    scratch: &mut Vec<f64>,
) {
    let prediction = &rival.passage.prediction;
    let expected: [Expected; MODES] = std::array::from_fn(|j| Expected::new(j, &prediction.modes[j]));
    scratch.clear();
    for plot in plots {
        let offset_s = common::units::seconds_between(rival.passage.time_ns, plot.time_ns);
        let mut density = 0.0;
        for (expected, weight) in expected.iter().zip(prediction.probability) {
            if let Some(likelihood) = expected.likelihood(plot, inflation) {
                let d = expected.innovation(plot, offset_s);
                let y = likelihood.solve(d);
                let square: f64 = d.iter().zip(y).map(|(d, y)| d * y).sum();
                density += weight * (likelihood.ln_peak - 0.5 * square).exp();
            }
        }
        let here = clutter(&plot.polar);
        let ratio = match rival.target {
            Some(target) if plot.has_power => target.likelihood_ratio_in_clutter(plot.power, here.mean_excess),
            _ => 1.0,
        };
        scratch.push((density * ratio / here.density).min(1e100));
    }
    let d = rival.detection_probability;
    let total = 1.0 - d + d * scratch.iter().sum::<f64>();
    for (extra, ratio) in extra.iter_mut().zip(scratch.iter()) {
        let prior = (rival.existence * d * ratio / total).min(SUREST);
        *extra += ratio * prior / (1.0 - prior);
    }
}

/// The confirmed tracks that may want the same plots as track `index` in this turn, with what they expect of it.
pub fn rivals_of<'a>(
    index: usize,
    tracks: &'a [LiveTrack],
    radar: &Radar,
) -> impl Iterator<Item = (&'a LiveTrack, &'a Passage)> {
    let own = &tracks[index].next;
    let reach_m = RIVAL_CELLS * radar.cell[0];
    let centre = own.prediction.modes[CONSTANT_VELOCITY].position();
    tracks.iter().enumerate().filter_map(move |(other, track)| {
        if other == index || !track.life.is_confirmed() {
            return None;
        }
        let expects = [&track.next, &track.last]
            .into_iter()
            .find(|passage| (passage.angle_rad - own.angle_rad).abs() < RIVAL_TURNS * TAU)?;
        let position = expects.prediction.modes[CONSTANT_VELOCITY].position();
        let square: f64 = (0..3).map(|axis| (position[axis] - centre[axis]).powi(2)).sum();
        (square < reach_m * reach_m).then_some((track, expects))
    })
}
