//! Category 062, edition 1.21: SDPS Track Messages.
//!
//! Generated from the specification by `WRITE_TABLES=1 cargo test -p asterix --test tables`.

#[allow(clippy::wildcard_imports)]
use crate::definition::*;

/// SDPS Track Messages.
pub const CAT062_1_21: &Edition = &Edition {
    category: 62,
    number: "1.21",
    title: "SDPS Track Messages",
    profiles: &[Profile { name: "", slots: &[
        Slot::Item(&I010),
        Slot::Spare,
        Slot::Item(&I015),
        Slot::Item(&I070),
        Slot::Item(&I105),
        Slot::Item(&I100),
        Slot::Item(&I185),
        Slot::Item(&I210),
        Slot::Item(&I060),
        Slot::Item(&I245),
        Slot::Item(&I380),
        Slot::Item(&I040),
        Slot::Item(&I080),
        Slot::Item(&I290),
        Slot::Item(&I200),
        Slot::Item(&I295),
        Slot::Item(&I136),
        Slot::Item(&I130),
        Slot::Item(&I135),
        Slot::Item(&I220),
        Slot::Item(&I390),
        Slot::Item(&I270),
        Slot::Item(&I300),
        Slot::Item(&I110),
        Slot::Item(&I120),
        Slot::Item(&I510),
        Slot::Item(&I500),
        Slot::Item(&I340),
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

const I010: Item = Item { name: "010", title: "Data Source Identifier", shape: Shape::Group { bits: 16, parts: &[
    Part::Item(Item { name: "SAC", title: "System Area Code", shape: Shape::Element { bits: 8, content: Content::Raw } }),
    Part::Item(Item { name: "SIC", title: "System Identification Code", shape: Shape::Element { bits: 8, content: Content::Raw } }),
] } };

const I015: Item = Item { name: "015", title: "Service Identification", shape: Shape::Element { bits: 8, content: Content::Raw } };

const I040: Item = Item { name: "040", title: "Track Number", shape: Shape::Element { bits: 16, content: Content::Raw } };

const I060: Item = Item { name: "060", title: "Track Mode 3/A Code", shape: Shape::Group { bits: 16, parts: &[
    Part::Item(Item { name: "V", title: "Validated", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Code validated"), (1, "Code not validated")]) } }),
    Part::Item(Item { name: "G", title: "Garbled", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Default"), (1, "Garbled code")]) } }),
    Part::Item(Item { name: "CH", title: "Change in Mode 3/A", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "No change"), (1, "Mode 3/A has changed")]) } }),
    Part::Spare(1),
    Part::Item(Item { name: "MODE3A", title: "Mode-3/A Reply in Octal Representation", shape: Shape::Element { bits: 12, content: Content::Text(Text::Octal) } }),
] } };

const I070: Item = Item { name: "070", title: "Time Of Track Information", shape: Shape::Element { bits: 24, content: Content::Quantity { signed: false, step: 1.0 / 128.0, unit: "s" } } };

const I080: Item = Item { name: "080", title: "Track Status", shape: Shape::Extended(&[
    Part::Item(Item { name: "MON", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Multisensor track"), (1, "Monosensor track")]) } }),
    Part::Item(Item { name: "SPI", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Default value"), (1, "SPI present in the last report received from a sensor capable of decoding this data")]) } }),
    Part::Item(Item { name: "MRH", title: "Most Reliable Height", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Barometric altitude (Mode C) more reliable"), (1, "Geometric altitude more reliable")]) } }),
    Part::Item(Item { name: "SRC", title: "Source of Calculated Track Altitude for I062/130", shape: Shape::Element { bits: 3, content: Content::Table(&[(0, "No source"), (1, "GNSS"), (2, "3D radar"), (3, "Triangulation"), (4, "Height from coverage"), (5, "Speed look-up table"), (6, "Default height"), (7, "Multilateration")]) } }),
    Part::Item(Item { name: "CNF", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Confirmed track"), (1, "Tentative track")]) } }),
    Part::Fx,
    Part::Item(Item { name: "SIM", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Actual track"), (1, "Simulated track")]) } }),
    Part::Item(Item { name: "TSE", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Default value"), (1, "Last message transmitted to the user for the track")]) } }),
    Part::Item(Item { name: "TSB", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Default value"), (1, "First message transmitted to the user for the track")]) } }),
    Part::Item(Item { name: "FPC", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Not flight-plan correlated"), (1, "Flight plan correlated")]) } }),
    Part::Item(Item { name: "AFF", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Default value"), (1, "ADS-B data inconsistent with other surveillance information")]) } }),
    Part::Item(Item { name: "STP", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Default value"), (1, "Slave Track Promotion")]) } }),
    Part::Item(Item { name: "KOS", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Complementary service used"), (1, "Background service used")]) } }),
    Part::Fx,
    Part::Item(Item { name: "AMA", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Track not resulting from amalgamation process"), (1, "Track resulting from amalgamation process")]) } }),
    Part::Item(Item { name: "MD4", title: "", shape: Shape::Element { bits: 2, content: Content::Table(&[(0, "No Mode 4 interrogation"), (1, "Friendly target"), (2, "Unknown target"), (3, "No reply")]) } }),
    Part::Item(Item { name: "ME", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Default value"), (1, "Military Emergency present in the last report received from a sensor capable of decoding this data")]) } }),
    Part::Item(Item { name: "MI", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Default value"), (1, "Military Identification present in the last report received from a sensor capable of decoding this data")]) } }),
    Part::Item(Item { name: "MD5", title: "", shape: Shape::Element { bits: 2, content: Content::Table(&[(0, "No Mode 5 interrogation"), (1, "Friendly target"), (2, "Unknown target"), (3, "No reply")]) } }),
    Part::Fx,
    Part::Item(Item { name: "CST", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Default value"), (1, "Age of the last received track update is higher than system dependent threshold (coasting)")]) } }),
    Part::Item(Item { name: "PSR", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Default value"), (1, "Age of the last received PSR track update is higher than system dependent threshold")]) } }),
    Part::Item(Item { name: "SSR", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Default value"), (1, "Age of the last received SSR track update is higher than system dependent threshold")]) } }),
    Part::Item(Item { name: "MDS", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Default value"), (1, "Age of the last received Mode S track update is higher than system dependent threshold")]) } }),
    Part::Item(Item { name: "ADS", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Default value"), (1, "Age of the last received ADS-B track update is higher than system dependent threshold")]) } }),
    Part::Item(Item { name: "SUC", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Default value"), (1, "Special Used Code (Mode A codes to be defined in the system to mark a track with special interest)")]) } }),
    Part::Item(Item { name: "AAC", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Default value"), (1, "Assigned Mode A Code Conflict (same discrete Mode A Code assigned to another track)")]) } }),
    Part::Fx,
    Part::Item(Item { name: "SDS", title: "", shape: Shape::Element { bits: 2, content: Content::Table(&[(0, "Combined"), (1, "Co-operative only"), (2, "Non-Cooperative only"), (3, "Not defined")]) } }),
    Part::Item(Item { name: "EMS", title: "", shape: Shape::Element { bits: 3, content: Content::Table(&[(0, "No emergency"), (1, "General emergency"), (2, "Lifeguard / medical"), (3, "Minimum fuel"), (4, "No communications"), (5, "Unlawful interference"), (6, "Downed Aircraft"), (7, "Undefined")]) } }),
    Part::Item(Item { name: "PFT", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "No indication"), (1, "Potential False Track Indication")]) } }),
    Part::Item(Item { name: "FPLT", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Default value"), (1, "Track created / updated with FPL data")]) } }),
    Part::Fx,
    Part::Item(Item { name: "DUPT", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Default value"), (1, "Duplicate Mode 3/A Code")]) } }),
    Part::Item(Item { name: "DUPF", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Default value"), (1, "Duplicate Flight Plan")]) } }),
    Part::Item(Item { name: "DUPM", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Default value"), (1, "Duplicate Flight Plan due to manual correlation")]) } }),
    Part::Item(Item { name: "SFC", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Default value"), (1, "Surface target")]) } }),
    Part::Item(Item { name: "IDD", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "No indication"), (1, "Duplicate Flight-ID")]) } }),
    Part::Item(Item { name: "IEC", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Default value"), (1, "Inconsistent Emergency Code")]) } }),
    Part::Item(Item { name: "MLAT", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Default value"), (1, "Age of the last received MLAT track updateis higher than system dependent threshold")]) } }),
    Part::Fx,
    Part::Item(Item { name: "M5I", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Default value"), (1, "Age of the last received Mode-5 interrogation track update is higher than system dependent threshold")]) } }),
    Part::Spare(6),
    Part::Fx,
]) };

const I100: Item = Item { name: "100", title: "Calculated Track Position (Cartesian)", shape: Shape::Group { bits: 48, parts: &[
    Part::Item(Item { name: "X", title: "X Coordinate", shape: Shape::Element { bits: 24, content: Content::Quantity { signed: true, step: 1.0 / 2.0, unit: "m" } } }),
    Part::Item(Item { name: "Y", title: "Y Coordinate", shape: Shape::Element { bits: 24, content: Content::Quantity { signed: true, step: 1.0 / 2.0, unit: "m" } } }),
] } };

const I105: Item = Item { name: "105", title: "Calculated Position In WGS-84 Co-ordinates", shape: Shape::Group { bits: 64, parts: &[
    Part::Item(Item { name: "LAT", title: "Latitude", shape: Shape::Element { bits: 32, content: Content::Quantity { signed: true, step: 180.0 / 33_554_432.0, unit: "°" } } }),
    Part::Item(Item { name: "LON", title: "Longitude", shape: Shape::Element { bits: 32, content: Content::Quantity { signed: true, step: 180.0 / 33_554_432.0, unit: "°" } } }),
] } };

const I110: Item = Item { name: "110", title: "Mode 5 Data Reports and Extended Mode 1 Code", shape: Shape::Compound(&[
    Some(Item { name: "SUM", title: "Mode 5 Summary", shape: Shape::Group { bits: 8, parts: &[
        Part::Item(Item { name: "M5", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "No Mode 5 interrogation"), (1, "Mode 5 interrogation")]) } }),
        Part::Item(Item { name: "ID", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "No authenticated Mode 5 ID reply"), (1, "Authenticated Mode 5 ID reply")]) } }),
        Part::Item(Item { name: "DA", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "No authenticated Mode 5 Data reply or Report"), (1, "Authenticated Mode 5 Data reply or Report (i.e any valid Mode 5 reply type other than ID)")]) } }),
        Part::Item(Item { name: "M1", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Mode 1 code not present or not from Mode 5 reply"), (1, "Mode 1 code from Mode 5 reply")]) } }),
        Part::Item(Item { name: "M2", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Mode 2 code not present or not from Mode 5 reply"), (1, "Mode 2 code from Mode 5 reply")]) } }),
        Part::Item(Item { name: "M3", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Mode 3 code not present or not from Mode 5 reply"), (1, "Mode 3 code from Mode 5 reply")]) } }),
        Part::Item(Item { name: "MC", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Mode C altitude code not present or not from Mode 5 reply"), (1, "Mode C altitude from Mode 5 reply")]) } }),
        Part::Item(Item { name: "X", title: "X-pulse from Mode 5 Data Reply or Report", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "X-pulse set to zero or no authenticated Data reply or Report received"), (1, "X-pulse set to one")]) } }),
    ] } }),
    Some(Item { name: "PMN", title: "Mode 5 PIN/ National Origin/Mission Code", shape: Shape::Group { bits: 32, parts: &[
        Part::Spare(2),
        Part::Item(Item { name: "PIN", title: "PIN Code", shape: Shape::Element { bits: 14, content: Content::Raw } }),
        Part::Spare(3),
        Part::Item(Item { name: "NAT", title: "National Origin", shape: Shape::Element { bits: 5, content: Content::Raw } }),
        Part::Spare(2),
        Part::Item(Item { name: "MIS", title: "Mission Code", shape: Shape::Element { bits: 6, content: Content::Raw } }),
    ] } }),
    Some(Item { name: "POS", title: "Mode 5 Reported Position", shape: Shape::Group { bits: 48, parts: &[
        Part::Item(Item { name: "LAT", title: "Latitude", shape: Shape::Element { bits: 24, content: Content::Quantity { signed: true, step: 180.0 / 8_388_608.0, unit: "°" } } }),
        Part::Item(Item { name: "LON", title: "Longitude", shape: Shape::Element { bits: 24, content: Content::Quantity { signed: true, step: 180.0 / 8_388_608.0, unit: "°" } } }),
    ] } }),
    Some(Item { name: "GA", title: "Mode 5 GNSS-derived Altitude", shape: Shape::Group { bits: 16, parts: &[
        Part::Spare(1),
        Part::Item(Item { name: "RES", title: "Resolution with which the GNSS-derived Altitude (GA) is Reported", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "GA reported in 100 ft increments"), (1, "GA reported in 25 ft increments")]) } }),
        Part::Item(Item { name: "GA", title: "GNSS-derived Altitude of Target, Expressed as Height Above WGS 84 Ellipsoid", shape: Shape::Element { bits: 14, content: Content::Quantity { signed: true, step: 25.0, unit: "ft" } } }),
    ] } }),
    Some(Item { name: "EM1", title: "Extended Mode 1 Code in Octal Representation", shape: Shape::Group { bits: 16, parts: &[
        Part::Spare(4),
        Part::Item(Item { name: "EM1", title: "Extended Mode 1 Reply in Octal Representation", shape: Shape::Element { bits: 12, content: Content::Text(Text::Octal) } }),
    ] } }),
    Some(Item { name: "TOS", title: "Time Offset for POS and GA", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: true, step: 1.0 / 128.0, unit: "s" } } }),
    Some(Item { name: "XP", title: "X Pulse Presence", shape: Shape::Group { bits: 8, parts: &[
        Part::Spare(3),
        Part::Item(Item { name: "X5", title: "X-pulse from Mode 5 Data Reply or Report", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "X-pulse set to zero or no authenticated Data reply or Report received"), (1, "X-pulse set to one (present)")]) } }),
        Part::Item(Item { name: "XC", title: "X-pulse from Mode C Reply", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "X-pulse set to zero or no Mode C reply"), (1, "X-pulse set to one (present)")]) } }),
        Part::Item(Item { name: "X3", title: "X-pulse from Mode 3/A Reply", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "X-pulse set to zero or no Mode 3/A reply"), (1, "X-pulse set to one (present)")]) } }),
        Part::Item(Item { name: "X2", title: "X-pulse from Mode 2 Reply", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "X-pulse set to zero or no Mode 2 reply"), (1, "X-pulse set to one (present)")]) } }),
        Part::Item(Item { name: "X1", title: "X-pulse from Mode 1 Reply", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "X-pulse set to zero or no Mode 1 reply"), (1, "X-pulse set to one (present)")]) } }),
    ] } }),
]) };

const I120: Item = Item { name: "120", title: "Track Mode 2 Code", shape: Shape::Group { bits: 16, parts: &[
    Part::Spare(4),
    Part::Item(Item { name: "MODE2", title: "Mode-2 Code in Octal Representation", shape: Shape::Element { bits: 12, content: Content::Text(Text::Octal) } }),
] } };

const I130: Item = Item { name: "130", title: "Calculated Track Geometric Altitude", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: true, step: 25.0 / 4.0, unit: "ft" } } };

const I135: Item = Item { name: "135", title: "Calculated Track Barometric Altitude", shape: Shape::Group { bits: 16, parts: &[
    Part::Item(Item { name: "QNH", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "No QNH correction applied"), (1, "QNH correction applied")]) } }),
    Part::Item(Item { name: "CTB", title: "Calculated Track Barometric Altitude", shape: Shape::Element { bits: 15, content: Content::Quantity { signed: true, step: 1.0 / 4.0, unit: "FL" } } }),
] } };

const I136: Item = Item { name: "136", title: "Measured Flight Level", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: true, step: 1.0 / 4.0, unit: "FL" } } };

const I185: Item = Item { name: "185", title: "Calculated Track Velocity (Cartesian)", shape: Shape::Group { bits: 32, parts: &[
    Part::Item(Item { name: "VX", title: "Velocity (X-component)", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: true, step: 1.0 / 4.0, unit: "m/s" } } }),
    Part::Item(Item { name: "VY", title: "Velocity (Y-component)", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: true, step: 1.0 / 4.0, unit: "m/s" } } }),
] } };

const I200: Item = Item { name: "200", title: "Mode of Movement", shape: Shape::Group { bits: 8, parts: &[
    Part::Item(Item { name: "TRANS", title: "Transversal Acceleration", shape: Shape::Element { bits: 2, content: Content::Table(&[(0, "Constant course"), (1, "Right turn"), (2, "Left turn"), (3, "Undetermined")]) } }),
    Part::Item(Item { name: "LONG", title: "Longitudinal Acceleration", shape: Shape::Element { bits: 2, content: Content::Table(&[(0, "Constant groundspeed"), (1, "Increasing groundspeed"), (2, "Decreasing groundspeed"), (3, "Undetermined")]) } }),
    Part::Item(Item { name: "VERT", title: "Vertical Rate", shape: Shape::Element { bits: 2, content: Content::Table(&[(0, "Level"), (1, "Climb"), (2, "Descent"), (3, "Undetermined")]) } }),
    Part::Item(Item { name: "ADF", title: "Altitude Discrepancy Flag", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "No altitude discrepancy"), (1, "Altitude discrepancy")]) } }),
    Part::Spare(1),
] } };

const I210: Item = Item { name: "210", title: "Calculated Acceleration (Cartesian)", shape: Shape::Group { bits: 16, parts: &[
    Part::Item(Item { name: "AX", title: "", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: true, step: 1.0 / 4.0, unit: "m/s²" } } }),
    Part::Item(Item { name: "AY", title: "", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: true, step: 1.0 / 4.0, unit: "m/s²" } } }),
] } };

