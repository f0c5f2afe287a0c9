//! Category 240, edition 1.3: Radar Video Transmission.
//!
//! Generated from the specification by `WRITE_TABLES=1 cargo test -p asterix --test tables`.

#[allow(clippy::wildcard_imports)]
use crate::definition::*;

/// Radar Video Transmission.
pub const CAT240_1_3: &Edition = &Edition {
    category: 240,
    number: "1.3",
    title: "Radar Video Transmission",
    profiles: &[Profile { name: "", slots: &[
        Slot::Item(&I010),
        Slot::Item(&I000),
        Slot::Item(&I020),
        Slot::Item(&I030),
        Slot::Item(&I040),
        Slot::Item(&I041),
        Slot::Item(&I048),
        Slot::Item(&I049),
        Slot::Item(&I050),
        Slot::Item(&I051),
        Slot::Item(&I052),
        Slot::Item(&I140),
        Slot::Item(&IRE),
        Slot::Item(&ISP),
    ] }],
    choice: None,
};

const I000: Item = Item { name: "000", title: "Message Type", shape: Shape::Element { bits: 8, content: Content::Table(&[(1, "Video Summary message"), (2, "Video message")]) } };

const I010: Item = Item { name: "010", title: "Data Source Identifier", shape: Shape::Group { bits: 16, parts: &[
    Part::Item(Item { name: "SAC", title: "System Area Code", shape: Shape::Element { bits: 8, content: Content::Raw } }),
    Part::Item(Item { name: "SIC", title: "System Identification Code", shape: Shape::Element { bits: 8, content: Content::Raw } }),
] } };

const I020: Item = Item { name: "020", title: "Video Record Header", shape: Shape::Element { bits: 32, content: Content::Integer { signed: false } } };

const I030: Item = Item { name: "030", title: "Video Summary", shape: Shape::Counted(&Shape::Element { bits: 8, content: Content::Text(Text::Ascii) }) };

const I040: Item = Item { name: "040", title: "Video Header Nano", shape: Shape::Group { bits: 96, parts: &[
    Part::Item(Item { name: "STARTAZ", title: "Start Azimuth of the Cells Group", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: false, step: 360.0 / 65536.0, unit: "°" } } }),
    Part::Item(Item { name: "ENDAZ", title: "End Azimuth of the Cells Group", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: false, step: 360.0 / 65536.0, unit: "°" } } }),
    Part::Item(Item { name: "STARTRG", title: "Starting Range of the Cells Group, Expressed in Number of Cells", shape: Shape::Element { bits: 32, content: Content::Integer { signed: false } } }),
    Part::Item(Item { name: "CELLDUR", title: "Video Cell Duration in Nano-seconds", shape: Shape::Element { bits: 32, content: Content::Quantity { signed: false, step: 1.0, unit: "ns" } } }),
] } };

const I041: Item = Item { name: "041", title: "Video Header Femto", shape: Shape::Group { bits: 96, parts: &[
    Part::Item(Item { name: "STARTAZ", title: "Start Azimuth of the Cells Group", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: false, step: 360.0 / 65536.0, unit: "°" } } }),
    Part::Item(Item { name: "ENDAZ", title: "End Azimuth of the Cells Group", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: false, step: 360.0 / 65536.0, unit: "°" } } }),
    Part::Item(Item { name: "STARTRG", title: "Starting Range of the Cells Group, Expressed in Number of Cells", shape: Shape::Element { bits: 32, content: Content::Integer { signed: false } } }),
    Part::Item(Item { name: "CELLDUR", title: "Video Cell Duration in Femto-seconds", shape: Shape::Element { bits: 32, content: Content::Quantity { signed: false, step: 1.0, unit: "fs" } } }),
] } };

const I048: Item = Item { name: "048", title: "Video Cells Resolution & Data Compression Indicator", shape: Shape::Group { bits: 16, parts: &[
    Part::Item(Item { name: "C", title: "Data Compression Indicator", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "No compression applied"), (1, "Compression applied")]) } }),
    Part::Spare(7),
    Part::Item(Item { name: "RES", title: "Bit Resolution", shape: Shape::Element { bits: 8, content: Content::Table(&[(1, "Monobit Resolution (1 bit)"), (2, "Low Resolution (2 bits)"), (3, "Medium Resolution (4 bits)"), (4, "High Resolution (8 bits)"), (5, "Very High Resolution (16 bits)"), (6, "Ultra High Resolution (32 bits)")]) } }),
] } };

const I049: Item = Item { name: "049", title: "Video Octets & Video Cells Counters", shape: Shape::Group { bits: 40, parts: &[
    Part::Item(Item { name: "NBVB", title: "Number of 'valid' Octets", shape: Shape::Element { bits: 16, content: Content::Integer { signed: false } } }),
    Part::Item(Item { name: "NBCELLS", title: "Number of 'valid' Cells", shape: Shape::Element { bits: 24, content: Content::Integer { signed: false } } }),
] } };

const I050: Item = Item { name: "050", title: "Video Block Low Data Volume", shape: Shape::Counted(&Shape::Element { bits: 32, content: Content::Raw }) };

const I051: Item = Item { name: "051", title: "Video Block Medium Data Volume", shape: Shape::Counted(&Shape::Element { bits: 512, content: Content::Raw }) };

const I052: Item = Item { name: "052", title: "Video Block High Data Volume", shape: Shape::Counted(&Shape::Element { bits: 2048, content: Content::Raw }) };

const I140: Item = Item { name: "140", title: "Time of Day", shape: Shape::Element { bits: 24, content: Content::Quantity { signed: false, step: 1.0 / 128.0, unit: "s" } } };

const IRE: Item = Item { name: "RE", title: "Reserved Expansion Field", shape: Shape::Explicit };

const ISP: Item = Item { name: "SP", title: "Special Purpose Field", shape: Shape::Explicit };
