//! Category 034, edition 1.29: service messages of a radar.

use std::f64::consts::TAU;

use crate::error::EncodeError;
use crate::field::Field;
use crate::record::Record;
use crate::report::{Service, ServiceMessage, SourceId, TimeOfDay, radians};
use crate::tables::CAT034_1_29;
use crate::writer::RecordWriter;

/// The category.
pub const CATEGORY: u8 = CAT034_1_29.category;

const SAC: Field = field!(CAT034_1_29, "010/SAC");
const SIC: Field = field!(CAT034_1_29, "010/SIC");
const MESSAGE_TYPE: Field = field!(CAT034_1_29, "000");
const TIME_OF_DAY: Field = field!(CAT034_1_29, "030");
const SECTOR: Field = field!(CAT034_1_29, "020");
const TURN: Field = field!(CAT034_1_29, "041");

const NORTH: u64 = 1;
const SECTOR_CROSSING: u64 = 2;
const JAMMING_STROBE: u64 = 4;

pub(crate) fn service_message(record: &Record<'_>) -> ServiceMessage {
    ServiceMessage {
        source: SourceId::read(record, &SAC, &SIC),
        service: match MESSAGE_TYPE.raw(record) {
            Some(NORTH) => Service::North,
            Some(SECTOR_CROSSING) => Service::Sector,
            Some(JAMMING_STROBE) => Service::Jamming,
            _ => Service::Other,
        },
        time_of_day: TimeOfDay::read(record, &TIME_OF_DAY),
        azimuth_rad: SECTOR.value(record).map(radians),
        turn_s: TURN.value(record),
    }
}

/// Writes a north marker or a sector crossing.
///
/// # Errors
/// [`EncodeError`]: another kind of message, or a value that its item cannot hold.
pub fn write(message: &ServiceMessage, record: &mut RecordWriter<'_>) -> Result<(), EncodeError> {
    let kind = match message.service {
        Service::North => NORTH,
        Service::Sector => SECTOR_CROSSING,
        _ => return Err(EncodeError::Shape { item: MESSAGE_TYPE.item }),
    };
    if let Some(source) = message.source {
        record.put_raw(&SAC, source.sac.into())?;
        record.put_raw(&SIC, source.sic.into())?;
    }
    record.put_raw(&MESSAGE_TYPE, kind)?;
    if let Some(time) = message.time_of_day {
        record.put_raw(&TIME_OF_DAY, time.steps.into())?;
    }
    if let Some(azimuth_rad) = message.azimuth_rad {
        record.put_angle(&SECTOR, azimuth_rad / TAU * 360.0)?;
    }
    if let Some(turn_s) = message.turn_s {
        record.put(&TURN, turn_s)?;
    }
    Ok(())
}
