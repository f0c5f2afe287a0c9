//! `tracks`: the tracks that could be brought up to date by the plots of one sector.

use std::io;

use iceoryx2::prelude::ZeroCopySend;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_big_array::BigArray;

use crate::message::{Header, Lineage, Place, Stamps};
use crate::recording::row::{Row, Table, Value, put_all};

/// Most tracks in one message; tentative ones are left out first, and counted.
pub const MAX_TRACKS: usize = 256;

/// Length of the state vector [x ẋ ẍ y ẏ ÿ z ż z̈].
pub const STATE: usize = 9;
/// Elements of the packed upper triangle of a 9×9 covariance.
pub const PACKED: usize = STATE * (STATE + 1) / 2;
/// Models of a target's motion that [`Track`] has room for.
pub const MODELS: usize = 8;

/// [`Track::estimator`]: interacting modes of a drone.
pub const ESTIMATOR_IMM_UAV: u16 = 1;
/// [`Track::estimator`]: one Kalman filter of near-constant velocity.
pub const ESTIMATOR_CV: u16 = 2;
/// [`Track::estimator`]: interacting models of known turn rates.
pub const ESTIMATOR_IMM_TURN: u16 = 3;
/// [`Track::estimator`]: three turn models whose rates follow the target.
pub const ESTIMATOR_ADAPTIVE_GRID: u16 = 4;
/// [`Track::estimator`]: three turn models that step through known rates.
pub const ESTIMATOR_SWITCHING_GRID: u16 = 5;
/// [`Track::estimator`]: several hypotheses on the mean acceleration of each coordinate.
pub const ESTIMATOR_MULTI_ALTERNATIVE: u16 = 6;
/// [`Track::estimator`]: correlated acceleration by coordinate, of a bandwidth that adapts.
pub const ESTIMATOR_ADAPTIVE_BANDWIDTH: u16 = 7;

/// [`Track::estimator`]: tracks of several sites, fused.
pub const ESTIMATOR_FUSION: u16 = 100;

/// [`Track::model_kind`]: no model.
pub const KIND_NONE: u16 = 0;
/// [`Track::model_kind`]: standing in the air.
pub const KIND_HOVER: u16 = 1;
/// [`Track::model_kind`]: near-constant velocity.
pub const KIND_CONSTANT_VELOCITY: u16 = 2;
/// [`Track::model_kind`]: accelerating, as a manoeuvre.
pub const KIND_MANOEUVRE: u16 = 3;
/// [`Track::model_kind`]: coordinated turn; its parameter is the turn rate, rad/s, positive from east towards north (to port).
pub const KIND_COORDINATED_TURN: u16 = 4;
/// [`Track::model_kind`]: acceleration about a mean; its parameter is that mean, m/s².
pub const KIND_MEAN_ACCELERATION: u16 = 5;

/// Name of an [`Track::estimator`], as `tracker.estimator` spells it.
pub fn estimator_name(estimator: u16) -> Option<&'static str> {
    match estimator {
        ESTIMATOR_IMM_UAV => Some("imm-uav"),
        ESTIMATOR_CV => Some("cv"),
        ESTIMATOR_IMM_TURN => Some("imm-turn"),
        ESTIMATOR_ADAPTIVE_GRID => Some("adaptive-grid"),
        ESTIMATOR_SWITCHING_GRID => Some("switching-grid"),
        ESTIMATOR_MULTI_ALTERNATIVE => Some("multi-alternative"),
        ESTIMATOR_ADAPTIVE_BANDWIDTH => Some("adaptive-bandwidth"),
        ESTIMATOR_FUSION => Some("fusion"),
        _ => None,
    }
}

/// Name of a [`Track::model_kind`].
pub fn kind_name(kind: u16) -> Option<&'static str> {
    match kind {
        KIND_HOVER => Some("hover"),
        KIND_CONSTANT_VELOCITY => Some("constant_velocity"),
        KIND_MANOEUVRE => Some("manoeuvre"),
        KIND_COORDINATED_TURN => Some("coordinated_turn"),
        KIND_MEAN_ACCELERATION => Some("mean_acceleration"),
        _ => None,
    }
}

