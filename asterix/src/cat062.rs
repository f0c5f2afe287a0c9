//! Category 062, edition 1.21: system tracks.

use std::f64::consts::TAU;

use crate::error::EncodeError;
use crate::field::Field;
use crate::record::Record;
use crate::report::{FT_M, NM_M, SourceId, TimeOfDay};
use crate::tables::CAT062_1_21;
use crate::writer::RecordWriter;

/// The category.
pub const CATEGORY: u8 = CAT062_1_21.category;

const SAC: Field = field!(CAT062_1_21, "010/SAC");
const SIC: Field = field!(CAT062_1_21, "010/SIC");
const SERVICE: Field = field!(CAT062_1_21, "015");
const TIME_OF_DAY: Field = field!(CAT062_1_21, "070");
const LATITUDE: Field = field!(CAT062_1_21, "105/LAT");
const LONGITUDE: Field = field!(CAT062_1_21, "105/LON");
const X: Field = field!(CAT062_1_21, "100/X");
const Y: Field = field!(CAT062_1_21, "100/Y");
const VX: Field = field!(CAT062_1_21, "185/VX");
const VY: Field = field!(CAT062_1_21, "185/VY");
const AX: Field = field!(CAT062_1_21, "210/AX");
const AY: Field = field!(CAT062_1_21, "210/AY");
const NUMBER: Field = field!(CAT062_1_21, "040");
const MONOSENSOR: Field = field!(CAT062_1_21, "080/MON");
const MOST_RELIABLE_HEIGHT: Field = field!(CAT062_1_21, "080/MRH");
const HEIGHT_SOURCE: Field = field!(CAT062_1_21, "080/SRC");
const TENTATIVE: Field = field!(CAT062_1_21, "080/CNF");
const SIMULATED: Field = field!(CAT062_1_21, "080/SIM");
const LAST: Field = field!(CAT062_1_21, "080/TSE");
const FIRST: Field = field!(CAT062_1_21, "080/TSB");
const COASTED: Field = field!(CAT062_1_21, "080/CST");
const COASTED_PRIMARY: Field = field!(CAT062_1_21, "080/PSR");
const COASTED_SECONDARY: Field = field!(CAT062_1_21, "080/SSR");
const COASTED_MODE_S: Field = field!(CAT062_1_21, "080/MDS");
const COASTED_ADS_B: Field = field!(CAT062_1_21, "080/ADS");
const TRACK_AGE: Field = field!(CAT062_1_21, "290/TRK");
const PRIMARY_AGE: Field = field!(CAT062_1_21, "290/PSR");
const TURN: Field = field!(CAT062_1_21, "200/TRANS");
const SPEED_CHANGE: Field = field!(CAT062_1_21, "200/LONG");
const CLIMB: Field = field!(CAT062_1_21, "200/VERT");
const HEIGHT: Field = field!(CAT062_1_21, "130");
const CLIMB_RATE: Field = field!(CAT062_1_21, "220");
const SIGMA_X: Field = field!(CAT062_1_21, "500/APC/X");
const SIGMA_Y: Field = field!(CAT062_1_21, "500/APC/Y");
const COVARIANCE: Field = field!(CAT062_1_21, "500/COV");
const SIGMA_HEIGHT: Field = field!(CAT062_1_21, "500/AGA");
const SIGMA_VX: Field = field!(CAT062_1_21, "500/ATV/X");
const SIGMA_VY: Field = field!(CAT062_1_21, "500/ATV/Y");
const SIGMA_AX: Field = field!(CAT062_1_21, "500/AA/X");
const SIGMA_AY: Field = field!(CAT062_1_21, "500/AA/Y");
const SIGMA_CLIMB_RATE: Field = field!(CAT062_1_21, "500/ARC");
const UNIT: Field = field!(CAT062_1_21, "510/IDENT");
const NUMBER_IN_UNIT: Field = field!(CAT062_1_21, "510/TRACK");
const PLOT_SAC: Field = field!(CAT062_1_21, "340/SID/SAC");
const PLOT_SIC: Field = field!(CAT062_1_21, "340/SID/SIC");
const PLOT_RANGE: Field = field!(CAT062_1_21, "340/POS/RHO");
const PLOT_AZIMUTH: Field = field!(CAT062_1_21, "340/POS/THETA");

