//! The cells of the last scan under a plan, as an image.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use common::dwell::DwellHeader;

use super::scale::Scale;
use super::sheet::Shading;
use crate::picture::video::{DB_FIRST, DB_STEP, Gatherer, SectorVideo};

/// Cells so strong over the noise, dB, begin to be seen, and are darkest.
const SEEN_DB: [f64; 2] = [4.0, 30.0];
/// A turn has no more lines.
const MOST_LINES: usize = 1 << 16;
/// Opacity of the darkest.
const OPACITY: f64 = 230.0;

/// The last levels of each line of a site.
#[derive(Debug, Default)]
pub(super) struct Cells {
    gatherer: Gatherer,
    sectors: BTreeMap<u32, Vec<SectorVideo>>,
}

impl Cells {
    /// Takes a dwell.
    pub(super) fn take(&mut self, header: &DwellHeader, amplitudes: &[f32]) {
        if let Some(video) = self.gatherer.take(header, amplitudes) {
            let pieces = self.sectors.entry(video.sector).or_default();
            pieces.retain(|piece| piece.scan == video.scan);
            pieces.push(video);
        }
    }

    /// A square about the middle of the plan whose upper left corner is at `corner`, px, as far as `range_m` reaches; none without
    /// cells. `site_m` is where the radar stands, m east and north.
    pub(super) fn shading(
        &self,
        scale: &Scale,
        range_m: f64,
        site_m: [f64; 2],
        corner: [f64; 2],
        grey: u8,
    ) -> Option<Shading> {
        let side = (2.0 * (scale.middle[0] - corner[0])) as u32;
        let any = self.sectors.values().flatten().next()?;
        let step_rad = any.azimuth_step_rad;
        let lines_per_scan = (TAU / step_rad).round() as usize;
        if !(1..=MOST_LINES).contains(&lines_per_scan) {
            return None;
        }
        let mut lines: Vec<Option<(&SectorVideo, usize)>> = vec![None; lines_per_scan];
        for piece in self.sectors.values().flatten() {
            for line in 0..piece.lines() {
                let azimuth_rad = piece.azimuth_first_rad + line as f64 * piece.azimuth_step_rad;
                lines[(azimuth_rad / step_rad) as usize % lines_per_scan] = Some((piece, line));
            }
        }
        let half_px_m = 0.5 / scale.per_m;
        let level = |x: u32, y: u32| {
            let east = (corner[0] + f64::from(x) + 0.5 - scale.middle[0]) / scale.per_m + scale.middle_m[0] - site_m[0];
            let north =
                (scale.middle[1] - corner[1] - f64::from(y) - 0.5) / scale.per_m + scale.middle_m[1] - site_m[1];
            if (east + site_m[0] - scale.middle_m[0]).hypot(north + site_m[1] - scale.middle_m[1]) > range_m {
                return None;
            }
            let range_m = east.hypot(north);
            let azimuth_rad = east.atan2(north).rem_euclid(TAU);
            let (piece, line) = lines[(azimuth_rad / step_rad) as usize % lines_per_scan]?;
            let cell = |range_m: f64| ((range_m - piece.range_first_m) / piece.range_step_m).round().max(0.0) as usize;
            let cells = &piece.levels[line * piece.ranges..][..piece.ranges];
            let (near, far) = (cell(range_m - half_px_m), cell(range_m + half_px_m).min(piece.ranges - 1));
            cells.get(near..=far.max(near)).and_then(|cells| cells.iter().max().copied())
        };
        let opacity = (0..side).flat_map(|y| (0..side).map(move |x| (x, y)));
        let opacity = opacity.map(|(x, y)| level(x, y).map_or(0, opacity_of)).collect();
        Some(Shading { side, grey, opacity })
    }
}

/// How opaque a level is drawn.
fn opacity_of(level: u8) -> u8 {
    let db = f64::from(DB_FIRST) + f64::from(level) * f64::from(DB_STEP);
    (((db - SEEN_DB[0]) / (SEEN_DB[1] - SEEN_DB[0])).clamp(0.0, 1.0) * OPACITY) as u8
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::message::END_OF_SECTOR;

    /// An echo at 90°, 800 m lies east of the middle, and nothing else is dark.
    #[test]
    fn an_echo_lies_at_its_place() {
        let mut cells = Cells::default();
        for dwell in 0..64_u32 {
            let mut amplitudes = vec![1.0; 100];
            if dwell == 16 {
                amplitudes[80] = 100.0;
            }
            let header = DwellHeader {
                seq: dwell.into(),
                azimuth_rad: (f64::from(dwell) + 0.5) / 64.0 * TAU,
                azimuth_step_rad: TAU / 64.0,
                range_step_m: 10.0,
                dwells_per_scan: 64,
                elevations: 1,
                dopplers: 1,
                ranges: 100,
                flags: if dwell == 63 { END_OF_SECTOR } else { 0 },
                ..DwellHeader::default()
            };
            cells.take(&header, &amplitudes);
        }
        let scale = Scale { middle_m: [0.0; 2], middle: [50.0, 50.0], per_m: 0.05 };
        let shading = cells.shading(&scale, 1000.0, [0.0; 2], [0.0; 2], 40).expect("cells");
        assert_eq!((shading.side, shading.opacity.len()), (100, 100 * 100));
        let dark: Vec<(usize, usize)> = (0..100)
            .flat_map(|y| (0..100).map(move |x| (x, y)))
            .filter(|&(x, y)| shading.opacity[y * 100 + x] > 100)
            .collect();
        assert!(
            !dark.is_empty() && dark.iter().all(|&(x, y)| (88..=92).contains(&x) && (48..=54).contains(&y)),
            "{dark:?}"
        );
    }
}
