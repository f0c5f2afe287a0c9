//! Captures in the form pcapng: blocks of several kinds, among them the interfaces and their packets.

use std::ops::Range;

use super::Packet;

const SECTION_HEADER: u32 = 0x0a0d_0d0a;
const INTERFACE: u32 = 1;
const OBSOLETE_PACKET: u32 = 2;
const SIMPLE_PACKET: u32 = 3;
const ENHANCED_PACKET: u32 = 6;

/// Options of an interface: resolution of its times, and what is added to them, s.
const RESOLUTION: u16 = 9;
const OFFSET: u16 = 14;

/// Least size of a block: kind, length, length.
const LEAST: usize = 12;

/// What packets refer to.
#[derive(Clone, Copy)]
struct Interface {
    link: u16,
    ticks_per_s: u64,
    offset_s: i64,
}

pub(super) fn is_capture(bytes: &[u8]) -> bool {
    bytes.starts_with(&SECTION_HEADER.to_be_bytes())
}

/// The packets of a capture, and the rest of it if that holds none.
pub(super) fn packets(bytes: &[u8]) -> impl Iterator<Item = Result<Packet<'_>, Range<usize>>> {
    let mut reader = Reader { bytes, at: 0, is_big_endian: false, interfaces: Vec::new() };
    std::iter::from_fn(move || reader.next_packet())
}

struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
    is_big_endian: bool,
    interfaces: Vec<Interface>,
}

impl<'a> Reader<'a> {
    fn next_packet(&mut self) -> Option<Result<Packet<'a>, Range<usize>>> {
        while self.at < self.bytes.len() {
            let begin = self.at;
            let Some((kind, body)) = self.next_block() else {
                self.at = self.bytes.len();
                return Some(Err(begin..self.bytes.len()));
            };
            match kind {
                SECTION_HEADER => self.interfaces.clear(),
                INTERFACE => self.interfaces.extend(self.interface(body.clone())),
                OBSOLETE_PACKET | SIMPLE_PACKET | ENHANCED_PACKET => {
                    return Some(self.packet(kind, body).ok_or(begin..self.at));
                }
                _ => {}
            }
        }
        None
    }

    /// Kind of the next block, and where its body lies.
    fn next_block(&mut self) -> Option<(u32, Range<usize>)> {
        let begin = self.at;
        if is_capture(&self.bytes[begin..]) {
            self.is_big_endian = self.bytes.get(begin + 8..begin + 12)? == [0x1a, 0x2b, 0x3c, 0x4d];
        }
        let (kind, length) = (self.word(begin)?, self.word(begin + 4)? as usize);
        let end = begin.checked_add(length)?;
        if length < LEAST || !length.is_multiple_of(4) || end > self.bytes.len() {
            return None;
        }
        self.at = end;
        Some((kind, begin + 8..end - 4))
    }

    fn word(&self, at: usize) -> Option<u32> {
        let word = *self.bytes.get(at..)?.first_chunk()?;
        Some(if self.is_big_endian { u32::from_be_bytes(word) } else { u32::from_le_bytes(word) })
    }

    fn half(&self, at: usize) -> Option<u16> {
        let half = *self.bytes.get(at..)?.first_chunk()?;
        Some(if self.is_big_endian { u16::from_be_bytes(half) } else { u16::from_le_bytes(half) })
    }

    fn interface(&self, body: Range<usize>) -> Option<Interface> {
        let mut interface = Interface { link: self.half(body.start)?, ticks_per_s: 1_000_000, offset_s: 0 };
        let mut at = body.start + 8;
        while at + 4 <= body.end {
            let (code, length) = (self.half(at)?, usize::from(self.half(at + 2)?));
            let value = at + 4;
            match (code, length) {
                (RESOLUTION, 1) => {
                    let power = u32::from(*self.bytes.get(value)?);
                    let ticks = if power < 128 { 10_u64.checked_pow(power) } else { 1_u64.checked_shl(power - 128) };
                    interface.ticks_per_s = ticks.filter(|&ticks| ticks > 0)?;
                }
                (OFFSET, 8) => {
                    let (first, second) = (u64::from(self.word(value)?), u64::from(self.word(value + 4)?));
                    let (high, low) = if self.is_big_endian { (first, second) } else { (second, first) };
                    interface.offset_s = (high << 32 | low) as i64;
                }
                _ => {}
            }
            at = value + length.next_multiple_of(4);
        }
        Some(interface)
    }

    fn packet(&self, kind: u32, body: Range<usize>) -> Option<Packet<'a>> {
        let begin = body.start;
        let (index, from, length) = match kind {
            SIMPLE_PACKET => (0, begin + 4, (self.word(begin)? as usize).min(body.len().checked_sub(4)?)),
            ENHANCED_PACKET => (self.word(begin)?, begin + 20, self.word(begin + 12)? as usize),
            _ => (self.half(begin)?.into(), begin + 20, self.word(begin + 12)? as usize),
        };
        let interface = self.interfaces.get(index as usize)?;
        let bytes = self.bytes.get(from..from.checked_add(length)?.min(self.bytes.len()))?;
        if bytes.len() < length || from + length > body.end {
            return None;
        }
        let time_ns = if kind == SIMPLE_PACKET {
            None
        } else {
            let ticks = u64::from(self.word(begin + 4)?) << 32 | u64::from(self.word(begin + 8)?);
            let ns = u128::from(ticks) * 1_000_000_000 / u128::from(interface.ticks_per_s);
            u64::try_from(ns as i128 + i128::from(interface.offset_s) * 1_000_000_000).ok()
        };
        Some(Packet { time_ns, link: interface.link, bytes, offset: from })
    }
}
