//! Category 010, edition 1.1: monosensor surface movement data.

use crate::field::Field;
use crate::record::Record;
use crate::report::{
    Artificial, FL_M, FT_M, Message, Service, ServiceMessage, SourceId, TargetKind, TargetReport, TimeOfDay, callsign,
    radians,
};
use crate::tables::CAT010_1_1;

/// The category.
pub const CATEGORY: u8 = CAT010_1_1.category;

/// What the lowest bit of the velocity is worth by the specification, m/s; sensors disagree about it.
pub const VELOCITY_STEP_MPS: f64 = VX.step;

const SAC: Field = field!(CAT010_1_1, "010/SAC");
const SIC: Field = field!(CAT010_1_1, "010/SIC");
const MESSAGE_TYPE: Field = field!(CAT010_1_1, "000");
const SENSOR: Field = field!(CAT010_1_1, "020/TYP");
const ON_GROUND: Field = field!(CAT010_1_1, "020/GBS");
const SIMULATED: Field = field!(CAT010_1_1, "020/SIM");
const TEST: Field = field!(CAT010_1_1, "020/TST");
const MONITOR: Field = field!(CAT010_1_1, "020/RAB");
const KIND: Field = field!(CAT010_1_1, "020/TOT");
const TIME_OF_DAY: Field = field!(CAT010_1_1, "140");
const RANGE: Field = field!(CAT010_1_1, "040/RHO");
const AZIMUTH: Field = field!(CAT010_1_1, "040/TH");
const X: Field = field!(CAT010_1_1, "042/X");
const Y: Field = field!(CAT010_1_1, "042/Y");
const VX: Field = field!(CAT010_1_1, "202/VX");
const VY: Field = field!(CAT010_1_1, "202/VY");
const TRACK_NUMBER: Field = field!(CAT010_1_1, "161/TRK");
const TENTATIVE: Field = field!(CAT010_1_1, "170/CNF");
const LAST_REPORT: Field = field!(CAT010_1_1, "170/TRE");
const MODE_3A: Field = field!(CAT010_1_1, "060/MODE3A");
const ADDRESS: Field = field!(CAT010_1_1, "220");
const CALLSIGN: Field = field!(CAT010_1_1, "245/CHR");
const FLIGHT_LEVEL: Field = field!(CAT010_1_1, "090/FL");
const HEIGHT: Field = field!(CAT010_1_1, "091");
const AMPLITUDE: Field = field!(CAT010_1_1, "131");

/// Type of sensor: a primary radar.
const PRIMARY: u64 = 3;

pub(crate) fn message(record: &Record<'_>) -> Message {
    let (source, time_of_day) = (SourceId::read(record, &SAC, &SIC), TimeOfDay::read(record, &TIME_OF_DAY));
    let service = match MESSAGE_TYPE.raw(record) {
        Some(1) => return Message::Target(target_report(record, source, time_of_day)),
        Some(2) => Service::North,
        _ => Service::Other,
    };
    Message::Service(ServiceMessage { source, service, time_of_day, azimuth_rad: None, turn_s: None })
}

fn target_report(record: &Record<'_>, source: Option<SourceId>, time_of_day: Option<TimeOfDay>) -> TargetReport {
    let sensor = SENSOR.raw(record);
    TargetReport {
        source,
        time_of_day,
        primary: sensor == Some(PRIMARY),
        secondary: sensor.is_some_and(|sensor| sensor != PRIMARY),
        extrapolated: false,
        artificial: Artificial {
            simulated: SIMULATED.is_set(record) == Some(true),
            test: TEST.is_set(record) == Some(true),
            monitor: MONITOR.is_set(record) == Some(true),
        },
        on_ground: ON_GROUND.is_set(record) == Some(true),
        kind: match KIND.raw(record) {
            Some(1) => TargetKind::Aircraft,
            Some(2) => TargetKind::GroundVehicle,
            Some(3) => TargetKind::Helicopter,
            _ => TargetKind::Undetermined,
        },
        polar: RANGE.value(record).zip(AZIMUTH.value(record)).map(|(range_m, deg)| (range_m, radians(deg))),
        cartesian_m: X.value(record).zip(Y.value(record)),
        pressure_height_m: FLIGHT_LEVEL.value(record).map(|level| level * FL_M),
        height_m: HEIGHT.value(record).map(|height_ft| height_ft * FT_M),
        radial_velocity_mps: None,
        amplitude_db: AMPLITUDE.value(record),
        mode_3a: MODE_3A.raw(record).map(|code| code as u16),
        address: ADDRESS.raw(record).map(|address| address as u32),
        callsign: CALLSIGN.raw(record).map(callsign),
        track_number: TRACK_NUMBER.raw(record).map(|number| number as u16),
        tentative: TENTATIVE.is_set(record),
        last_report: LAST_REPORT.is_set(record),
        velocity_mps: VX.value(record).zip(VY.value(record)),
    }
}
