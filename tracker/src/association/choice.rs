//! Which plots are looked at, and how much each of them is (T10), (T12), (T13), (T15), (T20).
//!
//! ```text
//! e_jm = N(y_m; h(u*_j), D_j)
//! w_jm ∝ e_jm a_m,  w_j0 ∝ b_j,  normalised over m = 0…M;   L_j = b_j + Σ_m e_jm a_m            (T12)
//! a_m = λ_m D/ρ,   b_j = 1 − D P_Gj;   ρ: M/V (non-parametric) or the density of false plots at the plot (parametric)
//! M = 0:  L_j = 1 − D P_Gj                                                                 (T15)
//! ```
//!
//! This is (T12) over its ρ_c/D: plots are weighed against noise, as in (T20), where ℓ(q_m)/ρ₀(p_m) = λ_m D/ρ. In a gate that holds too
//! many false plots only the stronger ones are looked at, D in b_j is the probability of exceeding that threshold, and λ_m counts for as
//! many plots as exceed it (T20.2).
//!
//! Nearest and strongest neighbour leave one candidate, which is the target's for certain: b = 0.

use common::amplitude::{FalsePower, TargetStatistics};
use common::config::{Association, Clutter, GateRule, TrackerConfig};
use common::tracks::{GATE_MOST_PROBABLE, GATE_NONE, GATE_UNION, GATE_WIDEST, GATE_WIDEST_FALLBACK, MODELS};

use crate::association::gate::{self, Gate};
use crate::constants::FEW;
use crate::filter::most_probable;
use crate::plots::measurement::Measurement;
use crate::plots::radar::Radar;

/// How plots are chosen and weighted; the part of the configuration that the filter needs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rules {
    /// Which gate is searched (T10).
    pub gate_rule: GateRule,
    /// α of (T9).
    pub alpha: f64,
    /// W*_j above which a component's gate belongs to the union; 0 takes in all.
    pub union_probability: f64,
    /// C of (T20.2): false plots expected in the gate at most; 0 for no limit.
    pub gate_false_plots: f64,
    /// Whether P_G is taken for each component in the gate used (T13).
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

impl Rules {
    /// P_G of a gate about its own component, all coordinates together.
    pub fn own_probability(&self, radar: &Radar) -> f64 {
        self.gate_probability.unwrap_or_else(|| gate::own_probability(self.alpha, radar.dimensions()))
    }
}

/// A plot in the gate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Candidate {
    /// Index in the plots that were offered.
    pub plot: usize,
    /// Plot's time minus the prediction's, s.
    pub offset_s: f64,
    /// a_m, other tracks' claims included, m³·m/s.
    pub gain: f64,
    /// The same as if there were no other tracks.
    pub alone: f64,
    /// The components in whose gates it lies, a bit each.
    pub gates: u32,
    /// Sum of squared normalised offsets from the gate's centre (T9).
    pub distance: f64,
}

/// The gate in use and what it holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Selection {
    /// `GATE_…` of [`common::tracks`].
    pub gate_code: u32,
    /// The gate: of the searched component, or the largest of a union.
    pub gate: Gate,
    /// Component of that gate.
    pub component: usize,
    /// V, m³·m/s.
    pub volume: f64,
    /// Plots below this power were not looked at (T20.2); 0 without such a limit.
    pub threshold: f64,
    /// 1 − D P_Gj by component, D being the probability that the target's plot exceeds the threshold.
    pub missed: [f64; MODELS],
    /// That D.
    pub detection_probability: f64,
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
            Some(detector) if most > 0.0 && cells * detector.pfa > most => detector.power_exceeded_by(most / cells),
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
        let false_plots = || detector.false_share_above(selection.threshold, here.power);
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