const I220: Item = Item { name: "220", title: "Calculated Rate of Climb/Descent", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: true, step: 25.0 / 4.0, unit: "ft/min" } } };

const I245: Item = Item { name: "245", title: "Target Identification", shape: Shape::Group { bits: 56, parts: &[
    Part::Item(Item { name: "STI", title: "", shape: Shape::Element { bits: 2, content: Content::Table(&[(0, "Callsign or registration downlinked from target"), (1, "Callsign not downlinked from target"), (2, "Registration not downlinked from target"), (3, "Invalid")]) } }),
    Part::Spare(6),
    Part::Item(Item { name: "CHR", title: "Characters 1-8 (Coded on 6 Bits Each) Defining Target Identification", shape: Shape::Element { bits: 48, content: Content::Text(Text::Icao) } }),
] } };

const I270: Item = Item { name: "270", title: "Target Size and Orientation", shape: Shape::Extended(&[
    Part::Item(Item { name: "LENGTH", title: "Length", shape: Shape::Element { bits: 7, content: Content::Quantity { signed: false, step: 1.0, unit: "m" } } }),
    Part::Fx,
    Part::Item(Item { name: "ORIENTATION", title: "Orientation", shape: Shape::Element { bits: 7, content: Content::Quantity { signed: false, step: 360.0 / 128.0, unit: "°" } } }),
    Part::Fx,
    Part::Item(Item { name: "WIDTH", title: "Width", shape: Shape::Element { bits: 7, content: Content::Quantity { signed: false, step: 1.0, unit: "m" } } }),
    Part::Fx,
]) };

