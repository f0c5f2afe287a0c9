//! What one radar says: target reports and service messages of all its categories, in SI units.

use std::f64::consts::TAU;
use std::fmt;

use crate::field::Field;
use crate::record::Record;
use crate::{cat001, cat002, cat010, cat034, cat048};

/// Metres in a nautical mile.
pub(crate) const NM_M: f64 = 1852.0;
/// Metres in a foot.
pub(crate) const FT_M: f64 = 0.3048;
/// Metres in a flight level, of the standard atmosphere.
pub(crate) const FL_M: f64 = 100.0 * FT_M;

/// Degrees to rad. A whole number of binary fractions of a turn keeps its exact share of 2π.
#[inline]
pub(crate) fn radians(degrees: f64) -> f64 {
    degrees / 360.0 * TAU
}

/// SAC and SIC of a sensor or system.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct SourceId {
    /// System area code.
    pub sac: u8,
    /// System identification code.
    pub sic: u8,
}

impl fmt::Display for SourceId {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "SAC {} SIC {}", self.sac, self.sic)
    }
}

impl SourceId {
    /// SAC in the high byte, SIC in the low one.
    pub fn number(self) -> u16 {
        u16::from_be_bytes([self.sac, self.sic])
    }

    #[inline]
    pub(crate) fn read(record: &Record<'_>, sac: &Field, sic: &Field) -> Option<Self> {
        Some(Self { sac: sac.raw(record)? as u8, sic: sic.raw(record)? as u8 })
    }
}

/// A time of day, in steps of 1/128 s.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TimeOfDay {
    /// Steps since midnight UTC.
    pub steps: u32,
    /// Steps after which it begins at 0 again: those of a day, or fewer where only the lower bits are sent.
    pub period: u32,
}

impl TimeOfDay {
    /// Steps of a second.
    pub const STEPS_PER_S: u32 = 128;
    /// Steps of a day.
    pub const DAY: u32 = 86_400 * Self::STEPS_PER_S;

    #[inline]
    pub(crate) fn read(record: &Record<'_>, field: &Field) -> Option<Self> {
        field.raw(record).map(|raw| Self { steps: raw as u32, period: Self::DAY })
    }
}

/// Kind of target, where the sensor can tell.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
pub enum TargetKind {
    /// It cannot.
    #[default]
    Undetermined,
    /// An aircraft.
    Aircraft,
    /// A vehicle on the ground.
    GroundVehicle,
    /// A helicopter.
    Helicopter,
}

/// Why a report may not be of a target that is there.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
pub struct Artificial {
    /// SIM: a simulated target.
    pub simulated: bool,
    /// TST: a test target.
    pub test: bool,
    /// RAB: a fixed monitor of the sensor.
    pub monitor: bool,
}

/// A target report of category 001, 010 or 048. What is absent is `None`.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
#[expect(clippy::struct_excessive_bools, reason = "they are bits of the target report descriptor")]
pub struct TargetReport {
    /// The radar.
    pub source: Option<SourceId>,
    /// When the target was detected.
    pub time_of_day: Option<TimeOfDay>,
    /// Whether it was seen by a primary radar in this scan.
    pub primary: bool,
    /// Whether it was seen by a secondary radar, Mode S or multilateration in this scan.
    pub secondary: bool,
    /// Whether it says that it was not seen: the position is the one that the radar's own tracker expects.
    pub extrapolated: bool,
    /// Why it may not be there.
    pub artificial: Artificial,
    /// Whether the transponder says that it is on the ground.
    pub on_ground: bool,
    /// Kind of target.
    pub kind: TargetKind,
    /// Slant range, m, and azimuth, rad, clockwise from north, as measured.
    pub polar: Option<(f64, f64)>,
    /// Position east and north by the radar's own tracker, m; category 010: as measured.
    pub cartesian_m: Option<(f64, f64)>,
    /// Height by the pressure of the standard atmosphere, m.
    pub pressure_height_m: Option<f64>,
    /// Height measured by a 3-D radar, m.
    pub height_m: Option<f64>,
    /// Range rate, m/s; positive when receding.
    pub radial_velocity_mps: Option<f64>,
    /// Amplitude of the primary plot, dB relative to a reference of the radar.
    pub amplitude_db: Option<f64>,
    /// Mode 3/A code, twelve bits.
    pub mode_3a: Option<u16>,
    /// 24-bit address of the transponder.
    pub address: Option<u32>,
    /// Eight characters of ASCII.
    pub callsign: Option<[u8; 8]>,
    /// Number that the radar's own tracker gave.
    pub track_number: Option<u16>,
    /// That the radar's own tracker has not confirmed the track yet.
    pub tentative: Option<bool>,
    /// That this is the last report of the track.
    pub last_report: Option<bool>,
    /// Velocity east and north by the radar's own tracker, m/s.
    pub velocity_mps: Option<(f64, f64)>,
}

/// What a service message says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Service {
    /// The antenna passes north, or a new update cycle begins.
    North,
    /// The antenna has reached the azimuth at which a sector begins.
    Sector,
    /// The antenna passes south.
    South,
    /// A jamming strobe.
    Jamming,
    /// Anything else: state of the sensor, filters.
    Other,
}

/// A service message of category 002, 010 or 034. What is absent is `None`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ServiceMessage {
    /// The radar.
    pub source: Option<SourceId>,
    /// What it says.
    pub service: Service,
    /// When it was sent.
    pub time_of_day: Option<TimeOfDay>,
    /// Azimuth at which the sector begins, rad.
    pub azimuth_rad: Option<f64>,
    /// Time of one turn of the antenna, s.
    pub turn_s: Option<f64>,
}

/// What one radar says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Message {
    /// Of a target.
    Target(TargetReport),
    /// Of the radar.
    Service(ServiceMessage),
}

impl Message {
    /// What a record of category 001, 002, 010, 034 or 048 says; `None` of another category.
    #[inline]
    pub fn of(record: &Record<'_>) -> Option<Self> {
        match record.edition.category {
            cat001::CATEGORY => Some(Self::Target(cat001::target_report(record))),
            cat002::CATEGORY => Some(Self::Service(cat002::service_message(record))),
            cat010::CATEGORY => Some(cat010::message(record)),
            cat034::CATEGORY => Some(Self::Service(cat034::service_message(record))),
            cat048::CATEGORY => Some(Self::Target(cat048::target_report(record))),
            _ => None,
        }
    }

    /// When.
    pub fn time_of_day(&self) -> Option<TimeOfDay> {
        match self {
            Self::Target(report) => report.time_of_day,
            Self::Service(message) => message.time_of_day,
        }
    }

    /// The radar.
    pub fn source(&self) -> Option<SourceId> {
        match self {
            Self::Target(report) => report.source,
            Self::Service(message) => message.source,
        }
    }
}

/// Eight characters of six bits each.
pub(crate) fn callsign(bits: u64) -> [u8; 8] {
    std::array::from_fn(|index| {
        // The low six bits of ASCII, where letters have lost their 64.
        let code = (bits >> (42 - 6 * index)) as u8 & 0x3f;
        if (1..=26).contains(&code) { code + b'@' } else { code.max(b' ') }
    })
}

/// The bits of eight characters; what has none is a space.
pub(crate) fn callsign_bits(callsign: [u8; 8]) -> u64 {
    callsign.into_iter().fold(0, |bits, character| {
        let code = match character {
            b'A'..=b'Z' => character - b'@',
            b'0'..=b'9' => character,
            _ => b' ',
        };
        bits << 6 | u64::from(code)
    })
}
