//! Exports, read back by readers of their own forms: they say what the recording says.

use std::collections::BTreeMap;
use std::fs::File;
use std::path::Path;

use common::health::{Health, HealthHeader};
use common::plots::{HAS_ELEVATION, HAS_STATISTIC, Plot, PlotsHeader};
use common::recording::container::Description;
use common::recording::{Recorded, RecordingError, jsonl};
use common::topic::Topic;
use common::tracks::{Track, TracksHeader};
use common::truth::{TruthHeader, TruthTarget};
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::Field;
use parquet_export::Parquet;
use recorder::export::{Form, Format, export};
use serde_json::Value;

const TOPICS: [Topic; 4] = [Topic::Plots, Topic::Tracks, Topic::Truth, Topic::HealthReports];
const EPOCH_NS: u64 = 1_700_000_000_000_000_000;

/// Messages of every topic; some values are not known. More plots than fit into a row group of Parquet.
fn messages() -> Vec<Recorded> {
    let mut messages = Vec::new();
    for seq in 0..200_u64 {
        let time_ns = EPOCH_NS + seq * 1_000_000;
        let plot = |index: u64| Plot {
            time_ns: time_ns - index,
            range_m: 1000.0 + (seq as f64).sqrt(),
            elevation_rad: 0.1,
            sigma_range_m: 0.1,
            flags: if index.is_multiple_of(2) { HAS_ELEVATION | HAS_STATISTIC } else { 0 },
            ..Plot::default()
        };
        let header = PlotsHeader { seq, time_ns, session: u64::MAX - 3, ..PlotsHeader::default() };
        messages.push(Recorded::Plots(header, (0..seq * 5).map(plot).collect()));
        let header = TracksHeader { seq, time_ns, ..TracksHeader::default() };
        let track = Track { id: seq, covariance: [0.25; 45], state: [-1e-9; 9], ..Track::default() };
        messages.push(Recorded::Tracks(header, vec![track; (seq % 3) as usize]));
        if seq % 10 == 0 {
            let header = TruthHeader { seq, time_ns, ..TruthHeader::default() };
            let target = |snr_db| TruthTarget { time_ns, target_id: 7, snr_db, ..TruthTarget::default() };
            messages.push(Recorded::Truth(header, vec![target(13.5), target(f32::NAN)]));
            let mut health = Health { heartbeat_ns: seq, ..Health::default() };
            health.process = "tracker, null".into();
            messages.push(Recorded::HealthReports(HealthHeader { seq, ..HealthHeader::default() }, vec![health]));
        }
    }
    messages
}

fn description() -> Description {
    Description { site: "hill".into(), config: "[run]\nseed = 7\n".into(), seed: 7, ..Description::default() }
}

/// Exports all topics and returns the rows or messages of each file.
fn exported(messages: &[Recorded], form: &dyn Form, folder: &Path) -> Vec<u64> {
    let files = export(messages.iter().cloned().map(Ok), Some(&description()), &TOPICS, form, folder).expect("written");
    files.into_iter().map(|(_, written)| written).collect()
}

fn elements(messages: &[Recorded], topic: Topic) -> u64 {
    let of_topic = messages.iter().map(Recorded::by_ref).filter(|message| message.topic() == topic);
    of_topic.map(|message| message.len() as u64).sum()
}

/// Every property says what it is.
fn assert_described(schema: &Value, place: &str) {
    for (name, property) in schema["properties"].as_object().into_iter().flatten() {
        assert!(property["type"].is_string(), "{place}.{name}: one type, for viewers: {property}");
        assert!(property["description"].is_string(), "{place}.{name}: {property}");
        assert_described(property, &format!("{place}.{name}"));
        assert_described(&property["items"], &format!("{place}.{name}[]"));
    }
}

/// Every field of `value` is in the schema, with its type.
fn assert_conforms(value: &Value, schema: &Value, place: &str) {
    let right = match schema["type"].as_str() {
        Some("object") => value.is_object(),
        Some("array") => value.is_array(),
        Some("integer") => value.is_u64() || value.is_i64(),
        Some("number") => value.is_number(),
        Some("string") => value.is_string(), // names in health
        _ => false,
    };
    assert!(right, "{place}: {value} is not of {}", schema["type"]);
    for (name, field) in value.as_object().into_iter().flatten() {
        assert_conforms(field, &schema["properties"][name], &format!("{place}.{name}"));
    }
    for item in value.as_array().into_iter().flatten() {
        assert_conforms(item, &schema["items"], place);
    }
}