const I290: Item = Item { name: "290", title: "System Track Update Ages", shape: Shape::Compound(&[
    Some(Item { name: "TRK", title: "Track Age", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: false, step: 1.0 / 4.0, unit: "s" } } }),
    Some(Item { name: "PSR", title: "PSR Age", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: false, step: 1.0 / 4.0, unit: "s" } } }),
    Some(Item { name: "SSR", title: "SSR Age", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: false, step: 1.0 / 4.0, unit: "s" } } }),
    Some(Item { name: "MDS", title: "Mode S Age", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: false, step: 1.0 / 4.0, unit: "s" } } }),
    Some(Item { name: "ADS", title: "ADS-C Age", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: false, step: 1.0 / 4.0, unit: "s" } } }),
    Some(Item { name: "ES", title: "ADS-B Extended Squitter Age", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: false, step: 1.0 / 4.0, unit: "s" } } }),
    Some(Item { name: "VDL", title: "ADS-B VDL Mode 4 Age", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: false, step: 1.0 / 4.0, unit: "s" } } }),
    Some(Item { name: "UAT", title: "ADS-B UAT Age", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: false, step: 1.0 / 4.0, unit: "s" } } }),
    Some(Item { name: "LOP", title: "Loop Age", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: false, step: 1.0 / 4.0, unit: "s" } } }),
    Some(Item { name: "MLT", title: "Multilateration Age", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: false, step: 1.0 / 4.0, unit: "s" } } }),
]) };

