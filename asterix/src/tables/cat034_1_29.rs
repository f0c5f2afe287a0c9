//! Category 034, edition 1.29: Transmission of Monoradar Service Messages.
//!
//! Generated from the specification by `WRITE_TABLES=1 cargo test -p asterix --test tables`.

#[allow(clippy::wildcard_imports)]
use crate::definition::*;

/// Transmission of Monoradar Service Messages.
pub const CAT034_1_29: &Edition = &Edition {
    category: 34,
    number: "1.29",
    title: "Transmission of Monoradar Service Messages",
    profiles: &[Profile { name: "", slots: &[
        Slot::Item(&I010),
        Slot::Item(&I000),
        Slot::Item(&I030),
        Slot::Item(&I020),
        Slot::Item(&I041),
        Slot::Item(&I050),
        Slot::Item(&I060),
        Slot::Item(&I070),
        Slot::Item(&I100),
        Slot::Item(&I110),
        Slot::Item(&I120),
        Slot::Item(&I090),
        Slot::Item(&IRE),
        Slot::Item(&ISP),
    ] }],
    choice: None,
};

const I000: Item = Item { name: "000", title: "Message Type", shape: Shape::Element { bits: 8, content: Content::Table(&[(1, "North marker message"), (2, "Sector crossing message"), (3, "Geographical filtering message"), (4, "Jamming strobe message"), (5, "Solar Storm Message"), (6, "SSR Jamming Strobe Message"), (7, "Mode S Jamming Strobe Message")]) } };

const I010: Item = Item { name: "010", title: "Data Source Identifier", shape: Shape::Group { bits: 16, parts: &[
    Part::Item(Item { name: "SAC", title: "System Area Code", shape: Shape::Element { bits: 8, content: Content::Raw } }),
    Part::Item(Item { name: "SIC", title: "System Identification Code", shape: Shape::Element { bits: 8, content: Content::Raw } }),
] } };

const I020: Item = Item { name: "020", title: "Sector Number", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: false, step: 360.0 / 256.0, unit: "°" } } };

const I030: Item = Item { name: "030", title: "Time of Day", shape: Shape::Element { bits: 24, content: Content::Quantity { signed: false, step: 1.0 / 128.0, unit: "s" } } };

const I041: Item = Item { name: "041", title: "Antenna Rotation Speed", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: false, step: 1.0 / 128.0, unit: "s" } } };

