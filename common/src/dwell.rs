//! `dwells`: the amplitude of every resolution cell of one azimuth step.
//!
//! Payload: `[elevation][doppler][range]` of f32 amplitudes, range fastest, in units
//! of the receiver (the simulator's noise has unit mean power).

use std::io;

use iceoryx2::prelude::ZeroCopySend;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::message::{Header, Place};
use crate::recording::row::{Row, Table};

/// Most cells in a dwell: 16 MiB of amplitudes.
pub const MAX_CELLS: usize = 4 * 1024 * 1024;

/// Header of one dwell of a stacked-beam radar.
#[derive(Debug, Default, Clone, Copy, PartialEq, Serialize, Deserialize, ZeroCopySend, JsonSchema)]
#[type_name("radar/DwellHeader/1")]
#[repr(C)]
#[repr(align(64))]
pub struct DwellHeader {
    /// Position in the stream: `scan · dwells_per_scan + dwell`.
    pub seq: u64,
    /// Session of the publisher.
    pub session: u64,
    /// When the beam passed the centre of the dwell, ns UTC.
    pub time_ns: u64,
    /// CLOCK_MONOTONIC just before publishing, ns.
    pub source_out_ns: u64,
    /// Beam azimuth at the centre of the dwell, rad, in [0, 2π).
    pub azimuth_rad: f64,
    /// Azimuth between dwells, rad.
    pub azimuth_step_rad: f64,
    /// Elevation of the lowest beam's centre, rad.
    pub elevation_first_rad: f64,
    /// Elevation between beams, rad.
    pub elevation_step_rad: f64,
    /// Range rate of the first Doppler cell's centre, m/s.
    pub range_rate_first_mps: f64,
    /// Range rate between Doppler cells, m/s.
    pub range_rate_step_mps: f64,
    /// Range of the first cell's centre, m.
    pub range_first_m: f64,
    /// Range between cells, m.
    pub range_step_m: f64,
    /// Time of one scan, s.
    pub scan_period_s: f64,
    /// Scan number from 0.
    pub scan: u32,
    /// Number of the dwell in its scan.
    pub dwell: u32,
    /// Dwells in a scan.
    pub dwells_per_scan: u32,
    /// Number of the sector in its scan.
    pub sector: u32,
    /// Sectors in a scan.
    pub sectors_per_scan: u32,
    /// Elevation beams.
    pub elevations: u32,
    /// Doppler cells.
    pub dopplers: u32,
    /// Range cells.
    pub ranges: u32,
    /// `END_OF_…` of [`crate::message`].
    pub flags: u32,
    /// SAC (high byte) and SIC (low byte) of the radar.
    pub source_id: u32,
    /// Amplitude at which the receiver is at its full scale; 0 where it has none.
    pub full_scale: f32,
    /// Always 0: no undefined bytes.
    pub reserved: [u32; 11],
}

// Changing the layout means a new type name.
const _: () = assert!(size_of::<DwellHeader>() == 192 && align_of::<DwellHeader>() == 64);

impl DwellHeader {
    /// Cells that the payload must hold.
    pub fn cells(&self) -> usize {
        let rows = (self.elevations as usize).saturating_mul(self.dopplers as usize);
        rows.saturating_mul(self.ranges as usize)
    }

    /// Whether one of the flags of [`crate::message`] is set.
    pub fn has(&self, flag: u32) -> bool {
        self.flags & flag != 0
    }
}

impl Header for DwellHeader {
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

/// Cells have no table: they would take 10⁹ bytes per second.
impl Row<DwellHeader> for f32 {
    fn put_row(&self, _: &DwellHeader, _: &mut dyn Table) -> io::Result<()> {
        Ok(())
    }
}