const I295: Item = Item { name: "295", title: "Track Data Ages", shape: Shape::Compound(&[
    Some(Item { name: "MFL", title: "Measured Flight Level Age", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: false, step: 1.0 / 4.0, unit: "s" } } }),
    Some(Item { name: "MD1", title: "Mode 1 Age", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: false, step: 1.0 / 4.0, unit: "s" } } }),
    Some(Item { name: "MD2", title: "Mode 2 Age", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: false, step: 1.0 / 4.0, unit: "s" } } }),
    Some(Item { name: "MDA", title: "Mode 3/A Age", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: false, step: 1.0 / 4.0, unit: "s" } } }),
    Some(Item { name: "MD4", title: "Mode 4 Age", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: false, step: 1.0 / 4.0, unit: "s" } } }),
    Some(Item { name: "MD5", title: "Mode 5 Age", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: false, step: 1.0 / 4.0, unit: "s" } } }),
    Some(Item { name: "MHG", title: "Magnetic Heading Age", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: false, step: 1.0 / 4.0, unit: "s" } } }),
    Some(Item { name: "IAS", title: "Indicated Airspeed / Mach Nb Age", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: false, step: 1.0 / 4.0, unit: "s" } } }),
    Some(Item { name: "TAS", title: "True Airspeed Age", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: false, step: 1.0 / 4.0, unit: "s" } } }),
    Some(Item { name: "SAL", title: "Selected Altitude Age", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: false, step: 1.0 / 4.0, unit: "s" } } }),
    Some(Item { name: "FSS", title: "Final State Selected Altitude Age", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: false, step: 1.0 / 4.0, unit: "s" } } }),
    Some(Item { name: "TID", title: "Trajectory Intent Age", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: false, step: 1.0 / 4.0, unit: "s" } } }),
    Some(Item { name: "COM", title: "Communication/ACAS Capability and Flight Status Age", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: false, step: 1.0 / 4.0, unit: "s" } } }),
    Some(Item { name: "SAB", title: "Status Reported by ADS-B Age", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: false, step: 1.0 / 4.0, unit: "s" } } }),
    Some(Item { name: "ACS", title: "ACAS Resolution Advisory Report Age", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: false, step: 1.0 / 4.0, unit: "s" } } }),
    Some(Item { name: "BVR", title: "Barometric Vertical Rate Age", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: false, step: 1.0 / 4.0, unit: "s" } } }),
    Some(Item { name: "GVR", title: "Geometrical Vertical Rate Age", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: false, step: 1.0 / 4.0, unit: "s" } } }),
    Some(Item { name: "RAN", title: "Roll Angle Age", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: false, step: 1.0 / 4.0, unit: "s" } } }),
    Some(Item { name: "TAR", title: "Track Angle Rate Age", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: false, step: 1.0 / 4.0, unit: "s" } } }),
    Some(Item { name: "TAN", title: "Track Angle Age", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: false, step: 1.0 / 4.0, unit: "s" } } }),
    Some(Item { name: "GSP", title: "Ground Speed Age", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: false, step: 1.0 / 4.0, unit: "s" } } }),
    Some(Item { name: "VUN", title: "Velocity Uncertainty Age", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: false, step: 1.0 / 4.0, unit: "s" } } }),
    Some(Item { name: "MET", title: "Meteorological Data Age", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: false, step: 1.0 / 4.0, unit: "s" } } }),
    Some(Item { name: "EMC", title: "Emitter Category Age", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: false, step: 1.0 / 4.0, unit: "s" } } }),
    Some(Item { name: "POS", title: "Position Age", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: false, step: 1.0 / 4.0, unit: "s" } } }),
    Some(Item { name: "GAL", title: "Geometric Altitude Age", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: false, step: 1.0 / 4.0, unit: "s" } } }),
    Some(Item { name: "PUN", title: "Position Uncertainty Age", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: false, step: 1.0 / 4.0, unit: "s" } } }),
    Some(Item { name: "MB", title: "BDS Register Data Age", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: false, step: 1.0 / 4.0, unit: "s" } } }),
    Some(Item { name: "IAR", title: "Indicated Airspeed Data Age", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: false, step: 1.0 / 4.0, unit: "s" } } }),
    Some(Item { name: "MAC", title: "Mach Number Data Age", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: false, step: 1.0 / 4.0, unit: "s" } } }),
    Some(Item { name: "BPS", title: "Barometric Pressure Setting Data Age", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: false, step: 1.0 / 4.0, unit: "s" } } }),
]) };

const I300: Item = Item { name: "300", title: "Vehicle Fleet Identification", shape: Shape::Element { bits: 8, content: Content::Table(&[(0, "Unknown"), (1, "ATC equipment maintenance"), (2, "Airport maintenance"), (3, "Fire"), (4, "Bird scarer"), (5, "Snow plough"), (6, "Runway sweeper"), (7, "Emergency"), (8, "Police"), (9, "Bus"), (10, "Tug (push/tow)"), (11, "Grass cutter"), (12, "Fuel"), (13, "Baggage"), (14, "Catering"), (15, "Aircraft maintenance"), (16, "Flyco (follow me)")]) } };

