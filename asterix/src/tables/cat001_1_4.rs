//! Category 001, edition 1.4: Transmission of Monoradar Data Target Reports.
//!
//! Generated from the specification by `WRITE_TABLES=1 cargo test -p asterix --test tables`.

#[allow(clippy::wildcard_imports)]
use crate::definition::*;

/// Transmission of Monoradar Data Target Reports.
pub const CAT001_1_4: &Edition = &Edition {
    category: 1,
    number: "1.4",
    title: "Transmission of Monoradar Data Target Reports",
    profiles: &[Profile { name: "plot", slots: &[
        Slot::Item(&I010),
        Slot::Item(&I020),
        Slot::Item(&I040),
        Slot::Item(&I070),
        Slot::Item(&I090),
        Slot::Item(&I130),
        Slot::Item(&I141),
        Slot::Item(&I050),
        Slot::Item(&I120),
        Slot::Item(&I131),
        Slot::Item(&I080),
        Slot::Item(&I100),
        Slot::Item(&I060),
        Slot::Item(&I030),
        Slot::Item(&I150),
        Slot::Spare,
        Slot::Spare,
        Slot::Spare,
        Slot::Spare,
        Slot::Item(&ISP),
        Slot::Sequence,
    ] }, Profile { name: "track", slots: &[
        Slot::Item(&I010),
        Slot::Item(&I020),
        Slot::Item(&I161),
        Slot::Item(&I040),
        Slot::Item(&I042),
        Slot::Item(&I200),
        Slot::Item(&I070),
        Slot::Item(&I090),
        Slot::Item(&I141),
        Slot::Item(&I130),
        Slot::Item(&I131),
        Slot::Item(&I120),
        Slot::Item(&I170),
        Slot::Item(&I210),
        Slot::Item(&I050),
        Slot::Item(&I080),
        Slot::Item(&I100),
        Slot::Item(&I060),
        Slot::Item(&I030),
        Slot::Item(&ISP),
        Slot::Sequence,
        Slot::Item(&I150),
    ] }],
    choice: Some(Choice { item: "020", bit: 0, bits: 1, profiles: &[(0, 0), (1, 1)] }),
};

const I010: Item = Item { name: "010", title: "Data Source Identifier", shape: Shape::Group { bits: 16, parts: &[
    Part::Item(Item { name: "SAC", title: "System Area Code", shape: Shape::Element { bits: 8, content: Content::Raw } }),
    Part::Item(Item { name: "SIC", title: "System Identification Code", shape: Shape::Element { bits: 8, content: Content::Raw } }),
] } };

