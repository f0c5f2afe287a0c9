//! Category 048, edition 1.32: Monoradar Target Reports.
//!
//! Generated from the specification by `WRITE_TABLES=1 cargo test -p asterix --test tables`.

#[allow(clippy::wildcard_imports)]
use crate::definition::*;

/// Monoradar Target Reports.
pub const CAT048_1_32: &Edition = &Edition {
    category: 48,
    number: "1.32",
    title: "Monoradar Target Reports",
    profiles: &[Profile { name: "", slots: &[
        Slot::Item(&I010),
        Slot::Item(&I140),
        Slot::Item(&I020),
        Slot::Item(&I040),
        Slot::Item(&I070),
        Slot::Item(&I090),
        Slot::Item(&I130),
        Slot::Item(&I220),
        Slot::Item(&I240),
        Slot::Item(&I250),
        Slot::Item(&I161),
        Slot::Item(&I042),
        Slot::Item(&I200),
        Slot::Item(&I170),
        Slot::Item(&I210),
        Slot::Item(&I030),
        Slot::Item(&I080),
        Slot::Item(&I100),
        Slot::Item(&I110),
        Slot::Item(&I120),
        Slot::Item(&I230),
        Slot::Item(&I260),
        Slot::Item(&I055),
        Slot::Item(&I050),
        Slot::Item(&I065),
        Slot::Item(&I060),
        Slot::Item(&ISP),
        Slot::Item(&IRE),
    ] }],
    choice: None,
};

const I010: Item = Item { name: "010", title: "Data Source Identifier", shape: Shape::Group { bits: 16, parts: &[
    Part::Item(Item { name: "SAC", title: "System Area Code", shape: Shape::Element { bits: 8, content: Content::Raw } }),
    Part::Item(Item { name: "SIC", title: "System Identification Code", shape: Shape::Element { bits: 8, content: Content::Raw } }),
] } };