const I050: Item = Item { name: "050", title: "System Configuration and Status", shape: Shape::Compound(&[
    Some(Item { name: "COM", title: "Common Part", shape: Shape::Group { bits: 8, parts: &[
        Part::Item(Item { name: "NOGO", title: "Operational Release Status of the System", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "System is released for operational use"), (1, "Operational use of System is inhibited, i.e. the data shall be discarded by an operational SDPS")]) } }),
        Part::Item(Item { name: "RDPC", title: "Radar Data Processor Chain Selection Status", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "RDPC-1 selected"), (1, "RDPC-2 selected")]) } }),
        Part::Item(Item { name: "RDPR", title: "Event to Signal a Reset/restart of the Selected Radar Data Processor Chain, I.e. Expect a New Assignment of Track Numbers", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Default situation"), (1, "Reset of RDPC")]) } }),
        Part::Item(Item { name: "OVLRDP", title: "Radar Data Processor Overload Indicator", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Default, no overload"), (1, "Overload in RDP")]) } }),
        Part::Item(Item { name: "OVLXMT", title: "Transmission Subsystem Overload Status", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Default, no overload"), (1, "Overload in transmission subsystem")]) } }),
        Part::Item(Item { name: "MSC", title: "Monitoring System Connected Status", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Monitoring system connected"), (1, "Monitoring system disconnected")]) } }),
        Part::Item(Item { name: "TSV", title: "Time Source Validity", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Valid"), (1, "Invalid")]) } }),
        Part::Spare(1),
    ] } }),
    None,
    None,
    Some(Item { name: "PSR", title: "Specific Status Information for a PSR Sensor", shape: Shape::Group { bits: 8, parts: &[
        Part::Item(Item { name: "ANT", title: "Selected Antenna", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Antenna 1"), (1, "Antenna 2")]) } }),
        Part::Item(Item { name: "CHAB", title: "Channel A/B Selection Status", shape: Shape::Element { bits: 2, content: Content::Table(&[(0, "No channel selected"), (1, "Channel A only selected"), (2, "Channel B only selected"), (3, "Diversity mode ; Channel A and B selected")]) } }),
        Part::Item(Item { name: "OVL", title: "Overload Condition", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "No overload"), (1, "Overload")]) } }),
        Part::Item(Item { name: "MSC", title: "Monitoring System Connected Status", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Monitoring system connected"), (1, "Monitoring system disconnected")]) } }),
        Part::Spare(3),
    ] } }),
    Some(Item { name: "SSR", title: "Specific Status Information for a SSR Sensor", shape: Shape::Group { bits: 8, parts: &[
        Part::Item(Item { name: "ANT", title: "Selected Antenna", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Antenna 1"), (1, "Antenna 2")]) } }),
        Part::Item(Item { name: "CHAB", title: "Channel A/B Selection Status", shape: Shape::Element { bits: 2, content: Content::Table(&[(0, "No channel selected"), (1, "Channel A only selected"), (2, "Channel B only selected"), (3, "Invalid combination")]) } }),
        Part::Item(Item { name: "OVL", title: "Overload Condition", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "No overload"), (1, "Overload")]) } }),
        Part::Item(Item { name: "MSC", title: "Monitoring System Connected Status:", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Monitoring system connected"), (1, "Monitoring system disconnected")]) } }),
        Part::Spare(3),
    ] } }),
    Some(Item { name: "MDS", title: "Specific Status Information for a Mode S Sensor", shape: Shape::Group { bits: 16, parts: &[
        Part::Item(Item { name: "ANT", title: "Selected Antenna", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Antenna 1"), (1, "Antenna 2")]) } }),
        Part::Item(Item { name: "CHAB", title: "Channel A/B Selection Status", shape: Shape::Element { bits: 2, content: Content::Table(&[(0, "No channel selected"), (1, "Channel A only selected"), (2, "Channel B only selected"), (3, "Illegal combination")]) } }),
        Part::Item(Item { name: "OVLSUR", title: "Overload Condition", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "No overload"), (1, "Overload")]) } }),
        Part::Item(Item { name: "MSC", title: "Monitoring System Connected Status:", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Monitoring system connected"), (1, "Monitoring system disconnected")]) } }),
        Part::Item(Item { name: "SCF", title: "Channel A/B Selection Status for Surveillance Co-ordination Function", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Channel A in use"), (1, "Channel B in use")]) } }),
        Part::Item(Item { name: "DLF", title: "Channel A/B Selection Status for Data Link Function", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Channel A in use"), (1, "Channel B in use")]) } }),
        Part::Item(Item { name: "OVLSCF", title: "Overload in Surveillance Co-ordination Function", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "No overload"), (1, "Overload")]) } }),
        Part::Item(Item { name: "OVLDLF", title: "Overload in Data Link Function", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "No overload"), (1, "Overload")]) } }),
        Part::Spare(7),
    ] } }),
]) };