/// [`Track::state_code`]: started, not yet believed.
pub const TENTATIVE: u32 = 0;
/// [`Track::state_code`]: believed and seen in its last scan.
pub const CONFIRMED: u32 = 1;
/// [`Track::state_code`]: believed, but without a plot in its last scan.
pub const COASTING: u32 = 2;
/// [`Track::state_code`]: ended; this is its last message.
pub const TERMINATED: u32 = 3;

/// Name of a [`Track::state_code`].
pub fn state_name(state_code: u32) -> &'static str {
    match state_code {
        TENTATIVE => "tentative",
        CONFIRMED => "confirmed",
        COASTING => "coasting",
        _ => "terminated",
    }
}

/// Name of a [`Track::gate_code`].
pub fn gate_name(gate_code: u32) -> &'static str {
    match gate_code {
        GATE_MOST_PROBABLE => "most_probable",
        GATE_WIDEST_FALLBACK => "widest_fallback",
        GATE_WIDEST => "widest",
        GATE_UNION => "union",
        _ => "none",
    }
}

/// [`Track::gate_code`]: no plot was looked for or found.
pub const GATE_NONE: u32 = 0;
/// [`Track::gate_code`]: gate of the most probable model.
pub const GATE_MOST_PROBABLE: u32 = 1;
/// [`Track::gate_code`]: the widest model's gate, searched because the first was empty.
pub const GATE_WIDEST_FALLBACK: u32 = 2;
/// [`Track::gate_code`]: the widest model's gate, by rule.
pub const GATE_WIDEST: u32 = 3;
/// [`Track::gate_code`]: several models' gates together.
pub const GATE_UNION: u32 = 4;

/// Plots that [`Track::used`] has room for.
pub const USED_PLOTS: usize = 6;

/// A plot that took part in the last update of a track.
#[derive(Debug, Default, Clone, Copy, PartialEq, Serialize, Deserialize, ZeroCopySend, JsonSchema)]
#[type_name("radar/UsedPlot/1")]
#[repr(C)]
pub struct UsedPlot {
    /// `seq` of the plots message that holds it.
    pub seq: u64,
    /// Its index in that message.
    pub index: u32,
    /// Probability that it is the track's.
    pub weight: f32,
    /// Bit j is set if it lies in the gate of model j of the filter.
    pub gates: u32,
    /// Always 0: no undefined bytes.
    pub reserved: u32,
}

impl UsedPlot {
    /// No plot.
    pub const NONE: Self = Self { seq: 0, index: 0, weight: 0.0, gates: 0, reserved: 0 };
}

/// What a filter says of a target's way to move, for [`Track`].
#[derive(Debug, Default, Clone, Copy, PartialEq)]
pub struct Models {
    /// Models in use.
    pub count: usize,
    /// `KIND_…` of each.
    pub kind: [u16; MODELS],
    /// Probability of each.
    pub probability: [f64; MODELS],
    /// Parameter of each, by kind; 0 where it has none.
    pub parameter: [f64; MODELS],
}

impl Models {
    /// Kind of the most probable model (the first of equals).
    pub fn most_probable(&self) -> u16 {
        let of = |j: usize| self.probability[j];
        self.kind[(1..self.count).fold(0, |best, j| if of(j) > of(best) { j } else { best })]
    }

    /// Adds a model. Of more than there is room for, the last are left out.
    pub fn push(&mut self, kind: u16, probability: f64, parameter: f64) {
        if self.count < MODELS {
            self.kind[self.count] = kind;
            self.probability[self.count] = probability;
            self.parameter[self.count] = parameter;
            self.count += 1;
        }
    }
}