/// [`HEIGHT_SOURCE`]: a 3-D radar.
const FROM_3D_RADAR: u64 = 2;

/// How a track moves across, along and up, as I062/200 says it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Movement {
    /// 0 constant course, 1 right turn, 2 left turn, 3 undetermined.
    pub turn: u8,
    /// 0 constant speed, 1 increasing, 2 decreasing, 3 undetermined.
    pub speed: u8,
    /// 0 level, 1 climb, 2 descent, 3 undetermined.
    pub climb: u8,
}

/// Standard errors of a track.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Accuracy {
    /// Position east and north, m.
    pub position_m: [f64; 2],
    /// Covariance of the position east and north, m².
    pub covariance_m2: f64,
    /// Height, m.
    pub height_m: Option<f64>,
    /// Velocity east and north, m/s.
    pub velocity_mps: [f64; 2],
    /// Acceleration east and north, m/s².
    pub acceleration_mps2: Option<[f64; 2]>,
    /// Rate of climb, m/s.
    pub climb_rate_mps: Option<f64>,
}

/// The number of a track in one of the units that have a part in it, I062/510.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
pub struct UnitTrack {
    /// The unit.
    pub unit: u8,
    /// Its number of the track, up to [`Self::LARGEST_NUMBER`].
    pub number: u16,
}

impl UnitTrack {
    /// Numbers have 15 bits.
    pub const LARGEST_NUMBER: u16 = 0x7fff;

    /// The number of the track `id`: its lower 15 bits.
    pub fn number_of(id: u64) -> u16 {
        id as u16 & Self::LARGEST_NUMBER
    }
}

/// A system track. What is absent is `None`. Of a value too large for its item the largest possible is written; a position
/// out of reach of its item is an error.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
#[expect(clippy::struct_excessive_bools, reason = "they are the bits of I062/080")]
pub struct SystemTrack {
    /// The system.
    pub source: SourceId,
    /// Service of the system.
    pub service: Option<u8>,
    /// Number of the track.
    pub number: u16,
    /// Time of the state.
    pub time_of_day: Option<TimeOfDay>,
    /// WGS-84 latitude and longitude, degrees.
    pub position_deg: Option<[f64; 2]>,
    /// Position east and north of the system's centre, m.
    pub position_m: Option<[f64; 2]>,
    /// Velocity east and north, m/s.
    pub velocity_mps: Option<[f64; 2]>,
    /// Acceleration east and north, m/s².
    pub acceleration_mps2: Option<[f64; 2]>,
    /// Height above the ellipsoid or the sea, m.
    pub height_m: Option<f64>,
    /// Rate of climb, m/s.
    pub climb_rate_mps: Option<f64>,
    /// Made from the plots of one sensor.
    pub monosensor: bool,
    /// Not confirmed yet.
    pub tentative: bool,
    /// Of a simulation.
    pub simulated: bool,
    /// The first message of the track.
    pub first: bool,
    /// The last message of the track.
    pub last: bool,
    /// Extrapolated: without a new plot in the last scan.
    pub coasted: bool,
    /// Time since the track began, s.
    pub track_age_s: Option<f64>,
    /// Time since the last primary plot, s.
    pub plot_age_s: Option<f64>,
    /// How it moves.
    pub movement: Option<Movement>,
    /// Standard errors.
    pub accuracy: Option<Accuracy>,
    /// Its composed number, of nine units at most: first the unit that is responsible for the track, with its own number of it (the
    /// master track), then those whose tracks it is made of, with theirs (the slave tracks).
    pub composed: [Option<UnitTrack>; 9],
    /// The last plot: radar, slant range, m, and azimuth, rad.
    pub plot: Option<(SourceId, f64, f64)>,
}

