//! Random records of any edition, to try decoders with.

use crate::definition::{Edition, Part, Profile, Shape, Slot};
use crate::value::{RecordValues, Value};

/// A record of random items with random bits; spare bits are 0. `draw` gives evenly distributed bits.
pub fn record(edition: &'static Edition, draw: &mut impl FnMut() -> u64) -> RecordValues {
    let index = below(edition.profiles.len() as u64, draw) as usize;
    let profile = &edition.profiles[index];
    let mut items: Vec<(usize, Value)> = Vec::new();
    for (position, slot) in profile.slots.iter().enumerate() {
        let chooses = |name: &str| edition.choice.as_ref().is_some_and(|choice| choice.item == name);
        match slot {
            Slot::Item(item) if chooses(item.name) => {
                let mut chosen = value(&item.shape, draw);
                if let (Some(choice), Value::Parts(parts)) = (&edition.choice, &mut chosen) {
                    let wanted = choice.profiles.iter().find(|&&(_, of)| of == index);
                    parts[0] = Value::Element(wanted.map_or(0, |&(value, _)| value));
                }
                items.push((position, chosen));
            }
            // Every record names its sensor.
            Slot::Item(item) if item.name == "010" || draw() & 1 == 1 => {
                items.push((position, value(&item.shape, draw)));
            }
            Slot::Sequence if below(8, draw) == 0 => items.push((position, sequence(profile, draw))),
            _ => {}
        }
    }
    let fspec_octets = octets_for(&items);
    RecordValues { edition, profile, fspec_octets, items }
}

fn sequence(profile: &Profile, draw: &mut impl FnMut() -> u64) -> Value {
    let items = profile.slots.iter().enumerate().filter_map(|(position, slot)| match slot {
        Slot::Item(item) if below(6, draw) == 0 => Some((position, value(&item.shape, draw))),
        _ => None,
    });
    Value::Sequence(items.collect())
}

fn value(shape: &Shape, draw: &mut impl FnMut() -> u64) -> Value {
    match shape {
        Shape::Element { bits, .. } if *bits <= 64 => Value::Element(draw() >> (64 - bits)),
        Shape::Element { bits, .. } => Value::Octets((0..bits / 8).map(|_| draw() as u8).collect()),
        Shape::Group { parts, .. } => Value::Parts(parts.iter().filter_map(|part| part_value(part, draw)).collect()),
        Shape::Extended(parts) => {
            let mut values = Vec::new();
            for part in *parts {
                match part_value(part, draw) {
                    Some(value) => values.push(value),
                    None if draw() & 1 == 1 => break,
                    None => {}
                }
            }
            Value::Parts(values)
        }
        Shape::Counted(of) => Value::List((0..below(4, draw)).map(|_| value(of, draw)).collect()),
        Shape::Chained(of) => Value::List((0..=below(3, draw)).map(|_| value(of, draw)).collect()),
        Shape::Explicit => {
            let length = 1 + below(8, draw) as u8;
            Value::Octets([length].into_iter().chain((1..length).map(|_| draw() as u8)).collect())
        }
        Shape::Compound(items) => {
            let parts = items.iter().enumerate().filter_map(|(index, item)| {
                let item = item.as_ref()?;
                (draw() & 1 == 1).then(|| (index, value(&item.shape, draw)))
            });
            let parts: Vec<(usize, Value)> = parts.collect();
            Value::Chosen { octets: octets_for(&parts), parts }
        }
    }
}

/// Least octets of a field of bits that names these.
fn octets_for(named: &[(usize, Value)]) -> usize {
    named.last().map_or(1, |(last, _)| last / 7 + 1)
}

/// None for the bit that says whether the item goes on.
fn part_value(part: &Part, draw: &mut impl FnMut() -> u64) -> Option<Value> {
    match part {
        Part::Item(item) => Some(value(&item.shape, draw)),
        Part::Spare(_) => Some(Value::Element(0)),
        Part::Fx => None,
    }
}

fn below(limit: u64, draw: &mut impl FnMut() -> u64) -> u64 {
    ((u128::from(draw()) * u128::from(limit)) >> 64) as u64
}