const I020: Item = Item { name: "020", title: "Target Report Descriptor", shape: Shape::Extended(&[
    Part::Item(Item { name: "TYP", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Plot"), (1, "Track")]) } }),
    Part::Item(Item { name: "SIM", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Actual plot or track"), (1, "Simulated plot or track")]) } }),
    Part::Item(Item { name: "SSRPSR", title: "Radar Detection in Last Antenna Scan", shape: Shape::Element { bits: 2, content: Content::Table(&[(0, "No detection"), (1, "Sole primary detection"), (2, "Sole secondary detection"), (3, "Combined primary and secondary detection")]) } }),
    Part::Item(Item { name: "ANT", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Target report from antenna 1"), (1, "Target report from antenna 2")]) } }),
    Part::Item(Item { name: "SPI", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Default"), (1, "Special Position Identification")]) } }),
    Part::Item(Item { name: "RAB", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Default"), (1, "Plot or track from a fixed transponder")]) } }),
    Part::Fx,
    Part::Item(Item { name: "TST", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Default"), (1, "Test target indicator")]) } }),
    Part::Item(Item { name: "DS1DS2", title: "Radar Detection in Last Antenna Scan", shape: Shape::Element { bits: 2, content: Content::Table(&[(0, "Default"), (1, "Unlawful interference (code 7500)"), (2, "Radio-communication failure (code 7600)"), (3, "Emergency (code 7700)")]) } }),
    Part::Item(Item { name: "ME", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Default"), (1, "Military emergency")]) } }),
    Part::Item(Item { name: "MI", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Default"), (1, "Military identification")]) } }),
    Part::Spare(2),
    Part::Fx,
]) };

const I030: Item = Item { name: "030", title: "Warning/Error Conditions", shape: Shape::Chained(&Shape::Element { bits: 7, content: Content::Table(&[(0, "No warning nor error condition"), (1, "Garbled reply"), (2, "Reflection"), (3, "Sidelobe reply"), (4, "Split plot"), (5, "Second time around reply"), (6, "Angels"), (7, "Terrestrial vehicles"), (64, "Possible wrong code in Mode-3/A"), (65, "Possible wrong altitude information, transmitted when the Code C credibility check fails together with the Mode-C code in binary notation"), (66, "Possible phantom MSSR plot"), (80, "Fixed PSR plot"), (81, "Slow PSR plot"), (82, "Low quality PSR plot")]) }) };

const I040: Item = Item { name: "040", title: "Measured Position in Polar Co-ordinates", shape: Shape::Group { bits: 32, parts: &[
    Part::Item(Item { name: "RHO", title: "", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: false, step: 1.0 / 128.0, unit: "NM" } } }),
    Part::Item(Item { name: "THETA", title: "", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: false, step: 360.0 / 65536.0, unit: "°" } } }),
] } };

const I042: Item = Item { name: "042", title: "Calculated Position in Cartesian Co-ordinates", shape: Shape::Group { bits: 32, parts: &[
    Part::Item(Item { name: "X", title: "X-Component", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: true, step: 1.0 / 64.0, unit: "NM" } } }),
    Part::Item(Item { name: "Y", title: "Y-Component", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: true, step: 1.0 / 64.0, unit: "NM" } } }),
] } };

const I050: Item = Item { name: "050", title: "Mode-2 Code in Octal Representation", shape: Shape::Group { bits: 16, parts: &[
    Part::Item(Item { name: "V", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Code validated"), (1, "Code not validated")]) } }),
    Part::Item(Item { name: "G", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Default"), (1, "Garbled code")]) } }),
    Part::Item(Item { name: "L", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Mode-2 code as derived from the reply of the transponder"), (1, "Smoothed Mode-2 code as provided by a local tracker")]) } }),
    Part::Spare(1),
    Part::Item(Item { name: "MODE2", title: "Mode-2 Code in Octal Representation", shape: Shape::Element { bits: 12, content: Content::Text(Text::Octal) } }),
] } };

const I060: Item = Item { name: "060", title: "Mode-2 Code Confidence Indicator", shape: Shape::Group { bits: 16, parts: &[
    Part::Spare(4),
    Part::Item(Item { name: "QA4", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "High quality pulse A4"), (1, "Low quality pulse A4")]) } }),
    Part::Item(Item { name: "QA2", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "High quality pulse A2"), (1, "Low quality pulse A2")]) } }),
    Part::Item(Item { name: "QA1", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "High quality pulse A1"), (1, "Low quality pulse A1")]) } }),
    Part::Item(Item { name: "QB4", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "High quality pulse B4"), (1, "Low quality pulse B4")]) } }),
    Part::Item(Item { name: "QB2", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "High quality pulse B2"), (1, "Low quality pulse B2")]) } }),
    Part::Item(Item { name: "QB1", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "High quality pulse B1"), (1, "Low quality pulse B1")]) } }),
    Part::Item(Item { name: "QC4", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "High quality pulse C4"), (1, "Low quality pulse C4")]) } }),
    Part::Item(Item { name: "QC2", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "High quality pulse C2"), (1, "Low quality pulse C2")]) } }),
    Part::Item(Item { name: "QC1", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "High quality pulse C1"), (1, "Low quality pulse C1")]) } }),
    Part::Item(Item { name: "QD4", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "High quality pulse D4"), (1, "Low quality pulse D4")]) } }),
    Part::Item(Item { name: "QD2", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "High quality pulse D2"), (1, "Low quality pulse D2")]) } }),
    Part::Item(Item { name: "QD1", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "High quality pulse D1"), (1, "Low quality pulse D1")]) } }),
] } };