impl<F: Fn(&Measurement) -> FalsePlots> Surroundings<'_, F> {
    /// ℓ(q)/ρ₀ of a plot, m³·m/s: what its density under the target is to be multiplied by to weigh it against noise (T20.4); `gate` is that of the
    /// best hypothesis, the same for all.
    pub fn ratio_to_noise(&self, plot: &Measurement, gate: GateLoad, rules: &Rules) -> f64 {
        let here = (self.clutter)(plot).crowded(gate);
        self.ratio(plot, here, rules) * self.detection_probability / here.density
    }

    /// λ of a plot among false plots `here`; 1 where power does not count or was not measured.
    fn ratio(&self, plot: &Measurement, here: FalsePlots, rules: &Rules) -> f64 {
        match self.target {
            Some(target) if rules.association.uses_power() && plot.has_power => {
                target.likelihood_ratio_among(plot.power, here.power)
            }
            _ => 1.0,
        }
    }
}

/// False plots to be expected at a place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FalsePlots {
    /// ρ_c in the measure of y, 1/(m³·m/s).
    pub density: f64,
    /// How strong they are.
    pub power: FalsePower,
}

impl FalsePlots {
    /// Where a gate holds many more plots than were to be expected, they are taken for false ones all over it: strobes, rain and interference
    /// that the map has not met here before. A few may be other targets' or a large target's.
    ///
    /// ```text
    /// ρ = max(ρ_c, (M − 3)/V)  where M − 3 > ρ_c V + 3 √(ρ_c V)
    /// ```
    #[must_use]
    pub fn crowded(self, gate: GateLoad) -> Self {
        let (crowd, expected) = (gate.plots.saturating_sub(FEW) as f64, self.density * gate.volume);
        if crowd > expected + 3.0 * expected.sqrt() { Self { density: crowd / gate.volume, ..self } } else { self }
    }
}

/// What a gate holds.
#[derive(Debug, Clone, Copy, Default)]
pub struct GateLoad {
    /// Plots, without those that only say what another says of two targets.
    pub plots: usize,
    /// V, m³·m/s.
    pub volume: f64,
}

impl GateLoad {
    /// Of a gate of volume `volume` with its candidates among `plots`.
    pub fn new(candidates: &[Candidate], plots: &[Measurement], volume: f64) -> Self {
        let plots = candidates.iter().filter(|candidate| !plots[candidate.plot].is_common).count();
        Self { plots, volume }
    }
}

/// What is asked for candidates: the components of a prediction.
#[derive(Debug, Clone, Copy)]
pub struct Prospect<'a> {
    /// W* by component.
    pub weights: &'a [f64],
    /// The components' gates.
    pub gates: &'a [Gate],
    /// The component whose gate is searched if another's is empty (T10).
    pub widest: usize,
    /// Time of the prediction, ns UTC.
    pub time_ns: u64,
    /// P_G of a component's own gate, as [`Rules::own_probability`] says.
    pub own_probability: f64,
}

/// Fills `candidates` with the plots in the gate that the rule names (T10).
pub fn select<F>(
    prospect: &Prospect<'_>,
    plots: &[Measurement],
    surroundings: &Surroundings<'_, F>,
    rules: &Rules,
    candidates: &mut Vec<Candidate>,
) -> Selection {
    let Prospect { weights, gates, widest, .. } = *prospect;
    let radar = surroundings.radar;
    let first = most_probable(weights);
    let mut joined = 1 << first;
    for (j, weight) in weights.iter().enumerate() {
        joined |= u32::from(*weight >= rules.union_probability) << j;
    }
    let mut volumes = [0.0; MODELS];
    for (volume, gate) in volumes.iter_mut().zip(gates) {
        *volume = gate.volume(radar);
    }
    let mut search = |searched: u32| {
        let is_searched = |j: usize| searched & 1 << j != 0;
        let mut component = first;
        for j in (0..gates.len()).filter(|&j| is_searched(j)) {
            if !is_searched(component) || volumes[j] > volumes[component] {
                component = j;
            }
        }
        let threshold = surroundings.scan_threshold(gates[component].cells(radar), rules.gate_false_plots);
        candidates.clear();
        append(prospect, searched, threshold, plots, rules, candidates);
        (component, threshold, !candidates.is_empty())
    };
    let only = |component: usize| 1 << component;
    let (gate_code, (component, threshold, found)) = match rules.gate_rule {
        GateRule::MostProbable => match search(only(first)) {
            (.., false) if first != widest => (GATE_WIDEST_FALLBACK, search(only(widest))),
            result => (GATE_MOST_PROBABLE, result),
        },
        GateRule::Widest => (GATE_WIDEST, search(only(widest))),
        GateRule::Union => (GATE_UNION, search(joined)),
    };
    let gate = gates[component];
    let detection_probability = surroundings.detection_probability_above(threshold);
    let mut missed = [1.0 - detection_probability * prospect.own_probability; MODELS];
    for (j, missed) in missed.iter_mut().enumerate().take(gates.len()) {
        if rules.gate_probability_by_mode && !(rules.gate_rule == GateRule::Union && joined & 1 << j != 0) {
            *missed = 1.0 - detection_probability * gate.probability(&gates[j], radar);
        }
    }
    Selection {
        gate_code: if found { gate_code } else { GATE_NONE },
        gate,
        component,
        volume: volumes[component],
        threshold,
        missed,
        detection_probability,
    }
}