const I020: Item = Item { name: "020", title: "Target Report Descriptor", shape: Shape::Extended(&[
    Part::Item(Item { name: "TYP", title: "", shape: Shape::Element { bits: 3, content: Content::Table(&[(0, "No detection"), (1, "Single PSR detection"), (2, "Single SSR detection"), (3, "SSR + PSR detection"), (4, "Single ModeS All-Call"), (5, "Single ModeS Roll-Call"), (6, "ModeS All-Call + PSR"), (7, "ModeS Roll-Call +PSR")]) } }),
    Part::Item(Item { name: "SIM", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Actual target report"), (1, "Simulated target report")]) } }),
    Part::Item(Item { name: "RDP", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Report from RDP Chain 1"), (1, "Report from RDP Chain 2")]) } }),
    Part::Item(Item { name: "SPI", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Absence of SPI"), (1, "Special Position Identification")]) } }),
    Part::Item(Item { name: "RAB", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Report from aircraft transponder"), (1, "Report from field monitor (fixed transponder)")]) } }),
    Part::Fx,
    Part::Item(Item { name: "TST", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Real target report"), (1, "Test target report")]) } }),
    Part::Item(Item { name: "ERR", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "No Extended Range"), (1, "Extended Range present")]) } }),
    Part::Item(Item { name: "XPP", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "No X-Pulse present"), (1, "X-Pulse present")]) } }),
    Part::Item(Item { name: "ME", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "No military emergency"), (1, "Military emergency")]) } }),
    Part::Item(Item { name: "MI", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "No military identification"), (1, "Military identification")]) } }),
    Part::Item(Item { name: "FOEFRI", title: "", shape: Shape::Element { bits: 2, content: Content::Table(&[(0, "No Mode 4 interrogation"), (1, "Friendly target"), (2, "Unknown target"), (3, "No reply")]) } }),
    Part::Fx,
    Part::Item(Item { name: "ADSB", title: "On-Site ADS-B Information", shape: Shape::Group { bits: 2, parts: &[
        Part::Item(Item { name: "EP", title: "ADSB Element Populated Bit", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "ADSB not populated"), (1, "ADSB populated")]) } }),
        Part::Item(Item { name: "VAL", title: "On-Site ADS-B Information", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Not available"), (1, "Available")]) } }),
    ] } }),
    Part::Item(Item { name: "SCN", title: "Surveillance Cluster Network Information", shape: Shape::Group { bits: 2, parts: &[
        Part::Item(Item { name: "EP", title: "SCN Element Populated Bit", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "SCN not populated"), (1, "SCN populated")]) } }),
        Part::Item(Item { name: "VAL", title: "Surveillance Cluster Network Information", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Not available"), (1, "Available")]) } }),
    ] } }),
    Part::Item(Item { name: "PAI", title: "Passive Acquisition Interface Information", shape: Shape::Group { bits: 2, parts: &[
        Part::Item(Item { name: "EP", title: "PAI Element Populated Bit", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "PAI not populated"), (1, "PAI populated")]) } }),
        Part::Item(Item { name: "VAL", title: "Passive Acquisition Interface Information", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Not available"), (1, "Available")]) } }),
    ] } }),
    Part::Spare(1),
    Part::Fx,
    Part::Item(Item { name: "ACASXV", title: "Extended Version", shape: Shape::Group { bits: 5, parts: &[
        Part::Item(Item { name: "EP", title: "ACASXV Element Populated Bit", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "ACASXV not populated"), (1, "ACASXV populated")]) } }),
        Part::Item(Item { name: "VAL", title: "ACAS Extended Version Value", shape: Shape::Element { bits: 4, content: Content::Table(&[(0, "Non-Extended Version"), (1, "ACAS Xa Version 1"), (2, "ACAS Xu Version 1")]) } }),
    ] } }),
    Part::Item(Item { name: "POXPR", title: "PO Transponder Capability", shape: Shape::Group { bits: 2, parts: &[
        Part::Item(Item { name: "EP", title: "POXPR Element Populated Bit", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "POXPR not populated"), (1, "POXPR populated")]) } }),
        Part::Item(Item { name: "VAL", title: "PO Transponder Capability", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "PO not supported (PPM only)"), (1, "PO supported")]) } }),
    ] } }),
    Part::Fx,
    Part::Item(Item { name: "POACT", title: "PO Active for Current Plot", shape: Shape::Group { bits: 2, parts: &[
        Part::Item(Item { name: "EP", title: "POACT Element Populated Bit", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "POACT not populated"), (1, "POACT populated")]) } }),
        Part::Item(Item { name: "VAL", title: "POACT Active for Current Plot", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "PO not active"), (1, "PO active")]) } }),
    ] } }),
    Part::Item(Item { name: "DTFXPR", title: "Basic Dataflash Transponder Capability", shape: Shape::Group { bits: 2, parts: &[
        Part::Item(Item { name: "EP", title: "DTFXPR Element Populated Bit", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "DTFXPR not populated"), (1, "DTFXPR populated")]) } }),
        Part::Item(Item { name: "VAL", title: "Basic Dataflash Transponder Capability", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Basic Dataflash not supported"), (1, "Basic Dataflash supported")]) } }),
    ] } }),
    Part::Item(Item { name: "DTFACT", title: "Basic Dataflash Active for Current Plot", shape: Shape::Group { bits: 2, parts: &[
        Part::Item(Item { name: "EP", title: "DTFACT Element Populated Bit", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "DTFACT not populated"), (1, "DTFACT populated")]) } }),
        Part::Item(Item { name: "VAL", title: "Basic Dataflash in Current Plot", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Basic Dataflash not active"), (1, "Basic Dataflash active")]) } }),
    ] } }),
    Part::Spare(1),
    Part::Fx,
    Part::Item(Item { name: "IRMXPR", title: "IRM Transponder Capability", shape: Shape::Group { bits: 2, parts: &[
        Part::Item(Item { name: "EP", title: "IRMXPR Element Populated Bit", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "IRMXPR not populated"), (1, "IRMXPR populated")]) } }),
        Part::Item(Item { name: "VAL", title: "Transponder IRM Capability", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Transponder not IRM capable"), (1, "Transponder IRM capable")]) } }),
    ] } }),
    Part::Item(Item { name: "IRMACT", title: "IRM Active for Current Plot", shape: Shape::Group { bits: 2, parts: &[
        Part::Item(Item { name: "EP", title: "IRM Element Populated Bit", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "IRMACT not populated"), (1, "IRMACT populated")]) } }),
        Part::Item(Item { name: "VAL", title: "IRM Active for Current Plot", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "IRM not active"), (1, "IRM active")]) } }),
    ] } }),
    Part::Spare(3),
    Part::Fx,
]) };

