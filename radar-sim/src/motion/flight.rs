//! A recorded flight, smoothly interpolated.

use std::fs::File;
use std::io::{ErrorKind, Read};

use common::truth::{CONSTANT_VELOCITY, HOVER, MANOEUVRE};
use nalgebra::Vector3;

use super::Kinematics;
use super::flight_time::FlightClock;

/// Mean radius of the earth, m: enough for a flight of a few kilometres.
const EARTH_M: f64 = 6_371_000.0;

/// Rows of a recorded flight in ENU, in time order.
#[derive(Debug, Clone)]
pub struct Flight {
    times_s: Vec<f64>,
    positions_m: Vec<Vector3<f64>>,
    velocities_mps: Vec<Vector3<f64>>,
    dropped: Dropped,
}

/// Rows that say nothing of the motion.
#[derive(Debug, Default, Clone, PartialEq, Eq)]
struct Dropped {
    /// Whose time is not after that of the row before.
    not_later: u32,
    /// Without a time or a place.
    empty: u32,
    /// Number of the first of them, counted from 1 with the header.
    first_row: usize,
}

impl Flight {
    /// Reads a CSV file with the columns `timestamp` or `time`, `latitude`, `longitude` (degrees)
    /// and `altitude (m)`, in any order among others, and puts its first row at `start_m`. Times are seconds, of the day
    /// or since any moment, or ISO 8601; a flight may pass midnight and the 180th meridian.
    ///
    /// # Errors
    /// A sentence that says what was expected.
    pub fn read(file: &str, start_m: Vector3<f64>) -> Result<Self, String> {
        Self::from_rows(open(file)?, start_m)
    }

    fn from_rows(rows: impl Read, start_m: Vector3<f64>) -> Result<Self, String> {
        let mut reader = csv::Reader::from_reader(rows);
        let headers = reader.headers().map_err(|error| error.to_string())?.clone();
        let column = |name: &str| headers.iter().position(|header| header.trim() == name);
        let expected = |name: &str| column(name).ok_or_else(|| format!("expected a column `{name}`"));
        let time_column = column("timestamp").map_or_else(|| expected("time"), Ok);
        let time_column = time_column.map_err(|_| "expected a column `timestamp` or `time`".to_string())?;
        let columns = [expected("latitude")?, expected("longitude")?, expected("altitude (m)")?];
        let mut clock = FlightClock::default();
        let mut dropped = Dropped::default();
        let mut times_s: Vec<f64> = Vec::new();
        let mut positions_m: Vec<Vector3<f64>> = Vec::new();
        let mut last_longitude = None;
        let mut origin = None;
        for (row, record) in (2..).zip(reader.records()) {
            let record = record.map_err(|error| error.to_string())?;
            let text = |column: usize| record.get(column).unwrap_or("").trim();
            let [latitude, longitude, height] = columns.map(text);
            if [text(time_column), latitude, longitude, height].contains(&"") {
                dropped.count(row, |dropped| &mut dropped.empty);
                continue;
            }
            let time_s = clock
                .read(text(time_column))
                .ok_or_else(|| format!("row {row}: `{}` is not a time (seconds or ISO 8601)", text(time_column)))?;
            let number = |text: &str, most: f64| {
                let number = text.parse::<f64>().ok().filter(|number| number.abs() <= most);
                number.ok_or_else(|| format!("row {row}: `{text}` is not a number from -{most} to {most}"))
            };
            let (latitude, longitude, height) =
                (number(latitude, 90.0)?, number(longitude, 360.0)?, number(height, 1e6)?);
            if times_s.last().is_some_and(|&last| time_s <= last) {
                dropped.count(row, |dropped| &mut dropped.not_later);
                continue;
            }
            // The shorter way round from the row before: longitudes jump at the 180th meridian.
            let longitude = last_longitude.map_or(longitude, |last: f64| last + shorter_way(longitude - last));
            last_longitude = Some(longitude);
            let (latitude0, longitude0, height0) = *origin.get_or_insert((latitude, longitude, height));
            let east = (longitude - longitude0).to_radians() * f64::cos(f64::to_radians(latitude0)) * EARTH_M;
            let north = (latitude - latitude0).to_radians() * EARTH_M;
            times_s.push(time_s);
            positions_m.push(start_m + Vector3::new(east, north, height - height0));
        }
        if times_s.len() < 2 {
            return Err("expected at least two rows with increasing times".into());
        }
        let first_s = times_s[0];
        for time in &mut times_s {
            *time -= first_s;
        }
        let velocities_mps = slopes(&times_s, &positions_m);
        Ok(Self { times_s, positions_m, velocities_mps, dropped })
    }

    /// What was left out of the file, in words.
    pub fn dropped(&self) -> Option<String> {
        let Dropped { not_later, empty, first_row } = self.dropped;
        let rows = not_later + empty + self.times_s.len() as u32;
        (not_later + empty > 0).then(|| {
            format!(
                "{} of {rows} rows dropped, the first is row {first_row}: {not_later} not later than the row before, \
                 {empty} without time or place",
                not_later + empty
            )
        })
    }

