//! Category 048, edition 1.32: target reports of a radar.

use std::f64::consts::TAU;

use crate::error::EncodeError;
use crate::field::Field;
use crate::record::Record;
use crate::report::{
    Artificial, FL_M, FT_M, NM_M, SourceId, TargetReport, TimeOfDay, callsign, callsign_bits, radians,
};
use crate::tables::CAT048_1_32;
use crate::writer::RecordWriter;

/// The category.
pub const CATEGORY: u8 = CAT048_1_32.category;

const SAC: Field = field!(CAT048_1_32, "010/SAC");
const SIC: Field = field!(CAT048_1_32, "010/SIC");
const TIME_OF_DAY: Field = field!(CAT048_1_32, "140");
const DETECTION: Field = field!(CAT048_1_32, "020/TYP");
const SIMULATED: Field = field!(CAT048_1_32, "020/SIM");
const MONITOR: Field = field!(CAT048_1_32, "020/RAB");
const TEST: Field = field!(CAT048_1_32, "020/TST");
const RANGE: Field = field!(CAT048_1_32, "040/RHO");
const AZIMUTH: Field = field!(CAT048_1_32, "040/THETA");
const MODE_3A: Field = field!(CAT048_1_32, "070/MODE3A");
const FLIGHT_LEVEL: Field = field!(CAT048_1_32, "090/FL");
const AMPLITUDE: Field = field!(CAT048_1_32, "130/PAM");
const ADDRESS: Field = field!(CAT048_1_32, "220");
const CALLSIGN: Field = field!(CAT048_1_32, "240");
const TRACK_NUMBER: Field = field!(CAT048_1_32, "161/TRN");
const X: Field = field!(CAT048_1_32, "042/X");
const Y: Field = field!(CAT048_1_32, "042/Y");
const SPEED: Field = field!(CAT048_1_32, "200/GSP");
const HEADING: Field = field!(CAT048_1_32, "200/HDG");
const TENTATIVE: Field = field!(CAT048_1_32, "170/CNF");
const LAST_REPORT: Field = field!(CAT048_1_32, "170/TRE");
const HEIGHT: Field = field!(CAT048_1_32, "110/3DH");
const DOUBTFUL: Field = field!(CAT048_1_32, "120/CAL/D");
const RADIAL_VELOCITY: Field = field!(CAT048_1_32, "120/CAL/CAL");

/// Values of [`DETECTION`].
const NO_DETECTION: u64 = 0;
const PRIMARY: u64 = 1;
const SECONDARY: u64 = 2;
const COMBINED: u64 = 3;
/// From here on Mode S, with a primary plot in [`MODE_S_PRIMARY`] and above.
const MODE_S: u64 = 4;
const MODE_S_PRIMARY: u64 = 6;

/// A target report. A radial velocity that the radar calls doubtful is left out.
#[inline]
pub fn target_report(record: &Record<'_>) -> TargetReport {
    let kind = DETECTION.raw(record);
    let detection = kind.unwrap_or(NO_DETECTION);
    TargetReport {
        source: SourceId::read(record, &SAC, &SIC),
        time_of_day: TimeOfDay::read(record, &TIME_OF_DAY),
        primary: matches!(detection, PRIMARY | COMBINED | MODE_S_PRIMARY..),
        secondary: matches!(detection, SECONDARY | COMBINED | MODE_S..),
        extrapolated: kind == Some(NO_DETECTION),
        artificial: Artificial {
            simulated: SIMULATED.is_set(record) == Some(true),
            test: TEST.is_set(record) == Some(true),
            monitor: MONITOR.is_set(record) == Some(true),
        },
        polar: RANGE.value(record).zip(AZIMUTH.value(record)).map(|(nm, deg)| (nm * NM_M, radians(deg))),
        cartesian_m: X.value(record).zip(Y.value(record)).map(|(x, y)| (x * NM_M, y * NM_M)),
        pressure_height_m: FLIGHT_LEVEL.value(record).map(|level| level * FL_M),
        height_m: HEIGHT.value(record).map(|height_ft| height_ft * FT_M),
        radial_velocity_mps: match DOUBTFUL.is_set(record) {
            Some(false) => RADIAL_VELOCITY.value(record),
            _ => None,
        },
        amplitude_db: AMPLITUDE.value(record),
        mode_3a: MODE_3A.raw(record).map(|code| code as u16),
        address: ADDRESS.raw(record).map(|address| address as u32),
        callsign: CALLSIGN.raw(record).map(callsign),
        track_number: TRACK_NUMBER.raw(record).map(|number| number as u16),
        tentative: TENTATIVE.is_set(record),
        last_report: LAST_REPORT.is_set(record),
        velocity_mps: SPEED.value(record).zip(HEADING.value(record)).map(|(nm_per_s, deg)| {
            let (east, north) = radians(deg).sin_cos();
            (nm_per_s * NM_M * east, nm_per_s * NM_M * north)
        }),
        ..TargetReport::default()
    }
}

/// Writes a plot: source, time, kind, position, codes, heights, amplitude and radial velocity; nothing of a track.
///
/// # Errors
/// [`EncodeError`]: a value that its item cannot hold.
pub fn write(report: &TargetReport, record: &mut RecordWriter<'_>) -> Result<(), EncodeError> {
    if let Some(source) = report.source {
        record.put_raw(&SAC, source.sac.into())?;
        record.put_raw(&SIC, source.sic.into())?;
    }
    if let Some(time) = report.time_of_day {
        record.put_raw(&TIME_OF_DAY, time.steps.into())?;
    }
    let detection = match (report.primary, report.secondary) {
        (false, false) => NO_DETECTION,
        (true, false) => PRIMARY,
        (false, true) => SECONDARY,
        (true, true) => COMBINED,
    };
    record.put_raw(&DETECTION, detection)?;
    record.put_raw(&SIMULATED, report.artificial.simulated.into())?;
    record.put_raw(&MONITOR, report.artificial.monitor.into())?;
    if report.artificial.test {
        record.put_raw(&TEST, 1)?;
    }
    if let Some((range_m, azimuth_rad)) = report.polar {
        record.put(&RANGE, range_m / NM_M)?;
        record.put_angle(&AZIMUTH, azimuth_rad / TAU * 360.0)?;
    }
    if let Some(code) = report.mode_3a {
        record.put_raw(&MODE_3A, code.into())?;
    }
    if let Some(height_m) = report.pressure_height_m {
        record.put(&FLIGHT_LEVEL, height_m / FL_M)?;
    }
    if let Some(amplitude_db) = report.amplitude_db {
        record.put_nearest(&AMPLITUDE, amplitude_db)?;
    }
    if let Some(address) = report.address {
        record.put_raw(&ADDRESS, address.into())?;
    }
    if let Some(callsign) = report.callsign {
        record.put_raw(&CALLSIGN, callsign_bits(callsign))?;
    }
    if let Some(height_m) = report.height_m {
        record.put_nearest(&HEIGHT, height_m / FT_M)?;
    }
    if let Some(velocity_mps) = report.radial_velocity_mps {
        record.put_nearest(&RADIAL_VELOCITY, velocity_mps)?;
    }
    Ok(())
}