/// Appends the plots of at least `threshold` in any of the gates that are `searched`; the distance, which only the nearest neighbour asks for,
/// is to the nearest of them.
fn append(
    prospect: &Prospect<'_>,
    searched: u32,
    threshold: f64,
    plots: &[Measurement],
    rules: &Rules,
    candidates: &mut Vec<Candidate>,
) {
    let asks_for_distance = rules.association == Association::Nearest;
    for (plot, measurement) in plots.iter().enumerate() {
        if measurement.has_power && measurement.power < threshold {
            continue;
        }
        let offset_s = common::units::seconds_between(prospect.time_ns, measurement.time_ns);
        let (mut distance, mut inside) = (f64::INFINITY, 0);
        for (j, gate) in prospect.gates.iter().enumerate() {
            let offset = gate.offset(measurement, offset_s);
            if gate.holds(&offset, measurement) {
                inside |= 1 << j;
                if asks_for_distance && searched & 1 << j != 0 {
                    distance = distance.min(gate.distance(&offset, measurement));
                }
            }
        }
        if inside & searched != 0 {
            candidates.push(Candidate { plot, offset_s, gain: 1.0, alone: 1.0, gates: inside, distance });
        }
    }
}

/// a_m of every candidate. Hard decisions leave one.
pub fn weigh<F: Fn(&Measurement) -> FalsePlots>(
    selection: &Selection,
    surroundings: &Surroundings<'_, F>,
    plots: &[Measurement],
    rules: &Rules,
    candidates: &mut Vec<Candidate>,
) {
    let parametric = rules.clutter == Clutter::Parametric;
    let load = GateLoad::new(candidates, plots, selection.volume);
    let of_gate = candidates.len() as f64 / selection.volume;
    for candidate in candidates.iter_mut() {
        let plot = &plots[candidate.plot];
        let with_statistics = rules.association.uses_power() && plot.has_power;
        let mut here = (surroundings.clutter)(plot);
        if selection.threshold <= 0.0 {
            here = here.crowded(load);
        }
        let above = if plot.has_power { surroundings.above(selection, here, with_statistics, parametric) } else { 1.0 };
        let density = if parametric { here.density } else { of_gate };
        let ratio = surroundings.ratio(plot, here, rules) * above;
        candidate.alone = ratio * surroundings.detection_probability / density;
        candidate.gain = candidate.alone * surroundings.share(candidate.plot);
    }
    let better = |a: &Candidate, b: &Candidate| match rules.association {
        Association::Nearest => a.distance < b.distance,
        Association::Strongest => plots[a.plot].power > plots[b.plot].power,
        _ => false,
    };
    if rules.association.decides() && !candidates.is_empty() {
        let mut best = candidates[0];
        for candidate in &candidates[1..] {
            if better(candidate, &best) {
                best = *candidate;
            }
        }
        candidates.clear();
        candidates.push(best);
    }
}
