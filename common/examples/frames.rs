//! Places through every change of frame, a JSON line for a JSON line: for `tests/judges/geodesy.py`, which asks PROJ for the same.

use std::error::Error;
use std::io::{BufRead, Write, stdin, stdout};

use common::geodesy::{DatumShift, Ellipsoid, FrameChange, LocalFrame, Position};
use nalgebra::Vector3;
use serde::Deserialize;

/// Degrees, degrees, m.
type Place = [f64; 3];

#[derive(Deserialize)]
struct Question {
    place: Place,
    /// Two sites.
    sites: [Place; 2],
    shift_m: [f64; 3],
    rotation_arcsec: [f64; 3],
    scale_ppm: f64,
}

fn position([latitude_deg, longitude_deg, height_m]: Place) -> Position {
    Position { latitude_deg, longitude_deg, height_m }
}

fn main() -> Result<(), Box<dyn Error>> {
    for line in stdin().lock().lines() {
        let Question { place, sites, shift_m, rotation_arcsec, scale_ppm } = serde_json::from_str(&line?)?;
        let (place, sites) = (position(place), sites.map(position));
        let [wgs84, krasovsky] = [Ellipsoid::WGS84, Ellipsoid::KRASOVSKY].map(|of| of.ecef_m(&place));
        let back = |ellipsoid: Ellipsoid, ecef_m: &Vector3<f64>| {
            let Position { latitude_deg, longitude_deg, height_m } = ellipsoid.position(ecef_m);
            [latitude_deg, longitude_deg, height_m]
        };
        let of_first = FrameChange::new(&place, &sites[0]).position_m([0.0; 3]);
        let seen = LocalFrame::new(&sites[0]).place(of_first);
        let answer = serde_json::json!({
            "wgs84": wgs84.as_slice(),
            "krasovsky": krasovsky.as_slice(),
            "shifted": DatumShift { shift_m, rotation_arcsec, scale_ppm }.apply(&krasovsky).as_slice(),
            "of_first": of_first,
            "of_second": FrameChange::new(&sites[0], &sites[1]).position_m(of_first),
            "back_wgs84": back(Ellipsoid::WGS84, &wgs84),
            "back_krasovsky": back(Ellipsoid::KRASOVSKY, &krasovsky),
            "back_first": [seen.latitude_deg, seen.longitude_deg, seen.height_m],
        });
        writeln!(stdout(), "{answer}")?;
    }
    Ok(())
}
