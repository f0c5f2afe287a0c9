//! Plots as clients get them.

use common::geometry::Polar;
use common::plots::{HAS_ELEVATION, HAS_RANGE_RATE, Plot, PlotsHeader};
use common::units::NS_PER_S;
use schemars::JsonSchema;
use serde::Serialize;

use super::columns::Column;
use crate::picture::place::Placement;

/// Header of the plots of a sector.
#[derive(Debug, Serialize, JsonSchema)]
pub struct PlotsHead<'a> {
    r#type: &'static str,
    site: &'a str,
    scan: u32,
    sector: u32,
    seq: u64,
    time_s: f64,
    covered_from_rad: f64,
    covered_to_rad: f64,
}

impl<'a> PlotsHead<'a> {
    /// Of the plots of a site.
    pub fn new(site: &'a str, header: &PlotsHeader) -> Self {
        let PlotsHeader { scan, sector, seq, covered_from_rad, covered_to_rad, .. } = *header;
        let time_s = header.time_ns as f64 / NS_PER_S;
        Self { r#type: "plots", site, scan, sector, seq, time_s, covered_from_rad, covered_to_rad }
    }
}

/// A plot with its place in the message and in the picture.
#[derive(Debug, Clone, Copy)]
pub struct PlotRow {
    index: u32,
    position_m: [f32; 3],
    plot: Plot,
}

impl PlotRow {
    /// The plots of a message, in its order.
    pub fn all(plots: &[Plot], place: &Placement) -> Vec<Self> {
        let row = |(index, plot): (usize, &Plot)| Self {
            index: index as u32,
            position_m: position_m(plot, place).map(|axis| axis as f32),
            plot: *plot,
        };
        plots.iter().enumerate().map(row).collect()
    }

    fn elevation(&self, value: f32) -> f32 {
        if self.plot.has(HAS_ELEVATION) { value } else { f32::NAN }
    }
}

/// Where a plot is in the picture, m. Without elevation it is drawn at that of the antenna, and its height is not known.
pub fn position_m(plot: &Plot, place: &Placement) -> [f64; 3] {
    let polar = Polar { range_m: plot.range_m, azimuth_rad: plot.azimuth_rad, elevation_rad: plot.elevation_rad };
    let [x, y, z] = place.position_m(polar.to_enu().into());
    [x, y, if plot.has(HAS_ELEVATION) { z } else { f64::NAN }]
}

/// Columns of plots. Range, azimuth and elevation are about the antenna of the site.
pub const PLOTS: [Column<PlotRow>; 13] =
    [
        Column::u32("index", |row| row.index),
        Column::f32("x_m", |row| row.position_m[0]),
        Column::f32("y_m", |row| row.position_m[1]),
        Column::f32("z_m", |row| row.position_m[2]),
        Column::f32("range_m", |row| row.plot.range_m as f32),
        Column::f32("azimuth_rad", |row| row.plot.azimuth_rad as f32),
        Column::f32("elevation_rad", |row| row.elevation(row.plot.elevation_rad as f32)),
        Column::f32("range_rate_mps", |row| {
            if row.plot.has(HAS_RANGE_RATE) { row.plot.range_rate_mps as f32 } else { f32::NAN }
        }),
        Column::f32("sigma_range_m", |row| row.plot.sigma_range_m),
        Column::f32("sigma_azimuth_rad", |row| row.plot.sigma_azimuth_rad),
        Column::f32("sigma_elevation_rad", |row| row.elevation(row.plot.sigma_elevation_rad)),
        Column::f32("snr_db", |row| row.plot.snr_db),
        Column::u32("flags", |row| row.plot.flags),
    ];
