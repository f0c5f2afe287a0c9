//! Exports for maps and test logs, read back by parsers of their own forms.

use std::path::Path;

use common::geodesy::{LocalFrame, Position};
use common::recording::Recorded;
use common::recording::container::Description;
use common::topic::Topic;
use common::tracks::{CONFIRMED, TENTATIVE, Track, TracksHeader, pack};
use common::truth::{PLANAR, TruthHeader, TruthTarget};
use recorder::export::{Format, export};
use serde_json::Value;

const EPOCH_NS: u64 = 1_767_225_600_000_000_000;
const RADAR: Position = Position { latitude_deg: 50.45, longitude_deg: 30.52, height_m: 120.0 };
const TOPICS: [Topic; 3] = [Topic::Plots, Topic::Tracks, Topic::Truth];

fn description(position: &str) -> Description {
    let config = format!("[site]\nname = \"hill\"\n{position}\n");
    Description { site: "hill".into(), config, ..Description::default() }
}

fn placed() -> Description {
    description("position = { latitude_deg = 50.45, longitude_deg = 30.52, height_m = 120.0 }")
}

/// Ten scans of a track that is confirmed from the third on, one that never is, and a true target without height.
fn messages() -> Vec<Recorded> {
    let mut messages = Vec::new();
    for scan in 0..10_u64 {
        let time_ns = EPOCH_NS + scan * 1_000_000_000;
        let mut track = Track { id: 7, time_ns, state_code: CONFIRMED, existence: 0.75, ..Track::default() };
        track.state = [1000.0 + 20.0 * scan as f64, 20.0, 0.0, 2000.0, 0.0, 0.0, 300.0, 1.0, 0.0];
        track.covariance[pack(6, 6)] = 100.0;
        if scan < 2 {
            track.state_code = TENTATIVE;
        }
        let other = Track { id: 8, state_code: TENTATIVE, ..track };
        messages
            .push(Recorded::Tracks(TracksHeader { seq: scan, time_ns, ..TracksHeader::default() }, vec![track, other]));
        let mut target = TruthTarget { time_ns, target_id: 0x4a_bc_de, flags: PLANAR, ..TruthTarget::default() };
        (target.state[0], target.state[3]) = (-500.0, scan as f64);
        messages.push(Recorded::Truth(TruthHeader { seq: scan, time_ns, ..TruthHeader::default() }, vec![target]));
    }
    messages
}

fn exported(format: Format, description: &Description, folder: &Path) -> Vec<(String, u64)> {
    let files = export(messages().into_iter().map(Ok), Some(description), &TOPICS, &format, folder).expect("written");
    let name = |path: &Path| path.file_name().expect("a name").to_string_lossy().into_owned();
    files.into_iter().map(|(path, count)| (name(&path), count)).collect()
}

fn read(folder: &Path, name: &str) -> String {
    std::fs::read_to_string(folder.join(name)).expect("a file")
}

#[test]
fn geojson_has_a_line_for_each_confirmed_track_and_true_target() {
    let folder = tempfile::tempdir().expect("a folder");
    let files = exported(Format::GeoJson, &placed(), folder.path());
    assert_eq!(files, [("tracks.geojson".into(), 8), ("truth.geojson".into(), 10)]);
    let tracks: Value = serde_json::from_str(&read(folder.path(), "tracks.geojson")).expect("JSON");
    assert_eq!(tracks["type"], "FeatureCollection");
    let [feature] = &tracks["features"].as_array().expect("features")[..] else { panic!("{tracks}") };
    assert_eq!(
        (&feature["properties"]["name"], &feature["geometry"]["type"]),
        (&"track 7".into(), &"LineString".into())
    );
    assert_eq!(feature["properties"]["coordTimes"][0], "2026-01-01T00:00:02.000Z");
    let line = feature["geometry"]["coordinates"].as_array().expect("a line");
    let place = LocalFrame::new(&RADAR).place([1180.0, 2000.0, 300.0]);
    let last: Vec<f64> = line[7].as_array().expect("a position").iter().filter_map(Value::as_f64).collect();
    assert_eq!((line.len(), last), (8, vec![place.longitude_deg, place.latitude_deg, place.height_m]));
    let truth: Value = serde_json::from_str(&read(folder.path(), "truth.geojson")).expect("JSON");
    let target = &truth["features"][0];
    assert_eq!(target["properties"]["name"], "target 4ABCDE");
    assert_eq!(target["geometry"]["coordinates"][0].as_array().map(Vec::len), Some(2), "it has no height");
}

