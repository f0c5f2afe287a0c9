//! What clients are sent, and what they ask for: `docs/display-api.md` describes it for programs.

pub mod clutter;
pub mod columns;
pub mod explain;
pub mod hello;
pub mod notices;
pub mod operator;
pub mod plots;
pub mod requests;
pub mod tracks;
pub mod truth;
pub mod video;

use common::turning::Turning;
use schemars::JsonSchema;
use serde::Serialize;

/// A stamp of the machine's monotonic clock, µs; `None` where a message has not been.
fn microseconds(stamp_ns: u64) -> Option<f64> {
    (stamp_ns != 0).then(|| stamp_ns as f64 / 1e3)
}

/// Where the beam of a site is now.
#[derive(Debug, Serialize, JsonSchema)]
pub struct SectorMessage<'a> {
    r#type: &'static str,
    site: &'a str,
    scan: u32,
    sector: u32,
    time_s: f64,
    azimuth_rad: f64,
}

impl<'a> SectorMessage<'a> {
    /// At the end of sector number `sector` of a scan, one of `sectors`, of an antenna that turns so.
    pub fn new(site: &'a str, scan: u32, (sector, sectors): (u32, u32), turning: Turning, time_s: f64) -> Self {
        let turned_rad = std::f64::consts::TAU * f64::from(sector + 1) / f64::from(sectors.max(1));
        let azimuth_rad = turning.mirrored(turned_rad);
        Self { r#type: "sector", site, scan, sector, time_s, azimuth_rad }
    }
}
