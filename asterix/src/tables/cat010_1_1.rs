//! Category 010, edition 1.1: Transmission of Monosensor Surface Movement Data.
//!
//! Generated from the specification by `WRITE_TABLES=1 cargo test -p asterix --test tables`.

#[allow(clippy::wildcard_imports)]
use crate::definition::*;

/// Transmission of Monosensor Surface Movement Data.
pub const CAT010_1_1: &Edition = &Edition {
    category: 10,
    number: "1.1",
    title: "Transmission of Monosensor Surface Movement Data",
    profiles: &[Profile { name: "", slots: &[
        Slot::Item(&I010),
        Slot::Item(&I000),
        Slot::Item(&I020),
        Slot::Item(&I140),
        Slot::Item(&I041),
        Slot::Item(&I040),
        Slot::Item(&I042),
        Slot::Item(&I200),
        Slot::Item(&I202),
        Slot::Item(&I161),
        Slot::Item(&I170),
        Slot::Item(&I060),
        Slot::Item(&I220),
        Slot::Item(&I245),
        Slot::Item(&I250),
        Slot::Item(&I300),
        Slot::Item(&I090),
        Slot::Item(&I091),
        Slot::Item(&I270),
        Slot::Item(&I550),
        Slot::Item(&I310),
        Slot::Item(&I500),
        Slot::Item(&I280),
        Slot::Item(&I131),
        Slot::Item(&I210),
        Slot::Spare,
        Slot::Item(&ISP),
        Slot::Item(&IRE),
    ] }],
    choice: None,
};

const I000: Item = Item { name: "000", title: "Message Type", shape: Shape::Element { bits: 8, content: Content::Table(&[(1, "Target Report"), (2, "Start of Update Cycle"), (3, "Periodic Status Message"), (4, "Event-triggered Status Message")]) } };

const I010: Item = Item { name: "010", title: "Data Source Identifier", shape: Shape::Group { bits: 16, parts: &[
    Part::Item(Item { name: "SAC", title: "System Area Code", shape: Shape::Element { bits: 8, content: Content::Raw } }),
    Part::Item(Item { name: "SIC", title: "System Identification Code", shape: Shape::Element { bits: 8, content: Content::Raw } }),
] } };

const I020: Item = Item { name: "020", title: "Target Report Descriptor", shape: Shape::Extended(&[
    Part::Item(Item { name: "TYP", title: "", shape: Shape::Element { bits: 3, content: Content::Table(&[(0, "SSR multilateration"), (1, "Mode S multilateration"), (2, "ADS-B"), (3, "PSR"), (4, "Magnetic Loop System"), (5, "HF multilateration"), (6, "Not defined"), (7, "Other types")]) } }),
    Part::Item(Item { name: "DCR", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "No differential correction (ADS-B)"), (1, "Differential correction (ADS-B)")]) } }),
    Part::Item(Item { name: "CHN", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Chain 1"), (1, "Chain 2")]) } }),
    Part::Item(Item { name: "GBS", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Transponder Ground bit not set"), (1, "Transponder Ground bit set")]) } }),
    Part::Item(Item { name: "CRT", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "No Corrupted reply in multilateration"), (1, "Corrupted replies in multilateration")]) } }),
    Part::Fx,
    Part::Item(Item { name: "SIM", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Actual target report"), (1, "Simulated target report")]) } }),
    Part::Item(Item { name: "TST", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Default"), (1, "Test Target")]) } }),
    Part::Item(Item { name: "RAB", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Report from target transponder"), (1, "Report from field monitor (fixed transponder)")]) } }),
    Part::Item(Item { name: "LOP", title: "", shape: Shape::Element { bits: 2, content: Content::Table(&[(0, "Undetermined"), (1, "Loop start"), (2, "Loop finish")]) } }),
    Part::Item(Item { name: "TOT", title: "", shape: Shape::Element { bits: 2, content: Content::Table(&[(0, "Undetermined"), (1, "Aircraft"), (2, "Ground vehicle"), (3, "Helicopter")]) } }),
    Part::Fx,
    Part::Item(Item { name: "SPI", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Absence of SPI"), (1, "Special Position Identification")]) } }),
    Part::Spare(6),
    Part::Fx,
]) };

const I040: Item = Item { name: "040", title: "Measured Position in Polar Co-ordinates", shape: Shape::Group { bits: 32, parts: &[
    Part::Item(Item { name: "RHO", title: "RHO", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: false, step: 1.0, unit: "m" } } }),
    Part::Item(Item { name: "TH", title: "Theta", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: false, step: 360.0 / 65536.0, unit: "°" } } }),
] } };

const I041: Item = Item { name: "041", title: "Position in WGS-84 Co-ordinates", shape: Shape::Group { bits: 64, parts: &[
    Part::Item(Item { name: "LAT", title: "Latitude", shape: Shape::Element { bits: 32, content: Content::Quantity { signed: true, step: 180.0 / 2_147_483_648.0, unit: "°" } } }),
    Part::Item(Item { name: "LON", title: "Longitude", shape: Shape::Element { bits: 32, content: Content::Quantity { signed: true, step: 180.0 / 2_147_483_648.0, unit: "°" } } }),
] } };

const I042: Item = Item { name: "042", title: "Position in Cartesian Co-ordinates", shape: Shape::Group { bits: 32, parts: &[
    Part::Item(Item { name: "X", title: "X Coordinate", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: true, step: 1.0, unit: "m" } } }),
    Part::Item(Item { name: "Y", title: "Y Coordinate", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: true, step: 1.0, unit: "m" } } }),
] } };

