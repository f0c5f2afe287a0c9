//! Elements by their path, found when the program is compiled.
//!
//! A [`Field`] that is a constant costs a reader no search: where the element lies, its size and what its lowest bit is
//! worth are taken from the table by the compiler, which also refuses a path that the edition does not have.

use crate::definition::{Content, Edition, Item, Part, Profile, Shape, Slot};
use crate::length::compound;
use crate::record::{Record, bits};

/// Where an element lies in a record, and what its bits are worth.
///
/// ```
/// use asterix::{Field, tables::CAT048_1_32};
///
/// const RANGE: Field = Field::of(CAT048_1_32, "040/RHO");
/// const AMPLITUDE: Field = Field::of(CAT048_1_32, "130/PAM");
/// assert_eq!((RANGE.step, AMPLITUDE.step), (1.0 / 256.0, 1.0));
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Field {
    /// Name of the item.
    pub item: &'static str,
    /// Position of the item in the profile, from 0.
    pub position: usize,
    /// What the lowest bit is worth, in the unit of the specification; 1 for what has none.
    pub step: f64,
    /// Size, bits.
    pub bits: u16,
    /// In two's complement.
    pub signed: bool,
    /// The parts of the compound item that it lies in, and the index of its part.
    pub(crate) part: Option<(&'static [Option<Item>], usize)>,
    /// First bit in the item or in the part.
    pub(crate) first_bit: u16,
    /// Size of the item or of the part, octets; none if it is extended.
    pub(crate) octets: Option<usize>,
}

impl Field {
    /// The element at a path of names, such as `140`, `040/RHO` or `130/PAM`, in the first profile of an edition.
    ///
    /// # Panics
    /// There is none, or it is repeated: an error of the compiler, where the field is a constant.
    pub const fn of(edition: &Edition, path: &'static str) -> Self {
        Self::in_profile(&edition.profiles[0], path)
    }

    /// As [`Field::of`], in one of the profiles of an edition.
    ///
    /// # Panics
    /// Likewise.
    pub const fn in_profile(profile: &Profile, path: &'static str) -> Self {
        let mut position = 0;
        loop {
            assert!(position < profile.slots.len(), "the profile has no item of this name");
            if let Slot::Item(item) = &profile.slots[position]
                && is_segment(path, 0, item.name)
            {
                let octets = item.shape.fixed_octets();
                let item_name = item.name;
                let field = Self {
                    item: item_name,
                    position,
                    step: 1.0,
                    bits: 0,
                    signed: false,
                    part: None,
                    first_bit: 0,
                    octets,
                };
                return field.inside(&item.shape, path, 1);
            }
            position += 1;
        }
    }

    const fn inside(mut self, shape: &'static Shape, path: &str, depth: usize) -> Self {
        match shape {
            Shape::Element { bits, content } => {
                assert!(segments(path) == depth, "the path goes on after an element");
                self.bits = *bits;
                match content {
                    Content::Quantity { signed, step, .. } => {
                        self.signed = *signed;
                        self.step = *step;
                    }
                    Content::Integer { signed } => self.signed = *signed,
                    _ => {}
                }
                self
            }
            Shape::Group { parts, .. } | Shape::Extended(parts) => {
                let mut index = 0;
                loop {
                    assert!(index < parts.len(), "the item has no part of this name");
                    match &parts[index] {
                        Part::Item(item) if is_segment(path, depth, item.name) => {
                            return self.inside(&item.shape, path, depth + 1);
                        }
                        Part::Item(item) => self.first_bit += bits_of(&item.shape),
                        Part::Spare(bits) => self.first_bit += *bits,
                        Part::Fx => self.first_bit += 1,
                    }
                    index += 1;
                }
            }
            Shape::Compound(items) => {
                assert!(self.part.is_none(), "a compound item inside another one");
                let mut index = 0;
                loop {
                    assert!(index < items.len(), "the item has no part of this name");
                    if let Some(item) = &items[index]
                        && is_segment(path, depth, item.name)
                    {
                        self.part = Some((items, index));
                        self.octets = item.shape.fixed_octets();
                        return self.inside(&item.shape, path, depth + 1);
                    }
                    index += 1;
                }
            }
            Shape::Counted(_) | Shape::Chained(_) | Shape::Explicit => panic!("the item is repeated or explicit"),
        }
    }

    /// The bits of the element, if the record has it.
    #[expect(clippy::inline_always, reason = "a constant field folds only into its caller")]
    #[inline(always)]
    pub fn raw(&self, record: &Record<'_>) -> Option<u64> {
        let item = record.octets(self.position)?;
        let bytes = match self.part {
            None => item,
            Some((items, part)) => &item[compound(items, item, part).ok()?],
        };
        bits(bytes, self.first_bit, self.bits)
    }

    /// Whether the element is 1, if the record has it.
    #[expect(clippy::inline_always, reason = "a constant field folds only into its caller")]
    #[inline(always)]
    pub fn is_set(&self, record: &Record<'_>) -> Option<bool> {
        self.raw(record).map(|raw| raw == 1)
    }

    /// The value of the element in the unit of the specification, if the record has it.
    #[expect(clippy::inline_always, reason = "a constant field folds only into its caller")]
    #[inline(always)]
    pub fn value(&self, record: &Record<'_>) -> Option<f64> {
        self.raw(record).map(|raw| in_units(raw, self.bits, self.signed, self.step))
    }
}

/// The value of an element's bits.
#[inline]
pub(crate) fn in_units(raw: u64, bits: u16, signed: bool, step: f64) -> f64 {
    let whole = if signed { ((raw << (64 - bits)) as i64 >> (64 - bits)) as f64 } else { raw as f64 };
    whole * step
}

const fn bits_of(shape: &Shape) -> u16 {
    match shape {
        Shape::Element { bits, .. } | Shape::Group { bits, .. } => *bits,
        _ => panic!("a part of a group whose size varies"),
    }
}

const fn segments(path: &str) -> usize {
    let (bytes, mut count, mut at) = (path.as_bytes(), 1, 0);
    while at < bytes.len() {
        if bytes[at] == b'/' {
            count += 1;
        }
        at += 1;
    }
    count
}

/// Whether a segment of the path, from 0, is `name`.
const fn is_segment(path: &str, segment: usize, name: &str) -> bool {
    let (bytes, name) = (path.as_bytes(), name.as_bytes());
    let (mut at, mut left) = (0, segment);
    while left > 0 {
        if at >= bytes.len() {
            return false;
        }
        if bytes[at] == b'/' {
            left -= 1;
        }
        at += 1;
    }
    let mut index = 0;
    while index < name.len() {
        if at + index >= bytes.len() || bytes[at + index] != name[index] {
            return false;
        }
        index += 1;
    }
    at + index == bytes.len() || bytes[at + index] == b'/'
}
