//! A marine radar of 360 dwells a turn, one row of range cells each.

use std::convert::Infallible;
use std::f64::consts::TAU;

use common::dwell::DwellHeader;
use common::message::{END_OF_SCAN, END_OF_SECTOR};
use common::plots::Plot;
use plot_extractor::PlotExtractor;

/// Dwells in a turn.
pub(crate) const DWELLS: u32 = 360;
const SECTORS: u32 = 8;

/// Hands one dwell to the extractor, and appends the plots that it gives.
pub(crate) fn take(
    extractor: &mut PlotExtractor,
    (scan, dwell): (u32, u32),
    range_step_m: f64,
    amplitudes: &[f32],
    found: &mut Vec<Plot>,
) {
    let sector_dwells = DWELLS / SECTORS;
    let ends = |dwells: u32| (dwell + 1).is_multiple_of(dwells);
    let header = DwellHeader {
        seq: u64::from(scan * DWELLS + dwell),
        time_ns: u64::from(scan * DWELLS + dwell + 1) * 5_000_000,
        azimuth_rad: (f64::from(dwell) + 0.5) * TAU / f64::from(DWELLS),
        azimuth_step_rad: TAU / f64::from(DWELLS),
        elevation_step_rad: 0.1,
        range_rate_step_mps: 1.0,
        range_step_m,
        scan_period_s: 1.8,
        scan,
        dwell,
        dwells_per_scan: DWELLS,
        sector: dwell / sector_dwells,
        sectors_per_scan: SECTORS,
        elevations: 1,
        dopplers: 1,
        ranges: amplitudes.len() as u32,
        flags: if ends(sector_dwells) { END_OF_SECTOR } else { 0 } | if ends(DWELLS) { END_OF_SCAN } else { 0 },
        ..DwellHeader::default()
    };
    let taken = extractor.take(&header, amplitudes, 1, |_, plots| {
        found.extend_from_slice(plots);
        Ok::<(), Infallible>(())
    });
    assert_eq!(taken, Ok(None));
}
