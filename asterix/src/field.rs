//! Elements by their path, found when the program is compiled.
//!
//! A [`Field`] that is a constant costs a reader no search: where the element lies, its size and what its lowest bit is
//! worth are taken from the table by the compiler, which also refuses a path that the edition does not have.

use crate::definition::{Content, Edition, Item, Part, Shape, Slot};
use crate::length::compound;
use crate::record::{Record, bits};

/// The [`Field`] at a path, found by the compiler, which refuses a path that does not lead to an element: in the first
/// profile of an edition, or in the one of an index, from 0.
///
/// ```compile_fail
/// asterix::field!(asterix::tables::CAT048_1_32, "040/HEIGHT");
/// ```
#[macro_export]
macro_rules! field {
    ($edition:expr, $path:expr) => {
        $crate::field!($edition, 0, $path)
    };
    ($edition:expr, $profile:expr, $path:expr) => {
        const {
            match $crate::Field::find($edition, $profile, $path) {
                Ok(field) => field,
                Err(_) => panic!("the path does not lead to an element of the edition"),
            }
        }
    };
}

/// Why a path does not lead to an element.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum FieldError {
    /// The edition has no such profile, or the profile no such item, or the item no such part.
    #[error("no profile, item or part of this name")]
    Unknown,
    /// The path ends before an element of 1 to 64 bits at a fixed place, or goes on after it.
    #[error("no element of 1 to 64 bits at a fixed place")]
    NoElement,
}