const I060: Item = Item { name: "060", title: "System Processing Mode", shape: Shape::Compound(&[
    Some(Item { name: "COM", title: "Common Part", shape: Shape::Group { bits: 8, parts: &[
        Part::Spare(1),
        Part::Item(Item { name: "REDRDP", title: "Reduction Steps in Use for An Overload of the RDP", shape: Shape::Element { bits: 3, content: Content::Table(&[(0, "No reduction active"), (1, "Reduction step 1 active"), (2, "Reduction step 2 active"), (3, "Reduction step 3 active"), (4, "Reduction step 4 active"), (5, "Reduction step 5 active"), (6, "Reduction step 6 active"), (7, "Reduction step 7 active")]) } }),
        Part::Item(Item { name: "REDXMT", title: "Reduction Steps in Use for An Overload of the Transmission Subsystem", shape: Shape::Element { bits: 3, content: Content::Table(&[(0, "No reduction active"), (1, "Reduction step 1 active"), (2, "Reduction step 2 active"), (3, "Reduction step 3 active"), (4, "Reduction step 4 active"), (5, "Reduction step 5 active"), (6, "Reduction step 6 active"), (7, "Reduction step 7 active")]) } }),
        Part::Spare(1),
    ] } }),
    None,
    None,
    Some(Item { name: "PSR", title: "Specific Processing Mode Information for a PSR Sensor", shape: Shape::Group { bits: 8, parts: &[
        Part::Item(Item { name: "POL", title: "Polarization in Use by PSR", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Linear polarization"), (1, "Circular polarization")]) } }),
        Part::Item(Item { name: "REDRAD", title: "Reduction Steps in Use as Result of An Overload Within the PSR Subsystem", shape: Shape::Element { bits: 3, content: Content::Table(&[(0, "No reduction active"), (1, "Reduction step 1 active"), (2, "Reduction step 2 active"), (3, "Reduction step 3 active"), (4, "Reduction step 4 active"), (5, "Reduction step 5 active"), (6, "Reduction step 6 active"), (7, "Reduction step 7 active")]) } }),
        Part::Item(Item { name: "STC", title: "Sensitivity Time Control Map in Use", shape: Shape::Element { bits: 2, content: Content::Table(&[(0, "STC Map-1"), (1, "STC Map-2"), (2, "STC Map-3"), (3, "STC Map-4")]) } }),
        Part::Spare(2),
    ] } }),
    Some(Item { name: "SSR", title: "Specific Processing Mode Information for a SSR Sensor", shape: Shape::Group { bits: 8, parts: &[
        Part::Item(Item { name: "REDRAD", title: "Reduction Steps in Use as Result of An Overload Within the SSR Subsystem", shape: Shape::Element { bits: 3, content: Content::Table(&[(0, "No reduction active"), (1, "Reduction step 1 active"), (2, "Reduction step 2 active"), (3, "Reduction step 3 active"), (4, "Reduction step 4 active"), (5, "Reduction step 5 active"), (6, "Reduction step 6 active"), (7, "Reduction step 7 active")]) } }),
        Part::Spare(5),
    ] } }),
    Some(Item { name: "MDS", title: "Specific Processing Mode Information for a Mode S Sensor", shape: Shape::Group { bits: 8, parts: &[
        Part::Item(Item { name: "REDRAD", title: "Reduction Steps in Use as Result of An Overload Within the Mode S Subsystem", shape: Shape::Element { bits: 3, content: Content::Table(&[(0, "No reduction active"), (1, "Reduction step 1 active"), (2, "Reduction step 2 active"), (3, "Reduction step 3 active"), (4, "Reduction step 4 active"), (5, "Reduction step 5 active"), (6, "Reduction step 6 active"), (7, "Reduction step 7 active")]) } }),
        Part::Item(Item { name: "CLU", title: "Cluster State", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Autonomous"), (1, "Not autonomous")]) } }),
        Part::Spare(4),
    ] } }),
]) };

const I070: Item = Item { name: "070", title: "Message Count Values", shape: Shape::Counted(&Shape::Group { bits: 16, parts: &[
    Part::Item(Item { name: "TYP", title: "Type of Message Counter", shape: Shape::Element { bits: 5, content: Content::Table(&[(0, "No detection (number of misses)"), (1, "Single PSR target reports"), (2, "Single SSR target reports (Non-Mode S)"), (3, "SSR+PSR target reports (Non-Mode S)"), (4, "Single All-Call target reports (Mode S)"), (5, "Single Roll-Call target reports (Mode S)"), (6, "All-Call + PSR (Mode S) target reports"), (7, "Roll-Call + PSR (Mode S) target reports"), (8, "Filter for Weather data"), (9, "Filter for Jamming Strobe"), (10, "Filter for PSR data"), (11, "Filter for SSR/Mode S data"), (12, "Filter for SSR/Mode S+PSR data"), (13, "Filter for Enhanced Surveillance data"), (14, "Filter for PSR+Enhanced Surveillance"), (15, "Filter for PSR+Enhanced Surveillance + SSR/Mode S data not in Area of Prime Interest"), (16, "Filter for PSR+Enhanced Surveillance + all SSR/Mode S data"), (17, "Re-Interrogations (per sector)"), (18, "BDS Swap and wrong DF replies(per sector)"), (19, "Mode A/C FRUIT (per sector)"), (20, "Mode S FRUIT (per sector)")]) } }),
    Part::Item(Item { name: "COUNT", title: "COUNTER", shape: Shape::Element { bits: 11, content: Content::Integer { signed: false } } }),
] }) };

const I090: Item = Item { name: "090", title: "Collimation Error", shape: Shape::Group { bits: 16, parts: &[
    Part::Item(Item { name: "RNG", title: "Range Error", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: true, step: 1.0 / 128.0, unit: "NM" } } }),
    Part::Item(Item { name: "AZM", title: "Azimuth Error", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: true, step: 360.0 / 16384.0, unit: "°" } } }),
] } };