const I340: Item = Item { name: "340", title: "Measured Information", shape: Shape::Compound(&[
    Some(Item { name: "SID", title: "Sensor Identification", shape: Shape::Group { bits: 16, parts: &[
        Part::Item(Item { name: "SAC", title: "System Area Code", shape: Shape::Element { bits: 8, content: Content::Raw } }),
        Part::Item(Item { name: "SIC", title: "System Identification Code", shape: Shape::Element { bits: 8, content: Content::Raw } }),
    ] } }),
    Some(Item { name: "POS", title: "Measured Position", shape: Shape::Group { bits: 32, parts: &[
        Part::Item(Item { name: "RHO", title: "Measured Distance", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: false, step: 1.0 / 256.0, unit: "NM" } } }),
        Part::Item(Item { name: "THETA", title: "Measured Azimuth", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: false, step: 360.0 / 65536.0, unit: "°" } } }),
    ] } }),
    Some(Item { name: "HEIGHT", title: "Measured 3-D Height", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: true, step: 25.0, unit: "ft" } } }),
    Some(Item { name: "MDC", title: "", shape: Shape::Group { bits: 16, parts: &[
        Part::Item(Item { name: "V", title: "Validated", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Code validated"), (1, "Code not validated")]) } }),
        Part::Item(Item { name: "G", title: "Garbled", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Default"), (1, "Garbled code")]) } }),
        Part::Item(Item { name: "LMC", title: "Last Measured Mode C Code", shape: Shape::Element { bits: 14, content: Content::Quantity { signed: true, step: 1.0 / 4.0, unit: "FL" } } }),
    ] } }),
    Some(Item { name: "MDA", title: "", shape: Shape::Group { bits: 16, parts: &[
        Part::Item(Item { name: "V", title: "Validated", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Code validated"), (1, "Code not validated")]) } }),
        Part::Item(Item { name: "G", title: "Garbled", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Default"), (1, "Garbled code")]) } }),
        Part::Item(Item { name: "L", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Mode 3/A code as derived from the reply of the transponder"), (1, "Mode 3/A code as provided by a sensor local tracker")]) } }),
        Part::Spare(1),
        Part::Item(Item { name: "MODE3A", title: "Mode-3/A Reply in Octal Representation", shape: Shape::Element { bits: 12, content: Content::Text(Text::Octal) } }),
    ] } }),
    Some(Item { name: "TYP", title: "", shape: Shape::Group { bits: 8, parts: &[
        Part::Item(Item { name: "TYP", title: "Report Type", shape: Shape::Element { bits: 3, content: Content::Table(&[(0, "No detection"), (1, "Single PSR detection"), (2, "Single SSR detection"), (3, "SSR + PSR detection"), (4, "Single ModeS All-Call"), (5, "Single ModeS Roll-Call"), (6, "ModeS All-Call + PSR"), (7, "ModeS Roll-Call + PSR")]) } }),
        Part::Item(Item { name: "SIM", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Actual target report"), (1, "Simulated target report")]) } }),
        Part::Item(Item { name: "RAB", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Report from target transponder"), (1, "Report from field monitor (item transponder)")]) } }),
        Part::Item(Item { name: "TST", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Real target report"), (1, "Test target report")]) } }),
        Part::Spare(2),
    ] } }),
]) };

const I380: Item = Item { name: "380", title: "Aircraft Derived Data", shape: Shape::Compound(&[
    Some(Item { name: "ADR", title: "Target Address", shape: Shape::Element { bits: 24, content: Content::Raw } }),
    Some(Item { name: "ID", title: "Target Identification", shape: Shape::Element { bits: 48, content: Content::Text(Text::Icao) } }),
    Some(Item { name: "MHG", title: "Magnetic Heading", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: false, step: 360.0 / 65536.0, unit: "°" } } }),
    Some(Item { name: "IAS", title: "Indicated Airspeed/Mach No", shape: Shape::Group { bits: 16, parts: &[
        Part::Item(Item { name: "IM", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Air Speed = IAS, LSB (Bit-1) = 2^-14 NM/s"), (1, "Air Speed = Mach, LSB (Bit-1) = 0.001")]) } }),
        Part::Item(Item { name: "IAS", title: "", shape: Shape::Element { bits: 15, content: Content::Case { of: "IM", cases: &[(0, Content::Quantity { signed: false, step: 1.0 / 16384.0, unit: "NM/s" }), (1, Content::Quantity { signed: false, step: 1.0 / 1000.0, unit: "Mach" })] } } }),
    ] } }),
    Some(Item { name: "TAS", title: "True Airspeed", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: false, step: 1.0, unit: "kt" } } }),
    Some(Item { name: "SAL", title: "Selected Altitude", shape: Shape::Group { bits: 16, parts: &[
        Part::Item(Item { name: "SAS", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "No source information provided"), (1, "Source information provided")]) } }),
        Part::Item(Item { name: "SRC", title: "", shape: Shape::Element { bits: 2, content: Content::Table(&[(0, "Unknown"), (1, "Aircraft altitude"), (2, "FCU/MCP selected altitude"), (3, "FMS selected altitude")]) } }),
        Part::Item(Item { name: "ALT", title: "Altitude in Two's Complement Form", shape: Shape::Element { bits: 13, content: Content::Quantity { signed: true, step: 25.0, unit: "ft" } } }),
    ] } }),
    Some(Item { name: "FSS", title: "Final State Selected Altitude", shape: Shape::Group { bits: 16, parts: &[
        Part::Item(Item { name: "MV", title: "Manage Vertical Mode", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Not active"), (1, "Active")]) } }),
        Part::Item(Item { name: "AH", title: "Altitude Hold", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Not active"), (1, "Active")]) } }),
        Part::Item(Item { name: "AM", title: "Approach Mode", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Not active"), (1, "Active")]) } }),
        Part::Item(Item { name: "ALT", title: "Altitude in Two's Complement Form", shape: Shape::Element { bits: 13, content: Content::Quantity { signed: true, step: 25.0, unit: "ft" } } }),
    ] } }),
    Some(Item { name: "TIS", title: "Trajectory Intent Status", shape: Shape::Extended(&[
        Part::Item(Item { name: "NAV", title: "TID Available", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Trajectory intent data is available for this aircraft"), (1, "Trajectory intent data is not available for this aircraft")]) } }),
        Part::Item(Item { name: "NVB", title: "TID Valid", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Trajectory intent data is valid"), (1, "Trajectory intent data is not valid")]) } }),
        Part::Spare(5),
        Part::Fx,
    ]) }),
    Some(Item { name: "TID", title: "Trajectory Intent Data", shape: Shape::Counted(&Shape::Group { bits: 120, parts: &[
        Part::Item(Item { name: "TCA", title: "TCP Number Availability", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "TCP number available"), (1, "TCP number not available")]) } }),
        Part::Item(Item { name: "NC", title: "TCP Compliance", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "TCP compliance"), (1, "TCP non-compliance")]) } }),
        Part::Item(Item { name: "TCPN", title: "Trajectory Change Point Number", shape: Shape::Element { bits: 6, content: Content::Raw } }),
        Part::Item(Item { name: "ALT", title: "Altitude in Two's Complement Form", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: true, step: 10.0, unit: "ft" } } }),
        Part::Item(Item { name: "LAT", title: "Latitude in WGS.84 in Two's Complement", shape: Shape::Element { bits: 24, content: Content::Quantity { signed: true, step: 180.0 / 8_388_608.0, unit: "°" } } }),
        Part::Item(Item { name: "LON", title: "Longitude in WGS.84 in Two's Complement", shape: Shape::Element { bits: 24, content: Content::Quantity { signed: true, step: 180.0 / 8_388_608.0, unit: "°" } } }),
        Part::Item(Item { name: "PT", title: "Point Type", shape: Shape::Element { bits: 4, content: Content::Table(&[(0, "Unknown"), (1, "Fly by waypoint (LT)"), (2, "Fly over waypoint (LT)"), (3, "Hold pattern (LT)"), (4, "Procedure hold (LT)"), (5, "Procedure turn (LT)"), (6, "RF leg (LT)"), (7, "Top of climb (VT)"), (8, "Top of descent (VT)"), (9, "Start of level (VT)"), (10, "Cross-over altitude (VT)"), (11, "Transition altitude (VT)")]) } }),
        Part::Item(Item { name: "TD", title: "Turn Direction", shape: Shape::Element { bits: 2, content: Content::Table(&[(0, "N/A"), (1, "Turn right"), (2, "Turn left"), (3, "No turn")]) } }),
        Part::Item(Item { name: "TRA", title: "Turn Radius Availability", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "TTR not available"), (1, "TTR available")]) } }),
        Part::Item(Item { name: "TOA", title: "TOV Available", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "TOV available"), (1, "TOV not available")]) } }),
        Part::Item(Item { name: "TOV", title: "Time Over Point", shape: Shape::Element { bits: 24, content: Content::Quantity { signed: false, step: 1.0, unit: "s" } } }),
        Part::Item(Item { name: "TTR", title: "TCP Turn Radius", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: false, step: 1.0 / 100.0, unit: "NM" } } }),
    ] }) }),
    Some(Item { name: "COM", title: "Communications/ACAS Capability and Flight Status", shape: Shape::Group { bits: 16, parts: &[
        Part::Item(Item { name: "COM", title: "Communications Capability of the Transponder", shape: Shape::Element { bits: 3, content: Content::Table(&[(0, "No communications capability (surveillance only)"), (1, "Comm. A and Comm. B capability"), (2, "Comm. A, Comm. B and Uplink ELM"), (3, "Comm. A, Comm. B, Uplink ELM and Downlink ELM"), (4, "Level 5 Transponder capability"), (5, "Not assigned"), (6, "Not assigned"), (7, "Not assigned")]) } }),
        Part::Item(Item { name: "STAT", title: "Flight Status", shape: Shape::Element { bits: 3, content: Content::Table(&[(0, "No alert, no SPI, aircraft airborne"), (1, "No alert, no SPI, aircraft on ground"), (2, "Alert, no SPI, aircraft airborne"), (3, "Alert, no SPI, aircraft on ground"), (4, "Alert, SPI, aircraft airborne or on ground"), (5, "No alert, SPI, aircraft airborne or on ground"), (6, "Not defined"), (7, "Unknown or not yet extracted")]) } }),
        Part::Spare(2),
        Part::Item(Item { name: "SSC", title: "Specific Service Capability", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "No"), (1, "Yes")]) } }),
        Part::Item(Item { name: "ARC", title: "Altitude Reporting Capability", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "100 ft resolution"), (1, "25 ft resolution")]) } }),
        Part::Item(Item { name: "AIC", title: "Aircraft Identification Capability", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "No"), (1, "Yes")]) } }),
        Part::Item(Item { name: "B1A", title: "BDS 1,0 Bit 16", shape: Shape::Element { bits: 1, content: Content::Raw } }),
        Part::Item(Item { name: "B1B", title: "BDS BDS 1,0 Bits 37/40", shape: Shape::Element { bits: 4, content: Content::Raw } }),
    ] } }),
    Some(Item { name: "SAB", title: "Status Reported by ADS-B", shape: Shape::Group { bits: 16, parts: &[
        Part::Item(Item { name: "AC", title: "ACAS Status", shape: Shape::Element { bits: 2, content: Content::Table(&[(0, "Unknown"), (1, "ACAS not operational"), (2, "ACAS operational"), (3, "Invalid")]) } }),
        Part::Item(Item { name: "MN", title: "Multiple Navigational Aids Status", shape: Shape::Element { bits: 2, content: Content::Table(&[(0, "Unknown"), (1, "Multiple navigational aids not operating"), (2, "Multiple navigational aids operating"), (3, "Invalid")]) } }),
        Part::Item(Item { name: "DC", title: "Differential Correction Status", shape: Shape::Element { bits: 2, content: Content::Table(&[(0, "Unknown"), (1, "Differential correction"), (2, "No differential correction"), (3, "Invalid")]) } }),
        Part::Item(Item { name: "GBS", title: "Ground Bit Set", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Transponder ground bit not set or unknown"), (1, "Transponder Ground Bit set")]) } }),
        Part::Spare(6),
        Part::Item(Item { name: "STAT", title: "Flight Status", shape: Shape::Element { bits: 3, content: Content::Table(&[(0, "No emergency"), (1, "General emergency"), (2, "Lifeguard / medical"), (3, "Minimum fuel"), (4, "No communications"), (5, "Unlawful interference"), (6, "Downed Aircraft"), (7, "Unknown")]) } }),
    ] } }),
    Some(Item { name: "ACS", title: "ACAS Resolution Advisory Report", shape: Shape::Element { bits: 56, content: Content::Raw } }),
    Some(Item { name: "BVR", title: "Barometric Vertical Rate", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: true, step: 25.0 / 4.0, unit: "ft/min" } } }),
    Some(Item { name: "GVR", title: "Geometric Vertical Rate", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: true, step: 25.0 / 4.0, unit: "ft/min" } } }),
    Some(Item { name: "RAN", title: "Roll Angle", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: true, step: 1.0 / 100.0, unit: "°" } } }),
    Some(Item { name: "TAR", title: "Track Angle Rate", shape: Shape::Group { bits: 16, parts: &[
        Part::Item(Item { name: "TI", title: "Turn Indicator", shape: Shape::Element { bits: 2, content: Content::Table(&[(0, "Not available"), (1, "Left"), (2, "Right"), (3, "Straight")]) } }),
        Part::Spare(6),
        Part::Item(Item { name: "ROT", title: "Rate of Turn in Two's Complement Form", shape: Shape::Element { bits: 7, content: Content::Quantity { signed: true, step: 1.0 / 4.0, unit: "°/s" } } }),
        Part::Spare(1),
    ] } }),
    Some(Item { name: "TAN", title: "Track Angle", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: false, step: 360.0 / 65536.0, unit: "°" } } }),
    Some(Item { name: "GS", title: "Ground Speed", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: true, step: 1.0 / 16384.0, unit: "NM/s" } } }),
    Some(Item { name: "VUN", title: "Velocity Uncertainty", shape: Shape::Element { bits: 8, content: Content::Raw } }),
    Some(Item { name: "MET", title: "Meteorological Data", shape: Shape::Group { bits: 64, parts: &[
        Part::Item(Item { name: "WS", title: "Wind Speed Valid Flag", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Not valid Wind Speed"), (1, "Valid Wind Speed")]) } }),
        Part::Item(Item { name: "WD", title: "Wind Direction Valid Flag", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Not valid Wind Direction"), (1, "Valid Wind Direction")]) } }),
        Part::Item(Item { name: "TMP", title: "Temperature Valid Flag", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Not valid Temperature"), (1, "Valid Temperature")]) } }),
        Part::Item(Item { name: "TRB", title: "Turbulence Valid Flag", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Not valid Turbulence"), (1, "Valid Turbulence")]) } }),
        Part::Spare(4),
        Part::Item(Item { name: "WSD", title: "Wind Speed", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: false, step: 1.0, unit: "kt" } } }),
        Part::Item(Item { name: "WDD", title: "Wind Direction", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: false, step: 1.0, unit: "°" } } }),
        Part::Item(Item { name: "TMPD", title: "Temperature in Degrees Celsius", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: true, step: 1.0 / 4.0, unit: "°C" } } }),
        Part::Item(Item { name: "TRBD", title: "Turbulence", shape: Shape::Element { bits: 8, content: Content::Integer { signed: false } } }),
    ] } }),
    Some(Item { name: "EMC", title: "Emitter Category", shape: Shape::Element { bits: 8, content: Content::Table(&[(1, "Light aircraft =< 7000 kg"), (2, "Reserved"), (3, "7000 kg < medium aircraft < 136000 kg"), (4, "Reserved"), (5, "136000 kg <= heavy aircraft"), (6, "Highly manoeuvrable (5g acceleration capability) and high speed (>400 knots cruise)"), (7, "Reserved"), (8, "Reserved"), (9, "Reserved"), (10, "Rotocraft"), (11, "Glider / sailplane"), (12, "Lighter-than-air"), (13, "Unmanned aerial vehicle"), (14, "Space / transatmospheric vehicle"), (15, "Ultralight / handglider / paraglider"), (16, "Parachutist / skydiver"), (17, "Reserved"), (18, "Reserved"), (19, "Reserved"), (20, "Surface emergency vehicle"), (21, "Surface service vehicle"), (22, "Fixed ground or tethered obstruction"), (23, "Reserved"), (24, "Reserved")]) } }),
    Some(Item { name: "POS", title: "Position", shape: Shape::Group { bits: 48, parts: &[
        Part::Item(Item { name: "LAT", title: "Latitude in WGS.84 in Two's Complement Form", shape: Shape::Element { bits: 24, content: Content::Quantity { signed: true, step: 180.0 / 8_388_608.0, unit: "°" } } }),
        Part::Item(Item { name: "LON", title: "Longitude in WGS.84 in Two's Complement Form", shape: Shape::Element { bits: 24, content: Content::Quantity { signed: true, step: 180.0 / 8_388_608.0, unit: "°" } } }),
    ] } }),
    Some(Item { name: "GAL", title: "Geometric Altitude", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: true, step: 25.0 / 4.0, unit: "ft" } } }),
    Some(Item { name: "PUN", title: "Position Uncertainty", shape: Shape::Group { bits: 8, parts: &[
        Part::Spare(4),
        Part::Item(Item { name: "PUN", title: "Position Uncertainty", shape: Shape::Element { bits: 4, content: Content::Raw } }),
    ] } }),
    Some(Item { name: "BDSDATA", title: "BDS Register DATA", shape: Shape::Counted(&Shape::Element { bits: 64, content: Content::Raw }) }),
    Some(Item { name: "IAR", title: "Indicated Airspeed", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: false, step: 1.0, unit: "kt" } } }),
    Some(Item { name: "MAC", title: "Mach Number", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: false, step: 1.0 / 125.0, unit: "Mach" } } }),
    Some(Item { name: "BPS", title: "Barometric Pressure Setting", shape: Shape::Group { bits: 16, parts: &[
        Part::Spare(4),
        Part::Item(Item { name: "BPS", title: "", shape: Shape::Element { bits: 12, content: Content::Quantity { signed: false, step: 1.0 / 10.0, unit: "mb" } } }),
    ] } }),
]) };

