//! Real recordings, element by element as an independent decoder reads them (see the README of the data).

use asterix::editions::Editions;
use asterix::recording::Recording;
use asterix::value::RecordValues;
use serde_json::Value;

/// The bits at a path of the JSON form of a record.
fn bits(items: &Value, path: &str) -> Option<u64> {
    let element = path.split('/').try_fold(items, |node, name| match node {
        Value::Array(list) => list.get(name.parse::<usize>().ok()?),
        _ => node.get(name),
    })?;
    element.get("raw")?.as_u64()
}

/// All elements, of however many parts.
fn count(node: &Value) -> usize {
    match node {
        Value::Object(parts) if parts.get("raw").is_some_and(Value::is_u64) => 1,
        Value::Object(parts) => parts.values().map(count).sum(),
        Value::Array(list) => list.iter().map(count).sum(),
        _ => 0,
    }
}

fn compare(file: &[u8], table: &str) {
    let editions = Editions::default();
    let recording = Recording::new(file, &editions);
    let records = recording.records(&editions).map(|received| received.expect("no record is bad").record);
    let records: Vec<_> = records.take(12).collect();
    let json = records.iter().map(|record| {
        serde_json::from_str::<Value>(&RecordValues::of(record).to_string()).expect("the form of a record is JSON")
    });
    let json: Vec<Value> = json.collect();
    let mut rows = 0;
    for row in table.lines() {
        let [index, category, path, expected] = row.splitn(4, ',').collect::<Vec<_>>()[..] else {
            panic!("a row of four columns: {row}")
        };
        let index: usize = index.parse().expect("a number");
        assert_eq!(records[index].edition.category.to_string(), category);
        assert_eq!(bits(&json[index], path), expected.parse().ok(), "{row}");
        rows += 1;
    }
    assert!(rows > 100);
    assert_eq!(json.iter().map(count).sum::<usize>(), rows, "elements that the other decoder does not have");
}

#[test]
fn elements_of_a_capture_are_those_of_another_decoder() {
    let file = include_bytes!("data/cat034-cat048-doppler-60s.pcapng");
    compare(file, include_str!("data/cat034-cat048-doppler-60s.csv"));
}

#[test]
fn elements_of_a_surface_movement_sensor_are_those_of_another_decoder() {
    let file = include_bytes!("../../plot-source/tests/data/lebl-mlat-30s.ast");
    compare(file, include_str!("data/lebl-mlat-30s.csv"));
}

/// Decoded and encoded again, both recordings are the same to the byte.
#[test]
fn recordings_come_back_to_the_byte() {
    let files = [
        &include_bytes!("data/cat034-cat048-doppler-60s.pcapng")[..],
        include_bytes!("../../plot-source/tests/data/lebl-mlat-30s.ast"),
        include_bytes!("../../plot-source/tests/data/lebl-smr-30s.ast"),
    ];
    let editions = Editions::default();
    for file in files {
        let recording = Recording::new(file, &editions);
        for received in recording.records(&editions) {
            let record = received.expect("no record is bad").record;
            let mut octets = Vec::new();
            RecordValues::of(&record).encode(&mut octets).expect("it can be encoded");
            assert_eq!(octets, record.bytes);
        }
    }
}
