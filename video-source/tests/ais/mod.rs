//! Ships by their own reports: AIS position reports in NMEA sentences, and the position of the receiver.

use std::collections::BTreeMap;

use asterix::recording::Recording;

/// Port of NMEA sentences.
const NMEA: u16 = 10110;
const MPS_PER_KNOT: f64 = 1852.0 / 3600.0;
/// m to a degree of latitude: close enough within 25 km.
const M_PER_DEG: f64 = 111_320.0;
/// Speed over ground that stands for not known, steps of 0.1 knots.
const NO_SPEED: u64 = 1023;

/// What a ship says of itself.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Report {
    pub(crate) time_ns: u64,
    latitude_deg: f64,
    longitude_deg: f64,
    pub(crate) speed_mps: f64,
    course_rad: f64,
}

/// Ships by their number, each with its last report.
#[derive(Debug, Default)]
pub(crate) struct Traffic {
    pub(crate) ships: BTreeMap<u64, Report>,
    /// Latitude and longitude of the receiver, degrees.
    pub(crate) own_deg: Option<(f64, f64)>,
}

impl Traffic {
    pub(crate) fn read(bytes: &[u8]) -> Self {
        let mut traffic = Self::default();
        for datagram in &Recording::whole(bytes).datagrams {
            if datagram.destination.is_some_and(|to| to.port() == NMEA) {
                let sentence = String::from_utf8_lossy(&datagram.bytes);
                let words: Vec<&str> = sentence.trim().split(',').collect();
                match words[..] {
                    ["!AIVDM", "1", _, _, _, payload, ..] => {
                        traffic.hear(payload, datagram.time_ns.expect("a capture"));
                    }
                    ["$CHGLL", latitude, "N", longitude, "E", ..] => {
                        traffic.own_deg = Some((degrees(latitude), degrees(longitude)));
                    }
                    _ => {}
                }
            }
        }
        traffic
    }

    /// East and north of the receiver at `time_ns`, m, going on as last reported.
    pub(crate) fn position_m(&self, ship: &Report, time_ns: u64) -> [f64; 2] {
        let (latitude, longitude) = self.own_deg.expect("an own position");
        let later_s = (time_ns as f64 - ship.time_ns as f64) / 1e9;
        let (sin, cos) = ship.course_rad.sin_cos();
        [
            (ship.longitude_deg - longitude) * M_PER_DEG * latitude.to_radians().cos() + later_s * ship.speed_mps * sin,
            (ship.latitude_deg - latitude) * M_PER_DEG + later_s * ship.speed_mps * cos,
        ]
    }

    /// A position report of class A (types 1 to 3) or B (type 18).
    fn hear(&mut self, payload: &str, time_ns: u64) {
        let bits: Vec<u8> = payload
            .bytes()
            .map(|letter| letter - 48)
            .map(|value| if value > 40 { value - 8 } else { value })
            .flat_map(|value| (0..6).rev().map(move |bit| value >> bit & 1))
            .collect();
        let number = |from: usize, to: usize| bits[from..to].iter().fold(0_u64, |sum, &bit| sum << 1 | u64::from(bit));
        let signed = |from: usize, to: usize| {
            let value = number(from, to).cast_signed();
            if bits[from] == 1 { value - (1 << (to - from)) } else { value }
        };
        let (speed, longitude, latitude, course) = match number(0, 6) {
            1..=3 => (number(50, 60), signed(61, 89), signed(89, 116), number(116, 128)),
            18 => (number(46, 56), signed(57, 85), signed(85, 112), number(112, 124)),
            _ => return,
        };
        if speed == NO_SPEED {
            return;
        }
        let report = Report {
            time_ns,
            latitude_deg: latitude as f64 / 600_000.0,
            longitude_deg: longitude as f64 / 600_000.0,
            speed_mps: speed as f64 / 10.0 * MPS_PER_KNOT,
            course_rad: (course as f64 / 10.0).to_radians(),
        };
        self.ships.insert(number(8, 38), report);
    }
}

/// Degrees of a text of degrees and, in the two digits before its point and all after it, minutes.
fn degrees(text: &str) -> f64 {
    let number = |text: &str| text.parse::<f64>().expect("a number");
    let point = text.find('.').expect("minutes with decimals") - 2;
    number(&text[..point]) + number(&text[point..]) / 60.0
}
