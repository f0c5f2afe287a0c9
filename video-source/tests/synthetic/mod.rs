//! Spokes as records of ASTERIX category 240, written octet by octet from the specification.

use std::io::Write;

use common::config::{self, ChainConfig};
use flate2::Compression;
use flate2::write::ZlibEncoder;

/// Spokes of a turn in these tests.
pub(crate) const SPOKES: u16 = 64;

pub(crate) fn chain(changes: &[&str]) -> ChainConfig {
    let own =
        ["run.source=video-source", "radar.dwells_per_scan=64", "radar.sectors_per_scan=8", "radar.scan_period_s=2.0"];
    let changes: Vec<String> = own.iter().chain(changes).map(|&change| change.to_string()).collect();
    config::load(None, &changes).expect("a valid configuration")
}

/// How a record says its cells.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Form {
    /// Code of I240/048: 1 to 6 stand for 1 to 32 bits.
    pub(crate) resolution: u8,
    pub(crate) is_compressed: bool,
    /// Repetitions of 4, 64 or 256 octets: bit of the item in the second octet of the FSPEC, and its size.
    pub(crate) block: (u8, usize),
    /// Duration of a cell in fs and not in ns.
    pub(crate) femto: bool,
}

pub(crate) const SMALL: (u8, usize) = (0x40, 4);
pub(crate) const MEDIUM: (u8, usize) = (0x20, 64);
pub(crate) const LARGE: (u8, usize) = (0x10, 256);

/// A block with the spoke number `spoke`, of SAC 25 and SIC 7, from cell 10 on, cells of 100 ns, at `time` in 1/128 s of the day.
pub(crate) fn block(spoke: u16, codes: &[u32], form: Form, time: u32) -> Vec<u8> {
    let bits = 1_usize << (form.resolution - 1);
    let mut octets = Vec::new();
    if bits < 8 {
        for codes in codes.chunks(8 / bits) {
            let mut octet = 0_u8;
            for index in 0..8 / bits {
                octet = octet << bits | codes.get(index).map_or(0, |&code| code as u8);
            }
            octets.push(octet);
        }
    } else {
        octets.extend(codes.iter().flat_map(|code| code.to_be_bytes()[4 - bits / 8..].to_vec()));
    }
    if form.is_compressed {
        let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
        encoder.write_all(&octets).expect("memory");
        octets = encoder.finish().expect("memory");
    }
    let valid = octets.len() as u16;
    octets.resize(octets.len().next_multiple_of(form.block.1), 0);
    let start = u32::from(spoke % SPOKES) * 65_536 / u32::from(SPOKES);
    let end = (start + 65_536 / u32::from(SPOKES)) as u16;
    let header = if form.femto { 0x04 } else { 0x08 };
    let mut record = vec![0x80 | 0x40 | 0x20 | header | 0x02 | 0x01, 0x80 | form.block.0 | 0x08, 25, 7, 2];
    record.extend(u32::from(spoke).to_be_bytes());
    record.extend((start as u16).to_be_bytes());
    record.extend(end.to_be_bytes());
    record.extend(10_u32.to_be_bytes());
    record.extend((if form.femto { 100_000_000_u32 } else { 100 }).to_be_bytes());
    record.extend([if form.is_compressed { 0x80 } else { 0 }, form.resolution]);
    record.extend(valid.to_be_bytes());
    record.extend(&(codes.len() as u32).to_be_bytes()[1..]);
    record.push((octets.len() / form.block.1) as u8);
    record.extend(octets);
    record.extend(&time.to_be_bytes()[1..]);
    let mut block = vec![240];
    block.extend((record.len() as u16 + 3).to_be_bytes());
    block.extend(record);
    block
}

/// Codes of 8 bits.
pub(crate) const BYTES: Form = Form { resolution: 4, is_compressed: false, block: SMALL, femto: false };
