//! The update of up to eight tracks at once: [`crate::filter::uav::update`] by the vector kernel of [`crate::filter::uav::batch`].
//!
//! Gates and candidates are chosen track by track, by the same [`select`] and [`weigh`] as there; what is computed as vectors is what
//! the modes expect, and the update. The kernel weighs plots against noise, the plain code against the density ρ_c at the gate's
//! centre: its b_j and e_jm λ_m are those of the kernel times ρ_c/D,
//! ```text
//! b_j = 1 − D P_Gj,   a_m = λ_m D/ρ_c;   existence ratio = Σ_j W*_j L_j,   likelihood of mode j = L_j ρ_c/D
//! ```
//! so that both give the same [`Outcome`] but for rounding.

use common::config::Association;

use crate::association::{FalsePlots, Rules, Selection, Surroundings, select, weigh};
use crate::filter::uav::batch::{Block, Candidates, Forecast, Kernel, LANES, Step, Weights};
use crate::filter::uav::imm::{Imm, transition};
use crate::filter::uav::motion::MODES;
use crate::filter::uav::update::{Outcome, Workspace};
use crate::plots::measurement::{COORDINATES, Measurement};
use crate::tracks::track::{Meeting, Passage};

/// A track, as [`crate::filter::uav::update::update`] takes it.
#[derive(Debug)]
pub struct Member<'a, F> {
    /// u*_j, P*_j, W*_j.
    pub prediction: &'a Imm,
    /// Its time, ns UTC.
    pub time_ns: u64,
    /// The plots that are offered.
    pub plots: &'a [Measurement],
    /// D, λ, ρ_c.
    pub surroundings: Surroundings<'a, F>,
}

/// Room for the update of a group, reused.
#[derive(Debug, Default)]
pub struct Group {
    forecast: Forecast,
    candidates: Candidates,
    weights: Weights,
    posterior: Block,
    step: Step,
    /// Selection and D/ρ_c by lane.
    chosen: Vec<(Selection, f64)>,
}

impl Group {
    /// Whether the kernel knows a rule: it has weights for all plots, not decisions for one.
    pub fn takes(association: Association) -> bool {
        matches!(association, Association::Pda | Association::PdaStatistics)
    }

    /// Appends the outcome of each of at most [`LANES`] members to `outcomes`; its candidates and their weights are in the workspace of
    /// the same number.
    pub fn update<'a, F: Fn(&[f64; COORDINATES]) -> FalsePlots>(
        &mut self,
        kernel: &Kernel,
        members: impl Iterator<Item = Member<'a, F>> + Clone,
        rules: &Rules,
        workspaces: &mut [Workspace; LANES],
        outcomes: &mut Vec<Outcome>,
    ) {
        let Self { forecast, candidates, weights, posterior, chosen, .. } = self;
        for (lane, member) in members.clone().enumerate() {
            forecast.prediction.load(lane, member.prediction);
        }
        kernel.expect(forecast);
        candidates.clear();
        chosen.clear();
        for (lane, (member, workspace)) in members.clone().zip(workspaces.iter_mut()).enumerate() {
            let Member { prediction, time_ns, plots, surroundings } = member;
            let Workspace { candidates: found, gates, .. } = &mut *workspace;
            *gates = forecast.gates(lane, rules.alpha);
            let selection = select(prediction, gates, time_ns, plots, &surroundings, rules, found);
            let per_density =
                surroundings.detection_probability / weigh(&selection, &surroundings, plots, rules, found);
            candidates.set_none(lane, selection.missed());
            for candidate in found.iter() {
                candidates.add(lane, &plots[candidate.plot], candidate.offset_s, candidate.ratio * per_density);
            }
            chosen.push((selection, per_density));
        }
        kernel.update(forecast, candidates, weights, posterior);
        for (lane, (member, workspace)) in members.zip(workspaces).enumerate() {
            let (selection, per_density) = chosen[lane];
            outcomes.push(outcome(lane, member.prediction, selection, per_density, weights, posterior, workspace));
        }
    }
}

impl Group {
    /// Predicts at most [`LANES`] tracks to their meetings with the beam and hands each passage to `take`, as
    /// [`Kinematics::passage`](crate::tracks::track::Kinematics::passage) does one by one.
    pub fn predict<'a>(
        &mut self,
        kernel: &Kernel,
        stay: f64,
        period_s: f64,
        tracks: impl Iterator<Item = (&'a Imm, Meeting)> + Clone,
        mut take: impl FnMut(usize, Passage),
    ) {
        let Self { forecast, posterior, step, .. } = self;
        for (lane, (track, meeting)) in tracks.clone().enumerate() {
            posterior.load(lane, track);
            step.set(lane, meeting.step_s(), &transition(stay, meeting.step_s()));
        }
        kernel.predict(posterior, step, forecast);
        for (lane, (_, meeting)) in tracks.enumerate() {
            let gates = forecast.gates(lane, kernel.alpha);
            let prediction = forecast.prediction.store(lane);
            take(lane, Passage::new(prediction, &gates, meeting.to_ns, meeting.angle_rad, period_s));
        }
    }
}

/// What the kernel made of the track in `lane`, in the terms of the plain code.
fn outcome(
    lane: usize,
    prediction: &Imm,
    selection: Selection,
    per_density: f64,
    weights: &Weights,
    posterior: &Block,
    workspace: &mut Workspace,
) -> Outcome {
    let of = |rows: &[crate::filter::uav::batch::Row; MODES]| rows.map(|row| row.0[lane]);
    let posterior = posterior.store(lane);
    let (likelihood, mode_none) = (of(&weights.likelihood), of(&weights.none));
    let plots_in_gate = workspace.candidates.len();
    workspace.weights.clear();
    workspace.weights.extend(weights.plots[..plots_in_gate].iter().map(of));
    // L_j without other tracks: every plot's part of it, w_jm L_j, over the plot's share.
    let mut alone: [f64; MODES] = std::array::from_fn(|j| mode_none[j] * likelihood[j]);
    for (candidate, weight) in workspace.candidates.iter().zip(&workspace.weights) {
        if candidate.ratio > 0.0 {
            let rivalry = candidate.alone / candidate.ratio;
            for j in 0..MODES {
                alone[j] += weight[j] * likelihood[j] * rivalry;
            }
        }
    }
    Outcome {
        posterior,
        selection,
        plots_in_gate,
        mode_likelihood: if plots_in_gate > 0 { likelihood.map(|l| l / per_density) } else { likelihood },
        mode_none,
        existence_ratio: prediction.average(&likelihood),
        ratio_alone: prediction.average(&alone),
        weight_none: posterior.average(&mode_none),
        best: workspace.best(&posterior),
    }
}
