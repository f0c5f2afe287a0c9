//! How many octets an item has.

use crate::definition::{Item, Shape};
use crate::error::Fault;

/// Octets of an item of this shape at the start of `bytes`.
pub(crate) fn octets(shape: &Shape, bytes: &[u8]) -> Result<usize, Fault> {
    match shape {
        Shape::Element { bits, .. } | Shape::Group { bits, .. } => within(usize::from(*bits) / 8, bytes),
        Shape::Extended(_) => flagged(bytes),
        Shape::Chained(of) => chained(of.link_octets(), bytes),
        Shape::Counted(of) => {
            let size = of.fixed_octets().unwrap_or(0);
            within(1 + usize::from(first(bytes)?) * size, bytes)
        }
        Shape::Explicit => match first(bytes)? {
            0 => Err(Fault::LengthZero),
            length => within(usize::from(length), bytes),
        },
        Shape::Compound(items) => compound(items, bytes, usize::MAX).map(|place| place.end),
    }
}

/// Octets up to and with the first whose lowest bit is 0.
pub(crate) fn flagged(bytes: &[u8]) -> Result<usize, Fault> {
    match bytes.iter().position(|octet| octet & 1 == 0) {
        Some(last) => Ok(last + 1),
        None => Err(Fault::Truncated { needed: bytes.len() + 1, left: bytes.len() }),
    }
}

/// Octets of links of `size` octets each, up to and with the first whose lowest bit is 0.
fn chained(size: usize, bytes: &[u8]) -> Result<usize, Fault> {
    let last = bytes.chunks_exact(size).position(|link| link[size - 1] & 1 == 0);
    let needed = last.map_or_else(|| (bytes.len() / size + 1) * size, |last| (last + 1) * size);
    within(needed, bytes)
}

/// Where a part of a compound item lies in it, or the end of the item if it does not have the part: an empty range.
pub(crate) fn compound(items: &[Option<Item>], bytes: &[u8], part: usize) -> Result<std::ops::Range<usize>, Fault> {
    let mut at = flagged(bytes)?;
    for (octet, named) in bytes[..at].iter().enumerate() {
        let mut named = named >> 1;
        while named != 0 {
            let bit = named.leading_zeros() - 1;
            named &= !(0x40 >> bit);
            let index = octet * 7 + bit as usize;
            let Some(Some(item)) = items.get(index) else { return Err(Fault::UndefinedPart(index + 1)) };
            let end = at + octets(&item.shape, &bytes[at..])?;
            if index == part {
                return Ok(at..end);
            }
            at = end;
        }
    }
    Ok(at..at)
}

fn first(bytes: &[u8]) -> Result<u8, Fault> {
    bytes.first().copied().ok_or(Fault::Truncated { needed: 1, left: 0 })
}

fn within(needed: usize, bytes: &[u8]) -> Result<usize, Fault> {
    if needed <= bytes.len() { Ok(needed) } else { Err(Fault::Truncated { needed, left: bytes.len() }) }
}
