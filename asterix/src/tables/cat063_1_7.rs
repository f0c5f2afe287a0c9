//! Category 063, edition 1.7: Sensor Status Reports.
//!
//! Generated from the specification by `WRITE_TABLES=1 cargo test -p asterix --test tables`.

#[allow(clippy::wildcard_imports)]
use crate::definition::*;

/// Sensor Status Reports.
pub const CAT063_1_7: &Edition = &Edition {
    category: 63,
    number: "1.7",
    title: "Sensor Status Reports",
    profiles: &[Profile { name: "", slots: &[
        Slot::Item(&I010),
        Slot::Item(&I015),
        Slot::Item(&I030),
        Slot::Item(&I050),
        Slot::Item(&I060),
        Slot::Item(&I070),
        Slot::Item(&I080),
        Slot::Item(&I081),
        Slot::Item(&I090),
        Slot::Item(&I091),
        Slot::Item(&I092),
        Slot::Spare,
        Slot::Item(&IRE),
        Slot::Item(&ISP),
    ] }],
    choice: None,
};

const I010: Item = Item { name: "010", title: "Data Source Identifier", shape: Shape::Group { bits: 16, parts: &[
    Part::Item(Item { name: "SAC", title: "System Area Code", shape: Shape::Element { bits: 8, content: Content::Raw } }),
    Part::Item(Item { name: "SIC", title: "System Identification Code", shape: Shape::Element { bits: 8, content: Content::Raw } }),
] } };

const I015: Item = Item { name: "015", title: "Service Identification", shape: Shape::Element { bits: 8, content: Content::Raw } };

const I030: Item = Item { name: "030", title: "Time of Message", shape: Shape::Element { bits: 24, content: Content::Quantity { signed: false, step: 1.0 / 128.0, unit: "s" } } };

const I050: Item = Item { name: "050", title: "Sensor Identifier", shape: Shape::Group { bits: 16, parts: &[
    Part::Item(Item { name: "SAC", title: "System Area Code", shape: Shape::Element { bits: 8, content: Content::Raw } }),
    Part::Item(Item { name: "SIC", title: "System Identification Code", shape: Shape::Element { bits: 8, content: Content::Raw } }),
] } };

const I060: Item = Item { name: "060", title: "Sensor Configuration and Status", shape: Shape::Extended(&[
    Part::Item(Item { name: "CON", title: "", shape: Shape::Element { bits: 2, content: Content::Table(&[(0, "Operational"), (1, "Degraded"), (2, "Initialization"), (3, "Not currently connected")]) } }),
    Part::Item(Item { name: "PSR", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "PSR GO"), (1, "PSR NOGO")]) } }),
    Part::Item(Item { name: "SSR", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "SSR GO"), (1, "SSR NOGO")]) } }),
    Part::Item(Item { name: "MDS", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "MDS GO"), (1, "MDS NOGO")]) } }),
    Part::Item(Item { name: "ADS", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "ADS GO"), (1, "ADS NOGO")]) } }),
    Part::Item(Item { name: "MLT", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "MLT GO"), (1, "MLT NOGO")]) } }),
    Part::Fx,
    Part::Item(Item { name: "OPS", title: "Operational Release Status of the System", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "System is released for operational use"), (1, "Operational use of System is inhibited")]) } }),
    Part::Item(Item { name: "ODP", title: "Data Processor Overload Indicator", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Default, no overload"), (1, "Overload in DP")]) } }),
    Part::Item(Item { name: "OXT", title: "Transmission Subsystem Overload Status", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Default, no overload"), (1, "Overload in transmission subsystem")]) } }),
    Part::Item(Item { name: "MSC", title: "Monitoring System Connected Status", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Monitoring system connected"), (1, "Monitoring system disconnected")]) } }),
    Part::Item(Item { name: "TSV", title: "Time Source Validity", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Valid"), (1, "Invalid")]) } }),
    Part::Item(Item { name: "NPW", title: "No Plot Warning", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Default (no meaning)"), (1, "No plots being received")]) } }),
    Part::Spare(1),
    Part::Fx,
    Part::Item(Item { name: "TTF", title: "Test Target Failure Status from Sensor", shape: Shape::Group { bits: 2, parts: &[
        Part::Item(Item { name: "EP", title: "Element Populated Bit", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Element not populated"), (1, "Element populated")]) } }),
        Part::Item(Item { name: "VAL", title: "Test Target Failure Status Values", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Test Target Operative"), (1, "Test Target Failure")]) } }),
    ] } }),
    Part::Item(Item { name: "SPO", title: "Indication of Spoofing Attack from Sensor", shape: Shape::Group { bits: 2, parts: &[
        Part::Item(Item { name: "EP", title: "Element Populated Bit", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Element not populated"), (1, "Element populated")]) } }),
        Part::Item(Item { name: "VAL", title: "Indication of Spoofing Attack Values", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "No spoofing detected"), (1, "Potential spoofing attack")]) } }),
    ] } }),
    Part::Spare(3),
    Part::Fx,
]) };

const I070: Item = Item { name: "070", title: "Time Stamping Bias", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: true, step: 1.0, unit: "ms" } } };

const I080: Item = Item { name: "080", title: "SSR / Mode S Range Gain and Bias", shape: Shape::Group { bits: 32, parts: &[
    Part::Item(Item { name: "SRG", title: "Mode S Range Gain", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: true, step: 1.0 / 100_000.0, unit: "" } } }),
    Part::Item(Item { name: "SRB", title: "Mode S Range Bias", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: true, step: 1.0 / 128.0, unit: "NM" } } }),
] } };

const I081: Item = Item { name: "081", title: "SSR Mode S Azimuth Bias", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: true, step: 360.0 / 65536.0, unit: "°" } } };

const I090: Item = Item { name: "090", title: "PSR Range Gain and Bias", shape: Shape::Group { bits: 32, parts: &[
    Part::Item(Item { name: "PRG", title: "PSR Range Gain", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: true, step: 1.0 / 100_000.0, unit: "" } } }),
    Part::Item(Item { name: "PRB", title: "PSR Range Bias", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: true, step: 1.0 / 128.0, unit: "NM" } } }),
] } };

const I091: Item = Item { name: "091", title: "PSR Azimuth Bias", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: true, step: 360.0 / 65536.0, unit: "°" } } };

const I092: Item = Item { name: "092", title: "PSR Elevation Bias", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: true, step: 360.0 / 65536.0, unit: "°" } } };

const IRE: Item = Item { name: "RE", title: "Reserved Expansion Field", shape: Shape::Explicit };

const ISP: Item = Item { name: "SP", title: "Special Purpose Field", shape: Shape::Explicit };