/// Where an element lies in a record, and what its bits are worth.
///
/// ```
/// use asterix::{Field, field, tables::CAT048_1_32};
///
/// const RANGE: Field = field!(CAT048_1_32, "040/RHO");
/// const AMPLITUDE: Field = field!(CAT048_1_32, "130/PAM");
/// assert_eq!((RANGE.step(), AMPLITUDE.step()), (1.0 / 256.0, 1.0));
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Field {
    /// Name of the item.
    pub(crate) item: &'static str,
    /// Position of the item in the profile, from 0.
    pub(crate) position: usize,
    /// What the lowest bit is worth, in the unit of the specification; 1 for what has none.
    pub(crate) step: f64,
    /// Size, bits; 1 to 64.
    pub(crate) bits: u16,
    /// In two's complement.
    pub(crate) signed: bool,
    /// The parts of the compound item that it lies in, and the index of its part.
    pub(crate) part: Option<(&'static [Option<Item>], usize)>,
    /// First bit in the item or in the part.
    pub(crate) first_bit: u16,
    /// Size of the item, of the part or of a link of a chained item, octets; none if it is extended.
    pub(crate) octets: Option<usize>,
}

impl Field {
    /// The element at a path of names, such as `140`, `040/RHO` or `130/PAM`, in a profile of an edition, by its index from
    /// 0; [`field!`](crate::field!) is the same for constants.
    ///
    /// # Errors
    /// [`FieldError`].
    pub const fn find(edition: &Edition, profile: usize, path: &str) -> Result<Self, FieldError> {
        if profile >= edition.profiles.len() {
            return Err(FieldError::Unknown);
        }
        let slots = edition.profiles[profile].slots;
        let mut position = 0;
        while position < slots.len() {
            if let Slot::Item(item) = &slots[position]
                && is_segment(path, 0, item.name)
            {
                let field = Self {
                    item: item.name,
                    position,
                    step: 1.0,
                    bits: 0,
                    signed: false,
                    part: None,
                    first_bit: 0,
                    octets: item.shape.fixed_octets(),
                };
                return field.inside(&item.shape, path, 1);
            }
            position += 1;
        }
        Err(FieldError::Unknown)
    }

    const fn inside(mut self, shape: &'static Shape, path: &str, depth: usize) -> Result<Self, FieldError> {
        match shape {
            Shape::Element { bits, content } => {
                if segments(path) != depth || *bits == 0 || *bits > 64 {
                    return Err(FieldError::NoElement);
                }
                self.bits = *bits;
                match content {
                    Content::Quantity { signed, step, .. } => {
                        self.signed = *signed;
                        self.step = *step;
                    }
                    Content::Integer { signed } => self.signed = *signed,
                    _ => {}
                }
                Ok(self)
            }
            Shape::Group { parts, .. } | Shape::Extended(parts) => {
                let mut index = 0;
                while index < parts.len() {
                    self.first_bit += match &parts[index] {
                        Part::Item(item) if is_segment(path, depth, item.name) => {
                            return self.inside(&item.shape, path, depth + 1);
                        }
                        Part::Item(Item { shape: Shape::Element { bits, .. } | Shape::Group { bits, .. }, .. })
                        | Part::Spare(bits) => *bits,
                        Part::Item(_) => return Err(FieldError::NoElement),
                        Part::Fx => 1,
                    };
                    index += 1;
                }
                Err(FieldError::Unknown)
            }
            Shape::Compound(items) => {
                let mut index = 0;
                while index < items.len() && self.part.is_none() {
                    if let Some(item) = &items[index]
                        && is_segment(path, depth, item.name)
                    {
                        self.part = Some((items, index));
                        self.octets = item.shape.fixed_octets();
                        return self.inside(&item.shape, path, depth + 1);
                    }
                    index += 1;
                }
                Err(FieldError::Unknown)
            }
            Shape::Chained(link) if self.part.is_none() => {
                self.octets = Some(link.link_octets());
                self.inside(link, path, depth)
            }
            Shape::Counted(_) | Shape::Chained(_) | Shape::Explicit => Err(FieldError::NoElement),
        }
    }

    /// What the lowest bit is worth, in the unit of the specification; 1 for what has none.
    pub const fn step(&self) -> f64 {
        self.step
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

    /// The bits of the element in a link of a chained item, from 0; the first is [`Self::raw`].
    #[inline]
    pub fn raw_of(&self, record: &Record<'_>, link: usize) -> Option<u64> {
        let octets = self.octets?;
        bits(record.octets(self.position)?.chunks_exact(octets).nth(link)?, self.first_bit, self.bits)
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tables::{ALL, CAT001_1_4, CAT048_1_32};

    #[test]
    fn a_path_that_leads_to_no_element_is_an_error() {
        let find = |path: &str| Field::find(CAT048_1_32, 0, path).map(|field| field.bits);
        assert_eq!(find("040/RHO"), Ok(16));
        for path in ["", "999", "040/HEIGHT", "130/XYZ", "RE/X/Y"] {
            assert!(find(path).is_err(), "{path}");
        }
        for path in ["040", "040/RHO/X", "140/X", "250", "SP", "130"] {
            assert!(find(path).is_err(), "{path}");
        }
        assert!(Field::find(CAT001_1_4, 2, "010/SAC").is_err());
    }

    /// Every path of one and two names, of every profile of every edition: found or not, and of a size that can be read.
    #[test]
    fn every_path_is_a_field_or_an_error() {
        let mut found = 0;
        for edition in ALL {
            for (index, profile) in edition.profiles.iter().enumerate() {
                for slot in profile.slots {
                    let Slot::Item(item) = slot else { continue };
                    let names: Vec<&str> = match &item.shape {
                        Shape::Group { parts, .. } | Shape::Extended(parts) => {
                            let names = parts.iter().filter_map(|part| match part {
                                Part::Item(item) => Some(item.name),
                                _ => None,
                            });
                            names.collect()
                        }
                        Shape::Compound(items) => items.iter().flatten().map(|item| item.name).collect(),
                        _ => Vec::new(),
                    };
                    let paths = names.into_iter().map(|name| format!("{}/{name}", item.name));
                    for path in paths.chain([item.name.to_string()]) {
                        if let Ok(field) = Field::find(edition, index, &path) {
                            assert!((1..=64).contains(&field.bits), "{path}");
                            found += 1;
                        }
                    }
                }
            }
        }
        assert!(found > 200, "{found}");
    }
}
