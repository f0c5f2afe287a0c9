//! Which plot is the track's: weights of the plots in the gate (T10), (T12), (T13), (T15).
//!
//! ```text
//! e_jm = N(y_m; h(u*_j), D_j)
//! w_jm ∝ e_jm λ_m,  w_j0 ∝ b_j,  normalised over m = 0…M;   L_j = b_j + Σ_m e_jm λ_m      (T12)
//! b_j = ρ_c (1 − D P_Gj)/D,  ρ_c: M/V (non-parametric) or the radar's density (parametric)
//! M = 0:  L_j = 1 − D P_Gj                                                                 (T15)
//! ```
//!
//! Clutter that varies over the gate enters by λ_m: it is multiplied by ρ_c over the density at the
//! plot. Nearest and strongest neighbour are the same with one candidate, λ = 1 and b = 0.

use common::amplitude::TargetStatistics;
use common::config::{Association, Clutter, GateRule, TrackerConfig};
use common::tracks::{GATE_MANOEUVRE, GATE_MANOEUVRE_FALLBACK, GATE_MOST_PROBABLE, GATE_NONE, GATE_UNION};

use crate::gate::{self, Gate, Radar};
use crate::imm::Imm;
use crate::measurement::{COORDINATES, Expected, Measurement};
use crate::motion::{MANOEUVRE, MODES};

/// How plots are chosen and weighted; the part of the configuration that the filter needs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rules {
    /// Which gate is searched (T10).
    pub gate_rule: GateRule,
    /// α of (T9).
    pub alpha: f64,
    /// W*_j above which a mode's gate belongs to the union.
    pub union_probability: f64,
    /// Whether P_G is taken for each mode in the gate used (T13).
    pub gate_probability_by_mode: bool,
    /// P_G instead of erf(α/√2)ⁿ, without (T13).
    pub gate_probability: Option<f64>,
    /// Weights (T12) or one neighbour.
    pub association: Association,
    /// Where ρ_c comes from.
    pub clutter: Clutter,
    /// γ of (T7).
    pub inflation: f64,
}

impl Rules {
    /// From the configuration.
    pub fn new(config: &TrackerConfig) -> Self {
        Self {
            gate_rule: config.gate_rule,
            alpha: config.gate_alpha,
            union_probability: UNION_PROBABILITY,
            gate_probability_by_mode: config.gate_probability_by_mode,
            gate_probability: None,
            association: config.association,
            clutter: config.clutter,
            inflation: config.range_rate_inflation,
        }
    }
}

/// W*_j above which a mode's gate belongs to the union.
const UNION_PROBABILITY: f64 = 0.02;

/// A plot in the gate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Candidate {
    /// Index in the plots that were offered.
    pub plot: usize,
    /// Plot's time minus the prediction's, s.
    pub offset_s: f64,
    /// λ_m, times ρ_c over the clutter density at the plot, other tracks' claims included.
    pub ratio: f64,
    /// The same as if there were no other tracks.
    pub alone: f64,
    /// Sum of squared normalised offsets from the gate's centre (T9).
    pub distance: f64,
}

/// The gate in use and what it holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Selection {
    /// `GATE_…` of [`common::tracks`].
    pub gate_code: u32,
    /// The gate: of the searched mode, or the largest of a union.
    pub gate: Gate,
    /// Mode of that gate.
    pub mode: usize,
    /// V, m³·m/s.
    pub volume: f64,
    /// P_Gj by mode.
    pub probability: [f64; MODES],
}

/// What a track knows of the target's amplitude and of its surroundings.
#[derive(Debug, Clone, Copy)]
pub struct Surroundings<'a, F> {
    /// The radar.
    pub radar: &'a Radar,
    /// D, probability of detection.
    pub detection_probability: f64,
    /// Statistics of the target's power; without, λ = 1.
    pub target: Option<&'a TargetStatistics>,
    /// By plot: density of other tracks' claims over that of clutter, see [`crate::joint`]; empty without.
    pub rivals: &'a [f64],
    /// The clutter at (r, β, ε, ṙ).
    pub clutter: F,
}

/// False plots to be expected at a place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FalsePlots {
    /// ρ_c in the measure of y, 1/(m³·m/s).
    pub density: f64,
    /// Mean of q − t₀ above the threshold; 0 for that of noise.
    pub mean_excess: f64,
}