const I070: Item = Item { name: "070", title: "Mode-3/A Code in Octal Representation", shape: Shape::Group { bits: 16, parts: &[
    Part::Item(Item { name: "V", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Code validated"), (1, "Code not validated")]) } }),
    Part::Item(Item { name: "G", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Default"), (1, "Garbled code")]) } }),
    Part::Item(Item { name: "L", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Mode-3/A code derived from the reply of the transponder"), (1, "Smoothed Mode-3/A code as provided by a local tracker")]) } }),
    Part::Spare(1),
    Part::Item(Item { name: "MODE3A", title: "Mode-3/A Reply in Octal Representation", shape: Shape::Element { bits: 12, content: Content::Text(Text::Octal) } }),
] } };

const I080: Item = Item { name: "080", title: "Mode-3/A Code Confidence Indicator", shape: Shape::Group { bits: 16, parts: &[
    Part::Spare(4),
    Part::Item(Item { name: "QA4", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "High quality pulse A4"), (1, "Low quality pulse A4")]) } }),
    Part::Item(Item { name: "QA2", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "High quality pulse A2"), (1, "Low quality pulse A2")]) } }),
    Part::Item(Item { name: "QA1", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "High quality pulse A1"), (1, "Low quality pulse A1")]) } }),
    Part::Item(Item { name: "QB4", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "High quality pulse B4"), (1, "Low quality pulse B4")]) } }),
    Part::Item(Item { name: "QB2", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "High quality pulse B2"), (1, "Low quality pulse B2")]) } }),
    Part::Item(Item { name: "QB1", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "High quality pulse B1"), (1, "Low quality pulse B1")]) } }),
    Part::Item(Item { name: "QC4", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "High quality pulse C4"), (1, "Low quality pulse C4")]) } }),
    Part::Item(Item { name: "QC2", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "High quality pulse C2"), (1, "Low quality pulse C2")]) } }),
    Part::Item(Item { name: "QC1", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "High quality pulse C1"), (1, "Low quality pulse C1")]) } }),
    Part::Item(Item { name: "QD4", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "High quality pulse D4"), (1, "Low quality pulse D4")]) } }),
    Part::Item(Item { name: "QD2", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "High quality pulse D2"), (1, "Low quality pulse D2")]) } }),
    Part::Item(Item { name: "QD1", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "High quality pulse D1"), (1, "Low quality pulse D1")]) } }),
] } };

const I090: Item = Item { name: "090", title: "Mode-C Code in Binary Representation", shape: Shape::Group { bits: 16, parts: &[
    Part::Item(Item { name: "V", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Code validated"), (1, "Code not validated")]) } }),
    Part::Item(Item { name: "G", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Default"), (1, "Garbled code")]) } }),
    Part::Item(Item { name: "HGT", title: "Mode-C HEIGHT", shape: Shape::Element { bits: 14, content: Content::Quantity { signed: true, step: 1.0 / 4.0, unit: "FL" } } }),
] } };

const I100: Item = Item { name: "100", title: "Mode-C Code and Code Confidence Indicator", shape: Shape::Group { bits: 32, parts: &[
    Part::Item(Item { name: "V", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Code validated"), (1, "Code not validated")]) } }),
    Part::Item(Item { name: "G", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Default"), (1, "Garbled code")]) } }),
    Part::Spare(2),
    Part::Item(Item { name: "MODEC", title: "Mode-C Reply in Gray Notation", shape: Shape::Element { bits: 12, content: Content::Raw } }),
    Part::Spare(4),
    Part::Item(Item { name: "QC1", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "High quality pulse C1"), (1, "Low quality pulse C1")]) } }),
    Part::Item(Item { name: "QA1", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "High quality pulse A1"), (1, "Low quality pulse A1")]) } }),
    Part::Item(Item { name: "QC2", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "High quality pulse C2"), (1, "Low quality pulse C2")]) } }),
    Part::Item(Item { name: "QA2", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "High quality pulse A2"), (1, "Low quality pulse A2")]) } }),
    Part::Item(Item { name: "QC4", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "High quality pulse C4"), (1, "Low quality pulse C4")]) } }),
    Part::Item(Item { name: "QA4", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "High quality pulse A4"), (1, "Low quality pulse A4")]) } }),
    Part::Item(Item { name: "QB1", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "High quality pulse B1"), (1, "Low quality pulse B1")]) } }),
    Part::Item(Item { name: "QD1", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "High quality pulse D1"), (1, "Low quality pulse D1")]) } }),
    Part::Item(Item { name: "QB2", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "High quality pulse B2"), (1, "Low quality pulse B2")]) } }),
    Part::Item(Item { name: "QD2", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "High quality pulse D2"), (1, "Low quality pulse D2")]) } }),
    Part::Item(Item { name: "QB4", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "High quality pulse B4"), (1, "Low quality pulse B4")]) } }),
    Part::Item(Item { name: "QD4", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "High quality pulse D4"), (1, "Low quality pulse D4")]) } }),
] } };

