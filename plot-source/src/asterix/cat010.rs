//! Category 010, edition 1.1: monosensor surface movement data.
//!
//! Every item of the profile has its length here, so that any record can be read past;
//! decoded is what plots and truth need.

use std::f64::consts::TAU;

use common::health::Reject;

/// The category.
pub const CATEGORY: u8 = 10;

/// What a record says (I010/000).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MessageType {
    /// A target.
    TargetReport,
    /// The antenna passes north, or a new update cycle begins.
    StartOfUpdateCycle,
    /// State of the sensor, sent regularly.
    PeriodicStatus,
    /// State of the sensor, sent because it changed.
    EventStatus,
}

/// Kind of target (TOT of I010/020).
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
pub enum TargetKind {
    /// The sensor cannot tell.
    #[default]
    Undetermined,
    /// An aircraft.
    Aircraft,
    /// A vehicle on the ground.
    GroundVehicle,
    /// A helicopter.
    Helicopter,
}

/// Target report descriptor (I010/020).
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
pub struct Descriptor {
    /// Type of the sensor: 1 Mode S multilateration, 3 primary radar, and others.
    pub sensor_type: u8,
    /// The transponder says that it is on the ground.
    pub on_ground: bool,
    /// A simulated or test target.
    pub test: bool,
    /// A fixed monitor of the sensor, not a target.
    pub fixed_monitor: bool,
    /// Kind of target.
    pub kind: TargetKind,
}

/// Track status (I010/170), as far as scoring a radar's own tracker needs it.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
pub struct TrackStatus {
    /// The track is still in its initialisation phase.
    pub initialising: bool,
    /// The last report of the track.
    pub last_report: bool,
}

/// One record. An item that is absent is `None`.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
pub struct Record {
    /// I010/000.
    pub message_type: Option<MessageType>,
    /// I010/010: SAC in the high byte, SIC in the low byte.
    pub source_id: Option<u16>,
    /// I010/020.
    pub descriptor: Option<Descriptor>,
    /// I010/140: time of day, 1/128 s since midnight UTC.
    pub time_of_day: Option<u32>,
    /// I010/040: range in m and azimuth in rad, as the sensor measured them.
    pub polar: Option<(f64, f64)>,
    /// I010/042: x and y, m.
    pub cartesian_m: Option<(f64, f64)>,
    /// I010/202: velocity along x and y in steps, whose size sensors disagree about.
    pub velocity_steps: Option<(i16, i16)>,
    /// I010/161: number that the sensor's own tracker gave.
    pub track_number: Option<u16>,
    /// I010/170.
    pub track_status: Option<TrackStatus>,
    /// I010/220: 24-bit address.
    pub address: Option<u32>,
    /// I010/245: eight characters.
    pub callsign: Option<[u8; 8]>,
    /// I010/090: quarter flight levels.
    pub flight_level_quarters: Option<i16>,
}

/// How an item tells its length.
#[derive(Debug, Clone, Copy)]
enum Length {
    /// Always this many bytes.
    Fixed(usize),
    /// Bytes up to the first one whose lowest bit is 0.
    Extended,
    /// A count, then that many elements of this many bytes.
    Repetitive(usize),
    /// A byte that counts itself and what follows.
    Explicit,
    /// Not defined by the edition.
    Undefined,
}

/// The user application profile: item number and length by position in the FSPEC.
const PROFILE: [(u16, Length); 28] = [
    (10, Length::Fixed(2)),
    (0, Length::Fixed(1)),
    (20, Length::Extended),
    (140, Length::Fixed(3)),
    (41, Length::Fixed(8)),
    (40, Length::Fixed(4)),
    (42, Length::Fixed(4)),
    (200, Length::Fixed(4)),
    (202, Length::Fixed(4)),
    (161, Length::Fixed(2)),
    (170, Length::Extended),
    (60, Length::Fixed(2)),
    (220, Length::Fixed(3)),
    (245, Length::Fixed(7)),
    (250, Length::Repetitive(8)),
    (300, Length::Fixed(1)),
    (90, Length::Fixed(2)),
    (91, Length::Fixed(2)),
    (270, Length::Extended),
    (550, Length::Fixed(1)),
    (310, Length::Fixed(1)),
    (500, Length::Fixed(4)),
    (280, Length::Repetitive(2)),
    (131, Length::Fixed(1)),
    (210, Length::Fixed(2)),
    (UNDEFINED, Length::Undefined),
    (SPECIAL_PURPOSE, Length::Explicit),
    (RESERVED_EXPANSION, Length::Explicit),
];

