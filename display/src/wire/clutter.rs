//! The clutter map as clients get it.

use common::clutter_map::{ClutterCell, ClutterMapHeader};
use common::units::NS_PER_S;
use schemars::JsonSchema;
use serde::Serialize;

use super::columns::Column;

/// Header of the map of a site.
#[derive(Debug, Serialize, JsonSchema)]
pub struct MapsHead<'a> {
    r#type: &'static str,
    site: &'a str,
    scan: u32,
    time_s: f64,
    azimuth_step_rad: f64,
    range_step_m: f64,
    /// Scans for which the counts stand: earlier ones count less.
    scans: f64,
    least_expected: f64,
}

impl<'a> MapsHead<'a> {
    /// Of the map of a site.
    pub fn new(site: &'a str, header: &ClutterMapHeader) -> Self {
        let ClutterMapHeader { scan, time_ns, azimuth_step_rad, range_step_m, scans, least_expected, .. } = *header;
        let time_s = time_ns as f64 / NS_PER_S;
        Self { r#type: "maps", site, scan, time_s, azimuth_step_rad, range_step_m, scans, least_expected }
    }
}

/// A cell of the map with what its header says of it.
#[derive(Debug, Clone, Copy)]
pub struct MapRow {
    azimuth_rad: f64,
    range_m: f64,
    found: f64,
    promised: f64,
    expected: f32,
}

impl MapRow {
    /// The cells of a map; the radar tests cells from the first to the second of `ranges_m`, where that is known.
    pub fn all(header: &ClutterMapHeader, cells: &[ClutterCell], ranges_m: Option<(f64, f64)>) -> Vec<Self> {
        let tested = ranges_m.map(|(from, to)| f64::from(header.azimuths) * (to - from) / header.range_step_m);
        let promised = tested.map_or(f64::NAN, |cells| header.pfa * header.tested / (cells.max(1.0) * header.scans));
        let promised = if promised > 0.0 { promised } else { f64::NAN };
        let row = |cell: &ClutterCell| {
            let (azimuth_rad, range_m) = cell.middle(header);
            let found = f64::from(cell.found) / header.scans;
            Self { azimuth_rad, range_m, found, promised, expected: cell.expected }
        };
        cells.iter().map(row).collect()
    }
}

/// Columns of the map: the middle of each cell, about the antenna of the site; false plots found in it, and promised by the
/// threshold, a scan; false plots that the tracker expects in a resolution cell there and scan.
pub const MAPS: [Column<MapRow>; 5] = [
    Column::f32("azimuth_rad", |row| row.azimuth_rad as f32),
    Column::f32("range_m", |row| row.range_m as f32),
    Column::f32("found_per_scan", |row| row.found as f32),
    Column::f32("promised_per_scan", |row| row.promised as f32),
    Column::f32("expected_per_cell", |row| row.expected),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_found_is_told_by_the_scan_beside_what_was_promised() {
        let header = ClutterMapHeader {
            azimuth_step_rad: 0.5,
            range_step_m: 100.0,
            scans: 20.0,
            tested: 20.0 * 1e6,
            pfa: 1e-5,
            azimuths: 10,
            ..ClutterMapHeader::default()
        };
        let cell = ClutterCell { azimuth: 1, range: 4, found: 10.0, expected: 0.25 };
        // A million cells a scan in ten wedges of ten rings: ten false plots, a tenth of one in each.
        let rows = MapRow::all(&header, &[cell], Some((500.0, 1500.0)));
        let MapRow { azimuth_rad, range_m, found, promised, expected } = rows[0];
        assert_eq!((azimuth_rad, range_m, found, expected), (0.75, 450.0, 0.5, 0.25));
        assert!((promised - 0.1).abs() < 1e-12, "{promised}");
        let promised = |header| MapRow::all(header, &[cell], Some((500.0, 1500.0)))[0].promised;
        assert!(promised(&ClutterMapHeader { pfa: 0.0, ..header }).is_nan());
        assert!(MapRow::all(&header, &[cell], None)[0].promised.is_nan());
    }
}
