//! Which plot is the track's: weights of the plots in the gate (T10), (T12), (T13), (T15), (T20).
//!
//! ```text
//! e_jm = N(y_m; h(u*_j), D_j)
//! w_jm ∝ e_jm λ_m,  w_j0 ∝ b_j,  normalised over m = 0…M;   L_j = b_j + Σ_m e_jm λ_m      (T12)
//! b_j = ρ_c (1 − D P_Gj)/D,  ρ_c: M/V (non-parametric) or the radar's density (parametric)
//! M = 0:  L_j = 1 − D P_Gj                                                                 (T15)
//! ```
//!
//! (T20) is the rule `union` of all modes with parametric clutter: with λ/ρ_c = ℓ/(D ρ₀) the weights are those of
//! b_j = 1 − D P_G, e_jm ℓ(q_m)/ρ₀(p_m). In a gate that holds too many false plots only the stronger ones are looked at, D
//! in b_j is the probability of exceeding that threshold, and λ_m counts for as many plots as exceed it (T20.2).
//!
//! Clutter that varies over the gate enters by λ_m: it is multiplied by ρ_c over the density at the
//! plot. Nearest and strongest neighbour are the same with one candidate, λ = 1 and b = 0.

use common::amplitude::{TargetStatistics, ca_cfar_factor};
use common::config::{Association, Clutter, GateRule, TrackerConfig};
use common::tracks::{GATE_MANOEUVRE, GATE_MANOEUVRE_FALLBACK, GATE_MOST_PROBABLE, GATE_NONE, GATE_UNION};

use crate::association::gate::{self, Gate, Radar};
use crate::filter::uav::imm::Imm;
use crate::filter::uav::motion::{MANOEUVRE, MODES};
use crate::plots::measurement::{COORDINATES, Measurement};

/// How plots are chosen and weighted; the part of the configuration that the filter needs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rules {
    /// Which gate is searched (T10).
    pub gate_rule: GateRule,
    /// α of (T9).
    pub alpha: f64,
    /// W*_j above which a mode's gate belongs to the union; 0 takes in all.
    pub union_probability: f64,
    /// C of (T20.2): false plots expected in the gate at most; 0 for no limit.
    pub gate_false_plots: f64,
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
            union_probability: config.gate_union_probability,
            gate_false_plots: config.gate_false_plots,
            gate_probability_by_mode: config.gate_probability_by_mode,
            gate_probability: None,
            association: config.association,
            clutter: config.clutter,
            inflation: config.range_rate_inflation,
        }
    }
}

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
    /// Plots below this power were not looked at (T20.2); 0 without such a limit.
    pub threshold: f64,
    /// D: probability that the target's plot exceeds it.
    pub detection_probability: f64,
}

impl Selection {
    /// 1 − D P_Gj by mode.
    pub fn missed(&self) -> [f64; MODES] {
        self.probability.map(|p_g| 1.0 - self.detection_probability * p_g)
    }
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
    /// What each plot is worth among other tracks that want it, see [`crate::association::joint`]; empty without.
    pub shares: &'a [f64],
    /// The clutter at (r, β, ε, ṙ).
    pub clutter: F,
}

impl<F> Surroundings<'_, F> {
    /// t of (T20.2): 0, or the power that at most `most` of `cells` cells of noise exceed.
    ///
    /// ```text
    /// t:  P_N(q > t) = C/U  where U F > C
    /// ```
    pub fn scan_threshold(&self, cells: f64, most: f64) -> f64 {
        match self.target.map(TargetStatistics::detector) {
            Some(detector) if most > 0.0 && cells * detector.pfa > most => {
                ca_cfar_factor(detector.reference_cells, most / cells)
            }
            _ => 0.0,
        }
    }

    /// Share of a plot, 1 without rivals.
    pub fn share(&self, plot: usize) -> f64 {
        self.shares.get(plot).copied().unwrap_or(1.0)
    }

    /// What λ/ρ_c of a plot is to be multiplied by where only plots of at least t are looked at: with statistics ℓ knows of no
    /// threshold, but M/V counts the plots above t only; without, a plot is one of fewer false and fewer true ones (T20.2).
    ///
    /// ```text
    /// with statistics       1  (parametric)              F(t)/F   (non-parametric)
    /// without               F/F(t) · D(t)/D              D(t)/D
    /// ```
    fn above(&self, selection: &Selection, here: FalsePlots, with_statistics: bool, parametric: bool) -> f64 {
        let Some(detector) = self.target.map(TargetStatistics::detector) else { return 1.0 };
        if selection.threshold <= detector.threshold {
            return 1.0;
        }
        let false_plots = || detector.false_share_above(selection.threshold, here.mean_excess);
        let target = selection.detection_probability / self.detection_probability;
        match (with_statistics, parametric) {
            (true, true) => 1.0,
            (true, false) => false_plots(),
            (false, true) => target / false_plots(),
            (false, false) => target,
        }
    }

    /// D for plots of at least `threshold`.
    fn detection_probability_above(&self, threshold: f64) -> f64 {
        match self.target {
            Some(target) if threshold > 0.0 => self.detection_probability.min(target.survival(threshold)),
            _ => self.detection_probability,
        }
    }
}

