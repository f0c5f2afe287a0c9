//! Category 065, edition 1.6: SDPS Service Status Reports.
//!
//! Generated from the specification by `WRITE_TABLES=1 cargo test -p asterix --test tables`.

#[allow(clippy::wildcard_imports)]
use crate::definition::*;

/// SDPS Service Status Reports.
pub const CAT065_1_6: &Edition = &Edition {
    category: 65,
    number: "1.6",
    title: "SDPS Service Status Reports",
    profiles: &[Profile { name: "", slots: &[
        Slot::Item(&I010),
        Slot::Item(&I000),
        Slot::Item(&I015),
        Slot::Item(&I030),
        Slot::Item(&I020),
        Slot::Item(&I040),
        Slot::Item(&I050),
        Slot::Spare,
        Slot::Spare,
        Slot::Spare,
        Slot::Spare,
        Slot::Spare,
        Slot::Item(&IRE),
        Slot::Item(&ISP),
    ] }],
    choice: None,
};

const I000: Item = Item { name: "000", title: "Message Type", shape: Shape::Element { bits: 8, content: Content::Table(&[(1, "SDPS Status"), (2, "End of Batch"), (3, "Service Status Report")]) } };

const I010: Item = Item { name: "010", title: "Data Source Identifier", shape: Shape::Group { bits: 16, parts: &[
    Part::Item(Item { name: "SAC", title: "System Area Code", shape: Shape::Element { bits: 8, content: Content::Raw } }),
    Part::Item(Item { name: "SIC", title: "System Identification Code", shape: Shape::Element { bits: 8, content: Content::Raw } }),
] } };

const I015: Item = Item { name: "015", title: "Service Identification", shape: Shape::Element { bits: 8, content: Content::Raw } };

const I020: Item = Item { name: "020", title: "Batch Number", shape: Shape::Element { bits: 8, content: Content::Integer { signed: false } } };

const I030: Item = Item { name: "030", title: "Time of Message", shape: Shape::Element { bits: 24, content: Content::Quantity { signed: false, step: 1.0 / 128.0, unit: "s" } } };

const I040: Item = Item { name: "040", title: "SDPS Configuration and Status", shape: Shape::Group { bits: 8, parts: &[
    Part::Item(Item { name: "NOGO", title: "", shape: Shape::Element { bits: 2, content: Content::Table(&[(0, "Operational"), (1, "Degraded"), (2, "Not currently connected"), (3, "Unknown")]) } }),
    Part::Item(Item { name: "OVL", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Default"), (1, "Overload")]) } }),
    Part::Item(Item { name: "TSV", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Default"), (1, "Invalid Time Source")]) } }),
    Part::Item(Item { name: "PSS", title: "Processing System Status", shape: Shape::Element { bits: 2, content: Content::Table(&[(0, "Not applicable"), (1, "SDPS-1 selected"), (2, "SDPS-2 selected"), (3, "SDPS-3 selected")]) } }),
    Part::Item(Item { name: "STTN", title: "Track Re-numbering Indication", shape: Shape::Element { bits: 1, content: Content::Raw } }),
    Part::Spare(1),
] } };

const I050: Item = Item { name: "050", title: "Service Status Report", shape: Shape::Element { bits: 8, content: Content::Table(&[(1, "Service degradation"), (2, "Service degradation ended"), (3, "Main radar out of service"), (4, "Service interrupted by the operator"), (5, "Service interrupted due to contingency"), (6, "Ready for service restart after contingency"), (7, "Service ended by the operator"), (8, "Failure of user main radar"), (9, "Service restarted by the operator"), (10, "Main radar becoming operational"), (11, "Main radar becoming degraded"), (12, "Service continuity interrupted due to disconnection with adjacent unit"), (13, "Service continuity restarted"), (14, "Service synchronised on backup radar"), (15, "Service synchronised on main radar"), (16, "Main and backup radar, if any, failed")]) } };

const IRE: Item = Item { name: "RE", title: "Reserved Expansion Field", shape: Shape::Explicit };

const ISP: Item = Item { name: "SP", title: "Special Purpose Field", shape: Shape::Explicit };
