//! `clutter-map`: where false plots fall, and how many of them the tracker expects there; every second scan.
//!
//! ```text
//! cell (i, j):  azimuth i Δβ … (i + 1) Δβ,  range j Δr … (j + 1) Δr
//! found n = Σ κ^age (1 − claimed) over the plots in the cell;  promised  = pfa Σ κ^age cells tested, as if the same number in each wedge
//! ```

use std::io;

use iceoryx2::prelude::ZeroCopySend;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::message::{Header, Place};
use crate::recording::row::{Row, Table, Value};

/// Wedges of the map in a turn.
pub const AZIMUTHS: usize = 90;
/// Rings of the map.
pub const RANGES: usize = 64;
/// Cells in one message.
pub const MAX_CLUTTER_CELLS: usize = AZIMUTHS * RANGES;

/// A cell of the map in which plots have come that no track explains. Others are left out.
#[derive(Debug, Default, Clone, Copy, PartialEq, Serialize, Deserialize, ZeroCopySend, JsonSchema)]
#[type_name("radar/ClutterCell/1")]
#[repr(C)]
pub struct ClutterCell {
    /// Its wedge, from north clockwise.
    pub azimuth: u16,
    /// Its ring, from the antenna outwards.
    pub range: u16,
    /// n, false plots found in it, earlier scans counting less.
    pub found: f32,
    /// False plots that the tracker expects in a resolution cell and scan, at the mean elevation and range rate of those found.
    pub expected: f32,
}

const _: () = assert!(size_of::<ClutterCell>() == 12 && align_of::<ClutterCell>() == 4);

/// Header of a map.
#[derive(Debug, Default, Clone, Copy, PartialEq, Serialize, Deserialize, ZeroCopySend, JsonSchema)]
#[type_name("radar/ClutterMapHeader/1")]
#[repr(C)]
#[repr(align(64))]
pub struct ClutterMapHeader {
    /// Position in the stream of its publisher, from 0.
    pub seq: u64,
    /// Session of the publisher.
    pub session: u64,
    /// Measurement time of the plots that it follows, ns UTC.
    pub time_ns: u64,
    /// CLOCK_MONOTONIC just before publishing, ns.
    pub out_ns: u64,
    /// Δβ, rad.
    pub azimuth_step_rad: f64,
    /// Δr, m.
    pub range_step_m: f64,
    /// Σ κ^age, scans that the counts stand for.
    pub scans: f64,
    /// Resolution cells tested in all cells of the map, earlier scans counting less; 0 where the radar does not say.
    pub tested: f64,
    /// Probability of a false alarm in a resolution cell that the threshold promises; 0 where the radar does not say.
    pub pfa: f64,
    /// False plots that are expected in a resolution cell and scan where nothing has been learnt.
    pub least_expected: f64,
    /// Scan number from 0.
    pub scan: u32,
    /// Wedges in a turn.
    pub azimuths: u32,
    /// Rings.
    pub ranges: u32,
    /// Always 0: no undefined bytes.
    pub reserved: [u32; 9],
}

const _: () = assert!(size_of::<ClutterMapHeader>() == 128 && align_of::<ClutterMapHeader>() == 64);

impl Header for ClutterMapHeader {
    fn place(&self) -> Place {
        let Self { session, seq, time_ns, scan, .. } = *self;
        Place { session, seq, time_ns, flags: 0, scan: Some(scan) }
    }

    fn each_stamp(&mut self, visit: &mut dyn FnMut(&mut u64)) {
        visit(&mut self.out_ns);
    }

    fn make_comparable(&mut self) {
        (self.session, self.out_ns) = (0, 0);
    }
}

impl ClutterCell {
    /// Middle of the cell: azimuth, rad, and range, m.
    pub fn middle(&self, header: &ClutterMapHeader) -> (f64, f64) {
        let middle = |index: u16, step: f64| (f64::from(index) + 0.5) * step;
        (middle(self.azimuth, header.azimuth_step_rad), middle(self.range, header.range_step_m))
    }
}

impl Row<ClutterMapHeader> for ClutterCell {
    fn put_row(&self, header: &ClutterMapHeader, table: &mut dyn Table) -> io::Result<()> {
        let (azimuth_rad, range_m) = self.middle(header);
        table.put("seq", Value::U64(header.seq))?;
        table.put("scan", Value::U32(header.scan))?;
        table.put("time_ns", Value::U64(header.time_ns))?;
        table.put("azimuth_rad", Value::F64(azimuth_rad))?;
        table.put("range_m", Value::F64(range_m))?;
        table.put("azimuth_step_rad", Value::F64(header.azimuth_step_rad))?;
        table.put("range_step_m", Value::F64(header.range_step_m))?;
        table.put("scans", Value::F64(header.scans))?;
        table.put("found", Value::F32(self.found))?;
        table.put("expected", Value::F32(self.expected))
    }
}