/// Numbers of the positions in [`PROFILE`] that have no item number.
const UNDEFINED: u16 = 1000;
const SPECIAL_PURPOSE: u16 = 1001;
const RESERVED_EXPANSION: u16 = 1002;

/// The records of one block, one after the other; ends after the first that cannot be read,
/// because the next one cannot be found.
#[derive(Debug, Clone)]
pub struct Records<'a> {
    rest: &'a [u8],
    failed: bool,
}

impl<'a> Records<'a> {
    /// The records in the payload of a block.
    pub fn new(records: &'a [u8]) -> Self {
        Self { rest: records, failed: false }
    }

    /// Bytes from the next record on, or from the one that cannot be read.
    pub fn left(&self) -> usize {
        self.rest.len()
    }
}

impl Iterator for Records<'_> {
    type Item = Result<Record, Reject>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.failed || self.rest.is_empty() {
            return None;
        }
        let mut cursor = Cursor(self.rest);
        let record = decode(&mut cursor);
        self.failed = record.is_err();
        if !self.failed {
            self.rest = cursor.0;
        }
        Some(record)
    }
}

/// What is left to read of a block.
struct Cursor<'a>(&'a [u8]);

impl<'a> Cursor<'a> {
    fn take(&mut self, length: usize) -> Result<&'a [u8], Reject> {
        let (taken, rest) = self.0.split_at_checked(length).ok_or(Reject::TruncatedRecord)?;
        self.0 = rest;
        Ok(taken)
    }

    fn byte(&self, index: usize) -> Result<u8, Reject> {
        self.0.get(index).copied().ok_or(Reject::TruncatedRecord)
    }

    /// Bytes up to and with the first one whose lowest bit is 0.
    fn extended(&mut self) -> Result<&'a [u8], Reject> {
        let more = self.0.iter().position(|byte| byte & 1 == 0).ok_or(Reject::TruncatedRecord)?;
        self.take(more + 1)
    }

    fn item(&mut self, length: Length) -> Result<&'a [u8], Reject> {
        match length {
            Length::Fixed(bytes) => self.take(bytes),
            Length::Extended => self.extended(),
            Length::Repetitive(bytes) => self.take(1 + usize::from(self.byte(0)?) * bytes),
            Length::Explicit => match self.byte(0)? {
                0 => Err(Reject::BadHeader), // it counts itself: less than 1 is impossible
                length => self.take(usize::from(length)),
            },
            Length::Undefined => Err(Reject::UnknownItem),
        }
    }
}

fn decode(cursor: &mut Cursor<'_>) -> Result<Record, Reject> {
    let fspec = cursor.extended()?;
    let mut record = Record::default();
    for (byte, bits) in fspec.iter().enumerate() {
        for bit in 0..7 {
            if bits & (0x80 >> bit) != 0 {
                let (number, length) = *PROFILE.get(byte * 7 + bit).ok_or(Reject::UnknownItem)?;
                record.set(number, cursor.item(length)?);
            }
        }
    }
    Ok(record)
}

impl Record {
    /// Takes over one item; lengths have been checked against [`PROFILE`].
    fn set(&mut self, number: u16, item: &[u8]) {
        match (number, item) {
            (0, &[kind]) => self.message_type = message_type(kind),
            (10, &[sac, sic]) => self.source_id = Some(u16::from_be_bytes([sac, sic])),
            (20, octets) => self.descriptor = Some(descriptor(octets)),
            (140, &[a, b, c]) => self.time_of_day = Some(u32::from_be_bytes([0, a, b, c])),
            (40, &[a, b, c, d]) => {
                let azimuth = f64::from(u16::from_be_bytes([c, d])) / 65_536.0 * TAU;
                self.polar = Some((f64::from(u16::from_be_bytes([a, b])), azimuth));
            }
            (42, &[a, b, c, d]) => {
                self.cartesian_m = Some((i16::from_be_bytes([a, b]).into(), i16::from_be_bytes([c, d]).into()));
            }
            (202, &[a, b, c, d]) => {
                self.velocity_steps = Some((i16::from_be_bytes([a, b]), i16::from_be_bytes([c, d])));
            }
            (161, &[a, b]) => self.track_number = Some(u16::from_be_bytes([a, b]) & 0x0fff),
            (170, &[first, ..]) => {
                self.track_status =
                    Some(TrackStatus { initialising: first & 0x80 != 0, last_report: first & 0x40 != 0 });
            }
            (220, &[a, b, c]) => self.address = Some(u32::from_be_bytes([0, a, b, c])),
            (245, &[_, a, b, c, d, e, f]) => self.callsign = Some(callsign([a, b, c, d, e, f])),
            // 14 bits, two's complement, below validity and garble.
            (90, &[a, b]) => self.flight_level_quarters = Some((i16::from_be_bytes([a, b]) << 2) >> 2),
            _ => {} // read past
        }
    }
}

