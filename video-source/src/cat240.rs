//! Spokes in records of ASTERIX category 240.

use std::borrow::Cow;
use std::io::Read;

use asterix::cat240::VideoRecord;
use flate2::read::ZlibDecoder;

use crate::cells::Packing;
use crate::spoke::Spoke;

/// No spoke of a recording has more cells.
pub const MOST_CELLS: usize = 1 << 16;
/// Octets of the largest block that cells fill up, I240/052.
const BLOCK: usize = 256;

/// The spoke of a record received at `time_ns`; none if it has more than `most_cells` cells, or they do not come out of its octets. Of
/// compressed ones no more is unpacked than they need.
pub fn spoke(record: &VideoRecord<'_>, most_cells: usize, time_ns: Option<u64>) -> Option<Spoke> {
    let packing = Packing::asterix(record.bits);
    let cells = record.cells as usize;
    if cells == 0 || cells > most_cells {
        return None;
    }
    let used = (cells * usize::from(record.bits)).div_ceil(8);
    let octets =
        if record.is_compressed { unzip(record.octets, used + BLOCK)?.into() } else { Cow::Borrowed(record.octets) };
    if octets.len() < used {
        return None;
    }
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

/// What comes out of `octets`; none if that is more than `most` octets.
fn unzip(octets: &[u8], most: usize) -> Option<Vec<u8>> {
    let mut unpacked = Vec::new();
    let mut decoder = ZlibDecoder::new(octets).take(most as u64 + 1);
    decoder.read_to_end(&mut unpacked).ok()?;
    (unpacked.len() <= most).then_some(unpacked)
}

#[cfg(test)]
mod tests {
    use super::*;
    use flate2::Compression;
    use flate2::write::ZlibEncoder;
    use std::io::Write;

    #[test]
    fn no_more_is_unpacked_than_cells_need() {
        let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
        encoder.write_all(&[7; 1000]).expect("memory");
        let packed = encoder.finish().expect("memory");
        assert_eq!(unzip(&packed, 1000).map(|octets| octets.len()), Some(1000));
        assert_eq!(unzip(&packed, 999), None);
    }
}