impl SystemTrack {
    /// Writes the track.
    ///
    /// # Errors
    /// [`EncodeError`]: a position that its item cannot hold.
    #[inline]
    pub fn write(&self, record: &mut RecordWriter<'_>) -> Result<(), EncodeError> {
        record.put_raw(&SAC, self.source.sac.into())?;
        record.put_raw(&SIC, self.source.sic.into())?;
        if let Some(service) = self.service {
            record.put_raw(&SERVICE, service.into())?;
        }
        if let Some(time) = self.time_of_day {
            record.put_raw(&TIME_OF_DAY, time.steps.into())?;
        }
        if let Some([latitude_deg, longitude_deg]) = self.position_deg {
            record.put(&LATITUDE, latitude_deg)?;
            record.put(&LONGITUDE, longitude_deg)?;
        }
        if let Some([x_m, y_m]) = self.position_m {
            record.put(&X, x_m)?;
            record.put(&Y, y_m)?;
        }
        if let Some([x_mps, y_mps]) = self.velocity_mps {
            record.put_nearest(&VX, x_mps)?;
            record.put_nearest(&VY, y_mps)?;
        }
        if let Some([x_mps2, y_mps2]) = self.acceleration_mps2 {
            record.put_nearest(&AX, x_mps2)?;
            record.put_nearest(&AY, y_mps2)?;
        }
        record.put_raw(&NUMBER, self.number.into())?;
        self.write_status(record)?;
        if let Some(age_s) = self.track_age_s {
            record.put_nearest(&TRACK_AGE, age_s)?;
        }
        if let Some(age_s) = self.plot_age_s {
            record.put_nearest(&PRIMARY_AGE, age_s)?;
        }
        if let Some(movement) = self.movement {
            record.put_raw(&TURN, movement.turn.into())?;
            record.put_raw(&SPEED_CHANGE, movement.speed.into())?;
            record.put_raw(&CLIMB, movement.climb.into())?;
        }
        if let Some(height_m) = self.height_m {
            record.put_nearest(&HEIGHT, height_m / FT_M)?;
        }
        if let Some(rate_mps) = self.climb_rate_mps {
            record.put_nearest(&CLIMB_RATE, rate_mps / FT_M * 60.0)?;
        }
        for of_unit in self.composed.iter().flatten() {
            record.begin_link(&UNIT)?;
            record.put_raw(&UNIT, of_unit.unit.into())?;
            record.put_raw(&NUMBER_IN_UNIT, of_unit.number.into())?;
        }
        if let Some(accuracy) = &self.accuracy {
            accuracy.write(record)?;
        }
        if let Some((source, range_m, azimuth_rad)) = self.plot {
            record.put_raw(&PLOT_SAC, source.sac.into())?;
            record.put_raw(&PLOT_SIC, source.sic.into())?;
            record.put_nearest(&PLOT_RANGE, range_m / NM_M)?;
            record.put_angle(&PLOT_AZIMUTH, azimuth_rad / TAU * 360.0)?;
        }
        Ok(())
    }

    /// I062/080, as many octets as needed.
    #[inline]
    fn write_status(&self, record: &mut RecordWriter<'_>) -> Result<(), EncodeError> {
        record.put_raw(&MONOSENSOR, self.monosensor.into())?;
        record.put_raw(&MOST_RELIABLE_HEIGHT, self.height_m.is_some().into())?;
        record.put_raw(&HEIGHT_SOURCE, if self.height_m.is_some() { FROM_3D_RADAR } else { 0 })?;
        record.put_raw(&TENTATIVE, self.tentative.into())?;
        if self.simulated || self.first || self.last || self.coasted {
            record.put_raw(&SIMULATED, self.simulated.into())?;
            record.put_raw(&LAST, self.last.into())?;
            record.put_raw(&FIRST, self.first.into())?;
        }
        if self.coasted {
            // The system has none of the other kinds of sensor: their reports are old, too.
            for kind in [&COASTED, &COASTED_PRIMARY, &COASTED_SECONDARY, &COASTED_MODE_S, &COASTED_ADS_B] {
                record.put_raw(kind, 1)?;
            }
        }
        Ok(())
    }