#[test]
fn mcap_with_json_has_a_schema_per_topic_and_every_message() {
    let folder = tempfile::tempdir().expect("a folder");
    let messages = messages();
    assert_eq!(exported(&messages, &Format::McapJson, folder.path()), [messages.len() as u64]);

    let bytes = std::fs::read(folder.path().join("messages.mcap")).expect("a file");
    let summary = mcap::Summary::read(&bytes).expect("a summary").expect("an index");
    assert_eq!(summary.stats.map(|stats| stats.message_count), Some(messages.len() as u64));
    let (mut read, mut time_ns) = (0, 0);
    for (message, recorded) in mcap::MessageStream::new(&bytes).expect("a container").zip(&messages) {
        let (message, recorded) = (message.expect("a message"), recorded.by_ref());
        let schema = message.channel.schema.as_ref().expect("a schema");
        assert_eq!((message.channel.message_encoding.as_str(), schema.encoding.as_str()), ("json", "jsonschema"));
        assert_eq!(message.channel.topic, format!("/{}", recorded.topic().name()));
        let schema: Value = serde_json::from_slice(&schema.data).expect("a schema in JSON");
        assert_described(&schema, recorded.topic().name());
        let body: Value = serde_json::from_slice(&message.data).expect("a message in JSON");
        assert_conforms(&body, &schema, recorded.topic().name());
        assert_eq!(body["elements"].as_array().map(Vec::len), Some(recorded.len()));
        assert_eq!(body["header"]["seq"], recorded.seq());

        time_ns = if recorded.topic() == Topic::HealthReports { time_ns } else { recorded.time_ns() };
        assert_eq!((message.log_time, u64::from(message.sequence)), (time_ns, recorded.seq()));
        // The same as the JSON line, but for what is not known.
        let mut line = Vec::new();
        jsonl::Writer::new(&mut line).write(recorded).expect("memory");
        let mut line: Value = serde_json::from_slice(&line).expect("a line");
        for element in line["elements"].as_array_mut().into_iter().flatten() {
            element.as_object_mut().expect("an object").retain(|_, field| !field.is_null());
        }
        assert_eq!((&body["header"], &body["elements"]), (&line["header"], &line["elements"]));
        read += 1;
    }
    assert_eq!(read, messages.len());
    let metadata = mcap::read::metadata(&bytes, &summary.metadata_indexes[0]).expect("metadata");
    assert_eq!((metadata.name.as_str(), &metadata.metadata), ("recording", &description().to_map()));
}

#[test]
fn an_export_that_fails_leaves_no_file() {
    let folder = tempfile::tempdir().expect("a folder");
    for form in [&Format::Csv as &dyn Form, &Parquet, &Format::JsonLines, &Format::McapJson] {
        let broken = RecordingError::Line { line: 7, message: "spoilt".into() };
        let recorded = messages().into_iter().map(Ok).chain(std::iter::once(Err(broken)));
        let error = export(recorded, Some(&description()), &TOPICS, form, folder.path())
            .expect_err("a spoilt line")
            .to_string();
        assert_eq!(error, "line 7: spoilt");
        assert_eq!(std::fs::read_dir(folder.path()).expect("a folder").count(), 0, "{:?}", form.files(&TOPICS));
    }
}

#[test]
fn a_topic_named_twice_is_written_once() {
    let folder = tempfile::tempdir().expect("a folder");
    let recorded = messages();
    let topics = [Topic::Tracks, Topic::Plots, Topic::Tracks];
    let files = export(recorded.iter().cloned().map(Ok), Some(&description()), &topics, &Format::Csv, folder.path())
        .expect("written");
    let wanted = [Topic::Plots, Topic::Tracks]
        .map(|topic| (folder.path().join(format!("{}.csv", topic.name())), elements(&recorded, topic)));
    assert_eq!(files, wanted);
}

