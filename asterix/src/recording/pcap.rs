//! Captures in the form pcap: a header, and packets with their times.

use std::ops::Range;

use super::Packet;

/// Size of the header of a file, and of a packet.
const FILE_HEADER: usize = 24;
const PACKET_HEADER: usize = 16;

/// How the octets of a number are put together.
type Order = fn([u8; 4]) -> u32;

/// Byte order of a file, and the unit of its fractions of a second, ns.
fn kind(bytes: &[u8]) -> Option<(Order, u64)> {
    match bytes.first_chunk()? {
        [0xa1, 0xb2, 0xc3, 0xd4] => Some((u32::from_be_bytes, 1000)),
        [0xd4, 0xc3, 0xb2, 0xa1] => Some((u32::from_le_bytes, 1000)),
        [0xa1, 0xb2, 0x3c, 0x4d] => Some((u32::from_be_bytes, 1)),
        [0x4d, 0x3c, 0xb2, 0xa1] => Some((u32::from_le_bytes, 1)),
        _ => None,
    }
}

pub(super) fn is_capture(bytes: &[u8]) -> bool {
    kind(bytes).is_some()
}

/// The packets of a capture, or the rest of it that holds none.
pub(super) fn packets(bytes: &[u8]) -> impl Iterator<Item = Result<Packet<'_>, Range<usize>>> {
    let (order, unit_ns) = kind(bytes).unwrap_or((u32::from_le_bytes, 1));
    let word = move |at: usize| bytes.get(at..)?.first_chunk().map(|word| order(*word));
    let link = word(FILE_HEADER - 4).map_or(0, |link| link as u16);
    let mut at = FILE_HEADER.min(bytes.len());
    std::iter::from_fn(move || {
        let begin = at;
        if begin == bytes.len() {
            return None;
        }
        let packet = || {
            let (seconds, fraction, length) = (word(begin)?, word(begin + 4)?, word(begin + 8)?);
            let from = begin + PACKET_HEADER;
            let data = bytes.get(from..from.checked_add(length as usize)?)?;
            let time_ns = Some(u64::from(seconds) * 1_000_000_000 + u64::from(fraction) * unit_ns);
            Some(Packet { time_ns, link, bytes: data, offset: from })
        };
        let packet = packet();
        at = packet.map_or(bytes.len(), |packet| packet.offset + packet.bytes.len());
        Some(packet.ok_or(begin..bytes.len()))
    })
}
