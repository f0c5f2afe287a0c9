//! `tracks`: the tracks that could be brought up to date by the plots of one sector.

use std::io;

use iceoryx2::prelude::ZeroCopySend;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::message::{Header, Lineage, Place, Stamps};
use crate::recording::row::{Row, Table, Value, put_all};

/// Most tracks in one message; tentative ones are left out first, and counted.
pub const MAX_TRACKS: usize = 256;

/// Length of the state vector [x ẋ ẍ y ẏ ÿ z ż z̈].
pub const STATE: usize = 9;
/// Elements of the packed upper triangle of a 9×9 covariance.
pub const PACKED: usize = STATE * (STATE + 1) / 2;

/// [`Track::state_code`]: started, not yet believed.
pub const TENTATIVE: u32 = 0;
/// [`Track::state_code`]: believed and seen in its last scan.
pub const CONFIRMED: u32 = 1;
/// [`Track::state_code`]: believed, but without a plot in its last scan.
pub const COASTING: u32 = 2;
/// [`Track::state_code`]: ended; this is its last message.
pub const TERMINATED: u32 = 3;

/// [`Track::gate_code`]: no plot was looked for or found.
pub const GATE_NONE: u32 = 0;
/// [`Track::gate_code`]: gate of the most probable mode.
pub const GATE_MOST_PROBABLE: u32 = 1;
/// [`Track::gate_code`]: the manoeuvre mode's gate, searched because the first was empty.
pub const GATE_MANOEUVRE_FALLBACK: u32 = 2;
/// [`Track::gate_code`]: the manoeuvre mode's gate, by rule.
pub const GATE_MANOEUVRE: u32 = 3;
/// [`Track::gate_code`]: several modes' gates together.
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
    /// Bit j is set if it lies in the gate of mode j.
    pub gates: u32,
    /// Always 0: no undefined bytes.
    pub reserved: u32,
}

/// State of one track at [`Track::time_ns`], in ENU about the antenna; m, m/s, m/s².
///
/// Order of the states: [x ẋ ẍ y ẏ ÿ z ż z̈]. Covariances are packed upper triangles,
/// row by row (see [`pack`]). Modes: 0 hover, 1 near-constant velocity, 2 manoeuvre.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ZeroCopySend, JsonSchema)]
#[type_name("radar/Track/2")]
#[repr(C)]
pub struct Track {
    /// Time of the state: when the beam passed the track, ns UTC.
    pub time_ns: u64,
    /// Number of the track, never used again in a session.
    pub id: u64,
    /// Mean of the mixture of modes (MMSE).
    pub state: [f64; STATE],
    /// State of the most probable mode.
    pub mode_state: [f64; STATE],
    /// Covariance of the mixture.
    #[serde(with = "packed")]
    #[schemars(with = "Vec<f64>")]
    pub covariance: [f64; PACKED],
    /// Covariance of the most probable mode.
    #[serde(with = "packed")]
    #[schemars(with = "Vec<f64>")]
    pub mode_covariance: [f64; PACKED],
    /// Probabilities of the modes.
    pub mode_probability: [f64; 3],
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
    /// The plots of the largest weights, in that order, and the gates in which they lay; weight 0 where there is none.
    pub used: [UsedPlot; USED_PLOTS],
}

const _: () = assert!(size_of::<Track>() == 1120 && align_of::<Track>() == 8);

impl Default for Track {
    fn default() -> Self {
        Self {
            time_ns: 0,
            id: 0,
            state: [0.0; STATE],
            mode_state: [0.0; STATE],
            covariance: [0.0; PACKED],
            mode_covariance: [0.0; PACKED],
            mode_probability: [0.0; 3],
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
            used: [UsedPlot::default(); USED_PLOTS],
        }
    }
}

impl Track {
    /// Confirmed or coasting: shown to users.
    pub fn is_confirmed(&self) -> bool {
        self.state_code == CONFIRMED || self.state_code == COASTING
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
    pub reserved: [u32; 11],
}

const _: () = assert!(size_of::<TracksHeader>() == 192 && align_of::<TracksHeader>() == 64);

impl TracksHeader {
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

    fn make_comparable(&mut self) {
        (self.session, self.stamps) = (0, Stamps::default());
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

/// Names of the probabilities of the modes.
const MODE_COLUMNS: [&str; 3] = ["mode_hover", "mode_constant_velocity", "mode_manoeuvre"];

impl Row<TracksHeader> for Track {
    fn put_row(&self, header: &TracksHeader, table: &mut dyn Table) -> io::Result<()> {
        table.put("seq", Value::U64(header.seq))?;
        table.put("scan", Value::U32(header.scan))?;
        table.put("sector", Value::U32(header.sector))?;
        table.put("id", Value::U64(self.id))?;
        table.put("time_ns", Value::U64(self.time_ns))?;
        table.put("state_code", Value::U32(self.state_code))?;
        put_all(&STATE_COLUMNS, &self.state, table)?;
        let sigmas: [f64; STATE] = std::array::from_fn(|axis| self.covariance[pack(axis, axis)].sqrt());
        put_all(&SIGMA_COLUMNS, &sigmas, table)?;
        table.put("existence", Value::F64(self.existence))?;
        put_all(&MODE_COLUMNS, &self.mode_probability, table)?;
        table.put("gate_code", Value::U32(self.gate_code))?;
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
        Ok(())
    }
}

/// serde knows arrays only up to 32 elements; a packed triangle is a sequence of 45.
mod packed {
    use serde::de::{Error, SeqAccess, Visitor};
    use serde::ser::SerializeTuple;
    use serde::{Deserializer, Serializer};

    use super::PACKED;

    pub(super) fn serialize<S: Serializer>(values: &[f64; PACKED], serializer: S) -> Result<S::Ok, S::Error> {
        let mut tuple = serializer.serialize_tuple(PACKED)?;
        for value in values {
            tuple.serialize_element(value)?;
        }
        tuple.end()
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<[f64; PACKED], D::Error> {
        struct Packed;
        impl<'de> Visitor<'de> for Packed {
            type Value = [f64; PACKED];

            fn expecting(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
                write!(f, "{PACKED} numbers: the packed upper triangle of a 9×9 covariance")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut sequence: A) -> Result<Self::Value, A::Error> {
                let mut values = [0.0; PACKED];
                for (index, value) in values.iter_mut().enumerate() {
                    *value = sequence.next_element()?.ok_or_else(|| A::Error::invalid_length(index, &self))?;
                }
                Ok(values)
            }
        }
        deserializer.deserialize_tuple(PACKED, Packed)
    }
}