/// State of one track at [`Track::time_ns`], in ENU about the antenna; m, m/s, m/s².
///
/// Order of the states: [x ẋ ẍ y ẏ ÿ z ż z̈]; the filter knows the first [`Track::known`] of [x y z ẋ ẏ ż ẍ ÿ z̈], the rest is 0.
/// Covariances are packed upper triangles, row by row (see [`pack`]).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ZeroCopySend, JsonSchema)]
#[type_name("radar/Track/3")]
#[repr(C)]
pub struct Track {
    /// Time of the state: when the beam passed the track, ns UTC.
    pub time_ns: u64,
    /// Number of the track, never used again in a session.
    pub id: u64,
    /// Mean of all models together (MMSE).
    pub state: [f64; STATE],
    /// Covariance of all models together.
    #[serde(with = "BigArray")]
    #[schemars(with = "Vec<f64>")]
    pub covariance: [f64; PACKED],
    /// The same for this time before the plots of the scan: what exact fusion needs. Of a track that has just started, that of the start.
    pub predicted_state: [f64; STATE],
    /// Covariance of that prediction.
    #[serde(with = "BigArray")]
    #[schemars(with = "Vec<f64>")]
    pub predicted_covariance: [f64; PACKED],
    /// Mean of the most probable component of the filter.
    pub model_state: [f64; STATE],
    /// Covariance of the most probable component of the filter.
    #[serde(with = "BigArray")]
    #[schemars(with = "Vec<f64>")]
    pub model_covariance: [f64; PACKED],
    /// Probability of each model.
    pub model_probability: [f64; MODELS],
    /// Parameter of each model, by kind; 0 where it has none.
    pub model_parameter: [f64; MODELS],
    /// Probability that the track follows a target (T18).
    pub existence: f64,
    /// Volume of the gate, m³·m/s (fewer dimensions where plots have fewer).
    pub gate_volume: f64,
    /// Weight of "no plot in the gate is mine".
    pub weight_none: f64,
    /// Weight of the best plot.
    pub weight_best: f64,
    /// `seq` of the plots message that holds the best plot.
    pub best_plot_seq: u64,
    /// Index of the best plot in that message; `u32::MAX` without one.
    pub best_plot_index: u32,
    /// Plots in the gate.
    pub plots_in_gate: u32,
    /// [`TENTATIVE`], [`CONFIRMED`], [`COASTING`], [`TERMINATED`].
    pub state_code: u32,
    /// `GATE_…`: which gate was used.
    pub gate_code: u32,
    /// Scans since the start of the track.
    pub age_scans: u32,
    /// Scans with a credible plot.
    pub hits: u32,
    /// Scans without a credible plot, in a row.
    pub misses: u32,
    /// Estimated signal-to-noise ratio of the target, dB.
    pub snr_db: f32,
    /// `KIND_…` of each model; [`KIND_NONE`] beyond the last.
    pub model_kind: [u16; MODELS],
    /// `ESTIMATOR_…`: the family of the filter.
    pub estimator: u16,
    /// Components of the state that the filter knows: 3 (position), 6 (and velocity) or 9 (and acceleration).
    pub known: u8,
    /// Models in use.
    pub models: u8,
    /// Always 0: no undefined bytes.
    pub reserved: u32,
    /// The plots of the largest weights, in that order, and the gates in which they lay; weight 0 where there is none.
    pub used: [UsedPlot; USED_PLOTS],
}

const _: () = assert!(size_of::<Track>() == 1680 && align_of::<Track>() == 8);

impl Default for Track {
    fn default() -> Self {
        Self::EMPTY
    }
}

impl Track {
    /// A tentative track of which nothing is known.
    pub const EMPTY: Self = Self {
        time_ns: 0,
        id: 0,
        state: [0.0; STATE],
        covariance: [0.0; PACKED],
        predicted_state: [0.0; STATE],
        predicted_covariance: [0.0; PACKED],
        model_state: [0.0; STATE],
        model_covariance: [0.0; PACKED],
        model_probability: [0.0; MODELS],
        model_parameter: [0.0; MODELS],
        existence: 0.0,
        gate_volume: 0.0,
        weight_none: 0.0,
        weight_best: 0.0,
        best_plot_seq: 0,
        best_plot_index: u32::MAX,
        plots_in_gate: 0,
        state_code: TENTATIVE,
        gate_code: GATE_NONE,
        age_scans: 0,
        hits: 0,
        misses: 0,
        snr_db: 0.0,
        model_kind: [KIND_NONE; MODELS],
        estimator: 0,
        known: 0,
        models: 0,
        reserved: 0,
        used: [UsedPlot::NONE; USED_PLOTS],
    };

    /// Confirmed or coasting: shown to users.
    pub fn is_confirmed(&self) -> bool {
        self.state_code == CONFIRMED || self.state_code == COASTING
    }

    /// Probability of the models of a kind together; 0 if the filter has none.
    pub fn probability_of(&self, kind: u16) -> f64 {
        self.model_kind.iter().zip(&self.model_probability).filter(|(own, _)| **own == kind).map(|(_, p)| p).sum()
    }