const I100: Item = Item { name: "100", title: "Generic Polar Window", shape: Shape::Group { bits: 64, parts: &[
    Part::Item(Item { name: "RHOST", title: "Rho Start", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: false, step: 1.0 / 256.0, unit: "NM" } } }),
    Part::Item(Item { name: "RHOEND", title: "Rho End", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: false, step: 1.0 / 256.0, unit: "NM" } } }),
    Part::Item(Item { name: "THETAST", title: "Theta Start", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: false, step: 360.0 / 65536.0, unit: "°" } } }),
    Part::Item(Item { name: "THETAEND", title: "Theta End", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: false, step: 360.0 / 65536.0, unit: "°" } } }),
] } };

const I110: Item = Item { name: "110", title: "Data Filter", shape: Shape::Element { bits: 8, content: Content::Table(&[(0, "Invalid value"), (1, "Filter for Weather data"), (2, "Filter for Jamming Strobe"), (3, "Filter for PSR data"), (4, "Filter for SSR/Mode S data"), (5, "Filter for SSR/Mode S + PSR data"), (6, "Enhanced Surveillance data"), (7, "Filter for PSR+Enhanced Surveillance data"), (8, "Filter for PSR+Enhanced Surveillance + SSR/Mode S data not in Area of Prime Interest"), (9, "Filter for PSR+Enhanced Surveillance + all SSR/Mode S data")]) } };

const I120: Item = Item { name: "120", title: "3D-Position Of Data Source", shape: Shape::Group { bits: 64, parts: &[
    Part::Item(Item { name: "HGT", title: "Height of Data Source", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: true, step: 1.0, unit: "m" } } }),
    Part::Item(Item { name: "LAT", title: "Latitude", shape: Shape::Element { bits: 24, content: Content::Quantity { signed: true, step: 180.0 / 8_388_608.0, unit: "°" } } }),
    Part::Item(Item { name: "LON", title: "Longitude", shape: Shape::Element { bits: 24, content: Content::Quantity { signed: true, step: 180.0 / 8_388_608.0, unit: "°" } } }),
] } };

const IRE: Item = Item { name: "RE", title: "Reserved Expansion Field", shape: Shape::Explicit };

const ISP: Item = Item { name: "SP", title: "Special Purpose Field", shape: Shape::Explicit };