const I060: Item = Item { name: "060", title: "Mode-3/A Code in Octal Representation", shape: Shape::Group { bits: 16, parts: &[
    Part::Item(Item { name: "V", title: "Validated", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Code validated"), (1, "Code not validated")]) } }),
    Part::Item(Item { name: "G", title: "Garbled", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Default"), (1, "Garbled code")]) } }),
    Part::Item(Item { name: "L", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Mode-3/A code derived from the reply of the transponder"), (1, "Mode-3/A code not extracted during the last scan")]) } }),
    Part::Spare(1),
    Part::Item(Item { name: "MODE3A", title: "Mode-3/A Reply in Octal Representation", shape: Shape::Element { bits: 12, content: Content::Text(Text::Octal) } }),
] } };

const I090: Item = Item { name: "090", title: "Flight Level in Binary Representation", shape: Shape::Group { bits: 16, parts: &[
    Part::Item(Item { name: "V", title: "Validated", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Code validated"), (1, "Code not validated")]) } }),
    Part::Item(Item { name: "G", title: "Garbled", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Default"), (1, "Garbled code")]) } }),
    Part::Item(Item { name: "FL", title: "Flight Level", shape: Shape::Element { bits: 14, content: Content::Quantity { signed: true, step: 1.0 / 4.0, unit: "FL" } } }),
] } };

const I091: Item = Item { name: "091", title: "Measured Height", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: true, step: 25.0 / 4.0, unit: "ft" } } };

const I131: Item = Item { name: "131", title: "Amplitude of Primary Plot", shape: Shape::Element { bits: 8, content: Content::Raw } };

const I140: Item = Item { name: "140", title: "Time of Day", shape: Shape::Element { bits: 24, content: Content::Quantity { signed: false, step: 1.0 / 128.0, unit: "s" } } };

const I161: Item = Item { name: "161", title: "Track Number", shape: Shape::Group { bits: 16, parts: &[
    Part::Spare(4),
    Part::Item(Item { name: "TRK", title: "Track Number", shape: Shape::Element { bits: 12, content: Content::Raw } }),
] } };

const I170: Item = Item { name: "170", title: "Track Status", shape: Shape::Extended(&[
    Part::Item(Item { name: "CNF", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Confirmed track"), (1, "Track in initialisation phase")]) } }),
    Part::Item(Item { name: "TRE", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Default"), (1, "Last report for a track")]) } }),
    Part::Item(Item { name: "CST", title: "", shape: Shape::Element { bits: 2, content: Content::Table(&[(0, "No extrapolation"), (1, "Predictable extrapolation due to sensor refresh period (see NOTE)"), (2, "Predictable extrapolation in masked area"), (3, "Extrapolation due to unpredictable absence of detection")]) } }),
    Part::Item(Item { name: "MAH", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Default"), (1, "Horizontal manoeuvre")]) } }),
    Part::Item(Item { name: "TCC", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Tracking performed in 'Sensor Plane', i.e. neither slant range correction nor projection was applied"), (1, "Slant range correction and a suitable projection technique are used to track in a 2D.reference plane, tangential to the earth model at the Sensor Site co-ordinates")]) } }),
    Part::Item(Item { name: "STH", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Measured position"), (1, "Smoothed position")]) } }),
    Part::Fx,
    Part::Item(Item { name: "TOM", title: "", shape: Shape::Element { bits: 2, content: Content::Table(&[(0, "Unknown type of movement"), (1, "Taking-off"), (2, "Landing"), (3, "Other types of movement")]) } }),
    Part::Item(Item { name: "DOU", title: "", shape: Shape::Element { bits: 3, content: Content::Table(&[(0, "No doubt"), (1, "Doubtful correlation (undetermined reason)"), (2, "Doubtful correlation in clutter"), (3, "Loss of accuracy"), (4, "Loss of accuracy in clutter"), (5, "Unstable track"), (6, "Previously coasted")]) } }),
    Part::Item(Item { name: "MRS", title: "", shape: Shape::Element { bits: 2, content: Content::Table(&[(0, "Merge or split indication undetermined"), (1, "Track merged by association to plot"), (2, "Track merged by non-association to plot"), (3, "Split track")]) } }),
    Part::Fx,
    Part::Item(Item { name: "GHO", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Default"), (1, "Ghost track")]) } }),
    Part::Spare(6),
    Part::Fx,
]) };

const I200: Item = Item { name: "200", title: "Calculated Track Velocity in Polar Co-ordinates", shape: Shape::Group { bits: 32, parts: &[
    Part::Item(Item { name: "GSP", title: "Ground Speed", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: false, step: 1.0 / 16384.0, unit: "NM/s" } } }),
    Part::Item(Item { name: "TRA", title: "Track Angle", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: false, step: 360.0 / 65536.0, unit: "°" } } }),
] } };

const I202: Item = Item { name: "202", title: "Calculated Track Velocity in Cartesian Co-ordinates", shape: Shape::Group { bits: 32, parts: &[
    Part::Item(Item { name: "VX", title: "X Velocity", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: true, step: 1.0 / 16.0, unit: "m/s" } } }),
    Part::Item(Item { name: "VY", title: "Y Velocity", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: true, step: 1.0 / 16.0, unit: "m/s" } } }),
] } };

const I210: Item = Item { name: "210", title: "Calculated Acceleration", shape: Shape::Group { bits: 16, parts: &[
    Part::Item(Item { name: "AX", title: "X Acceleration", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: true, step: 1.0 / 16.0, unit: "m/s²" } } }),
    Part::Item(Item { name: "AY", title: "Y Acceleration", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: true, step: 1.0 / 16.0, unit: "m/s²" } } }),
] } };

const I220: Item = Item { name: "220", title: "Target Address", shape: Shape::Element { bits: 24, content: Content::Raw } };

const I245: Item = Item { name: "245", title: "Target Identification", shape: Shape::Group { bits: 56, parts: &[
    Part::Item(Item { name: "STI", title: "", shape: Shape::Element { bits: 2, content: Content::Table(&[(0, "Callsign or registration downlinked from transponder"), (1, "Callsign not downlinked from transponder"), (2, "Registration not downlinked from transponder")]) } }),
    Part::Spare(6),
    Part::Item(Item { name: "CHR", title: "Characters 1-8 (Coded on 6 Bits Each) Defining Target Identification", shape: Shape::Element { bits: 48, content: Content::Text(Text::Icao) } }),
] } };

const I250: Item = Item { name: "250", title: "Mode S MB Data", shape: Shape::Counted(&Shape::Group { bits: 64, parts: &[
    Part::Item(Item { name: "MBDATA", title: "", shape: Shape::Element { bits: 56, content: Content::Raw } }),
    Part::Item(Item { name: "BDS1", title: "", shape: Shape::Element { bits: 4, content: Content::Raw } }),
    Part::Item(Item { name: "BDS2", title: "", shape: Shape::Element { bits: 4, content: Content::Raw } }),
] }) };

const I270: Item = Item { name: "270", title: "Target Size and Orientation", shape: Shape::Extended(&[
    Part::Item(Item { name: "LENGTH", title: "Length", shape: Shape::Element { bits: 7, content: Content::Quantity { signed: false, step: 1.0, unit: "m" } } }),
    Part::Fx,
    Part::Item(Item { name: "ORIENTATION", title: "Orientation", shape: Shape::Element { bits: 7, content: Content::Quantity { signed: false, step: 360.0 / 128.0, unit: "°" } } }),
    Part::Fx,
    Part::Item(Item { name: "WIDTH", title: "Width", shape: Shape::Element { bits: 7, content: Content::Quantity { signed: false, step: 1.0, unit: "m" } } }),
    Part::Fx,
]) };

const I280: Item = Item { name: "280", title: "Presence", shape: Shape::Counted(&Shape::Group { bits: 16, parts: &[
    Part::Item(Item { name: "DRHO", title: "", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: true, step: 1.0, unit: "m" } } }),
    Part::Item(Item { name: "DTHETA", title: "", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: true, step: 3.0 / 20.0, unit: "°" } } }),
] }) };

const I300: Item = Item { name: "300", title: "Vehicle Fleet Identification", shape: Shape::Element { bits: 8, content: Content::Table(&[(0, "Unknown"), (1, "ATC equipment maintenance"), (2, "Airport maintenance"), (3, "Fire"), (4, "Bird scarer"), (5, "Snow plough"), (6, "Runway sweeper"), (7, "Emergency"), (8, "Police"), (9, "Bus"), (10, "Tug (push/tow)"), (11, "Grass cutter"), (12, "Fuel"), (13, "Baggage"), (14, "Catering"), (15, "Aircraft maintenance"), (16, "Flyco (follow me)")]) } };

const I310: Item = Item { name: "310", title: "Pre-programmed Message", shape: Shape::Group { bits: 8, parts: &[
    Part::Item(Item { name: "TRB", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Default"), (1, "In Trouble")]) } }),
    Part::Item(Item { name: "MSG", title: "", shape: Shape::Element { bits: 7, content: Content::Table(&[(1, "Towing aircraft"), (2, "“Follow me” operation"), (3, "Runway check"), (4, "Emergency operation (fire, medical...)"), (5, "Work in progress (maintenance, birds scarer, sweepers...)")]) } }),
] } };

const I500: Item = Item { name: "500", title: "Standard Deviation of Position", shape: Shape::Group { bits: 32, parts: &[
    Part::Item(Item { name: "DEVX", title: "Standard Deviation of X Component", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: false, step: 1.0 / 4.0, unit: "m" } } }),
    Part::Item(Item { name: "DEVY", title: "Standard Deviation of Y Component", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: false, step: 1.0 / 4.0, unit: "m" } } }),
    Part::Item(Item { name: "COVXY", title: "Covariance in Two’s Complement Form", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: true, step: 1.0 / 4.0, unit: "m" } } }),
] } };

const I550: Item = Item { name: "550", title: "System Status", shape: Shape::Group { bits: 8, parts: &[
    Part::Item(Item { name: "NOGO", title: "Operational Release Status of the System", shape: Shape::Element { bits: 2, content: Content::Table(&[(0, "Operational"), (1, "Degraded"), (2, "NOGO")]) } }),
    Part::Item(Item { name: "OVL", title: "Overload Indicator", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "No overload"), (1, "Overload")]) } }),
    Part::Item(Item { name: "TSV", title: "Time Source Validity", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Valid"), (1, "Invalid")]) } }),
    Part::Item(Item { name: "DIV", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Normal Operation"), (1, "Diversity degraded")]) } }),
    Part::Item(Item { name: "TTF", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Test Target Operative"), (1, "Test Target Failure")]) } }),
    Part::Spare(2),
] } };

const IRE: Item = Item { name: "RE", title: "Reserved Expansion Field", shape: Shape::Explicit };

const ISP: Item = Item { name: "SP", title: "Special Purpose Field", shape: Shape::Explicit };