const I030: Item = Item { name: "030", title: "Warning/Error Conditions and Target Classification", shape: Shape::Chained(&Shape::Element { bits: 7, content: Content::Table(&[(0, "Not defined; never used"), (1, "Multipath Reply (Reflection)"), (2, "Reply due to sidelobe interrogation/reception"), (3, "Split plot"), (4, "Second time around reply"), (5, "Angel"), (6, "Slow moving target correlated with road infrastructure (terrestrial vehicle)"), (7, "Fixed PSR plot"), (8, "Slow PSR target"), (9, "Low quality PSR plot"), (10, "Phantom SSR plot"), (11, "Non-Matching Mode-3/A Code"), (12, "Mode C code / Mode S altitude code abnormal value compared to the track"), (13, "Target in Clutter Area"), (14, "Maximum Doppler Response in Zero Filter"), (15, "Transponder anomaly detected"), (16, "Duplicated or Illegal Mode S Aircraft Address"), (17, "Mode S error correction applied"), (18, "Undecodable Mode C code / Mode S altitude code"), (19, "Birds"), (20, "Flock of Birds"), (21, "Mode-1 was present in original reply"), (22, "Mode-2 was present in original reply"), (23, "Plot potentially caused by Wind Turbine"), (24, "Helicopter"), (25, "Maximum number of re-interrogations reached (surveillance information)"), (26, "Maximum number of re-interrogations reached (BDS Extractions)"), (27, "BDS Overlay Incoherence"), (28, "Potential BDS Swap Detected"), (29, "Track Update in the Zenithal Gap"), (30, "Mode S Track re-acquired"), (31, "Duplicated Mode 5 Pair NO/PIN detected"), (32, "Wrong DF reply format detected"), (33, "Transponder anomaly (MS XPD replies with Mode A/C to Mode A/C-only all-call)"), (34, "Transponder anomaly (SI capability report wrong)"), (35, "Potential IC Conflict"), (36, "IC Conflict detection possible-no conflict currently detected"), (37, "Duplicate Mode 5 PIN (refer to the Mode 5 items in the REF)")]) }) };

const I040: Item = Item { name: "040", title: "Measured Position in Polar Co-ordinates", shape: Shape::Group { bits: 32, parts: &[
    Part::Item(Item { name: "RHO", title: "", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: false, step: 1.0 / 256.0, unit: "NM" } } }),
    Part::Item(Item { name: "THETA", title: "", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: false, step: 360.0 / 65536.0, unit: "°" } } }),
] } };

const I042: Item = Item { name: "042", title: "Calculated Position in Cartesian Co-ordinates", shape: Shape::Group { bits: 32, parts: &[
    Part::Item(Item { name: "X", title: "X-Component", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: true, step: 1.0 / 128.0, unit: "NM" } } }),
    Part::Item(Item { name: "Y", title: "X-Component", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: true, step: 1.0 / 128.0, unit: "NM" } } }),
] } };