    /// Kind of the most probable model (the first of equals).
    pub fn most_probable_kind(&self) -> u16 {
        let of = |j: usize| self.model_probability[j];
        self.model_kind[(1..MODELS).fold(0, |best, j| if of(j) > of(best) { j } else { best })]
    }

    /// East, north, up; m.
    pub fn position_m(&self) -> [f64; 3] {
        [self.state[0], self.state[3], self.state[6]]
    }

    /// East, north, up; m/s.
    pub fn velocity_mps(&self) -> [f64; 3] {
        [self.state[1], self.state[4], self.state[7]]
    }
}

/// Index of element (row, column) of a symmetric 9×9 matrix in its packed upper triangle.
pub const fn pack(row: usize, column: usize) -> usize {
    let (r, c) = if row <= column { (row, column) } else { (column, row) };
    r * STATE - r * (r + 1) / 2 + c
}

/// Header of the tracks of one sector.
#[derive(Debug, Default, Clone, Copy, PartialEq, Serialize, Deserialize, ZeroCopySend, JsonSchema)]
#[type_name("radar/TracksHeader/2")]
#[repr(C)]
#[repr(align(64))]
pub struct TracksHeader {
    /// Position in the stream: `scan · sectors_per_scan + sector`.
    pub seq: u64,
    /// Session of the publisher.
    pub session: u64,
    /// Measurement time at the end of the sector, ns UTC.
    pub time_ns: u64,
    /// Plots messages that went into this message.
    pub lineage: Lineage,
    /// When and where the last dwell of the sector was.
    pub stamps: Stamps,
    /// Scan number from 0.
    pub scan: u32,
    /// Number of the sector in its scan.
    pub sector: u32,
    /// Sectors in a scan.
    pub sectors_per_scan: u32,
    /// `END_OF_…`, `TRUNCATED` of [`crate::message`].
    pub flags: u32,
    /// Tracks alive, of any state.
    pub alive: u32,
    /// Tracks confirmed or coasting.
    pub confirmed: u32,
    /// Plots rejected since the last message.
    pub rejected: u32,
    /// Tracks left out because the message was full.
    pub left_out: u32,
    /// SAC (high byte) and SIC (low byte) of the radar.
    pub source_id: u32,
    /// Always 0: no undefined bytes.
    pub reserved: u32,
    /// Session whose track numbers these go on with: that of a tracker before, whose tracks this one has taken over; 0: its own.
    pub continued_session: u64,
    /// Always 0: no undefined bytes.
    pub reserved_too: [u32; 8],
}

const _: () = assert!(size_of::<TracksHeader>() == 192 && align_of::<TracksHeader>() == 64);

impl TracksHeader {
    /// Session that a track number belongs to: the same number in the same numbering is the same track, also after the tracker has
    /// been started again.
    pub fn numbering(&self) -> u64 {
        if self.continued_session == 0 { self.session } else { self.continued_session }
    }

    /// Whether one of the flags of [`crate::message`] is set.
    pub fn has(&self, flag: u32) -> bool {
        self.flags & flag != 0
    }
}

impl Header for TracksHeader {
    fn place(&self) -> Place {
        let Self { session, seq, time_ns, flags, scan, .. } = *self;
        Place { session, seq, time_ns, flags, scan: Some(scan) }
    }

    fn lineage(&self) -> Option<&Lineage> {
        Some(&self.lineage)
    }

    fn forget_upstream(&mut self) {
        self.lineage.forget_upstream();
    }

    fn each_stamp(&mut self, visit: &mut dyn FnMut(&mut u64)) {
        self.stamps.each(visit);
    }

    fn make_comparable(&mut self) {
        (self.session, self.continued_session, self.stamps) = (0, 0, Stamps::default());
        self.lineage.make_comparable();
    }
}

/// Names of the components of the state.
pub(crate) const STATE_COLUMNS: [&str; STATE] =
    ["x_m", "vx_mps", "ax_mps2", "y_m", "vy_mps", "ay_mps2", "z_m", "vz_mps", "az_mps2"];
/// Names of their standard errors.
const SIGMA_COLUMNS: [&str; STATE] = [
    "sigma_x_m",
    "sigma_vx_mps",
    "sigma_ax_mps2",
    "sigma_y_m",
    "sigma_vy_mps",
    "sigma_ay_mps2",
    "sigma_z_m",
    "sigma_vz_mps",
    "sigma_az_mps2",
];

