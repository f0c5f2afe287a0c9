//! Any record as a tree of values, and back.
//!
//! The way for what treats all categories alike. What a program reads a million times a second it reads by
//! [`crate::Field`]s.

use crate::definition::{Edition, Item, Part, Profile, Shape, Slot};
use crate::error::EncodeError;
use crate::length::flagged;
use crate::record::{Record, bits};

/// What an item, or a part of one, holds.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Value {
    /// The bits of an element of at most 64.
    Element(u64),
    /// Octets: of a longer element, of an explicit item, or of extensions that the edition does not have.
    Octets(Vec<u8>),
    /// What was sent of the parts of a group or of an extended item, in order: also spare ones, but no FX.
    Parts(Vec<Self>),
    /// Repeated values.
    List(Vec<Self>),
    /// Parts of a compound item by index, from 0.
    Chosen {
        /// Size of the field of bits that names them; some radars send more than it needs.
        octets: usize,
        /// The parts.
        parts: Vec<(usize, Self)>,
    },
    /// Items of random field sequencing by position, from 0.
    Sequence(Vec<(usize, Self)>),
}

/// A record as values.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordValues {
    /// Its edition.
    pub edition: &'static Edition,
    /// Its profile.
    pub profile: &'static Profile,
    /// Size of the FSPEC; some radars send more than it needs.
    pub fspec_octets: usize,
    /// Position in the profile, from 0, and value of each item.
    pub items: Vec<(usize, Value)>,
}

impl RecordValues {
    /// The values of a record.
    pub fn of(record: &Record<'_>) -> Self {
        let items = record.items().map(|found| {
            let value = match found.item {
                Some(item) => value(&item.shape, found.bytes),
                None => sequence(record.profile, found.bytes),
            };
            (found.position, value)
        });
        let fspec_octets = flagged(record.bytes).unwrap_or(1);
        Self { edition: record.edition, profile: record.profile, fspec_octets, items: items.collect() }
    }

    /// Appends the octets of the record.
    ///
    /// # Errors
    /// [`EncodeError`]: a value does not have the shape of its item, or items are not in order.
    pub fn encode(&self, out: &mut Vec<u8>) -> Result<(), EncodeError> {
        let positions: Vec<usize> = self.items.iter().map(|&(position, _)| position).collect();
        named(&positions, self.fspec_octets, "FSPEC", out)?;
        for (position, value) in &self.items {
            match (self.profile.slots.get(*position), value) {
                (Some(Slot::Item(item)), value) => encode(item, value, out)?,
                (Some(Slot::Sequence), Value::Sequence(items)) => {
                    out.push(u8::try_from(items.len()).map_err(|_| EncodeError::Shape { item: "RFS" })?);
                    for (position, value) in items {
                        let Some(Slot::Item(item)) = self.profile.slots.get(*position) else {
                            return Err(EncodeError::Shape { item: "RFS" });
                        };
                        out.push(*position as u8 + 1);
                        encode(item, value, out)?;
                    }
                }
                _ => return Err(EncodeError::Shape { item: "FSPEC" }),
            }
        }
        Ok(())
    }
}

/// The value of an item that fills `bytes`, as [`crate::length`] has found.
fn value(shape: &Shape, bytes: &[u8]) -> Value {
    match shape {
        Shape::Element { bits: count, .. } if *count <= 64 => Value::Element(bits(bytes, 0, *count).unwrap_or(0)),
        Shape::Element { .. } | Shape::Explicit => Value::Octets(bytes.to_vec()),
        Shape::Group { parts, .. } => Value::Parts(group(parts, bytes, &mut 0)),
        Shape::Extended(parts) => {
            let mut bit = 0;
            let mut values = group(parts, bytes, &mut bit);
            let beyond = &bytes[usize::from(bit / 8)..];
            if !beyond.is_empty() {
                values.push(Value::Octets(beyond.to_vec()));
            }
            Value::Parts(values)
        }
        Shape::Counted(of) => {
            let size = of.fixed_octets().unwrap_or(0).max(1);
            Value::List(bytes[1..].chunks_exact(size).map(|one| value(of, one)).collect())
        }
        Shape::Chained(of) => Value::List(bytes.chunks_exact(of.link_octets()).map(|link| value(of, link)).collect()),
        Shape::Compound(items) => {
            let parts = items.iter().enumerate().filter_map(|(index, item)| {
                let place = crate::length::compound(items, bytes, index).ok().filter(|place| !place.is_empty())?;
                Some((index, value(&item.as_ref()?.shape, &bytes[place])))
            });
            Value::Chosen { octets: flagged(bytes).unwrap_or(1), parts: parts.collect() }
        }
    }
}