const I050: Item = Item { name: "050", title: "Mode-2 Code in Octal Representation", shape: Shape::Group { bits: 16, parts: &[
    Part::Item(Item { name: "V", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Code validated"), (1, "Code not validated")]) } }),
    Part::Item(Item { name: "G", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Default"), (1, "Garbled code")]) } }),
    Part::Item(Item { name: "L", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Mode-2 code as derived from the reply of the transponder"), (1, "Smoothed Mode-2 code as provided by a local tracker")]) } }),
    Part::Spare(1),
    Part::Item(Item { name: "MODE2", title: "Mode-2 Code in Octal Representation", shape: Shape::Element { bits: 12, content: Content::Text(Text::Octal) } }),
] } };

const I055: Item = Item { name: "055", title: "Mode-1 Code in Octal Representation", shape: Shape::Group { bits: 8, parts: &[
    Part::Item(Item { name: "V", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Code validated"), (1, "Code not validated")]) } }),
    Part::Item(Item { name: "G", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Default"), (1, "Garbled code")]) } }),
    Part::Item(Item { name: "L", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Mode-1 code as derived from the reply of the transponder"), (1, "Smoothed Mode-1 code as provided by a local tracker")]) } }),
    Part::Item(Item { name: "MODE1", title: "Mode-1 Code", shape: Shape::Element { bits: 5, content: Content::Raw } }),
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

const I065: Item = Item { name: "065", title: "Mode-1 Code Confidence Indicator", shape: Shape::Group { bits: 8, parts: &[
    Part::Spare(3),
    Part::Item(Item { name: "QA4", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "High quality pulse A4"), (1, "Low quality pulse A4")]) } }),
    Part::Item(Item { name: "QA2", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "High quality pulse A2"), (1, "Low quality pulse A2")]) } }),
    Part::Item(Item { name: "QA1", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "High quality pulse A1"), (1, "Low quality pulse A1")]) } }),
    Part::Item(Item { name: "QB2", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "High quality pulse B2"), (1, "Low quality pulse B2")]) } }),
    Part::Item(Item { name: "QB1", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "High quality pulse B1"), (1, "Low quality pulse B1")]) } }),
] } };

const I070: Item = Item { name: "070", title: "Mode-3/A Code in Octal Representation", shape: Shape::Group { bits: 16, parts: &[
    Part::Item(Item { name: "V", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Code validated"), (1, "Code not validated")]) } }),
    Part::Item(Item { name: "G", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Default"), (1, "Garbled code")]) } }),
    Part::Item(Item { name: "L", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Mode-3/A code derived from the reply of the transponder"), (1, "Mode-3/A code not extracted during the last scan")]) } }),
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

const I090: Item = Item { name: "090", title: "Flight Level in Binary Representation", shape: Shape::Group { bits: 16, parts: &[
    Part::Item(Item { name: "V", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Code validated"), (1, "Code not validated")]) } }),
    Part::Item(Item { name: "G", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Default"), (1, "Garbled code")]) } }),
    Part::Item(Item { name: "FL", title: "", shape: Shape::Element { bits: 14, content: Content::Quantity { signed: true, step: 1.0 / 4.0, unit: "FL" } } }),
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

const I110: Item = Item { name: "110", title: "Height Measured by a 3D Radar", shape: Shape::Group { bits: 16, parts: &[
    Part::Spare(2),
    Part::Item(Item { name: "3DH", title: "3D Height, in Binary Notation. Negative Values Are Expressed in Two's Complement", shape: Shape::Element { bits: 14, content: Content::Quantity { signed: true, step: 25.0, unit: "ft" } } }),
] } };

const I120: Item = Item { name: "120", title: "Radial Doppler Speed", shape: Shape::Compound(&[
    Some(Item { name: "CAL", title: "Calculated Doppler Speed", shape: Shape::Group { bits: 16, parts: &[
        Part::Item(Item { name: "D", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Doppler speed is valid"), (1, "Doppler speed is doubtful")]) } }),
        Part::Spare(5),
        Part::Item(Item { name: "CAL", title: "Calculated Doppler Speed, Coded in Two's Complement", shape: Shape::Element { bits: 10, content: Content::Quantity { signed: true, step: 1.0, unit: "m/s" } } }),
    ] } }),
    Some(Item { name: "RDS", title: "Raw Doppler Speed", shape: Shape::Counted(&Shape::Group { bits: 48, parts: &[
        Part::Item(Item { name: "DOP", title: "Doppler Speed", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: false, step: 1.0, unit: "m/s" } } }),
        Part::Item(Item { name: "AMB", title: "Ambiguity Range", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: false, step: 1.0, unit: "m/s" } } }),
        Part::Item(Item { name: "FRQ", title: "Transmitter Frequency", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: false, step: 1.0, unit: "MHz" } } }),
    ] }) }),
]) };

const I130: Item = Item { name: "130", title: "Radar Plot Characteristics", shape: Shape::Compound(&[
    Some(Item { name: "SRL", title: "SSR Plot Runlength", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: false, step: 360.0 / 8192.0, unit: "°" } } }),
    Some(Item { name: "SRR", title: "Number of Received Replies for (M)SSR", shape: Shape::Element { bits: 8, content: Content::Integer { signed: false } } }),
    Some(Item { name: "SAM", title: "Amplitude of (M)SSR Reply", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: true, step: 1.0, unit: "dBm" } } }),
    Some(Item { name: "PRL", title: "Primary Plot Runlength", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: false, step: 360.0 / 8192.0, unit: "°" } } }),
    Some(Item { name: "PAM", title: "Amplitude of Primary Plot", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: true, step: 1.0, unit: "dBm" } } }),
    Some(Item { name: "RPD", title: "Difference in Range Between PSR and SSR Plot", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: true, step: 1.0 / 256.0, unit: "NM" } } }),
    Some(Item { name: "APD", title: "Difference in Azimuth Between PSR and SSR Plot", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: true, step: 360.0 / 16384.0, unit: "°" } } }),
]) };

