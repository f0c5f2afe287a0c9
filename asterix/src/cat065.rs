//! Category 065, edition 1.6: service status of a system that sends tracks.

use crate::error::EncodeError;
use crate::field::Field;
use crate::record::Record;
use crate::report::{SourceId, TimeOfDay};
use crate::tables::CAT065_1_6;
use crate::writer::RecordWriter;

/// The category.
pub const CATEGORY: u8 = CAT065_1_6.category;

const SAC: Field = field!(CAT065_1_6, "010/SAC");
const SIC: Field = field!(CAT065_1_6, "010/SIC");
const MESSAGE_TYPE: Field = field!(CAT065_1_6, "000");
const SERVICE: Field = field!(CAT065_1_6, "015");
const TIME: Field = field!(CAT065_1_6, "030");
const STATE: Field = field!(CAT065_1_6, "040/NOGO");
const OVERLOAD: Field = field!(CAT065_1_6, "040/OVL");

const SYSTEM_STATUS: u64 = 1;

/// Whether the system can be used.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
pub enum Operation {
    /// Operational.
    #[default]
    Operational,
    /// Degraded.
    Degraded,
    /// Not connected.
    NotConnected,
    /// Unknown.
    Unknown,
}

/// A status message of the system.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
pub struct SystemStatus {
    /// The system.
    pub source: SourceId,
    /// Service of the system.
    pub service: Option<u8>,
    /// When it was sent.
    pub time_of_day: Option<TimeOfDay>,
    /// Whether it can be used.
    pub operation: Operation,
    /// It cannot keep up.
    pub overload: bool,
}

impl SystemStatus {
    /// Writes the message.
    ///
    /// # Errors
    /// [`EncodeError`]: a time that is none.
    pub fn write(&self, record: &mut RecordWriter<'_>) -> Result<(), EncodeError> {
        record.put_raw(&SAC, self.source.sac.into())?;
        record.put_raw(&SIC, self.source.sic.into())?;
        record.put_raw(&MESSAGE_TYPE, SYSTEM_STATUS)?;
        if let Some(service) = self.service {
            record.put_raw(&SERVICE, service.into())?;
        }
        if let Some(time) = self.time_of_day {
            record.put_raw(&TIME, time.steps.into())?;
        }
        record.put_raw(&STATE, self.operation as u64)?;
        record.put_raw(&OVERLOAD, self.overload.into())
    }

    /// The message of a record; `None` of another kind.
    pub fn read(record: &Record<'_>) -> Option<Self> {
        (MESSAGE_TYPE.raw(record) == Some(SYSTEM_STATUS)).then(|| Self {
            source: SourceId::read(record, &SAC, &SIC).unwrap_or_default(),
            service: SERVICE.raw(record).map(|service| service as u8),
            time_of_day: TimeOfDay::read(record, &TIME),
            operation: match STATE.raw(record) {
                Some(0) => Operation::Operational,
                Some(1) => Operation::Degraded,
                Some(2) => Operation::NotConnected,
                _ => Operation::Unknown,
            },
            overload: OVERLOAD.is_set(record) == Some(true),
        })
    }
}
