//! One track on one target for one run: the tracker's own filter, scan by scan.

use common::amplitude::Detector;
use common::config::{Association, Clutter, GateRule, TrackerConfig};
use common::random::{Purpose, generator};
use tracker::amplitude::Amplitude;
use tracker::association::{FalsePlots, Rules, Surroundings};
use tracker::gate::{Gate, Radar};
use tracker::hypotheses::{Hypotheses, Room};
use tracker::imm::{Imm, transition};
use tracker::measurement::{COORDINATES, Expected, Measurement};
use tracker::motion::{MANOEUVRE, MODES, Motion};
use tracker::start::two_plots;
use tracker::track::Kinematics;
use tracker::update::{Workspace, update};

use crate::world::{Conditions, Region, Sight, add_false_plots, distance_m, radar};

/// Scans running outside the gate, or beyond the distance, that lose a track.
pub const LOST_SCANS: u32 = 3;
/// Position error that counts as lost where it lasts, m.
pub const LOST_DISTANCE_M: f64 = 150.0;
/// False plots expected in the gate above which the source gives a track up.
pub const MOST_FALSE_PLOTS: f64 = 2000.0;
/// α of a gate that holds everything.
const WITHOUT_GATE: f64 = 100.0;
/// Mode probabilities at the start.
pub const START_PROBABILITY: [f64; MODES] = [0.33, 0.34, 0.33];

/// The settings of \[L22\] for `conditions`: one mode's gate, density M/V, SNR known.
pub fn source_settings(conditions: &Conditions) -> TrackerConfig {
    TrackerConfig {
        gate_rule: GateRule::MostProbable,
        gate_union_probability: 0.0,
        gate_false_plots: 0.0,
        hover_noise_mps: 1.0,
        velocity_noise_mps2: 1.0,
        manoeuvre_noise_mps3: 7.0,
        gate_alpha: 3.0,
        stay_probability: 0.9,
        gate_probability_by_mode: false,
        range_rate_inflation: 0.8,
        clutter: Clutter::NonParametric,
        swerling: conditions.swerling,
        snr_db: conditions.snr_db,
        snr_spread_db: 0.0,
        snr_prior_scans: 0.0,
        detection_probability: 1.0 - 1e-12,
        ..TrackerConfig::default()
    }
}

/// What one scan did.
#[derive(Debug, Clone, Copy)]
pub struct ScanRecord {
    /// Predicted position minus truth, ENU, m.
    pub predicted_error_m: [f64; 3],
    /// Estimated position minus truth, ENU, m.
    pub position_error_m: [f64; 3],
    /// Estimated velocity minus truth, ENU, m/s.
    pub velocity_error_mps: [f64; 3],
    /// Standard deviations that the filter states for the estimated position, m.
    pub position_sd_m: [f64; 3],
    /// ν' P⁻¹ ν of the position.
    pub nees_position: f64,
    /// W.
    pub probability: [f64; MODES],
    /// Whether the target's measured place, detected or not, lies in the gate in use.
    pub in_gate: bool,
    /// The gate in use.
    pub gate: Gate,
    /// Plots in it.
    pub plots_in_gate: usize,
    /// ln Σ_j W*_j L_j in units of clutter: the step of the track's score (T20.6).
    pub ln_evidence: f64,
}

/// A run.
#[derive(Debug, Clone)]
pub struct RunRecord {
    /// By scan, from k = 1; ends early if the source would give the track up.
    pub scans: Vec<ScanRecord>,
    /// Scan at which the target had been outside the gate for three scans, or the gate had grown too large.
    pub lost_at: Option<u32>,
    /// Whether the position was wrong by more than 150 m in three scans running.
    pub strayed: bool,
}

/// A track in the making.
pub struct Follower {
    config: TrackerConfig,
    rules: Rules,
    motion: Motion,
    radar: Radar,
    detector: Detector,
    workspace: Workspace,
    room: Room,
    plots: Vec<Measurement>,
}