const I140: Item = Item { name: "140", title: "Time of Day", shape: Shape::Element { bits: 24, content: Content::Quantity { signed: false, step: 1.0 / 128.0, unit: "s" } } };

const I161: Item = Item { name: "161", title: "Track Number", shape: Shape::Group { bits: 16, parts: &[
    Part::Spare(4),
    Part::Item(Item { name: "TRN", title: "Track Number", shape: Shape::Element { bits: 12, content: Content::Raw } }),
] } };

const I170: Item = Item { name: "170", title: "Track Status", shape: Shape::Extended(&[
    Part::Item(Item { name: "CNF", title: "Confirmed Vs. Tentative Track", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Confirmed Track"), (1, "Tentative Track")]) } }),
    Part::Item(Item { name: "RAD", title: "Type of Sensor(s) Maintaining Track", shape: Shape::Element { bits: 2, content: Content::Table(&[(0, "Combined Track"), (1, "PSR Track"), (2, "SSR/Mode S Track"), (3, "Invalid")]) } }),
    Part::Item(Item { name: "DOU", title: "Signals Level of Confidence in Plot to Track Association Process", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Normal confidence"), (1, "Low confidence in plot to track association")]) } }),
    Part::Item(Item { name: "MAH", title: "Manoeuvre Detection in Horizontal Sense", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "No horizontal man.sensed"), (1, "Horizontal man. sensed")]) } }),
    Part::Item(Item { name: "CDM", title: "Climbing / Descending Mode", shape: Shape::Element { bits: 2, content: Content::Table(&[(0, "Maintaining"), (1, "Climbing"), (2, "Descending"), (3, "Unknown")]) } }),
    Part::Fx,
    Part::Item(Item { name: "TRE", title: "Signal for End_of_Track", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Track still alive"), (1, "End of track lifetime(last report for this track)")]) } }),
    Part::Item(Item { name: "GHO", title: "Ghost Vs. True Target", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "True target track"), (1, "Ghost target track")]) } }),
    Part::Item(Item { name: "SUP", title: "Track Maintained with Track Information from Neighbouring Node B on the Cluster, or Network", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "No"), (1, "Yes")]) } }),
    Part::Item(Item { name: "TCC", title: "Type of Plot Coordinate Transformation Mechanism:", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Tracking performed in so-called 'Radar Plane', i.e. neither slant range correction nor stereographical projection was applied"), (1, "Slant range correction and a suitable projection technique are used to track in a 2D.reference plane, tangential to the earth model at the Radar Site co-ordinates")]) } }),
    Part::Spare(3),
    Part::Fx,
]) };

const I200: Item = Item { name: "200", title: "Calculated Track Velocity in Polar Co-ordinates", shape: Shape::Group { bits: 32, parts: &[
    Part::Item(Item { name: "GSP", title: "Calculated Groundspeed", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: false, step: 1.0 / 16384.0, unit: "NM/s" } } }),
    Part::Item(Item { name: "HDG", title: "Calculated Heading", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: false, step: 360.0 / 65536.0, unit: "°" } } }),
] } };

