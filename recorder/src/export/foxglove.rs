//! Confirmed tracks in the messages that viewers draw by themselves: `foxglove.SceneUpdate` in three dimensions, and where the radar has
//! a place `foxglove.GeoJSON` and `foxglove.LocationFix` on a map.
//!
//! ```text
//! /tracks/scene   at every message of tracks: a sphere of one standard error, the way of the next five seconds, the number
//! /tracks/map     at the end of every scan: all tracks as points
//! /site           once: the radar
//! ```

use std::collections::BTreeMap;

use common::geodesy::{LocalFrame, Position};
use common::message::END_OF_SCAN;
use common::recording::container::Description;
use common::tracks::{TERMINATED, Track, TracksHeader, pack, state_name};
use serde_json::{Value, json};

use super::places::configuration;

/// The names of the messages, and what is in them.
pub(super) const SCENE: &str = "foxglove.SceneUpdate";
pub(super) const MAP: &str = "foxglove.GeoJSON";
pub(super) const SITE: &str = "foxglove.LocationFix";
/// A track without news disappears after this, s.
const LIFETIME_S: u64 = 30;
/// Length of the line ahead of a track, s of its movement.
const AHEAD_S: f64 = 5.0;
/// A sphere is not smaller, m: it could not be seen.
const SMALLEST_M: f64 = 10.0;

/// What a viewer draws, from the messages of tracks.
#[derive(Debug)]
pub(super) struct Viewer {
    frame_id: String,
    radar: Option<(Position, LocalFrame)>,
    has_told_site: bool,
    features: BTreeMap<u64, Value>,
}

/// JSON Schema of a message of this name: the fields that are sent. Viewers know the names.
pub(super) fn schema(name: &str) -> Value {
    let (integer, number, text, truth) = (kind("integer"), kind("number"), kind("string"), kind("boolean"));
    let time = object(&json!({ "sec": integer, "nsec": integer }));
    let properties = match name {
        SCENE => {
            let point = object(&json!({ "x": number, "y": number, "z": number }));
            let color = object(&json!({ "r": number, "g": number, "b": number, "a": number }));
            let turn = object(&json!({ "x": number, "y": number, "z": number, "w": number }));
            let pose = object(&json!({ "position": point, "orientation": turn }));
            json!({
                "deletions": list(&object(&json!({ "timestamp": time, "type": integer, "id": text }))),
                "entities": list(&object(&json!({
                    "timestamp": time,
                    "frame_id": text,
                    "id": text,
                    "lifetime": time,
                    "frame_locked": truth,
                    "metadata": list(&object(&json!({ "key": text, "value": text }))),
                    "spheres": list(&object(&json!({ "pose": pose, "size": point, "color": color }))),
                    "lines": list(&object(&json!({
                        "type": integer,
                        "pose": pose,
                        "thickness": number,
                        "scale_invariant": truth,
                        "points": list(&point),
                        "color": color,
                        "colors": list(&color),
                        "indices": list(&integer),
                    }))),
                    "texts": list(&object(&json!({
                        "pose": pose,
                        "billboard": truth,
                        "font_size": number,
                        "scale_invariant": truth,
                        "color": color,
                        "text": text,
                    }))),
                }))),
            })
        }
        MAP => json!({ "geojson": text }),
        _ => json!({
            "timestamp": time,
            "frame_id": text,
            "latitude": number,
            "longitude": number,
            "altitude": number,
            "position_covariance": list(&number),
            "position_covariance_type": integer,
        }),
    };
    json!({ "title": name, "type": "object", "properties": properties })
}

fn kind(name: &str) -> Value {
    json!({ "type": name })
}

fn object(properties: &Value) -> Value {
    json!({ "type": "object", "properties": properties })
}

fn list(items: &Value) -> Value {
    json!({ "type": "array", "items": items })
}

fn time(time_ns: u64) -> Value {
    json!({ "sec": time_ns / 1_000_000_000, "nsec": time_ns % 1_000_000_000 })
}

fn point([x, y, z]: [f64; 3]) -> Value {
    json!({ "x": x, "y": y, "z": z })
}

fn color(track: &Track) -> Value {
    let [r, g, b] = if track.misses == 0 { [0.2, 0.9, 0.4] } else { [0.9, 0.7, 0.2] };
    json!({ "r": r, "g": g, "b": b, "a": 0.6 })
}

impl Viewer {
    /// Of a recording that says `description` of itself.
    pub(super) fn new(description: Option<&Description>) -> Self {
        let chain = configuration(description).unwrap_or_default();
        Self {
            radar: chain.site.position.map(|position| (position, LocalFrame::new(&position))),
            frame_id: chain.site.name,
            has_told_site: false,
            features: BTreeMap::new(),
        }
    }

    /// The names of the messages that it has, with the channels they go to.
    pub(super) fn channels(&self) -> Vec<(&'static str, &'static str)> {
        let mut channels = vec![(SCENE, "/tracks/scene")];
        if self.radar.is_some() {
            channels.extend([(MAP, "/tracks/map"), (SITE, "/site")]);
        }
        channels
    }

