//! The cells of the last scan under a plan, as an image.

use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::io::Write;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use common::dwell::DwellHeader;
use flate2::{Compression, Crc, write::ZlibEncoder};

use super::scale::Scale;
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

    /// The image of a square about the middle of the plan whose upper left corner is at `corner`, px, as far as `range_m` reaches, as
    /// the address of a PNG; none without cells. `site_m` is where the radar stands, m east and north.
    pub(super) fn image(
        &self,
        scale: &Scale,
        range_m: f64,
        site_m: [f64; 2],
        corner: [f64; 2],
        shade: u8,
    ) -> Option<String> {
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
        let mut rows = Vec::with_capacity((2 * side as usize + 1) * side as usize);
        for y in 0..side {
            rows.push(0); // no filter
            for x in 0..side {
                rows.extend([shade, level(x, y).map_or(0, opacity)]);
            }
        }
        Some(format!("data:image/png;base64,{}", STANDARD.encode(png(side, &rows))))
    }
}

/// How opaque a level is drawn.
fn opacity(level: u8) -> u8 {
    let db = f64::from(DB_FIRST) + f64::from(level) * f64::from(DB_STEP);
    (((db - SEEN_DB[0]) / (SEEN_DB[1] - SEEN_DB[0])).clamp(0.0, 1.0) * OPACITY) as u8
}

/// A square of grey and opacity, 8 bits each, as PNG.
fn png(side: u32, rows: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    // Writing to memory cannot fail.
    let _ = encoder.write_all(rows);
    let data = encoder.finish().unwrap_or_default();
    let mut header = [side.to_be_bytes(), side.to_be_bytes()].concat();
    header.extend([8, 4, 0, 0, 0]);
    let mut bytes = b"\x89PNG\r\n\x1a\n".to_vec();
    for (name, content) in [(b"IHDR", header), (b"IDAT", data), (b"IEND", Vec::new())] {
        let mut check = Crc::new();
        check.update(name);
        check.update(&content);
        bytes.extend((content.len() as u32).to_be_bytes());
        bytes.extend(name);
        bytes.extend(content);
        bytes.extend(check.sum().to_be_bytes());
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::message::END_OF_SECTOR;
    use flate2::read::ZlibDecoder;
    use std::io::Read;

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
        let image = cells.image(&scale, 1000.0, [0.0; 2], [0.0; 2], 40).expect("cells");
        let bytes = STANDARD.decode(image.strip_prefix("data:image/png;base64,").expect("a PNG")).expect("base64");
        assert_eq!(bytes[16..24], [0, 0, 0, 100, 0, 0, 0, 100]);
        let length = u32::from_be_bytes(bytes[33..37].try_into().expect("four")) as usize;
        let mut rows = Vec::new();
        ZlibDecoder::new(&bytes[41..41 + length]).read_to_end(&mut rows).expect("zlib");
        let dark: Vec<(usize, usize)> = (0..100)
            .flat_map(|y| (0..100).map(move |x| (x, y)))
            .filter(|&(x, y)| rows[y * 201 + 1 + 2 * x + 1] > 100)
            .collect();
        assert!(
            !dark.is_empty() && dark.iter().all(|&(x, y)| (88..=92).contains(&x) && (48..=54).contains(&y)),
            "{dark:?}"
        );
    }
}
