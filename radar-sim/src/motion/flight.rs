//! A recorded flight, smoothly interpolated.

use common::truth::{CONSTANT_VELOCITY, HOVER, MANOEUVRE};
use nalgebra::Vector3;

use super::Kinematics;

/// Mean radius of the earth, m: enough for a flight of a few kilometres.
const EARTH_M: f64 = 6_371_000.0;

/// Rows of a recorded flight in ENU, in time order.
#[derive(Debug, Clone)]
pub struct Flight {
    times_s: Vec<f64>,
    positions_m: Vec<Vector3<f64>>,
    velocities_mps: Vec<Vector3<f64>>,
}

impl Flight {
    /// Reads a CSV file with the columns `timestamp` (s), `latitude`, `longitude` (degrees)
    /// and `altitude (m)`, in any order among others, and puts its first row at `start_m`.
    ///
    /// # Errors
    /// A sentence that says what was expected.
    pub fn read(file: &str, start_m: Vector3<f64>) -> Result<Self, String> {
        let mut reader = csv::Reader::from_path(file).map_err(|error| error.to_string())?;
        let headers = reader.headers().map_err(|error| error.to_string())?.clone();
        let column = |name: &str| {
            let found = headers.iter().position(|header| header.trim() == name);
            found.ok_or_else(|| format!("expected a column `{name}`"))
        };
        let columns = [column("timestamp")?, column("latitude")?, column("longitude")?, column("altitude (m)")?];
        let mut times_s: Vec<f64> = Vec::new();
        let mut positions_m = Vec::new();
        let mut origin = None;
        for (row, record) in reader.records().enumerate() {
            let record = record.map_err(|error| error.to_string())?;
            let value = |column: usize| {
                let text = record.get(column).unwrap_or("");
                let number = text.trim().parse::<f64>().ok().filter(|number| number.is_finite());
                number.ok_or_else(|| format!("row {}: `{text}` is not a finite number", row + 2))
            };
            let [time, latitude, longitude, height] =
                [value(columns[0])?, value(columns[1])?, value(columns[2])?, value(columns[3])?];
            if times_s.last().is_some_and(|&last| time <= last) {
                continue; // repeated rows carry no motion
            }
            let (latitude0, longitude0, height0) = *origin.get_or_insert((latitude, longitude, height));
            let east = (longitude - longitude0).to_radians() * latitude0.to_radians().cos() * EARTH_M;
            let north = (latitude - latitude0).to_radians() * EARTH_M;
            times_s.push(time);
            positions_m.push(start_m + Vector3::new(east, north, height - height0));
        }
        if times_s.len() < 2 {
            return Err("expected at least two rows with increasing timestamps".into());
        }
        let first_s = times_s[0];
        for time in &mut times_s {
            *time -= first_s;
        }
        let velocities_mps = slopes(&times_s, &positions_m);
        Ok(Self { times_s, positions_m, velocities_mps })
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
