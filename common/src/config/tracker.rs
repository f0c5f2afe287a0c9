//! `[tracker]`: filters, association, life cycle.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::load::{ConfigError, not_negative, positive, probability, require, within};
use super::{BandwidthConfig, BankConfig, Swerling, TurnConfig};

/// The family of filters that follow targets.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Estimator {
    /// Interacting modes of a drone: hover, near-constant velocity, manoeuvre (T1)-(T4).
    ImmUav,
    /// One Kalman filter of near-constant velocity.
    Cv,
    /// Interacting models of known turn rates (V1), (V2).
    ImmTurn,
    /// Three turn models whose rates follow the target (V3).
    AdaptiveGrid,
    /// Three turn models that step through known rates (V4).
    SwitchingGrid,
    /// Several hypotheses on the mean acceleration of each coordinate (M1)-(M3).
    MultiAlternative,
    /// One filter of correlated acceleration by coordinate whose bandwidth adapts (M4).
    AdaptiveBandwidth,
}

impl Estimator {
    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::ImmUav,
        Self::Cv,
        Self::ImmTurn,
        Self::AdaptiveGrid,
        Self::SwitchingGrid,
        Self::MultiAlternative,
        Self::AdaptiveBandwidth,
    ];
}

/// Which gate a track is searched in (T10).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum GateRule {
    /// The most probable model's; the widest model's if that one is empty.
    MostProbable,
    /// Always the widest model's: of the drone filter that of the manoeuvre, after which the key's value is named.
    #[serde(rename = "manoeuvre", alias = "widest")]
    Widest,
    /// Those of all models of some probability together; with probability 0 of all modes (T20.3).
    Union,
}

/// How plots in the gate are weighted (T12).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Association {
    /// Probabilistic data association with decision statistics.
    PdaStatistics,
    /// Probabilistic data association by positions alone.
    Pda,
    /// The plot at the smallest normalised distance.
    Nearest,
    /// The plot of the largest statistic.
    Strongest,
    /// Several hypotheses of which plots were the track's own, with decision statistics (T21).
    Mht,
}

impl Association {
    /// Whether one plot is taken for the target's, and no other.
    pub fn decides(self) -> bool {
        matches!(self, Self::Nearest | Self::Strongest)
    }

    /// Whether decision statistics count.
    pub fn uses_power(self) -> bool {
        self != Self::Pda
    }
}

/// Where the density of false plots comes from (T12).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Clutter {
    /// From the CFAR's design and the clutter map.
    Parametric,
    /// From the number of plots in the gate and its volume.
    NonParametric,
}

/// What makes a track confirmed and what ends it (T18).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Logic {
    /// The probability of existence.
    Existence,
    /// Counts of scans with and without a plot.
    MOfN,
}

