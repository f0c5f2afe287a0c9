//! MCAP with JSON messages, which viewers open without knowing this program.
//!
//! One channel per topic, named as the topic; its schema says what each field is, with units. The times of a message are its
//! measurement time; health, which has none, takes that of the last message that has one. The metadata `recording` is what
//! the recording says of itself.
//! What is not known is left out, because viewers take no `null` for a number; so nothing is required.

use std::fs::File;
use std::io::BufWriter;

use common::health::Health;
use common::plots::{Plot, PlotsHeader};
use common::recording::container::Description;
use common::recording::{RecordedRef, RecordingError};
use common::services::{HealthHeader, TOPICS, Topic};
use common::tracks::{Track, TracksHeader};
use common::truth::{TruthHeader, TruthTarget};
use mcap::records::{MessageHeader, Metadata};
use schemars::generate::SchemaSettings;
use schemars::transform::RecursiveTransform;
use schemars::{JsonSchema, Schema};
use serde::Serialize;
use serde_json::Value;

use super::Sink;

/// A file of messages.
pub(super) struct McapJson {
    mcap: mcap::Writer<BufWriter<File>>,
    channels: [u16; TOPICS],
    /// Measurement time of the last message that has one, ns UTC.
    time_ns: u64,
    text: Vec<u8>,
}

/// A message: its header and its elements.
#[derive(Serialize, JsonSchema)]
struct Body<'a, H, E> {
    /// What holds for the whole message.
    header: &'a H,
    /// Its elements, in the order of the message.
    elements: &'a [E],
}

impl McapJson {
    pub(super) fn create(
        file: BufWriter<File>,
        description: Option<&Description>,
        topics: &[Topic],
    ) -> Result<Self, RecordingError> {
        let mut mcap = mcap::WriteOptions::new()
            .library(concat!("radar-chain ", env!("CARGO_PKG_VERSION")))
            .compression(Some(mcap::Compression::Zstd))
            .compression_threads(0)
            .create(file)
            .map_err(failed)?;
        if let Some(description) = description {
            let metadata = description.to_map();
            mcap.write_metadata(&Metadata { name: "recording".into(), metadata }).map_err(failed)?;
        }
        let mut channels = [0; TOPICS];
        for &topic in topics {
            let text = serde_json::to_vec_pretty(&schema(topic)).map_err(std::io::Error::from)?;
            let schema = mcap.add_schema(&format!("radar.{}", topic.name()), "jsonschema", &text).map_err(failed)?;
            let channel = mcap.add_channel(schema, &format!("/{}", topic.name()), "json", &[].into());
            channels[topic as usize] = channel.map_err(failed)?;
        }
        Ok(Self { mcap, channels, time_ns: 0, text: Vec::new() })
    }

    fn put<H: Serialize, E: Serialize>(&mut self, header: &H, elements: &[E]) -> serde_json::Result<()> {
        self.text.clear();
        serde_json::to_writer(&mut self.text, &Body { header, elements })?;
        if self.text.windows(4).any(|text| text == b"null") {
            let mut body: Value = serde_json::from_slice(&self.text)?;
            leave_out_unknown(&mut body);
            self.text = serde_json::to_vec(&body)?;
        }
        Ok(())
    }
}

impl Sink for McapJson {
    fn write(&mut self, message: RecordedRef<'_>) -> Result<u64, RecordingError> {
        match message {
            RecordedRef::Dwells(..) => return Ok(0),
            RecordedRef::Plots(header, elements) => self.put(header, elements),
            RecordedRef::Tracks(header, elements) => self.put(header, elements),
            RecordedRef::Truth(header, elements) => self.put(header, elements),
            RecordedRef::Health(header, elements) => self.put(header, elements),
        }
        .map_err(std::io::Error::from)?;
        if message.time_ns() > 0 {
            self.time_ns = message.time_ns();
        }
        let (channel_id, log_time) = (self.channels[message.topic() as usize], self.time_ns);
        let header = MessageHeader { channel_id, sequence: message.seq() as u32, log_time, publish_time: log_time };
        self.mcap.write_to_known_channel(&header, &self.text).map_err(failed)?;
        Ok(1)
    }

    fn finish(mut self: Box<Self>) -> Result<(), RecordingError> {
        self.mcap.finish().map_err(failed)?;
        Ok(())
    }
}

/// JSON Schema of a topic's messages.
fn schema(topic: Topic) -> Schema {
    // Viewers want the whole schema in one piece.
    let nothing_required = RecursiveTransform(|schema: &mut Schema| {
        schema.remove("required");
    });
    let settings = SchemaSettings::draft07().with(|settings| settings.inline_subschemas = true);
    let generator = settings.with_transform(nothing_required).into_generator();
    let mut schema = match topic {
        Topic::Dwells => Schema::default(),
        Topic::Plots => generator.into_root_schema_for::<Body<'_, PlotsHeader, Plot>>(),
        Topic::Tracks => generator.into_root_schema_for::<Body<'_, TracksHeader, Track>>(),
        Topic::Truth => generator.into_root_schema_for::<Body<'_, TruthHeader, TruthTarget>>(),
        Topic::Health => generator.into_root_schema_for::<Body<'_, HealthHeader, Health>>(),
    };
    schema.insert("title".into(), topic.name().into());
    schema
}

/// Takes the fields away that are `null`.
fn leave_out_unknown(value: &mut Value) {
    match value {
        Value::Object(fields) => {
            fields.retain(|_, field| !field.is_null());
            fields.values_mut().for_each(leave_out_unknown);
        }
        Value::Array(items) => items.iter_mut().for_each(leave_out_unknown),
        _ => {}
    }
}

fn failed(error: mcap::McapError) -> RecordingError {
    match error {
        mcap::McapError::Io(error) => RecordingError::Io(error),
        other => RecordingError::Container { message: other.to_string() },
    }
}