/// Fills `candidates` with the plots in the gate that the rule names (T10). `time_ns` is that of the prediction.
pub fn select(
    prediction: &Imm,
    expected: &[Expected; MODES],
    time_ns: u64,
    plots: &[Measurement],
    radar: &Radar,
    rules: &Rules,
    candidates: &mut Vec<Candidate>,
) -> Selection {
    let gates: [Gate; MODES] = std::array::from_fn(|j| Gate::new(&expected[j], radar, rules.alpha));
    let first = prediction.most_probable();
    candidates.clear();
    let (gate_code, mode) = match rules.gate_rule {
        GateRule::MostProbable => {
            search(&gates, expected, &[first], time_ns, plots, candidates);
            if candidates.is_empty() && first != MANOEUVRE {
                search(&gates, expected, &[MANOEUVRE], time_ns, plots, candidates);
                (GATE_MANOEUVRE_FALLBACK, MANOEUVRE)
            } else {
                (GATE_MOST_PROBABLE, first)
            }
        }
        GateRule::Manoeuvre => {
            search(&gates, expected, &[MANOEUVRE], time_ns, plots, candidates);
            (GATE_MANOEUVRE, MANOEUVRE)
        }
        GateRule::Union => {
            let mut joined = [first; MODES];
            let mut largest = first;
            for j in 0..MODES {
                if prediction.probability[j] > rules.union_probability {
                    joined[j] = j;
                    if gates[j].volume(radar) > gates[largest].volume(radar) {
                        largest = j;
                    }
                }
            }
            search(&gates, expected, &joined, time_ns, plots, candidates);
            (GATE_UNION, largest)
        }
    };
    let gate = gates[mode];
    let own = rules.gate_probability.unwrap_or_else(|| gate::own_probability(rules.alpha, radar.dimensions()));
    let in_union = |j: usize| {
        rules.gate_rule == GateRule::Union && (j == first || prediction.probability[j] > rules.union_probability)
    };
    let probability = std::array::from_fn(|j| {
        if !rules.gate_probability_by_mode || in_union(j) { own } else { gate.probability(&expected[j], radar) }
    });
    Selection {
        gate_code: if candidates.is_empty() { GATE_NONE } else { gate_code },
        gate,
        mode,
        volume: gate.volume(radar),
        probability,
    }
}

/// Appends the plots in any of the gates of `modes`; the distance is to the nearest of them.
fn search(
    gates: &[Gate; MODES],
    expected: &[Expected; MODES],
    modes: &[usize],
    time_ns: u64,
    plots: &[Measurement],
    candidates: &mut Vec<Candidate>,
) {
    for (plot, measurement) in plots.iter().enumerate() {
        let offset_s = common::units::seconds_between(time_ns, measurement.time_ns);
        let mut distance = f64::INFINITY;
        for &mode in modes {
            let offset = gates[mode].offset(measurement, &expected[mode].drift(offset_s));
            if gates[mode].holds(&offset, measurement) {
                distance = distance.min(gates[mode].distance(&offset, measurement));
            }
        }
        if distance < f64::INFINITY {
            candidates.push(Candidate { plot, offset_s, ratio: 1.0, alone: 1.0, distance });
        }
    }
}

/// ρ_c at the centre of the gate, and λ_m of every candidate.
///
/// With no candidate the density does not matter and 1 is returned. Hard decisions leave one candidate.
pub fn weigh<F: Fn(&[f64; COORDINATES]) -> FalsePlots>(
    selection: &Selection,
    surroundings: &Surroundings<'_, F>,
    plots: &[Measurement],
    rules: &Rules,
    candidates: &mut Vec<Candidate>,
) -> f64 {
    if candidates.is_empty() {
        return 1.0;
    }
    let parametric = rules.clutter == Clutter::Parametric;
    let reference = if parametric {
        (surroundings.clutter)(&selection.gate.centre).density
    } else {
        candidates.len() as f64 / selection.volume
    };
    for candidate in candidates.iter_mut() {
        let plot = &plots[candidate.plot];
        let with_statistics = rules.association != Association::Pda && plot.has_power;
        let here = (surroundings.clutter)(&plot.polar);
        let ratio = match surroundings.target {
            Some(target) if with_statistics => target.likelihood_ratio_in_clutter(plot.power, here.mean_excess),
            _ => 1.0,
        };
        candidate.alone = if parametric { ratio * reference / here.density } else { ratio };
        let rivals = surroundings.rivals.get(candidate.plot).copied().unwrap_or(0.0);
        candidate.ratio = candidate.alone / (1.0 + rivals);
    }
    let better = |a: &Candidate, b: &Candidate| match rules.association {
        Association::Nearest => a.distance < b.distance,
        Association::Strongest => plots[a.plot].power > plots[b.plot].power,
        Association::PdaStatistics | Association::Pda => false,
    };
    if matches!(rules.association, Association::Nearest | Association::Strongest) {
        let mut best = candidates[0];
        for candidate in &candidates[1..] {
            if better(candidate, &best) {
                best = *candidate;
            }
        }
        candidates.clear();
        candidates.push(best);
    }
    reference
}
