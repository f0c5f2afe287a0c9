//! Category 002, edition 1.2: service messages of older radars.

use crate::field::Field;
use crate::record::Record;
use crate::report::{Service, ServiceMessage, SourceId, TimeOfDay, radians};
use crate::tables::CAT002_1_2;

/// The category.
pub const CATEGORY: u8 = CAT002_1_2.category;

const SAC: Field = field!(CAT002_1_2, "010/SAC");
const SIC: Field = field!(CAT002_1_2, "010/SIC");
const MESSAGE_TYPE: Field = field!(CAT002_1_2, "000");
const SECTOR: Field = field!(CAT002_1_2, "020");
const TIME_OF_DAY: Field = field!(CAT002_1_2, "030");
const TURN: Field = field!(CAT002_1_2, "041");

pub(crate) fn service_message(record: &Record<'_>) -> ServiceMessage {
    ServiceMessage {
        source: SourceId::read(record, &SAC, &SIC),
        service: match MESSAGE_TYPE.raw(record) {
            Some(1) => Service::North,
            Some(2) => Service::Sector,
            Some(3) => Service::South,
            _ => Service::Other,
        },
        time_of_day: TimeOfDay::read(record, &TIME_OF_DAY),
        azimuth_rad: SECTOR.value(record).map(radians),
        turn_s: TURN.value(record),
    }
}
