//! Records as JSON: one object, by the names of the specification.
//!
//! An element is an object with its bits, `raw`, and what they mean: `value` and `unit` of a quantity, `value` of a whole
//! number, `text` of a table or of characters. Bits of more than 64 and explicit items are `hex`. A repeated item is a list.

use std::fmt::{self, Display, Formatter};

use crate::definition::{Content, Item, Part, Shape, Slot, Text};
use crate::field::in_units;
use crate::value::{RecordValues, Value};

/// The items of a record as a JSON object.
impl Display for RecordValues {
    fn fmt(&self, out: &mut Formatter<'_>) -> fmt::Result {
        object(out, self.items.iter(), |out, (position, value)| self.item(out, *position, value))
    }
}

impl RecordValues {
    fn item(&self, out: &mut Formatter<'_>, position: usize, value: &Value) -> fmt::Result {
        match (self.profile.slots.get(position), value) {
            (Some(Slot::Item(item)), value) => named(out, item, value),
            (_, Value::Sequence(items)) => {
                write!(out, "\"RFS\":")?;
                object(out, items.iter(), |out, (position, value)| self.item(out, *position, value))
            }
            _ => Err(fmt::Error),
        }
    }
}

fn object<T>(
    out: &mut Formatter<'_>,
    members: impl Iterator<Item = T>,
    mut write_member: impl FnMut(&mut Formatter<'_>, T) -> fmt::Result,
) -> fmt::Result {
    write!(out, "{{")?;
    for (index, member) in members.enumerate() {
        if index > 0 {
            write!(out, ",")?;
        }
        write_member(out, member)?;
    }
    write!(out, "}}")
}

fn named(out: &mut Formatter<'_>, item: &Item, value: &Value) -> fmt::Result {
    write!(out, "{}:", Quoted(item.name))?;
    write_value(out, &item.shape, value)
}

fn write_value(out: &mut Formatter<'_>, shape: &Shape, value: &Value) -> fmt::Result {
    match (shape, value) {
        (Shape::Element { bits, content }, Value::Element(raw)) => element(out, *raw, *bits, content, &[]),
        (_, Value::Octets(octets)) => write!(out, "{{\"hex\":\"{}\"}}", Hex(octets)),
        (Shape::Group { parts, .. } | Shape::Extended(parts), Value::Parts(values)) => write_parts(out, parts, values),
        (Shape::Counted(of) | Shape::Chained(of), Value::List(values)) => {
            write!(out, "[")?;
            for (index, value) in values.iter().enumerate() {
                if index > 0 {
                    write!(out, ",")?;
                }
                write_value(out, of, value)?;
            }
            write!(out, "]")
        }
        (Shape::Compound(items), Value::Chosen { parts, .. }) => object(out, parts.iter(), |out, (index, value)| {
            items.get(*index).and_then(Option::as_ref).map_or(Err(fmt::Error), |item| named(out, item, value))
        }),
        _ => Err(fmt::Error),
    }
}

/// Parts by name. Spare bits are shown where they are not 0, octets beyond the edition as `beyond`.
fn write_parts(out: &mut Formatter<'_>, parts: &[Part], values: &[Value]) -> fmt::Result {
    let present = parts.iter().filter(|part| !matches!(part, Part::Fx));
    let raws: Vec<(&str, u64)> = present
        .clone()
        .zip(values)
        .filter_map(|(part, value)| match (part, value) {
            (Part::Item(item), Value::Element(raw)) => Some((item.name, *raw)),
            _ => None,
        })
        .collect();
    let shown = present.map(Some).chain([None]).zip(values).filter(|(part, value)| match part {
        Some(Part::Spare(_)) => **value != Value::Element(0),
        _ => true,
    });
    object(out, shown, |out, (part, value)| match (part, value) {
        (Some(Part::Item(item)), Value::Element(raw)) => {
            let Shape::Element { bits, content } = &item.shape else { return Err(fmt::Error) };
            write!(out, "{}:", Quoted(item.name))?;
            element(out, *raw, *bits, content, &raws)
        }
        (_, Value::Octets(octets)) => write!(out, "\"beyond\":{{\"hex\":\"{}\"}}", Hex(octets)),
        (Some(Part::Item(item)), value) => named(out, item, value),
        (_, Value::Element(raw)) => write!(out, "\"spare\":{{\"raw\":{raw}}}"),
        _ => Err(fmt::Error),
    })
}

fn element(out: &mut Formatter<'_>, raw: u64, bits: u16, content: &Content, beside: &[(&str, u64)]) -> fmt::Result {
    if let Content::Case { of, cases } = content {
        let decides = beside.iter().find(|(name, _)| name == of).map(|&(_, raw)| raw);
        let case = cases.iter().find(|(value, _)| Some(*value) == decides);
        return element(out, raw, bits, case.map_or(&Content::Raw, |(_, content)| content), &[]);
    }
    write!(out, "{{\"raw\":{raw}")?;
    match content {
        Content::Table(rows) => {
            if let Some((_, text)) = rows.iter().find(|(value, _)| *value == raw) {
                write!(out, ",\"text\":{}", Quoted(text))?;
            }
        }
        Content::Text(text) => write!(out, ",\"text\":{}", Quoted(&characters(raw, bits, *text)))?,
        Content::Integer { signed } => write!(out, ",\"value\":{}", in_units(raw, bits, *signed, 1.0))?,
        Content::Quantity { signed, step, unit } => {
            write!(out, ",\"value\":{},\"unit\":{}", in_units(raw, bits, *signed, *step), Quoted(unit))?;
        }
        Content::Raw | Content::Case { .. } => {}
    }
    write!(out, "}}")
}

/// The characters of an element.
pub(crate) fn characters(raw: u64, bits: u16, text: Text) -> String {
    let size = match text {
        Text::Ascii => 8,
        Text::Icao => 6,
        Text::Octal => 3,
    };
    let codes = (0..bits / size).rev().map(|index| (raw >> (index * size)) as u8 & (0xff >> (8 - size)));
    codes
        .map(|code| match text {
            Text::Ascii => char::from(code),
            Text::Octal => char::from(b'0' + code),
            // The low six bits of ASCII, where letters have lost their 64.
            Text::Icao if (1..=26).contains(&code) => char::from(b'@' + code),
            Text::Icao if code == 32 || (48..=57).contains(&code) => char::from(code),
            Text::Icao => '?',
        })
        .collect()
}

struct Hex<'a>(&'a [u8]);

impl Display for Hex<'_> {
    fn fmt(&self, out: &mut Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|octet| write!(out, "{octet:02x}"))
    }
}

/// A JSON string.
struct Quoted<'a>(&'a str);

impl Display for Quoted<'_> {
    fn fmt(&self, out: &mut Formatter<'_>) -> fmt::Result {
        write!(out, "\"")?;
        for character in self.0.chars() {
            match character {
                '"' | '\\' => write!(out, "\\{character}")?,
                control if control < ' ' => write!(out, "\\u{:04x}", u32::from(control))?,
                other => write!(out, "{other}")?,
            }
        }
        write!(out, "\"")
    }
}