    /// State `time_s` after the first row: cubic Hermite interpolation between rows, at
    /// rest at the last position after the last one.
    pub fn at(&self, time_s: f64) -> Kinematics {
        let last = self.times_s.len() - 1;
        if time_s >= self.times_s[last] {
            let position_m = self.positions_m[last];
            let zero = Vector3::zeros();
            return Kinematics { position_m, velocity_mps: zero, acceleration_mps2: zero, mode: HOVER };
        }
        let index = self.times_s.partition_point(|&t| t <= time_s).saturating_sub(1);
        let step = self.times_s[index + 1] - self.times_s[index];
        let u = ((time_s - self.times_s[index]) / step).max(0.0);
        let (p0, p1) = (self.positions_m[index], self.positions_m[index + 1]);
        let (m0, m1) = (self.velocities_mps[index] * step, self.velocities_mps[index + 1] * step);
        // p(u) = p0 + m0 u + c u² + d u³ with the slopes m0, m1 at the ends.
        let c = (p1 - p0) * 3.0 - m0 * 2.0 - m1;
        let d = (p0 - p1) * 2.0 + m0 + m1;
        let acceleration_mps2 = (c * 2.0 + d * (6.0 * u)) / (step * step);
        let velocity_mps = (m0 + c * (2.0 * u) + d * (3.0 * u * u)) / step;
        let mode = match (acceleration_mps2.norm() > 1.0, velocity_mps.norm() > 1.5) {
            (true, _) => MANOEUVRE,
            (false, true) => CONSTANT_VELOCITY,
            (false, false) => HOVER,
        };
        Kinematics { position_m: p0 + m0 * u + c * (u * u) + d * (u * u * u), velocity_mps, acceleration_mps2, mode }
    }
}

impl Dropped {
    fn count(&mut self, row: usize, reason: impl Fn(&mut Self) -> &mut u32) {
        if self.not_later + self.empty == 0 {
            self.first_row = row;
        }
        *reason(self) += 1;
    }
}

/// Opens a file, and says where it was looked for.
fn open(file: &str) -> Result<File, String> {
    let opened = File::open(file).map_err(|error| match error.kind() {
        ErrorKind::NotFound => "No such file; its path is relative to the folder of the configuration file".to_string(),
        _ => error.to_string(),
    })?;
    let is_file = opened.metadata().is_ok_and(|metadata| metadata.is_file());
    if is_file { Ok(opened) } else { Err("it is not a regular file".into()) }
}

/// The same turn in (-180°, 180°].
fn shorter_way(degrees: f64) -> f64 {
    180.0 - (180.0 - degrees).rem_euclid(360.0)
}

/// Velocities at the rows from central differences.
fn slopes(times_s: &[f64], positions_m: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
    let last = times_s.len() - 1;
    (0..=last)
        .map(|row| {
            let (before, after) = (row.saturating_sub(1), (row + 1).min(last));
            (positions_m[after] - positions_m[before]) / (times_s[after] - times_s[before])
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flight(rows: &str) -> Result<Flight, String> {
        let text = format!("time,latitude,longitude,altitude (m)\n{rows}");
        Flight::from_rows(text.as_bytes(), Vector3::new(10.0, 20.0, 30.0))
    }

    /// One step of longitude at the equator, m.
    const STEP_M: f64 = 0.001 * std::f64::consts::PI / 180.0 * EARTH_M;

    #[test]
    fn a_flight_goes_on_over_midnight_and_the_180th_meridian() {
        for rows in [
            "86398,0,179.999,5\n86399,0,-180,5\n0,0,-179.999,5\n1,0,-179.998,5\n",
            "2024-05-05T23:59:58Z,0,179.999,5\n2024-05-05T23:59:59Z,0,180,5\n2024-05-06 00:00:00,0,180.001,5\n2024-05-06 00:00:01,0,-179.998,5\n",
        ] {
            let flight = flight(rows).expect("a flight");
            assert_eq!(flight.dropped(), None);
            for step in 0..4 {
                let expected = Vector3::new(10.0 + f64::from(step) * STEP_M, 20.0, 30.0);
                let at = flight.at(f64::from(step)).position_m;
                assert!((at - expected).norm() < 1e-6, "{step}: {at}");
            }
        }
    }

    #[test]
    fn dropped_rows_are_counted_and_said() {
        let flight = flight("0,0,0,5\n1,,0,5\n1,0,0.001,5\n1,0,0.001,5\n0.5,0,0,5\n2,0,0.002,5\n").expect("a flight");
        assert_eq!(
            flight.dropped().as_deref(),
            Some("3 of 6 rows dropped, the first is row 3: 2 not later than the row before, 1 without time or place")
        );
        assert!((flight.at(2.0).position_m.x - 10.0 - 2.0 * STEP_M).abs() < 1e-6);
    }

    #[test]
    fn what_is_no_flight_is_refused_with_its_row() {
        let error = |rows: &str| flight(rows).expect_err(rows);
        assert_eq!(error("0,0,0,5\nnoon,0,0,5\n"), "row 3: `noon` is not a time (seconds or ISO 8601)");
        assert_eq!(error("0,91,0,5\n"), "row 2: `91` is not a number from -90 to 90");
        assert_eq!(error("0,0,0,5\n"), "expected at least two rows with increasing times");
        let start = Vector3::zeros();
        assert_eq!(
            Flight::from_rows("a,b\n".as_bytes(), start).expect_err("no columns"),
            "expected a column `timestamp` or `time`"
        );
        assert!(
            Flight::read("no/such.csv", start)
                .expect_err("no file")
                .starts_with("No such file; its path is relative to")
        );
        assert_eq!(Flight::read("/dev/zero", start).expect_err("endless"), "it is not a regular file");
    }
}
