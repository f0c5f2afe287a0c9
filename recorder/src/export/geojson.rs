//! Ways of targets as GeoJSON (RFC 7946): a feature for each, longitude before latitude, heights above the ellipsoid.

use std::fs::File;
use std::io::{BufWriter, Write};

use common::recording::container::Description;
use common::recording::{RecordedRef, RecordingError};
use common::time::rfc3339;
use serde_json::{Value, json};

use super::Sink;
use super::paths::{Path, Paths, Point};

/// One collection of features.
pub(super) struct GeoJson {
    out: BufWriter<File>,
    paths: Paths,
}

impl GeoJson {
    pub(super) fn create(out: BufWriter<File>, description: Option<&Description>) -> Result<Self, RecordingError> {
        Ok(Self { out, paths: Paths::new(description)? })
    }
}

fn coordinates(point: &Point) -> Value {
    let mut coordinates = vec![point.place.longitude_deg, point.place.latitude_deg];
    coordinates.extend(point.has_height.then_some(point.place.height_m));
    json!(coordinates)
}

/// A line, or a point of a target that was seen once.
fn feature(id: u64, path: &Path) -> Value {
    let [first, .., last] = path.points[..] else {
        let point = &path.points[0];
        let properties = json!({ "name": path.name, "time": rfc3339(point.time_ns) });
        let geometry = json!({ "type": "Point", "coordinates": coordinates(point) });
        return json!({ "type": "Feature", "id": id, "properties": properties, "geometry": geometry });
    };
    let times: Vec<String> = path.points.iter().map(|point| rfc3339(point.time_ns)).collect();
    let line: Vec<Value> = path.points.iter().map(coordinates).collect();
    json!({
        "type": "Feature",
        "id": id,
        "properties": {
            "name": path.name,
            "from": rfc3339(first.time_ns),
            "to": rfc3339(last.time_ns),
            "coordTimes": times,
        },
        "geometry": { "type": "LineString", "coordinates": line },
    })
}

impl Sink for GeoJson {
    fn write(&mut self, message: RecordedRef<'_>) -> Result<u64, RecordingError> {
        Ok(self.paths.take(message))
    }

    fn finish(mut self: Box<Self>) -> Result<(), RecordingError> {
        self.out.write_all(b"{\"type\":\"FeatureCollection\",\"features\":[")?;
        for (index, (id, path)) in self.paths.iter().enumerate() {
            self.out.write_all(if index == 0 { b"\n" } else { b",\n" })?;
            serde_json::to_writer(&mut self.out, &feature(id, path)).map_err(std::io::Error::from)?;
        }
        self.out.write_all(b"\n]}\n")?;
        Ok(self.out.flush()?)
    }
}