impl Follower {
    /// With the settings of the tracker.
    pub fn new(config: &TrackerConfig, conditions: &Conditions) -> Self {
        let radar = radar();
        let mut rules = Rules::new(config);
        if conditions.pfa <= 0.0 {
            // The one plot is the target's: no gate, nothing else that it could be.
            rules.alpha = WITHOUT_GATE;
            rules.gate_probability = Some(1.0);
            rules.gate_probability_by_mode = false;
            rules.gate_false_plots = 0.0;
        }
        Self {
            rules,
            motion: Kinematics::new(config, &radar).motion,
            radar,
            detector: conditions.detector(),
            workspace: Workspace::default(),
            room: Room::default(),
            plots: Vec::new(),
            config: config.clone(),
        }
    }

    /// Follows one target; `gives_up` as the source does.
    pub fn run(&mut self, sights: &[Sight], conditions: &Conditions, seed: u64, run: u32) -> RunRecord {
        let (first, second) = (&sights[0].plot, &sights[1].plot);
        let mht = self.config.association == Association::Mht;
        let mut posterior = two_plots(first, second, 1.0, &self.motion, START_PROBABILITY);
        let mut amplitude = Amplitude::prior(&self.config, &self.detector);
        for plot in [first, second] {
            amplitude.learn(plot.power, 1.0, &self.detector);
        }
        let mut hypotheses = Hypotheses::new(&posterior, self.config.hypotheses as usize);
        let chain = transition(self.config.stay_probability, 1.0);
        let mut record = RunRecord { scans: Vec::with_capacity(sights.len()), lost_at: None, strayed: false };
        let (mut outside, mut beyond) = (0, 0);
        for (scan, sight) in sights.iter().enumerate().skip(2) {
            let prediction = posterior.predict(&chain, &self.motion, 1.0);
            let mut rng = generator(seed, Purpose::Clutter, run, scan as u32);
            amplitude.look(&self.config, &self.detector);
            let expected: [Expected; MODES] = std::array::from_fn(|j| Expected::new(j, &prediction.modes[j]));
            let gates = expected.map(|expected| Gate::new(&expected, &self.radar, self.rules.alpha));
            let statistics = *amplitude.statistics();
            let cells: f64 = self.radar.cell.iter().product();
            let pfa = conditions.pfa.max(1e-300);
            let surroundings = Surroundings {
                radar: &self.radar,
                detection_probability: if conditions.pfa > 0.0 {
                    statistics.detection_probability.min(self.config.detection_probability)
                } else {
                    1.0 - 1e-12
                },
                target: Some(&statistics),
                shares: &[],
                clutter: |polar: &[f64; COORDINATES]| FalsePlots {
                    density: pfa.max(1e-12) / cells / (polar[0] * polar[0] * polar[2].cos().max(1e-3)),
                    mean_excess: 0.0,
                },
            };
            self.plots.clear();
            if sight.detected {
                self.plots.push(sight.plot);
            }
            let region = |mode: usize| Region { centre: gates[mode].centre, half: gates[mode].half };
            let given_up = conditions.pfa > 0.0 && self.rules.gate_false_plots <= 0.0 && {
                let first = prediction.most_probable();
                let mode = if self.rules.gate_rule == GateRule::MostProbable { first } else { MANOEUVRE };
                gates[mode].cells(&self.radar) * conditions.pfa > MOST_FALSE_PLOTS
            };
            if given_up {
                record.lost_at.get_or_insert(scan as u32 - 1);
            } else if conditions.pfa > 0.0 {
                match self.rules.gate_rule {
                    GateRule::MostProbable => {
                        let first = region(prediction.most_probable());
                        add_false_plots(&first, self.detector.threshold, &mut rng, &mut self.plots);
                        if !self.plots.iter().any(|plot| first.holds(&plot.polar)) {
                            let from = self.plots.len();
                            add_false_plots(&region(MANOEUVRE), self.detector.threshold, &mut rng, &mut self.plots);
                            let mut index = 0;
                            self.plots.retain(|plot| {
                                index += 1;
                                index <= from || !first.holds(&plot.polar)
                            });
                        }
                    }
                    GateRule::Manoeuvre => {
                        add_false_plots(&region(MANOEUVRE), self.detector.threshold, &mut rng, &mut self.plots);
                    }
                    GateRule::Union => {
                        let joined = |imm: &Imm| {
                            let gates: [Gate; MODES] = std::array::from_fn(|j| {
                                Gate::new(&Expected::new(j, &imm.modes[j]), &self.radar, self.rules.alpha)
                            });
                            let cells = gates.iter().map(|gate| gate.cells(&self.radar)).fold(0.0, f64::max);
                            let [first, second, third] =
                                gates.map(|gate| Region { centre: gate.centre, half: gate.half });
                            let threshold = surroundings.scan_threshold(cells, self.rules.gate_false_plots);
                            (first.join(&second).join(&third), threshold.max(self.detector.threshold))
                        };
                        let mut regions: Vec<(Region, f64)> = if mht {
                            hypotheses
                                .filters()
                                .map(|filter| joined(&filter.predict(&chain, &self.motion, 1.0)))
                                .collect()
                        } else {
                            vec![joined(&prediction)]
                        };
                        regions.sort_by(|a, b| a.1.total_cmp(&b.1));
                        for (index, (region, threshold)) in regions.iter().enumerate() {
                            let from = self.plots.len();
                            add_false_plots(region, *threshold, &mut rng, &mut self.plots);
                            let mut count = 0;
                            self.plots.retain(|plot| {
                                count += 1;
                                count <= from || !regions[..index].iter().any(|(earlier, _)| earlier.holds(&plot.polar))
                            });
                        }
                    }
                }
            }
            if given_up {
                self.plots.clear();
            }
            let outcome = if mht {
                hypotheses.predict(&chain, &self.motion, 1.0);
                hypotheses.update(0, &self.plots, &surroundings, &self.rules, &mut self.workspace, &mut self.room)
            } else {
                update(&prediction, 0, &self.plots, &surroundings, &self.rules, &mut self.workspace)
            };
            for (candidate, weights) in self.workspace.candidates.iter().zip(&self.workspace.weights) {
                let weight: f64 = (0..MODES).map(|j| outcome.posterior.probability[j] * weights[j]).sum();
                let plot = &self.plots[candidate.plot];
                amplitude.learn(plot.power, weight, &self.detector);
            }
            posterior = outcome.posterior;
            let holds = |gate: &Gate| gate.holds(&gate.offset(&sight.plot, 0.0), &sight.plot);
            let in_gate = match self.rules.gate_rule {
                GateRule::Union => gates.iter().any(holds),
                GateRule::MostProbable if outcome.plots_in_gate == 0 => holds(&outcome.selection.gate),
                _ => holds(&outcome.selection.gate),
            };
            outside = if in_gate { 0 } else { outside + 1 };
            let scan_record = describe(&prediction, &posterior, sight, in_gate, &outcome);
            beyond =
                if distance_m(posterior.mixture().position(), &sight.truth) > LOST_DISTANCE_M { beyond + 1 } else { 0 };
            record.strayed |= beyond >= LOST_SCANS;
            if outside >= LOST_SCANS {
                record.lost_at.get_or_insert(scan as u32 - 1);
            }
            record.scans.push(scan_record);
        }
        record
    }
}