    /// The track of a record.
    pub fn read(record: &Record<'_>) -> Self {
        let pair = |x: &Field, y: &Field| x.value(record).zip(y.value(record)).map(|(x, y)| [x, y]);
        let is_set = |field: &Field| field.is_set(record) == Some(true);
        Self {
            source: SourceId::read(record, &SAC, &SIC).unwrap_or_default(),
            service: SERVICE.raw(record).map(|service| service as u8),
            number: NUMBER.raw(record).unwrap_or(0) as u16,
            time_of_day: TimeOfDay::read(record, &TIME_OF_DAY),
            position_deg: pair(&LATITUDE, &LONGITUDE),
            position_m: pair(&X, &Y),
            velocity_mps: pair(&VX, &VY),
            acceleration_mps2: pair(&AX, &AY),
            height_m: HEIGHT.value(record).map(|height_ft| height_ft * FT_M),
            climb_rate_mps: CLIMB_RATE.value(record).map(|ft_per_min| ft_per_min * FT_M / 60.0),
            monosensor: is_set(&MONOSENSOR),
            tentative: is_set(&TENTATIVE),
            simulated: is_set(&SIMULATED),
            first: is_set(&FIRST),
            last: is_set(&LAST),
            coasted: is_set(&COASTED),
            track_age_s: TRACK_AGE.value(record),
            plot_age_s: PRIMARY_AGE.value(record),
            movement: TURN.raw(record).map(|turn| Movement {
                turn: turn as u8,
                speed: SPEED_CHANGE.raw(record).unwrap_or(0) as u8,
                climb: CLIMB.raw(record).unwrap_or(0) as u8,
            }),
            accuracy: pair(&SIGMA_X, &SIGMA_Y).map(|position_m| Accuracy {
                position_m,
                covariance_m2: COVARIANCE.value(record).map_or(0.0, |root_m| root_m * root_m.abs()),
                height_m: SIGMA_HEIGHT.value(record).map(|height_ft| height_ft * FT_M),
                velocity_mps: pair(&SIGMA_VX, &SIGMA_VY).unwrap_or_default(),
                acceleration_mps2: pair(&SIGMA_AX, &SIGMA_AY),
                climb_rate_mps: SIGMA_CLIMB_RATE.value(record).map(|ft_per_min| ft_per_min * FT_M / 60.0),
            }),
            composed: std::array::from_fn(|link| {
                let (unit, number) = UNIT.raw_of(record, link).zip(NUMBER_IN_UNIT.raw_of(record, link))?;
                Some(UnitTrack { unit: unit as u8, number: number as u16 })
            }),
            plot: SourceId::read(record, &PLOT_SAC, &PLOT_SIC).and_then(|source| {
                let (range_nm, azimuth_deg) = PLOT_RANGE.value(record).zip(PLOT_AZIMUTH.value(record))?;
                Some((source, range_nm * NM_M, azimuth_deg.to_radians()))
            }),
        }
    }
}

impl Accuracy {
    /// I062/500. The covariance is sent as the root of its size, with its sign; no standard error as 0 that is not.
    #[inline]
    fn write(&self, record: &mut RecordWriter<'_>) -> Result<(), EncodeError> {
        put_sigma(record, &SIGMA_X, self.position_m[0])?;
        put_sigma(record, &SIGMA_Y, self.position_m[1])?;
        record.put_nearest(&COVARIANCE, self.covariance_m2.abs().sqrt().copysign(self.covariance_m2))?;
        if let Some(height_m) = self.height_m {
            put_sigma(record, &SIGMA_HEIGHT, height_m / FT_M)?;
        }
        put_sigma(record, &SIGMA_VX, self.velocity_mps[0])?;
        put_sigma(record, &SIGMA_VY, self.velocity_mps[1])?;
        if let Some([x_mps2, y_mps2]) = self.acceleration_mps2 {
            put_sigma(record, &SIGMA_AX, x_mps2)?;
            put_sigma(record, &SIGMA_AY, y_mps2)?;
        }
        if let Some(rate_mps) = self.climb_rate_mps {
            put_sigma(record, &SIGMA_CLIMB_RATE, rate_mps / FT_M * 60.0)?;
        }
        Ok(())
    }
}

/// A standard error, in whole steps from one on.
#[expect(clippy::inline_always, reason = "a constant field folds only into its caller")]
#[inline(always)]
fn put_sigma(record: &mut RecordWriter<'_>, field: &Field, sigma: f64) -> Result<(), EncodeError> {
    record.put_nearest(field, if sigma > 0.0 { sigma.max(field.step) } else { sigma })
}