fn message_type(kind: u8) -> Option<MessageType> {
    match kind {
        1 => Some(MessageType::TargetReport),
        2 => Some(MessageType::StartOfUpdateCycle),
        3 => Some(MessageType::PeriodicStatus),
        4 => Some(MessageType::EventStatus),
        _ => None,
    }
}

fn descriptor(octets: &[u8]) -> Descriptor {
    let octet = |index: usize| octets.get(index).copied().unwrap_or(0);
    Descriptor {
        sensor_type: octet(0) >> 5,
        on_ground: octet(0) & 0x04 != 0,
        test: octet(1) & 0xc0 != 0,
        fixed_monitor: octet(1) & 0x20 != 0,
        kind: match octet(1) >> 1 & 0x03 {
            1 => TargetKind::Aircraft,
            2 => TargetKind::GroundVehicle,
            3 => TargetKind::Helicopter,
            _ => TargetKind::Undetermined,
        },
    }
}

/// Eight characters of six bits: the low six bits of ASCII, where letters have lost their 64.
fn callsign(packed: [u8; 6]) -> [u8; 8] {
    let bits = packed.iter().fold(0_u64, |bits, &byte| bits << 8 | u64::from(byte));
    std::array::from_fn(|index| {
        let code = (bits >> (42 - 6 * index) & 0x3f) as u8;
        if (1..=26).contains(&code) { code + 64 } else { code.max(b' ') }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A start-of-cycle record of the Barcelona radar.
    const START_OF_CYCLE: [u8; 7] = [0xd0, 0x00, 0x07, 0x02, 0x38, 0x41, 0x43];

    #[test]
    fn a_start_of_cycle_message_is_read() {
        let records: Vec<_> = Records::new(&START_OF_CYCLE).collect();
        let record = records[0].expect("a good record");
        assert_eq!(record.message_type, Some(MessageType::StartOfUpdateCycle));
        assert_eq!((record.source_id, record.time_of_day), (Some(7), Some(0x0038_4143)));
        assert_eq!(records.len(), 1);
    }

    /// All items of the profile but the undefined one: the record ends exactly where its last item does.
    #[test]
    fn every_item_can_be_read_past() {
        let mut bytes = vec![0xff, 0xff, 0xff, 0b1111_0110];
        for (_, length) in PROFILE {
            match length {
                Length::Fixed(size) => bytes.extend(std::iter::repeat_n(0x01, size)),
                Length::Extended => bytes.extend([0x01, 0x01, 0x02]),
                Length::Repetitive(size) => {
                    bytes.push(3);
                    bytes.extend(std::iter::repeat_n(0xff, 3 * size));
                }
                Length::Explicit => bytes.extend([4, 9, 9, 9]),
                Length::Undefined => {}
            }
        }
        let count = bytes.len();
        bytes.extend(START_OF_CYCLE);
        let records: Vec<_> = Records::new(&bytes).collect();
        assert!(records.len() == 2 && records.iter().all(Result::is_ok), "{records:?}");
        let cut: Vec<_> = Records::new(&bytes[..count - 1]).collect();
        assert_eq!(cut, [Err(Reject::TruncatedRecord)]);
    }

    #[test]
    fn what_the_edition_does_not_define_is_rejected() {
        let spare: Vec<_> = Records::new(&[0x01, 0x01, 0x01, 0x08, 0x00]).collect();
        assert_eq!(spare, [Err(Reject::UnknownItem)]);
        let fifth_byte: Vec<_> = Records::new(&[0x01, 0x01, 0x01, 0x01, 0x80, 0x00]).collect();
        assert_eq!(fifth_byte, [Err(Reject::UnknownItem)]);
    }

    #[test]
    fn negative_flight_levels_and_callsigns_are_decoded() {
        let mut record = Record::default();
        record.set(90, &[0x3f, 0xfc]);
        assert_eq!(record.flight_level_quarters, Some(-4));
        record.set(90, &[0x00, 0x18]);
        assert_eq!(record.flight_level_quarters, Some(24));
        // V=22 L=12 G=7 2=50 7=55 3=51 T=20 space=32
        record.set(245, &[0, 0x58, 0xc1, 0xf2, 0xdf, 0x35, 0x20]);
        assert_eq!(record.callsign.as_ref().map(|text| &text[..]), Some(&b"VLG273T "[..]));
    }

    proptest! {
        #[test]
        fn no_bytes_make_it_panic(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
            for record in Records::new(&bytes) {
                let _ = record;
            }
        }
    }
}