impl<F: Fn(&[f64; COORDINATES]) -> FalsePlots> Surroundings<'_, F> {
    /// ℓ(q)/ρ₀ of a plot, m³·m/s: what its density under the target is to be multiplied by to weigh it against noise (T20.4).
    pub fn ratio_to_noise(&self, plot: &Measurement, rules: &Rules) -> f64 {
        let here = (self.clutter)(&plot.polar);
        let ratio = match self.target {
            Some(target) if rules.association.uses_power() && plot.has_power => {
                target.likelihood_ratio_in_clutter(plot.power, here.mean_excess)
            }
            _ => 1.0,
        };
        ratio * self.detection_probability / here.density
    }
}

/// False plots to be expected at a place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FalsePlots {
    /// ρ_c in the measure of y, 1/(m³·m/s).
    pub density: f64,
    /// Mean of q − t₀ above the threshold; 0 for that of noise.
    pub mean_excess: f64,
}

/// Fills `candidates` with the plots in the gate that the rule names (T10). `gates` are the modes' own, `time_ns` is that of the prediction.
pub fn select<F>(
    prediction: &Imm,
    gates: &[Gate; MODES],
    time_ns: u64,
    plots: &[Measurement],
    surroundings: &Surroundings<'_, F>,
    rules: &Rules,
    candidates: &mut Vec<Candidate>,
) -> Selection {
    let radar = surroundings.radar;
    let first = prediction.most_probable();
    let joined: [bool; MODES] =
        std::array::from_fn(|j| j == first || prediction.probability[j] >= rules.union_probability);
    let mut search = |searched: [bool; MODES]| {
        let mut mode = first;
        for j in (0..MODES).filter(|&j| searched[j]) {
            if !searched[mode] || gates[j].volume(radar) > gates[mode].volume(radar) {
                mode = j;
            }
        }
        let threshold = surroundings.scan_threshold(gates[mode].cells(radar), rules.gate_false_plots);
        candidates.clear();
        append(gates, searched, threshold, time_ns, plots, candidates);
        (mode, threshold, !candidates.is_empty())
    };
    let only = |mode: usize| std::array::from_fn(|j| j == mode);
    let (gate_code, (mode, threshold, found)) = match rules.gate_rule {
        GateRule::MostProbable => match search(only(first)) {
            (.., false) if first != MANOEUVRE => (GATE_MANOEUVRE_FALLBACK, search(only(MANOEUVRE))),
            result => (GATE_MOST_PROBABLE, result),
        },
        GateRule::Manoeuvre => (GATE_MANOEUVRE, search(only(MANOEUVRE))),
        GateRule::Union => (GATE_UNION, search(joined)),
    };
    let gate = gates[mode];
    let own = rules.gate_probability.unwrap_or_else(|| gate::own_probability(rules.alpha, radar.dimensions()));
    let by_mode = |j: usize| rules.gate_probability_by_mode && !(rules.gate_rule == GateRule::Union && joined[j]);
    Selection {
        gate_code: if found { gate_code } else { GATE_NONE },
        gate,
        mode,
        volume: gate.volume(radar),
        probability: std::array::from_fn(|j| if by_mode(j) { gate.probability(&gates[j], radar) } else { own }),
        threshold,
        detection_probability: surroundings.detection_probability_above(threshold),
    }
}

/// Appends the plots of at least `threshold` in any of the gates that are `searched`; the distance is to the nearest of them.
fn append(
    gates: &[Gate; MODES],
    searched: [bool; MODES],
    threshold: f64,
    time_ns: u64,
    plots: &[Measurement],
    candidates: &mut Vec<Candidate>,
) {
    for (plot, measurement) in plots.iter().enumerate() {
        if measurement.has_power && measurement.power < threshold {
            continue;
        }
        let offset_s = common::units::seconds_between(time_ns, measurement.time_ns);
        let mut distance = f64::INFINITY;
        for mode in (0..MODES).filter(|&mode| searched[mode]) {
            let offset = gates[mode].offset(measurement, offset_s);
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
        let with_statistics = rules.association.uses_power() && plot.has_power;
        let here = (surroundings.clutter)(&plot.polar);
        let ratio = match surroundings.target {
            Some(target) if with_statistics => target.likelihood_ratio_in_clutter(plot.power, here.mean_excess),
            _ => 1.0,
        };
        let above = if plot.has_power { surroundings.above(selection, here, with_statistics, parametric) } else { 1.0 };
        let ratio = ratio * above;
        candidate.alone = if parametric { ratio * reference / here.density } else { ratio };
        candidate.ratio = candidate.alone * surroundings.share(candidate.plot);
    }
    let better = |a: &Candidate, b: &Candidate| match rules.association {
        Association::Nearest => a.distance < b.distance,
        Association::Strongest => plots[a.plot].power > plots[b.plot].power,
        _ => false,
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