/// Names of the probabilities of the kinds of models; empty where the filter has none of a kind.
const KIND_COLUMNS: [(u16, &str); 5] = [
    (KIND_HOVER, "mode_hover"),
    (KIND_CONSTANT_VELOCITY, "mode_constant_velocity"),
    (KIND_MANOEUVRE, "mode_manoeuvre"),
    (KIND_COORDINATED_TURN, "mode_coordinated_turn"),
    (KIND_MEAN_ACCELERATION, "mode_mean_acceleration"),
];
/// Names of the components of the state predicted before the plots of the scan.
const PREDICTED_COLUMNS: [&str; STATE] = [
    "predicted_x_m",
    "predicted_vx_mps",
    "predicted_ax_mps2",
    "predicted_y_m",
    "predicted_vy_mps",
    "predicted_ay_mps2",
    "predicted_z_m",
    "predicted_vz_mps",
    "predicted_az_mps2",
];
/// Names of their standard errors.
const PREDICTED_SIGMA_COLUMNS: [&str; STATE] = [
    "predicted_sigma_x_m",
    "predicted_sigma_vx_mps",
    "predicted_sigma_ax_mps2",
    "predicted_sigma_y_m",
    "predicted_sigma_vy_mps",
    "predicted_sigma_ay_mps2",
    "predicted_sigma_z_m",
    "predicted_sigma_vz_mps",
    "predicted_sigma_az_mps2",
];

impl Row<TracksHeader> for Track {
    fn put_row(&self, header: &TracksHeader, table: &mut dyn Table) -> io::Result<()> {
        table.put("seq", Value::U64(header.seq))?;
        table.put("scan", Value::U32(header.scan))?;
        table.put("sector", Value::U32(header.sector))?;
        table.put("id", Value::U64(self.id))?;
        table.put("time_ns", Value::U64(self.time_ns))?;
        table.put("state_code", Value::U32(self.state_code))?;
        table.put("state", Value::Text(state_name(self.state_code)))?;
        put_all(&STATE_COLUMNS, &self.state, table)?;
        let sigmas = |covariance: &[f64; PACKED]| -> [f64; STATE] {
            std::array::from_fn(|axis| covariance[pack(axis, axis)].sqrt())
        };
        put_all(&SIGMA_COLUMNS, &sigmas(&self.covariance), table)?;
        table.put("existence", Value::F64(self.existence))?;
        for (kind, column) in KIND_COLUMNS {
            table.put_if(self.model_kind.contains(&kind), column, Value::F64(self.probability_of(kind)))?;
        }
        table.put("gate_code", Value::U32(self.gate_code))?;
        table.put("gate", Value::Text(gate_name(self.gate_code)))?;
        table.put("gate_volume", Value::F64(self.gate_volume))?;
        table.put("plots_in_gate", Value::U32(self.plots_in_gate))?;
        table.put("weight_none", Value::F64(self.weight_none))?;
        let found = self.best_plot_index != u32::MAX;
        table.put_if(found, "weight_best", Value::F64(self.weight_best))?;
        table.put_if(found, "best_plot_seq", Value::U64(self.best_plot_seq))?;
        table.put_if(found, "best_plot_index", Value::U32(self.best_plot_index))?;
        table.put("snr_db", Value::F32(self.snr_db))?;
        table.put("age_scans", Value::U32(self.age_scans))?;
        table.put("hits", Value::U32(self.hits))?;
        table.put("misses", Value::U32(self.misses))?;
        table.put("estimator", Value::U32(self.estimator.into()))?;
        let estimator = estimator_name(self.estimator);
        table.put_if(estimator.is_some(), "estimator_name", Value::Text(estimator.unwrap_or_default()))?;
        table.put("known", Value::U32(self.known.into()))?;
        put_all(&PREDICTED_COLUMNS, &self.predicted_state, table)?;
        put_all(&PREDICTED_SIGMA_COLUMNS, &sigmas(&self.predicted_covariance), table)?;
        Ok(())
    }

    fn position_m(&self) -> Option<[f64; 3]> {
        Some(Track::position_m(self))
    }
}