fn describe(
    prediction: &Imm,
    posterior: &Imm,
    sight: &Sight,
    in_gate: bool,
    outcome: &tracker::update::Outcome,
) -> ScanRecord {
    let (predicted, estimate) = (prediction.mixture(), posterior.mixture());
    let truth = &sight.truth;
    let position_error_m: [f64; 3] = std::array::from_fn(|i| estimate.mean[i] - truth.position_m[i]);
    let p = &estimate.covariance;
    let covariance = nalgebra::Matrix3::new(p[0], p[1], p[3], p[1], p[2], p[4], p[3], p[4], p[5]);
    let error = nalgebra::Vector3::from(position_error_m);
    ScanRecord {
        predicted_error_m: std::array::from_fn(|i| predicted.mean[i] - truth.position_m[i]),
        position_error_m,
        velocity_error_mps: std::array::from_fn(|i| estimate.mean[3 + i] - truth.velocity_mps[i]),
        position_sd_m: [p[0].sqrt(), p[2].sqrt(), p[5].sqrt()],
        nees_position: covariance.cholesky().map_or(f64::NAN, |factor| error.dot(&factor.solve(&error))),
        probability: posterior.probability,
        in_gate,
        gate: outcome.selection.gate,
        plots_in_gate: outcome.plots_in_gate,
        ln_evidence: outcome.existence_ratio.ln(),
    }
}
