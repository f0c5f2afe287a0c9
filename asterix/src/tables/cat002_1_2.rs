//! Category 002, edition 1.2: Transmission of Monoradar Service Messages.
//!
//! Generated from the specification by `WRITE_TABLES=1 cargo test -p asterix --test tables`.

#[allow(clippy::wildcard_imports)]
use crate::definition::*;

/// Transmission of Monoradar Service Messages.
pub const CAT002_1_2: &Edition = &Edition {
    category: 2,
    number: "1.2",
    title: "Transmission of Monoradar Service Messages",
    profiles: &[Profile { name: "", slots: &[
        Slot::Item(&I010),
        Slot::Item(&I000),
        Slot::Item(&I020),
        Slot::Item(&I030),
        Slot::Item(&I041),
        Slot::Item(&I050),
        Slot::Item(&I060),
        Slot::Item(&I070),
        Slot::Item(&I100),
        Slot::Item(&I090),
        Slot::Item(&I080),
        Slot::Spare,
        Slot::Item(&ISP),
        Slot::Sequence,
    ] }],
    choice: None,
};

const I000: Item = Item { name: "000", title: "Message Type", shape: Shape::Element { bits: 8, content: Content::Table(&[(1, "North marker message"), (2, "Sector crossing message"), (3, "South marker message"), (8, "Activation of blind zone filtering"), (9, "Stop of blind zone filtering")]) } };

const I010: Item = Item { name: "010", title: "Data Source Identifier", shape: Shape::Group { bits: 16, parts: &[
    Part::Item(Item { name: "SAC", title: "System Area Code", shape: Shape::Element { bits: 8, content: Content::Raw } }),
    Part::Item(Item { name: "SIC", title: "System Identification Code", shape: Shape::Element { bits: 8, content: Content::Raw } }),
] } };

const I020: Item = Item { name: "020", title: "Sector Number", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: false, step: 360.0 / 256.0, unit: "°" } } };

const I030: Item = Item { name: "030", title: "Time of Day", shape: Shape::Element { bits: 24, content: Content::Quantity { signed: false, step: 1.0 / 128.0, unit: "s" } } };

const I041: Item = Item { name: "041", title: "Antenna Rotation Speed", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: false, step: 1.0 / 128.0, unit: "s" } } };

const I050: Item = Item { name: "050", title: "Station Configuration Status", shape: Shape::Chained(&Shape::Element { bits: 7, content: Content::Raw }) };

const I060: Item = Item { name: "060", title: "Station Processing Mode", shape: Shape::Chained(&Shape::Element { bits: 7, content: Content::Raw }) };

const I070: Item = Item { name: "070", title: "Plot Count Values", shape: Shape::Counted(&Shape::Group { bits: 16, parts: &[
    Part::Item(Item { name: "A", title: "Aerial Identification", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Counter for antenna 1"), (1, "Counter for antenna 2")]) } }),
    Part::Item(Item { name: "IDENT", title: "", shape: Shape::Element { bits: 5, content: Content::Table(&[(1, "Sole primary plots"), (2, "Sole SSR plots"), (3, "Combined plots")]) } }),
    Part::Item(Item { name: "COUNTER", title: "", shape: Shape::Element { bits: 10, content: Content::Integer { signed: false } } }),
] }) };

const I080: Item = Item { name: "080", title: "Warning/Error Conditions", shape: Shape::Chained(&Shape::Element { bits: 7, content: Content::Raw }) };

const I090: Item = Item { name: "090", title: "Collimation Error", shape: Shape::Group { bits: 16, parts: &[
    Part::Item(Item { name: "RE", title: "Range Error", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: true, step: 1.0 / 128.0, unit: "NM" } } }),
    Part::Item(Item { name: "AE", title: "Azimuth Error", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: true, step: 360.0 / 16384.0, unit: "°" } } }),
] } };

const I100: Item = Item { name: "100", title: "Dynamic Window Type 1", shape: Shape::Group { bits: 64, parts: &[
    Part::Item(Item { name: "RS", title: "Rho Start", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: false, step: 1.0 / 128.0, unit: "NM" } } }),
    Part::Item(Item { name: "RE", title: "Rho End", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: false, step: 1.0 / 128.0, unit: "NM" } } }),
    Part::Item(Item { name: "TS", title: "Theta Start", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: false, step: 360.0 / 65536.0, unit: "°" } } }),
    Part::Item(Item { name: "TE", title: "Theta End", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: false, step: 360.0 / 65536.0, unit: "°" } } }),
] } };

const ISP: Item = Item { name: "SP", title: "Special Purpose Field", shape: Shape::Explicit };