#[test]
fn kml_has_as_many_times_as_places() {
    let folder = tempfile::tempdir().expect("a folder");
    exported(Format::Kml, &placed(), folder.path());
    for (name, mode, points) in [("tracks.kml", "absolute", 8), ("truth.kml", "clampToGround", 10)] {
        let text = read(folder.path(), name);
        let mut reader = quick_xml::Reader::from_str(&text);
        let (mut open, mut whens, mut coords) = (Vec::new(), 0, 0);
        loop {
            match reader.read_event().expect("XML") {
                quick_xml::events::Event::Start(element) => open.push(element.name().as_ref().to_string()),
                quick_xml::events::Event::End(_) => drop(open.pop()),
                quick_xml::events::Event::Text(inside) => match open.last().map(String::as_str) {
                    Some("when") => whens += 1,
                    Some("gx:coord") => {
                        let numbers = inside.split(' ').filter_map(|it| it.parse::<f64>().ok()).count();
                        coords += usize::from(numbers == 3);
                    }
                    Some("altitudeMode") => assert_eq!(&*inside, mode),
                    _ => {}
                },
                quick_xml::events::Event::Eof => break,
                _ => {}
            }
        }
        assert_eq!((whens, coords, open.len()), (points, points, 0), "{name}");
    }
}

#[test]
fn a_test_log_numbers_its_records_and_says_where_targets_are() {
    let folder = tempfile::tempdir().expect("a folder");
    assert_eq!(exported(Format::Courageous, &placed(), folder.path()), [("courageous.json".into(), 8)]);
    let log: Value = serde_json::from_str(&read(folder.path(), "courageous.json")).expect("JSON");
    assert_eq!((&log["system_name"], &log["static_cuas_location"]["lat"]), (&"hill".into(), &50.45.into()));
    let records = log["tracks"][0]["records"].as_array().expect("records");
    let numbers: Vec<u64> = records.iter().filter_map(|record| record["record_number"].as_u64()).collect();
    assert_eq!(numbers, (1..=8).collect::<Vec<u64>>());
    let first = &records[0];
    assert_eq!(first["time"].as_u64(), Some(EPOCH_NS / 1_000_000 + 2000));
    assert_eq!(first["alarm"], serde_json::json!({ "active": true, "certainty": 0.75 }));
    let distance_m = first["location"]["distance"].as_f64().expect("a distance");
    assert!((distance_m - 1040.0_f64.hypot(2000.0).hypot(300.0)).abs() < 1e-9);
}

#[test]
fn tables_have_places_and_names_and_maps_need_a_place() {
    let folder = tempfile::tempdir().expect("a folder");
    exported(Format::Csv, &placed(), folder.path());
    let text = read(folder.path(), "tracks.csv");
    let mut table = csv::Reader::from_reader(text.as_bytes());
    let names = table.headers().expect("columns").clone();
    let column = |name: &str| names.iter().position(|other| other == name).expect(name);
    let row = table.records().nth(4).expect("a row").expect("a row");
    assert_eq!((&row[column("state")], &row[column("gate")]), ("confirmed", "none"));
    let place = LocalFrame::new(&RADAR).place([1040.0, 2000.0, 300.0]);
    assert_eq!(row[column("latitude_deg")].parse(), Ok(place.latitude_deg));

    let nowhere = description("");
    exported(Format::Csv, &nowhere, folder.path());
    assert!(!read(folder.path(), "tracks.csv").contains("latitude_deg"));
    let error = export(messages().into_iter().map(Ok), Some(&nowhere), &TOPICS, &Format::Kml, folder.path());
    let error = error.expect_err("no place").to_string();
    assert!(error.contains("the recorded radar has no place, expected site.position"), "{error}");
}