/// Tracking. Numbers like (T9) refer to `docs/theory/imm-pda.md`, (V3) to `docs/theory/turns.md`, (M2) to
/// `docs/theory/acceleration.md`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct TrackerConfig {
    /// `imm-uav` (hover, near-constant velocity and manoeuvre of a drone), `cv` (one filter of near-constant velocity), or coordinated
    /// turns: `imm-turn` (known rates), `adaptive-grid` (three rates that follow the target), `switching-grid` (three of the known rates);
    /// or correlated acceleration: `multi-alternative` (several hypotheses on its mean), `adaptive-bandwidth` (one).
    pub estimator: Estimator,
    /// For `cv`: noise of its acceleration over a step, m/s².
    pub cv_noise_mps2: f64,
    /// For `imm-uav`: a₁: noise of the hover mode (T1), m/s.
    pub hover_noise_mps: f64,
    /// For `imm-uav`: a₂: noise of the near-constant-velocity mode (T1), m/s².
    pub velocity_noise_mps2: f64,
    /// For `imm-uav`: a₃: noise of the manoeuvre mode (T1), m/s³.
    pub manoeuvre_noise_mps3: f64,
    /// For `imm-uav`: probability that a target stays in its mode for 1 s.
    pub stay_probability: f64,
    /// `most-probable` (else the widest, the source's rule), `manoeuvre` (the widest model's) or `union` (T10).
    pub gate_rule: GateRule,
    /// For `union`: the gates of models above this probability; 0 searches all (T20.3).
    pub gate_union_probability: f64,
    /// Most false plots expected in the gate: in a larger gate weaker plots are ignored (T20.2); 0 for no limit.
    pub gate_false_plots: f64,
    /// α: half width of gates in standard deviations (T9).
    pub gate_alpha: f64,
    /// P_G of each mode in the gate in use (T13), or one for all; with the gates of all modes each has its own anyway.
    pub gate_probability_by_mode: bool,
    /// γ: inflation of the range rate's variance (T7).
    pub range_rate_inflation: f64,
    /// `pda-statistics`, `pda`, `nearest`, `strongest` (T12) or `mht` (T21).
    pub association: Association,
    /// For `mht`: hypotheses kept of each track.
    pub hypotheses: u32,
    /// Whether tracks take account of each other's claims to plots (joint events without coalescence).
    pub joint_association: bool,
    /// `parametric` or `non-parametric` clutter (T12).
    pub clutter: Clutter,
    /// Least density of false plots per resolution cell and scan, also where none were detected.
    pub clutter_floor: f64,
    /// Memory of the clutter map, scans; 0 for no map.
    pub clutter_map_scans: u32,
    /// Fluctuation of targets, for decision statistics (C4): `"0"`, `"I"` or `"III"`.
    pub swerling: Swerling,
    /// Signal-to-noise ratio expected of a new target, dB.
    pub snr_db: f64,
    /// Half width of the interval about the estimated ratio over which statistics are averaged, dB (T20.5).
    pub snr_spread_db: f64,
    /// Weight of the expected ratio against a track's own statistics, scans (T19); 0 never learns.
    pub snr_prior_scans: f64,
    /// Probability of detection where plots have no statistic, and its limit where they have.
    pub detection_probability: f64,
    /// Fastest target that starts a track, m/s.
    pub start_speed_mps: f64,
    /// New targets expected per resolution cell and scan: the prior of a pair of plots against false plots.
    pub start_density: f64,
    /// Probability of existence that two plots alone can give at most.
    pub start_existence: f64,
    /// Probability that a target still exists after one scan.
    pub survival_probability: f64,
    /// `existence` or `m-of-n` (T18).
    pub logic: Logic,
    /// Existence that confirms a track.
    pub confirm_existence: f64,
    /// Existence below which a track ends.
    pub delete_existence: f64,
    /// Scans with a plot, the two of the start included, before a track is confirmed.
    pub confirm_hits: u32,
    /// For `m-of-n`: scans from the start in which those hits must come.
    pub confirm_scans: u32,
    /// Scans in a row without a plot after which a tentative track ends.
    pub tentative_misses: u32,
    /// Scans in a row without a plot after which a confirmed track ends.
    pub confirmed_misses: u32,
    /// `[tracker.turn]`: filters of coordinated turns.
    pub turn: TurnConfig,
    /// `[tracker.bank]`: the filter of several hypotheses on acceleration.
    pub bank: BankConfig,
    /// `[tracker.bandwidth]`: the filter of one hypothesis whose bandwidth adapts.
    pub bandwidth: BandwidthConfig,
}