    /// What is drawn after a message of tracks.
    pub(super) fn draw(&mut self, header: &TracksHeader, tracks: &[Track]) -> Vec<(&'static str, Value)> {
        let mut messages = Vec::new();
        let finite = |track: &&Track| track.state.iter().all(|value| value.is_finite());
        let ended = tracks.iter().filter(|track| track.state_code == TERMINATED);
        let deletions: Vec<Value> = ended
            .map(|track| {
                self.features.remove(&track.id);
                json!({ "timestamp": time(track.time_ns), "type": 0, "id": entity_id(track) })
            })
            .collect();
        let confirmed = || tracks.iter().filter(|track| track.is_confirmed()).filter(finite);
        let entities: Vec<Value> = confirmed().map(|track| self.entity(track)).collect();
        if !deletions.is_empty() || !entities.is_empty() {
            messages.push((SCENE, json!({ "deletions": deletions, "entities": entities })));
        }
        let Some((radar, frame)) = self.radar else { return messages };
        self.features.extend(confirmed().map(|track| (track.id, feature(track, &frame))));
        if header.flags & END_OF_SCAN != 0 {
            let features: Vec<&Value> = self.features.values().collect();
            let collection = json!({ "type": "FeatureCollection", "features": features });
            messages.push((MAP, json!({ "geojson": collection.to_string() })));
        }
        if !std::mem::replace(&mut self.has_told_site, true) {
            messages.push((
                SITE,
                json!({
                    "timestamp": time(header.time_ns),
                    "frame_id": self.frame_id,
                    "latitude": radar.latitude_deg,
                    "longitude": radar.longitude_deg,
                    "altitude": radar.height_m,
                    "position_covariance": vec![0.0; 9],
                    "position_covariance_type": 0,
                }),
            ));
        }
        messages
    }

    fn entity(&self, track: &Track) -> Value {
        let (position, velocity) = (track.position_m(), track.velocity_mps());
        let ahead: [f64; 3] = std::array::from_fn(|axis| position[axis] + velocity[axis] * AHEAD_S);
        let size = [0, 3, 6].map(|axis| 2.0 * track.covariance[pack(axis, axis)].max(0.0).sqrt().max(SMALLEST_M / 2.0));
        let upright = json!({ "x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0 });
        let at = |position| json!({ "position": point(position), "orientation": upright });
        json!({
            "timestamp": time(track.time_ns),
            "frame_id": self.frame_id,
            "id": entity_id(track),
            "lifetime": { "sec": LIFETIME_S, "nsec": 0 },
            "frame_locked": false,
            "metadata": [{ "key": "state", "value": state_name(track.state_code) }],
            "spheres": [{ "pose": at(position), "size": point(size), "color": color(track) }],
            "lines": [{
                "type": 0,
                "pose": at([0.0; 3]),
                "thickness": 2.0,
                "scale_invariant": true,
                "points": [point(position), point(ahead)],
                "color": color(track),
                "colors": [],
                "indices": [],
            }],
            "texts": [{
                "pose": at(position),
                "billboard": true,
                "font_size": 12.0,
                "scale_invariant": true,
                "color": { "r": 1.0, "g": 1.0, "b": 1.0, "a": 1.0 },
                "text": track.id.to_string(),
            }],
        })
    }
}

fn entity_id(track: &Track) -> String {
    format!("track {}", track.id)
}

fn feature(track: &Track, frame: &LocalFrame) -> Value {
    let place = frame.place(track.position_m());
    json!({
        "type": "Feature",
        "properties": { "name": entity_id(track), "state": state_name(track.state_code) },
        "geometry": { "type": "Point", "coordinates": [place.longitude_deg, place.latitude_deg, place.height_m] },
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::tracks::{CONFIRMED, TENTATIVE};

    fn viewer() -> Viewer {
        let config = "[site]\nname = \"hill\"\nposition = { latitude_deg = 50.0, longitude_deg = 30.0 }\n".to_string();
        Viewer::new(Some(&Description { config, ..Description::default() }))
    }

    fn track(id: u64, state_code: u32) -> Track {
        let mut track = Track { id, state_code, time_ns: 1_500_000_000, ..Track::default() };
        (track.state[0], track.state[1], track.covariance[pack(0, 0)]) = (1000.0, 10.0, 400.0);
        track
    }

    #[test]
    fn tracks_are_drawn_while_they_are_confirmed() {
        let mut viewer = viewer();
        let scan = TracksHeader { flags: END_OF_SCAN, ..TracksHeader::default() };
        let drawn = viewer.draw(&scan, &[track(7, CONFIRMED), track(8, TENTATIVE)]);
        assert_eq!(drawn.iter().map(|(name, _)| *name).collect::<Vec<_>>(), [SCENE, MAP, SITE]);
        let entity = &drawn[0].1["entities"][0];
        assert_eq!(
            (&entity["id"], &entity["timestamp"]),
            (&json!("track 7"), &json!({ "sec": 1, "nsec": 500_000_000 }))
        );
        assert_eq!(entity["spheres"][0]["size"], json!({ "x": 40.0, "y": 10.0, "z": 10.0 }));
        assert_eq!(entity["lines"][0]["points"][1]["x"], 1050.0);
        let map: Value = serde_json::from_str(drawn[1].1["geojson"].as_str().expect("text")).expect("JSON");
        assert_eq!(map["features"].as_array().map(Vec::len), Some(1));
        let ended = viewer.draw(&scan, &[track(7, TERMINATED)]);
        assert_eq!(ended[0].1["deletions"][0]["id"], "track 7");
        assert!(ended[1].1["geojson"].as_str().is_some_and(|text| text.contains("\"features\":[]")));
        assert_eq!(ended.len(), 2, "the radar is told once");
    }

    #[test]
    fn without_a_place_there_is_no_map() {
        let mut viewer = Viewer::new(None);
        assert_eq!(viewer.channels().len(), 1);
        let header = TracksHeader { flags: END_OF_SCAN, ..TracksHeader::default() };
        assert_eq!(viewer.draw(&header, &[track(7, TENTATIVE)]), []);
    }
}
