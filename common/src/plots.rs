//! `plots`: what was detected in one sector, with decision statistics.
//!
//! One message per sector, also when nothing was detected: a missing message always
//! means loss, and the tracker knows how far the beam's results are complete.

use std::{fmt, io};

use iceoryx2::prelude::ZeroCopySend;
use schemars::JsonSchema;
use serde::de::{SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};

use crate::message::{Header, Lineage, Place, Stamps};
use crate::recording::row::{Row, Table, Value};
use crate::turning::Turning;

/// Most plots in one message; the weakest of more are left out and counted.
pub const MAX_PLOTS: usize = 1024;

/// [`Plot::elevation_rad`] is measured.
pub const HAS_ELEVATION: u32 = 1;
/// [`Plot::range_rate_mps`] is measured.
pub const HAS_RANGE_RATE: u32 = 2;
/// [`Plot::statistic`] is measured.
pub const HAS_STATISTIC: u32 = 4;
/// Of a simulated or test target, or of a fixed monitor of the sensor.
pub const ARTIFICIAL: u32 = 8;

/// One detection: a cluster of cells over threshold, in polar coordinates about the antenna.
#[derive(Debug, Default, Clone, Copy, PartialEq, Serialize, Deserialize, ZeroCopySend, JsonSchema)]
#[type_name("radar/Plot/1")]
#[repr(C)]
pub struct Plot {
    /// When the beam passed the target, ns UTC.
    pub time_ns: u64,
    /// Slant range, m.
    pub range_m: f64,
    /// Clockwise from north, rad, in [0, 2π).
    pub azimuth_rad: f64,
    /// Above the horizontal, rad; 0 unless [`HAS_ELEVATION`].
    pub elevation_rad: f64,
    /// Range rate, m/s, positive when receding; 0 unless [`HAS_RANGE_RATE`].
    pub range_rate_mps: f64,
    /// Standard error of the range, m.
    pub sigma_range_m: f32,
    /// Standard error of the azimuth, rad.
    pub sigma_azimuth_rad: f32,
    /// Standard error of the elevation, rad.
    pub sigma_elevation_rad: f32,
    /// Standard error of the range rate, m/s.
    pub sigma_range_rate_mps: f32,
    /// Decision statistic z of the peak cell: amplitude over root mean noise power (C4).
    pub statistic: f32,
    /// Estimated signal-to-noise ratio at the peak, dB.
    pub snr_db: f32,
    /// Cells over threshold in the cluster.
    pub cell_count: u32,
    /// `HAS_…`.
    pub flags: u32,
    /// SAC (high byte) and SIC (low byte) of the sensor.
    pub source_id: u32,
    /// Identity of the target where the sensor knows it, else 0. Only for scoring.
    pub target_id: u32,
}

const _: () = assert!(size_of::<Plot>() == 80 && align_of::<Plot>() == 8);

impl Plot {
    /// Whether all of the given `HAS_…` flags are set.
    pub fn has(&self, flags: u32) -> bool {
        self.flags & flags == flags
    }
}

/// Header of the plots of one sector.
#[derive(Debug, Default, Clone, Copy, PartialEq, Serialize, Deserialize, ZeroCopySend, JsonSchema)]
#[type_name("radar/PlotsHeader/2")]
#[repr(C)]
#[repr(align(64))]
pub struct PlotsHeader {
    /// Position in the stream: `scan · sectors_per_scan + sector`.
    pub seq: u64,
    /// Session of the publisher.
    pub session: u64,
    /// Measurement time at the end of the sector, ns UTC.
    pub time_ns: u64,
    /// Dwells that went into this message.
    pub lineage: Lineage,
    /// When and where the last dwell of the sector was.
    pub stamps: Stamps,
    /// Start of the interval of beam angle ([`crate::turning`]) newly covered, rad, counted from north of this
    /// scan without wrapping: negative when it begins in the scan before. Of an antenna that stands, the last sector of a
    /// scan covers all of it, and the others nothing.
    pub covered_from_rad: f64,
    /// End of the interval: every plot before this angle has been published. It stays
    /// behind the beam while a cluster of detections is still open.
    pub covered_to_rad: f64,
    /// Time of one scan, s.
    pub scan_period_s: f64,
    /// Set probability of false alarm per cell; 0 when unknown.
    pub pfa: f64,
    /// Cells tested against a threshold.
    pub cells: u64,
    /// Cells over threshold.
    pub detections: u64,
    /// Size of a resolution cell: range, m.
    pub cell_range_m: f64,
    /// Size of a resolution cell: azimuth, rad.
    pub cell_azimuth_rad: f64,
    /// Size of a resolution cell: elevation, rad; 0 without elevation.
    pub cell_elevation_rad: f64,
    /// Size of a resolution cell: range rate, m/s; 0 without Doppler.
    pub cell_range_rate_mps: f64,
    /// Reference cells of the CFAR; 0 when unknown.
    pub reference_cells: u32,
    /// Scan number from 0.
    pub scan: u32,
    /// Number of the sector in its scan.
    pub sector: u32,
    /// Sectors in a scan.
    pub sectors_per_scan: u32,
    /// `END_OF_…`, `TRUNCATED`, `COUNTER_CLOCKWISE`, `STANDING` of [`crate::message`].
    pub flags: u32,
    /// Dwells or records rejected since the last message.
    pub rejected: u32,
    /// Plots left out because the message was full.
    pub left_out: u32,
    /// SAC (high byte) and SIC (low byte) of the radar.
    pub source_id: u32,
    /// Unambiguous interval of range rates, m/s: those of plots are known up to multiples of it; 0 where they are known.
    pub range_rate_interval_mps: f64,
    /// How the CFAR estimates the noise: a number of [`crate::amplitude::Cfar`]; 0, the mean of the reference cells, where
    /// nothing is said.
    #[serde(default)]
    pub cfar: u32,
    /// Always 0: no undefined bytes.
    #[serde(deserialize_with = "spare")]
    pub reserved: [u32; 1],
}