#[test]
fn parquet_has_the_types_and_values_of_the_csv() {
    let folder = tempfile::tempdir().expect("a folder");
    let messages = messages();
    let rows = TOPICS.map(|topic| elements(&messages, topic));
    assert_eq!(exported(&messages, &Format::Csv, folder.path()), rows);
    assert_eq!(exported(&messages, &Parquet, folder.path()), rows);
    for (topic, rows) in TOPICS.into_iter().zip(rows) {
        let path = |extension: &str| folder.path().join(format!("{}.{extension}", topic.name()));
        let mut table = csv::Reader::from_path(path("csv")).expect("a table");
        let reader = SerializedFileReader::new(File::open(path("parquet")).expect("a file")).expect("Parquet");
        assert_eq!(reader.metadata().file_metadata().num_rows(), i64::try_from(rows).expect("rows"));
        assert_eq!(reader.num_row_groups(), if topic == Topic::Plots { 2 } else { 1 });
        let about = reader.metadata().file_metadata().key_value_metadata().expect("metadata");
        let about = about.iter().map(|pair| (pair.key.clone(), pair.value.clone().expect("a value")));
        let wanted = description().to_map().into_iter().map(|(key, value)| (format!("radar-chain.{key}"), value));
        assert!(wanted.eq(about));
        let columns = reader.metadata().file_metadata().schema().get_fields();
        let names: Vec<&str> = columns.iter().map(|column| column.name()).collect();
        assert_eq!(table.headers().expect("names").iter().collect::<Vec<_>>(), names);
        let mut compared = 0;
        for (row, record) in reader.get_row_iter(None).expect("rows").zip(table.records()) {
            for ((name, field), text) in row.expect("a row").get_column_iter().zip(&record.expect("a record")) {
                let number = || text.parse::<f64>().map(f64::to_bits);
                let equal = match field {
                    Field::Null => text.is_empty(),
                    Field::Str(field) => field == text,
                    Field::UInt(field) => Ok(*field) == text.parse(),
                    Field::ULong(field) => Ok(*field) == text.parse(),
                    // A timestamp, which this reader gives as a number.
                    Field::Long(field) if name == "time_ns" => Ok(*field) == text.parse(),
                    Field::Float(field) => text.parse::<f32>().map(f32::to_bits) == Ok(field.to_bits()),
                    Field::Double(field) => Ok(field.to_bits()) == number(),
                    _ => false,
                };
                assert!(equal, "{} {name}: {field:?} and `{text}`", topic.name());
            }
            compared += 1;
        }
        assert_eq!(compared, rows);
    }
}

#[test]
fn tables_say_what_was_recorded_and_what_is_not_known() {
    let folder = tempfile::tempdir().expect("a folder");
    let messages = messages();
    exported(&messages, &Parquet, folder.path());
    let rows = |topic: &str| {
        let file = File::open(folder.path().join(format!("{topic}.parquet"))).expect("a file");
        let reader = SerializedFileReader::new(file).expect("Parquet");
        let row = |row: parquet::record::Row| {
            row.get_column_iter().map(|(name, field)| (name.clone(), field.clone())).collect()
        };
        let rows = reader.get_row_iter(None).expect("rows").map(|found| row(found.expect("a row")));
        rows.collect::<Vec<BTreeMap<String, Field>>>()
    };
    let mut plots = rows("plots").into_iter();
    for message in &messages {
        let Recorded::Plots(header, elements) = message else { continue };
        for plot in elements {
            let row = plots.next().expect("a row");
            let if_known = |flag, field| if plot.has(flag) { field } else { Field::Null };
            assert_eq!(row["seq"], Field::ULong(header.seq));
            assert_eq!(row["time_ns"], Field::Long(plot.time_ns.cast_signed()));
            assert_eq!(row["range_m"], Field::Double(plot.range_m));
            assert_eq!(row["elevation_rad"], if_known(HAS_ELEVATION, Field::Double(plot.elevation_rad)));
            assert_eq!(row["statistic"], if_known(HAS_STATISTIC, Field::Float(plot.statistic)));
            assert_eq!(row["range_rate_mps"], Field::Null);
        }
    }
    assert!(plots.next().is_none());
    assert!(
        rows("truth")
            .iter()
            .zip([Field::Float(13.5), Field::Null].iter().cycle())
            .all(|(row, snr)| row["snr_db"] == *snr)
    );
    assert!(
        rows("tracks")
            .iter()
            .all(|row| row["sigma_x_m"] == Field::Double(0.5) && row["ay_mps2"] == Field::Double(-1e-9))
    );
    assert!(rows("health").iter().all(|row| row["process"] == Field::Str("tracker, null".into())));
}