const I210: Item = Item { name: "210", title: "Track Quality", shape: Shape::Group { bits: 32, parts: &[
    Part::Item(Item { name: "SIGX", title: "Sigma (X)) Standard Deviation on the Horizontal Axis of the Local Grid System", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: false, step: 1.0 / 128.0, unit: "NM" } } }),
    Part::Item(Item { name: "SIGY", title: "Sigma (Y)) Standard Deviation on the Vertical Axis of the Local Grid System", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: false, step: 1.0 / 128.0, unit: "NM" } } }),
    Part::Item(Item { name: "SIGV", title: "Sigma (V)) Standard Deviation on the Groundspeed Within the Local Grid System", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: false, step: 1.0 / 16384.0, unit: "NM/s" } } }),
    Part::Item(Item { name: "SIGH", title: "Sigma (H)) Standard Deviation on the Heading Within the Local Grid System", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: false, step: 360.0 / 4096.0, unit: "°" } } }),
] } };

const I220: Item = Item { name: "220", title: "Aircraft Address", shape: Shape::Element { bits: 24, content: Content::Raw } };

const I230: Item = Item { name: "230", title: "Communications/ACAS Capability and Flight Status", shape: Shape::Group { bits: 16, parts: &[
    Part::Item(Item { name: "COM", title: "Communications Capability of the Transponder", shape: Shape::Element { bits: 3, content: Content::Table(&[(0, "No communications capability (surveillance only)"), (1, "Comm. A and Comm. B capability"), (2, "Comm. A, Comm. B and Uplink ELM"), (3, "Comm. A, Comm. B, Uplink ELM and Downlink ELM"), (4, "Level 5 Transponder capability")]) } }),
    Part::Item(Item { name: "STAT", title: "Flight Status", shape: Shape::Element { bits: 3, content: Content::Table(&[(0, "No alert, no SPI, aircraft airborne"), (1, "No alert, no SPI, aircraft on ground"), (2, "Alert, no SPI, aircraft airborne"), (3, "Alert, no SPI, aircraft on ground"), (4, "Alert, SPI, aircraft airborne or on ground"), (5, "No alert, SPI, aircraft airborne or on ground"), (7, "Unknown")]) } }),
    Part::Item(Item { name: "SI", title: "SI/II Transponder Capability", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "SI-Code Capable"), (1, "II-Code Capable")]) } }),
    Part::Spare(1),
    Part::Item(Item { name: "MSSC", title: "Mode-S Specific Service Capability", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "No"), (1, "Yes")]) } }),
    Part::Item(Item { name: "ARC", title: "Altitude Reporting Capability", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "100 ft resolution"), (1, "25 ft resolution")]) } }),
    Part::Item(Item { name: "AIC", title: "Aircraft Identification Capability", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "No"), (1, "Yes")]) } }),
    Part::Item(Item { name: "B1A", title: "BDS 1,0 Bit 16", shape: Shape::Element { bits: 1, content: Content::Raw } }),
    Part::Item(Item { name: "B1B", title: "BDS 1,0 Bits 37/40", shape: Shape::Element { bits: 4, content: Content::Raw } }),
] } };

const I240: Item = Item { name: "240", title: "Aircraft Identification", shape: Shape::Element { bits: 48, content: Content::Text(Text::Icao) } };

const I250: Item = Item { name: "250", title: "BDS Register Data", shape: Shape::Counted(&Shape::Group { bits: 64, parts: &[
    Part::Item(Item { name: "MBDATA", title: "Mode S Comm B Message Data", shape: Shape::Element { bits: 56, content: Content::Raw } }),
    Part::Item(Item { name: "BDS1", title: "Comm B Data Buffer Store 1 Address", shape: Shape::Element { bits: 4, content: Content::Raw } }),
    Part::Item(Item { name: "BDS2", title: "Comm B Data Buffer Store 2 Address", shape: Shape::Element { bits: 4, content: Content::Raw } }),
] }) };

const I260: Item = Item { name: "260", title: "ACAS Resolution Advisory Report", shape: Shape::Element { bits: 56, content: Content::Raw } };

const IRE: Item = Item { name: "RE", title: "Reserved Expansion Field", shape: Shape::Explicit };

const ISP: Item = Item { name: "SP", title: "Special Purpose Field", shape: Shape::Explicit };