const I390: Item = Item { name: "390", title: "Flight Plan Related Data", shape: Shape::Compound(&[
    Some(Item { name: "TAG", title: "FPPS Identification Tag", shape: Shape::Group { bits: 16, parts: &[
        Part::Item(Item { name: "SAC", title: "System Area Code", shape: Shape::Element { bits: 8, content: Content::Raw } }),
        Part::Item(Item { name: "SIC", title: "System Identification Code", shape: Shape::Element { bits: 8, content: Content::Raw } }),
    ] } }),
    Some(Item { name: "CS", title: "Callsign", shape: Shape::Element { bits: 56, content: Content::Text(Text::Ascii) } }),
    Some(Item { name: "IFI", title: "IFPS_FLIGHT_ID", shape: Shape::Group { bits: 32, parts: &[
        Part::Item(Item { name: "TYP", title: "", shape: Shape::Element { bits: 2, content: Content::Table(&[(0, "Plan Number"), (1, "Unit 1 internal flight number"), (2, "Unit 2 internal flight number"), (3, "Unit 3 internal flight number")]) } }),
        Part::Spare(3),
        Part::Item(Item { name: "NBR", title: "Number from 0 to 99 999 999", shape: Shape::Element { bits: 27, content: Content::Integer { signed: false } } }),
    ] } }),
    Some(Item { name: "FCT", title: "Flight Category", shape: Shape::Group { bits: 8, parts: &[
        Part::Item(Item { name: "GATOAT", title: "", shape: Shape::Element { bits: 2, content: Content::Table(&[(0, "Unknown"), (1, "General Air Traffic"), (2, "Operational Air Traffic"), (3, "Not applicable")]) } }),
        Part::Item(Item { name: "FR1FR2", title: "", shape: Shape::Element { bits: 2, content: Content::Table(&[(0, "Instrument Flight Rules"), (1, "Visual Flight Rules"), (2, "Not applicable"), (3, "Controlled Visual Flight Rules")]) } }),
        Part::Item(Item { name: "RVSM", title: "", shape: Shape::Element { bits: 2, content: Content::Table(&[(0, "Unknown"), (1, "Approved"), (2, "Exempt"), (3, "Not Approved")]) } }),
        Part::Item(Item { name: "HPR", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Normal Priority Flight"), (1, "High Priority Flight")]) } }),
        Part::Spare(1),
    ] } }),
    Some(Item { name: "TAC", title: "Type of Aircraft", shape: Shape::Element { bits: 32, content: Content::Text(Text::Ascii) } }),
    Some(Item { name: "WTC", title: "Wake Turbulence Category", shape: Shape::Element { bits: 8, content: Content::Text(Text::Ascii) } }),
    Some(Item { name: "DEP", title: "Departure Airport", shape: Shape::Element { bits: 32, content: Content::Text(Text::Ascii) } }),
    Some(Item { name: "DST", title: "Destination Airport", shape: Shape::Element { bits: 32, content: Content::Text(Text::Ascii) } }),
    Some(Item { name: "RDS", title: "Runway Designation", shape: Shape::Group { bits: 24, parts: &[
        Part::Item(Item { name: "NU1", title: "First Number", shape: Shape::Element { bits: 8, content: Content::Text(Text::Ascii) } }),
        Part::Item(Item { name: "NU2", title: "Second Number", shape: Shape::Element { bits: 8, content: Content::Text(Text::Ascii) } }),
        Part::Item(Item { name: "LTR", title: "Letter", shape: Shape::Element { bits: 8, content: Content::Text(Text::Ascii) } }),
    ] } }),
    Some(Item { name: "CFL", title: "Current Cleared Flight Level", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: false, step: 1.0 / 4.0, unit: "FL" } } }),
    Some(Item { name: "CTL", title: "Current Control Position", shape: Shape::Group { bits: 16, parts: &[
        Part::Item(Item { name: "CENTRE", title: "8-bit Group Identification Code", shape: Shape::Element { bits: 8, content: Content::Raw } }),
        Part::Item(Item { name: "POSITION", title: "8-bit Control Position Identification Code", shape: Shape::Element { bits: 8, content: Content::Raw } }),
    ] } }),
    Some(Item { name: "TOD", title: "Time of Departure / Arrival", shape: Shape::Counted(&Shape::Group { bits: 32, parts: &[
        Part::Item(Item { name: "TYP", title: "", shape: Shape::Element { bits: 5, content: Content::Table(&[(0, "Scheduled off-block time"), (1, "Estimated off-block time"), (2, "Estimated take-off time"), (3, "Actual off-block time"), (4, "Predicted time at runway hold"), (5, "Actual time at runway hold"), (6, "Actual line-up time"), (7, "Actual take-off time"), (8, "Estimated time of arrival"), (9, "Predicted landing time"), (10, "Actual landing time"), (11, "Actual time off runway"), (12, "Predicted time to gate"), (13, "Actual on-block time")]) } }),
        Part::Item(Item { name: "DAY", title: "", shape: Shape::Element { bits: 2, content: Content::Table(&[(0, "Today"), (1, "Yesterday"), (2, "Tomorrow"), (3, "Invalid")]) } }),
        Part::Spare(4),
        Part::Item(Item { name: "HOR", title: "Hours", shape: Shape::Element { bits: 5, content: Content::Integer { signed: false } } }),
        Part::Spare(2),
        Part::Item(Item { name: "MIN", title: "Minutes", shape: Shape::Element { bits: 6, content: Content::Integer { signed: false } } }),
        Part::Item(Item { name: "AVS", title: "Seconds Available Flag", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "Seconds available"), (1, "Seconds not available")]) } }),
        Part::Spare(1),
        Part::Item(Item { name: "SEC", title: "Seconds", shape: Shape::Element { bits: 6, content: Content::Integer { signed: false } } }),
    ] }) }),
    Some(Item { name: "AST", title: "Aircraft Stand", shape: Shape::Element { bits: 48, content: Content::Text(Text::Ascii) } }),
    Some(Item { name: "STS", title: "Stand Status", shape: Shape::Group { bits: 8, parts: &[
        Part::Item(Item { name: "EMP", title: "", shape: Shape::Element { bits: 2, content: Content::Table(&[(0, "Empty"), (1, "Occupied"), (2, "Unknown"), (3, "Invalid")]) } }),
        Part::Item(Item { name: "AVL", title: "", shape: Shape::Element { bits: 2, content: Content::Table(&[(0, "Available"), (1, "Not available"), (2, "Unknown"), (3, "Invalid")]) } }),
        Part::Spare(4),
    ] } }),
    Some(Item { name: "STD", title: "Standard Instrument Departure", shape: Shape::Element { bits: 56, content: Content::Text(Text::Ascii) } }),
    Some(Item { name: "STA", title: "Standard Instrument Arrival", shape: Shape::Element { bits: 56, content: Content::Text(Text::Ascii) } }),
    Some(Item { name: "PEM", title: "Pre-Emergency Mode 3/A", shape: Shape::Group { bits: 16, parts: &[
        Part::Spare(3),
        Part::Item(Item { name: "VA", title: "", shape: Shape::Element { bits: 1, content: Content::Table(&[(0, "No valid Mode 3/A available"), (1, "Valid Mode 3/A available")]) } }),
        Part::Item(Item { name: "MODE3A", title: "Mode-3/A Reply in Octal Representation", shape: Shape::Element { bits: 12, content: Content::Text(Text::Octal) } }),
    ] } }),
    Some(Item { name: "PEC", title: "Pre-Emergency Callsign", shape: Shape::Element { bits: 56, content: Content::Text(Text::Ascii) } }),
]) };

