//! Spokes in records of ASTERIX category 240.

use std::borrow::Cow;
use std::io::Read;

use asterix::cat240::VideoRecord;
use flate2::read::ZlibDecoder;

use crate::cells::Packing;
use crate::spoke::Spoke;

/// No spoke has more cells.
const MOST_CELLS: usize = 1 << 16;
/// No more octets come out of a compressed record: 2 MiB, half a million cells of 32 bits.
const MOST_OCTETS: usize = 2 << 20;

/// The spoke of a record received at `time_ns`; none if its cells do not come out of its octets.
pub fn spoke(record: &VideoRecord<'_>, time_ns: Option<u64>) -> Option<Spoke> {
    let octets = if record.is_compressed { unzip(record.octets)?.into() } else { Cow::Borrowed(record.octets) };
    let packing = Packing::asterix(record.bits);
    let cells = record.cells as usize;
    if cells == 0 || cells > MOST_CELLS || packing.cells(octets.len()) < cells {
        return None;
    }
    let used = (cells * usize::from(record.bits)).div_ceil(8).min(octets.len());
    let range_step_m = record.cell_s * common::units::SPEED_OF_LIGHT_MPS / 2.0;
    Some(Spoke {
        time_ns,
        followers: 0,
        source_id: record.source.map_or(0, |source| source.number().into()),
        azimuth_rad: record.azimuth_rad,
        range_first_m: (f64::from(record.first_cell) + 0.5) * range_step_m,
        range_step_m,
        cells,
        packing,
        octets: octets[..used].into(),
    })
}

fn unzip(octets: &[u8]) -> Option<Vec<u8>> {
    let mut unpacked = Vec::new();
    let mut decoder = ZlibDecoder::new(octets).take(MOST_OCTETS as u64 + 1);
    decoder.read_to_end(&mut unpacked).ok()?;
    (unpacked.len() <= MOST_OCTETS).then_some(unpacked)
}