/// The values of the parts that `bytes` reach to, from a bit on.
fn group(parts: &[Part], bytes: &[u8], bit: &mut u16) -> Vec<Value> {
    let mut values = Vec::new();
    for part in parts {
        let count = match part {
            Part::Item(item) => match &item.shape {
                Shape::Group { parts, .. } => {
                    let inner = group(parts, bytes, bit);
                    if !inner.is_empty() {
                        values.push(Value::Parts(inner));
                    }
                    continue;
                }
                Shape::Element { bits, .. } => *bits,
                _ => 0,
            },
            Part::Spare(bits) => *bits,
            Part::Fx => 1,
        };
        let Some(raw) = bits(bytes, *bit, count) else { break };
        *bit += count;
        if !matches!(part, Part::Fx) {
            values.push(Value::Element(raw));
        }
    }
    values
}

fn sequence(profile: &Profile, bytes: &[u8]) -> Value {
    let mut items = Vec::new();
    let mut at = 1;
    while let Some(&position) = bytes.get(at) {
        let position = usize::from(position).wrapping_sub(1);
        let Some(Slot::Item(item)) = profile.slots.get(position) else { break };
        let rest = &bytes[at + 1..];
        let Ok(length) = crate::length::octets(&item.shape, rest) else { break };
        items.push((position, value(&item.shape, &rest[..length])));
        at += 1 + length;
    }
    Value::Sequence(items)
}

/// Appends a field of bits like the FSPEC, as short as it can be, but of at least so many octets.
fn named(positions: &[usize], least: usize, item: &'static str, out: &mut Vec<u8>) -> Result<(), EncodeError> {
    if !positions.is_sorted_by(|a, b| a < b) {
        return Err(EncodeError::Order { item });
    }
    let octets = positions.last().map_or(1, |last| last / 7 + 1).max(least);
    if octets > usize::from(u16::MAX) {
        return Err(EncodeError::Shape { item }); // no block holds it
    }
    let start = out.len();
    out.resize(start + octets - 1, 1);
    out.push(0);
    for position in positions {
        out[start + position / 7] |= 0x80 >> (position % 7);
    }
    Ok(())
}

/// Appends an item.
fn encode(item: &Item, value: &Value, out: &mut Vec<u8>) -> Result<(), EncodeError> {
    let wrong = EncodeError::Shape { item: item.name };
    match (&item.shape, value) {
        (Shape::Compound(items), Value::Chosen { octets, parts }) => {
            let indices: Vec<usize> = parts.iter().map(|&(index, _)| index).collect();
            named(&indices, *octets, item.name, out)?;
            for (index, value) in parts {
                encode(items.get(*index).and_then(Option::as_ref).ok_or(wrong)?, value, out)?;
            }
            Ok(())
        }
        (shape, value) => plain(shape, value, out).ok_or(wrong),
    }
}