const I500: Item = Item { name: "500", title: "Estimated Accuracies", shape: Shape::Compound(&[
    Some(Item { name: "APC", title: "Estimated Accuracy Of Track Position (Cartesian)", shape: Shape::Group { bits: 32, parts: &[
        Part::Item(Item { name: "X", title: "APC (X-Component)", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: false, step: 1.0 / 2.0, unit: "m" } } }),
        Part::Item(Item { name: "Y", title: "APC (Y-Component)", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: false, step: 1.0 / 2.0, unit: "m" } } }),
    ] } }),
    Some(Item { name: "COV", title: "XY Covariance Component", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: true, step: 1.0 / 2.0, unit: "m" } } }),
    Some(Item { name: "APW", title: "Estimated Accuracy Of Track Position (WGS-84)", shape: Shape::Group { bits: 32, parts: &[
        Part::Item(Item { name: "LAT", title: "APW (Latitude Component)", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: false, step: 180.0 / 33_554_432.0, unit: "°" } } }),
        Part::Item(Item { name: "LON", title: "APW (Longitude Component)", shape: Shape::Element { bits: 16, content: Content::Quantity { signed: false, step: 180.0 / 33_554_432.0, unit: "°" } } }),
    ] } }),
    Some(Item { name: "AGA", title: "Estimated Accuracy Of Calculated Track Geometric Altitude", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: false, step: 25.0 / 4.0, unit: "ft" } } }),
    Some(Item { name: "ABA", title: "Estimated Accuracy Of Calculated Track Barometric Altitude", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: false, step: 1.0 / 4.0, unit: "FL" } } }),
    Some(Item { name: "ATV", title: "Estimated Accuracy Of Track Velocity (Cartesian)", shape: Shape::Group { bits: 16, parts: &[
        Part::Item(Item { name: "X", title: "ATV (X-Component)", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: false, step: 1.0 / 4.0, unit: "m/s" } } }),
        Part::Item(Item { name: "Y", title: "ATV (Y-Component)", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: false, step: 1.0 / 4.0, unit: "m/s" } } }),
    ] } }),
    Some(Item { name: "AA", title: "Estimated Accuracy Of Acceleration (Cartesian)", shape: Shape::Group { bits: 16, parts: &[
        Part::Item(Item { name: "X", title: "AA (X-Component)", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: false, step: 1.0 / 4.0, unit: "m/s²" } } }),
        Part::Item(Item { name: "Y", title: "AA (Y-Component)", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: false, step: 1.0 / 4.0, unit: "m/s²" } } }),
    ] } }),
    Some(Item { name: "ARC", title: "Estimated Accuracy Of Rate Of Climb/Descent", shape: Shape::Element { bits: 8, content: Content::Quantity { signed: false, step: 25.0 / 4.0, unit: "ft/min" } } }),
]) };

const I510: Item = Item { name: "510", title: "Composed Track Number", shape: Shape::Chained(&Shape::Group { bits: 23, parts: &[
    Part::Item(Item { name: "IDENT", title: "System Unit Identification", shape: Shape::Element { bits: 8, content: Content::Raw } }),
    Part::Item(Item { name: "TRACK", title: "System Track Number", shape: Shape::Element { bits: 15, content: Content::Raw } }),
] }) };

const IRE: Item = Item { name: "RE", title: "Reserved Expansion Field", shape: Shape::Explicit };

const ISP: Item = Item { name: "SP", title: "Special Purpose Field", shape: Shape::Explicit };