const I120: Item = Item { name: "120", title: "Measured Radial Doppler Speed", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: true, step: 1.0 / 256.0, unit: "NM/s" } } };

const I130: Item = Item { name: "130", title: "Radar Plot Characteristics", shape: Shape::Chained(&Shape::Element { bits: 7, content: Content::Raw }) };

const I131: Item = Item { name: "131", title: "Received Power", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: true, step: 1.0, unit: "dBm" } } };

const I141: Item = Item { name: "141", title: "Truncated Time of Day", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: false, step: 1.0 / 128.0, unit: "s" } } };

const I150: Item = Item { name: "150", title: "Presence of X-Pulse", shape: Shape::Group { bits: 8, parts: &[
    Part::Item(Item { name: "XA", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Default"), (1, "X-pulse received in Mode-3/A reply")]) } }),
    Part::Spare(1),
    Part::Item(Item { name: "XC", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Default"), (1, "X-pulse received in Mode-C reply")]) } }),
    Part::Spare(2),
    Part::Item(Item { name: "X2", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Default"), (1, "X-pulse received in Mode-2 reply")]) } }),
    Part::Spare(2),
] } };

const I161: Item = Item { name: "161", title: "Track Plot Number", shape: Shape::Element { bits: 16, content: Content::Raw } };

const I170: Item = Item { name: "170", title: "Track Status", shape: Shape::Extended(&[
    Part::Item(Item { name: "CON", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Confirmed Track"), (1, "Track in initialisation phase")]) } }),
    Part::Item(Item { name: "RAD", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Primary track"), (1, "SSR/Combined track")]) } }),
    Part::Item(Item { name: "MAN", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Default"), (1, "Aircraft manoeuvring")]) } }),
    Part::Item(Item { name: "DOU", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Default"), (1, "Doubtful plot to track association")]) } }),
    Part::Item(Item { name: "RDPC", title: "Radar Data Processing Chain", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "RDP Chain 1"), (1, "RDP Chain 2")]) } }),
    Part::Spare(1),
    Part::Item(Item { name: "GHO", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Default"), (1, "Ghost track")]) } }),
    Part::Fx,
    Part::Item(Item { name: "TRE", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Default"), (1, "Last report for a track")]) } }),
    Part::Spare(6),
    Part::Fx,
]) };

const I200: Item = Item { name: "200", title: "Calculated Track Velocity in Polar Co-ordinates", shape: Shape::Group { bits: 32, parts: &[
    Part::Item(Item { name: "GSP", title: "Calculated Groundspeed", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: false, step: 1.0 / 16384.0, unit: "NM/s" } } }),
    Part::Item(Item { name: "HDG", title: "Calculated Heading", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: false, step: 360.0 / 65536.0, unit: "°" } } }),
] } };

const I210: Item = Item { name: "210", title: "Track Quality", shape: Shape::Chained(&Shape::Element { bits: 7, content: Content::Raw }) };

const ISP: Item = Item { name: "SP", title: "Special Purpose Field", shape: Shape::Explicit };
