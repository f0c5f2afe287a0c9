//! Tracks as the test log of a counter-drone system (COURAGEOUS, CWA 18150), JSON of schema 0.4.0.
//!
//! A track with heights is said by bearing, elevation and distance from the system, which need no model of the sea level; others by latitude
//! and longitude. A track is a target of its own: what is lost and found again has two numbers. An alarm is active while a confirmed
//! track is reported, with the probability that there is a target.

use std::fs::File;
use std::io::{BufWriter, Write};

use common::angle::wrap;
use common::recording::container::Description;
use common::recording::{RecordedRef, RecordingError};
use serde_json::{Value, json};

use super::Sink;
use super::paths::{Paths, Point};

const SCHEMA: &str = "0.4.0";

/// One document.
pub(super) struct Courageous {
    out: BufWriter<File>,
    paths: Paths,
}

impl Courageous {
    pub(super) fn create(out: BufWriter<File>, description: Option<&Description>) -> Result<Self, RecordingError> {
        Ok(Self { out, paths: Paths::new(description)? })
    }
}

fn location(point: &Point) -> Value {
    let [east, north, up] = point.position_m;
    let ground_m = east.hypot(north);
    if point.has_height {
        json!({
            "$type": "BearingElevationDistance",
            "bearing": wrap(east.atan2(north)).to_degrees(),
            "elevation": up.atan2(ground_m).to_degrees(),
            "distance": ground_m.hypot(up),
        })
    } else {
        json!({ "$type": "Position2d", "lat": point.place.latitude_deg, "lon": point.place.longitude_deg })
    }
}

fn record(number: u64, point: &Point) -> Value {
    let [east, north, up] = point.velocity_mps;
    json!({
        "time": point.time_ns / 1_000_000,
        "record_number": number,
        "classification": "Unknown",
        "alarm": { "active": true, "certainty": point.existence.clamp(0.0, 1.0) },
        "location": location(point),
        "velocity": { "east": east, "north": north, "up": if point.has_height { up } else { 0.0 } },
    })
}

impl Sink for Courageous {
    fn write(&mut self, message: RecordedRef<'_>) -> Result<u64, RecordingError> {
        Ok(self.paths.take(message))
    }

    fn finish(mut self: Box<Self>) -> Result<(), RecordingError> {
        let radar = self.paths.radar;
        let mut number = 0;
        let mut tracks = Vec::new();
        for (uas, (_, path)) in self.paths.iter().enumerate() {
            let records: Vec<Value> = path
                .points
                .iter()
                .map(|point| {
                    number += 1;
                    record(number, point)
                })
                .collect();
            tracks.push(json!({ "uas_id": uas + 1, "name": path.name, "records": records }));
        }
        let document = json!({
            "version": SCHEMA,
            "vendor_name": "radar-chain",
            "system_name": self.paths.chain.site.name,
            "static_cuas_location": {
                "lat": radar.latitude_deg, "lon": radar.longitude_deg, "height_amsl": radar.height_m,
            },
            "detection": [],
            "tracks": tracks,
        });
        serde_json::to_writer(&mut self.out, &document).map_err(std::io::Error::from)?;
        self.out.write_all(b"\n")?;
        Ok(self.out.flush()?)
    }
}