/// What is left of four words, all of which older JSON lines hold.
fn spare<'de, D: Deserializer<'de>>(deserializer: D) -> Result<[u32; 1], D::Error> {
    struct Words;
    impl<'de> Visitor<'de> for Words {
        type Value = [u32; 1];

        fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
            formatter.write_str("words that are 0")
        }

        fn visit_seq<A: SeqAccess<'de>>(self, mut words: A) -> Result<Self::Value, A::Error> {
            while words.next_element::<u32>()?.is_some() {}
            Ok([0; 1])
        }
    }
    deserializer.deserialize_tuple(1, Words)
}

const _: () = assert!(size_of::<PlotsHeader>() == 256 && align_of::<PlotsHeader>() == 64);

impl PlotsHeader {
    /// Whether one of the flags of [`crate::message`] is set.
    pub fn has(&self, flag: u32) -> bool {
        self.flags & flag != 0
    }

    /// How the antenna turns.
    pub fn turning(&self) -> Turning {
        Turning::of_flags(self.flags)
    }
}

impl Header for PlotsHeader {
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
        (self.session, self.stamps) = (0, Stamps::default());
        self.lineage.make_comparable();
    }
}

impl Row<PlotsHeader> for Plot {
    fn put_row(&self, header: &PlotsHeader, table: &mut dyn Table) -> io::Result<()> {
        let (elevation, range_rate) = (self.has(HAS_ELEVATION), self.has(HAS_RANGE_RATE));
        table.put("seq", Value::U64(header.seq))?;
        table.put("scan", Value::U32(header.scan))?;
        table.put("sector", Value::U32(header.sector))?;
        table.put("time_ns", Value::U64(self.time_ns))?;
        table.put("range_m", Value::F64(self.range_m))?;
        table.put("azimuth_rad", Value::F64(self.azimuth_rad))?;
        table.put_if(elevation, "elevation_rad", Value::F64(self.elevation_rad))?;
        table.put_if(range_rate, "range_rate_mps", Value::F64(self.range_rate_mps))?;
        table.put("sigma_range_m", Value::F32(self.sigma_range_m))?;
        table.put("sigma_azimuth_rad", Value::F32(self.sigma_azimuth_rad))?;
        table.put_if(elevation, "sigma_elevation_rad", Value::F32(self.sigma_elevation_rad))?;
        table.put_if(range_rate, "sigma_range_rate_mps", Value::F32(self.sigma_range_rate_mps))?;
        table.put_if(self.has(HAS_STATISTIC), "statistic", Value::F32(self.statistic))?;
        table.put("snr_db", Value::F32(self.snr_db))?;
        table.put("cell_count", Value::U32(self.cell_count))?;
        table.put("flags", Value::U32(self.flags))?;
        table.put("source_id", Value::U32(self.source_id))?;
        table.put_if(self.target_id != 0, "target_id", Value::U32(self.target_id))?;
        Ok(())
    }

    /// Without elevation, on the horizontal plane of the antenna.
    fn position_m(&self) -> Option<[f64; 3]> {
        let (sin, cos) = self.elevation_rad.sin_cos();
        let (east, north) = self.azimuth_rad.sin_cos();
        Some([self.range_m * cos * east, self.range_m * cos * north, self.range_m * sin])
    }
}