impl Default for TrackerConfig {
    fn default() -> Self {
        Self {
            estimator: Estimator::ImmUav,
            cv_noise_mps2: 3.0,
            hover_noise_mps: 0.9,
            velocity_noise_mps2: 0.8,
            manoeuvre_noise_mps3: 7.5,
            stay_probability: 0.89,
            gate_rule: GateRule::Union,
            gate_union_probability: 0.0,
            gate_false_plots: 100.0,
            gate_alpha: 3.5,
            gate_probability_by_mode: true,
            range_rate_inflation: 0.45,
            association: Association::PdaStatistics,
            hypotheses: 16,
            joint_association: true,
            clutter: Clutter::Parametric,
            clutter_floor: 1e-7,
            clutter_map_scans: 30,
            swerling: Swerling::One,
            snr_db: 14.0,
            snr_spread_db: 6.0,
            snr_prior_scans: 3.0,
            detection_probability: 0.95,
            start_speed_mps: 60.0,
            start_density: 1e-7,
            start_existence: 0.5,
            survival_probability: 0.998,
            logic: Logic::Existence,
            confirm_existence: 0.99,
            delete_existence: 0.02,
            confirm_hits: 3,
            confirm_scans: 5,
            tentative_misses: 3,
            confirmed_misses: 20,
            turn: TurnConfig::default(),
            bank: BankConfig::default(),
            bandwidth: BandwidthConfig::default(),
        }
    }
}

impl TrackerConfig {
    /// Checks every range.
    ///
    /// # Errors
    /// [`ConfigError`], naming the key and what was expected.
    pub fn check(&self) -> Result<(), ConfigError> {
        positive("tracker.cv_noise_mps2", self.cv_noise_mps2)?;
        positive("tracker.hover_noise_mps", self.hover_noise_mps)?;
        positive("tracker.velocity_noise_mps2", self.velocity_noise_mps2)?;
        positive("tracker.manoeuvre_noise_mps3", self.manoeuvre_noise_mps3)?;
        let stay = self.stay_probability;
        require("tracker.stay_probability", stay, stay > 0.34 && stay < 1.0, "a number above 0.34, below 1")?;
        let alpha = self.gate_alpha;
        require("tracker.gate_alpha", alpha, (1.0..=10.0).contains(&alpha), "a number from 1 to 10")?;
        let union = self.gate_union_probability;
        require("tracker.gate_union_probability", union, (0.0..1.0).contains(&union), "a number from 0, below 1")?;
        let most = self.gate_false_plots;
        require(
            "tracker.gate_false_plots",
            most,
            most == 0.0 || (0.01..=1e9).contains(&most),
            "0 or a number from 0.01 to 1e9",
        )?;
        not_negative("tracker.range_rate_inflation", self.range_rate_inflation)?;
        within("tracker.hypotheses", self.hypotheses.into(), 1..=256)?;
        probability("tracker.clutter_floor", self.clutter_floor)?;
        within("tracker.clutter_map_scans", self.clutter_map_scans.into(), 0..=100_000)?;
        let snr = self.snr_db;
        require("tracker.snr_db", snr, (0.0..=60.0).contains(&snr), "a number from 0 to 60")?;
        let spread = self.snr_spread_db;
        require("tracker.snr_spread_db", spread, (0.0..=30.0).contains(&spread), "a number from 0 to 30")?;
        not_negative("tracker.snr_prior_scans", self.snr_prior_scans)?;
        probability("tracker.detection_probability", self.detection_probability)?;
        positive("tracker.start_speed_mps", self.start_speed_mps)?;
        probability("tracker.start_density", self.start_density)?;
        probability("tracker.start_existence", self.start_existence)?;
        probability("tracker.survival_probability", self.survival_probability)?;
        probability("tracker.confirm_existence", self.confirm_existence)?;
        let delete = self.delete_existence;
        let valid = delete > 0.0 && delete < self.start_existence && delete < self.confirm_existence;
        require("tracker.delete_existence", delete, valid, "a probability below start and confirm existence")?;
        within("tracker.confirm_hits", self.confirm_hits.into(), 2..=1000)?;
        within("tracker.confirm_scans", self.confirm_scans.into(), u64::from(self.confirm_hits)..=1000)?;
        within("tracker.tentative_misses", self.tentative_misses.into(), 1..=1000)?;
        within("tracker.confirmed_misses", self.confirmed_misses.into(), 1..=1000)?;
        self.turn.check()?;
        self.bank.check()?;
        self.bandwidth.check()
    }
}
