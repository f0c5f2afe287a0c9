//! `truth`: where the targets really were, once per scan. Only for scoring.

use std::io;

use iceoryx2::prelude::ZeroCopySend;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::message::{Header, Place};
use crate::recording::row::{Row, Table, Value, put_all};
use crate::tracks::{STATE, STATE_COLUMNS};

/// Most targets in the truth of one scan.
pub const MAX_TARGETS: usize = 1024;

/// [`TruthTarget::mode`]: standing in the air.
pub const HOVER: u32 = 0;
/// [`TruthTarget::mode`]: straight and level at constant speed.
pub const CONSTANT_VELOCITY: u32 = 1;
/// [`TruthTarget::mode`]: accelerating.
pub const MANOEUVRE: u32 = 2;
/// [`TruthTarget::mode`]: not known.
pub const MODE_UNKNOWN: u32 = 3;

/// Name of a [`TruthTarget::mode`].
pub fn mode_name(mode: u32) -> &'static str {
    match mode {
        HOVER => "hover",
        CONSTANT_VELOCITY => "constant_velocity",
        MANOEUVRE => "manoeuvre",
        _ => "not_known",
    }
}

/// [`TruthTarget::flags`]: inside the volume that the radar covers.
pub const VISIBLE: u32 = 1;
/// [`TruthTarget::flags`]: a vehicle, not an aircraft.
pub const VEHICLE: u32 = 2;
/// [`TruthTarget::flags`]: flying, where a source tells ground from air.
pub const AIRBORNE: u32 = 4;
/// [`TruthTarget::flags`]: on the ground, where a source tells ground from air.
pub const ON_GROUND: u32 = 8;
/// [`TruthTarget::flags`]: the height is not known (z is 0).
pub const PLANAR: u32 = 16;

/// One target at the time the beam passed it (or its own sensor measured it).
#[derive(Debug, Default, Clone, Copy, PartialEq, Serialize, Deserialize, ZeroCopySend, JsonSchema)]
#[type_name("radar/TruthTarget/1")]
#[repr(C)]
pub struct TruthTarget {
    /// Time of the state, ns UTC.
    pub time_ns: u64,
    /// Identity over the whole run, from 1 (an aircraft address for cooperative sensors).
    pub target_id: u32,
    /// Mode of motion.
    pub mode: u32,
    /// [x ẋ ẍ y ẏ ÿ z ż z̈] in ENU about the antenna; m, m/s, m/s².
    pub state: [f64; STATE],
    /// Mean signal-to-noise ratio at the centre of the beam, dB; NaN when not known.
    #[serde(with = "crate::recording::not_known")]
    #[schemars(with = "f32")]
    pub snr_db: f32,
    /// [`VISIBLE`] and others.
    pub flags: u32,
}

const _: () = assert!(size_of::<TruthTarget>() == 96 && align_of::<TruthTarget>() == 8);

impl TruthTarget {
    /// Whether one of the flags is set.
    pub fn has(&self, flag: u32) -> bool {
        self.flags & flag != 0
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

/// Header of the truth of one scan.
#[derive(Debug, Default, Clone, Copy, PartialEq, Serialize, Deserialize, ZeroCopySend, JsonSchema)]
#[type_name("radar/TruthHeader/1")]
#[repr(C)]
#[repr(align(64))]
pub struct TruthHeader {
    /// Position in the stream: the scan number.
    pub seq: u64,
    /// Session of the publisher.
    pub session: u64,
    /// Measurement time at the end of the scan, ns UTC.
    pub time_ns: u64,
    /// CLOCK_MONOTONIC just before publishing, ns.
    pub source_out_ns: u64,
    /// Time of one scan, s.
    pub scan_period_s: f64,
    /// Scan number from 0.
    pub scan: u32,
    /// `END_OF_…` of [`crate::message`].
    pub flags: u32,
    /// Always 0: no undefined bytes.
    pub reserved: [u32; 4],
}

const _: () = assert!(size_of::<TruthHeader>() == 64 && align_of::<TruthHeader>() == 64);

impl Header for TruthHeader {
    fn place(&self) -> Place {
        let Self { session, seq, time_ns, flags, scan, .. } = *self;
        Place { session, seq, time_ns, flags, scan: Some(scan) }
    }

    fn each_stamp(&mut self, visit: &mut dyn FnMut(&mut u64)) {
        visit(&mut self.source_out_ns);
    }

    fn make_comparable(&mut self) {
        (self.session, self.source_out_ns) = (0, 0);
    }
}

impl Row<TruthHeader> for TruthTarget {
    fn put_row(&self, header: &TruthHeader, table: &mut dyn Table) -> io::Result<()> {
        table.put("seq", Value::U64(header.seq))?;
        table.put("target_id", Value::U32(self.target_id))?;
        table.put("time_ns", Value::U64(self.time_ns))?;
        table.put("mode", Value::U32(self.mode))?;
        table.put("mode_name", Value::Text(mode_name(self.mode)))?;
        table.put("flags", Value::U32(self.flags))?;
        table.put_if(!self.snr_db.is_nan(), "snr_db", Value::F32(self.snr_db))?;
        put_all(&STATE_COLUMNS, &self.state, table)?;
        Ok(())
    }

    fn position_m(&self) -> Option<[f64; 3]> {
        Some([self.state[0], self.state[3], self.state[6]])
    }
}