/// Appends an item that is not compound; none if the value has another shape.
fn plain(shape: &Shape, value: &Value, out: &mut Vec<u8>) -> Option<()> {
    match (shape, value) {
        (Shape::Element { bits, .. }, Value::Element(raw)) => {
            let mut writer = BitWriter { out, free: 0 };
            writer.push(*raw, *bits)?;
            writer.is_whole()
        }
        (Shape::Element { bits, .. }, Value::Octets(octets)) => {
            out.extend_from_slice(octets);
            (octets.len() * 8 == usize::from(*bits)).then_some(())
        }
        (Shape::Group { parts, .. }, Value::Parts(values)) => {
            let mut writer = BitWriter { out, free: 0 };
            writer.parts(parts, values)?;
            writer.is_whole()
        }
        (Shape::Extended(parts), Value::Parts(values)) => {
            let (values, beyond) = match values.split_last() {
                Some((Value::Octets(beyond), values)) => (values, &beyond[..]),
                _ => (&values[..], &[][..]),
            };
            let mut writer = BitWriter { out, free: 0 };
            writer.extended(parts, values, !beyond.is_empty())?;
            writer.is_whole()?;
            out.extend_from_slice(beyond);
            let is_closed = beyond
                .split_last()
                .is_none_or(|(last, others)| last & 1 == 0 && others.iter().all(|octet| octet & 1 == 1));
            is_closed.then_some(())
        }
        (Shape::Counted(of), Value::List(values)) => {
            out.push(u8::try_from(values.len()).ok()?);
            values.iter().try_for_each(|value| plain(of, value, out))
        }
        (Shape::Chained(of), Value::List(values)) => {
            let last = values.len().checked_sub(1)?;
            values.iter().enumerate().try_for_each(|(index, value)| {
                let mut writer = BitWriter { out, free: 0 };
                match (&**of, value) {
                    (Shape::Element { bits, .. }, Value::Element(raw)) => writer.push(*raw, *bits)?,
                    (Shape::Group { parts, .. }, Value::Parts(values)) => writer.parts(parts, values)?,
                    _ => return None,
                }
                writer.push(u64::from(index < last), 1)?;
                writer.is_whole()
            })
        }
        (Shape::Explicit, Value::Octets(octets)) => {
            out.extend_from_slice(octets);
            (octets.first().map(|&length| usize::from(length)) == Some(octets.len())).then_some(())
        }
        _ => None,
    }
}

/// Bits appended to octets.
struct BitWriter<'a> {
    out: &'a mut Vec<u8>,
    /// Bits of the last octet that are not written yet.
    free: u16,
}

impl BitWriter<'_> {
    fn push(&mut self, raw: u64, bits: u16) -> Option<()> {
        if bits > 64 || (bits < 64 && raw >> bits != 0) {
            return None;
        }
        for bit in (0..bits).rev() {
            if self.free == 0 {
                self.out.push(0);
                self.free = 8;
            }
            self.free -= 1;
            *self.out.last_mut()? |= ((raw >> bit & 1) as u8) << self.free;
        }
        Some(())
    }

    /// All parts of a group.
    fn parts(&mut self, parts: &[Part], values: &[Value]) -> Option<()> {
        let mut values = values.iter();
        parts.iter().try_for_each(|part| self.part(part, values.next()?))?;
        values.next().is_none().then_some(())
    }

    /// As many octets of an extended item as there are values for.
    fn extended(&mut self, parts: &[Part], values: &[Value], goes_on: bool) -> Option<()> {
        let mut values = values.iter().peekable();
        for (index, part) in parts.iter().enumerate() {
            match part {
                Part::Fx => {
                    let more = values.peek().is_some() || (index + 1 == parts.len() && goes_on);
                    self.push(u64::from(more), 1)?;
                    if !more {
                        return (!goes_on).then_some(());
                    }
                }
                part => self.part(part, values.next()?)?,
            }
        }
        values.next().is_none().then_some(())
    }

    fn part(&mut self, part: &Part, value: &Value) -> Option<()> {
        match (part, value) {
            (Part::Spare(bits), Value::Element(raw)) => self.push(*raw, *bits),
            (Part::Item(item), value) => match (&item.shape, value) {
                (Shape::Element { bits, .. }, Value::Element(raw)) => self.push(*raw, *bits),
                (Shape::Group { parts, .. }, Value::Parts(values)) => self.parts(parts, values),
                _ => None,
            },
            _ => None,
        }
    }

    fn is_whole(&self) -> Option<()> {
        (self.free == 0).then_some(())
    }
}
