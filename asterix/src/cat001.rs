//! Category 001, edition 1.4: monoradar target reports of older radars.

use crate::field::Field;
use crate::record::Record;
use crate::report::{Artificial, FL_M, NM_M, SourceId, TargetReport, TimeOfDay, radians};
use crate::tables::CAT001_1_4;

/// The category.
pub const CATEGORY: u8 = CAT001_1_4.category;

/// Steps after which the truncated time of day begins at 0 again.
const PERIOD: u32 = 1 << 16;

/// Where the elements lie in one of the two profiles.
struct Fields {
    time_of_day: Field,
    range: Field,
    azimuth: Field,
    height: Field,
    amplitude: Field,
    radial_velocity: Field,
    mode_3a: Field,
}

impl Fields {
    const fn of<const PROFILE: usize>() -> Self {
        Self {
            time_of_day: field!(CAT001_1_4, PROFILE, "141"),
            range: field!(CAT001_1_4, PROFILE, "040/RHO"),
            azimuth: field!(CAT001_1_4, PROFILE, "040/THETA"),
            height: field!(CAT001_1_4, PROFILE, "090/HGT"),
            amplitude: field!(CAT001_1_4, PROFILE, "131"),
            radial_velocity: field!(CAT001_1_4, PROFILE, "120"),
            mode_3a: field!(CAT001_1_4, PROFILE, "070/MODE3A"),
        }
    }
}

const PLOT: Fields = Fields::of::<0>();
const TRACK: Fields = Fields::of::<1>();

const SAC: Field = field!(CAT001_1_4, "010/SAC");
const SIC: Field = field!(CAT001_1_4, "010/SIC");
const IS_TRACK: Field = field!(CAT001_1_4, "020/TYP");
const SIMULATED: Field = field!(CAT001_1_4, "020/SIM");
const DETECTION: Field = field!(CAT001_1_4, "020/SSRPSR");
const MONITOR: Field = field!(CAT001_1_4, "020/RAB");
const TEST: Field = field!(CAT001_1_4, "020/TST");
const TRACK_NUMBER: Field = field!(CAT001_1_4, 1, "161");
const TRACK_X: Field = field!(CAT001_1_4, 1, "042/X");
const TRACK_Y: Field = field!(CAT001_1_4, 1, "042/Y");

/// A target report; of a track without range and azimuth, those of its position.
pub(crate) fn target_report(record: &Record<'_>) -> TargetReport {
    let is_track = IS_TRACK.is_set(record) == Some(true);
    let fields = if is_track { &TRACK } else { &PLOT };
    let kind = DETECTION.raw(record);
    let detection = kind.unwrap_or(0);
    TargetReport {
        source: SourceId::read(record, &SAC, &SIC),
        time_of_day: fields.time_of_day.raw(record).map(|raw| TimeOfDay { steps: raw as u32, period: PERIOD }),
        primary: detection & 1 != 0,
        secondary: detection & 2 != 0,
        extrapolated: kind == Some(0),
        artificial: Artificial {
            simulated: SIMULATED.is_set(record) == Some(true),
            test: TEST.is_set(record) == Some(true),
            monitor: MONITOR.is_set(record) == Some(true),
        },
        polar: fields.range.value(record).zip(fields.azimuth.value(record)).map(|(nm, deg)| (nm * NM_M, radians(deg))),
        cartesian_m: if is_track {
            TRACK_X.value(record).zip(TRACK_Y.value(record)).map(|(x, y)| (x * NM_M, y * NM_M))
        } else {
            None
        },
        pressure_height_m: fields.height.value(record).map(|level| level * FL_M),
        radial_velocity_mps: fields.radial_velocity.value(record).map(|nm_per_s| nm_per_s * NM_M),
        amplitude_db: fields.amplitude.value(record),
        mode_3a: fields.mode_3a.raw(record).map(|code| code as u16),
        track_number: if is_track { TRACK_NUMBER.raw(record).map(|number| number as u16) } else { None },
        ..TargetReport::default()
    }
}
