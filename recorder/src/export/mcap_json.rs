//! MCAP with JSON messages, which viewers open without knowing this program.
//!
//! One channel per topic, named as the topic; its schema says what each field is, with units. The times of a message are its
//! measurement time; health, which has none, takes that of the last message that has one. The metadata `recording` is what
//! the recording says of itself.
//! What is not known is left out, because viewers take no `null` for a number; so nothing is required.

use std::fs::File;
use std::io::BufWriter;

use common::messages::{ForMessage, ForTopic, Message};
use common::recording::container::Description;
use common::recording::{RecordedRef, RecordingError};
use common::topic::{TOPICS, Topic};
use mcap::records::{MessageHeader, Metadata};
use schemars::generate::SchemaSettings;
use schemars::transform::RecursiveTransform;
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::Serialize;
use serde_json::Value;

use super::Sink;

/// A file of messages.
pub(super) struct McapJson {
    mcap: mcap::Writer<BufWriter<File>>,
    channels: [u16; TOPICS],
    /// Measurement time of the last message that has one, ns UTC; 0 before the first.
    time_ns: u64,
    /// Channel, sequence and text of what came before it: it gets the first time, so that no file begins in 1970.
    early: Vec<(u16, u32, Vec<u8>)>,
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
        Ok(Self { mcap, channels, time_ns: 0, early: Vec::new(), text: Vec::new() })
    }

    fn append(&mut self, channel_id: u16, sequence: u32, text: &[u8]) -> Result<(), RecordingError> {
        let (log_time, publish_time) = (self.time_ns, self.time_ns);
        let header = MessageHeader { channel_id, sequence, log_time, publish_time };
        self.mcap.write_to_known_channel(&header, text).map_err(failed)
    }

    fn append_early(&mut self) -> Result<(), RecordingError> {
        let early = std::mem::take(&mut self.early);
        early.iter().try_for_each(|(channel_id, sequence, text)| self.append(*channel_id, *sequence, text))
    }

    /// Turns a message into text; what is not known is left out.
    fn put(&mut self, message: RecordedRef<'_>) -> serde_json::Result<()> {
        struct Text<'a>(&'a mut Vec<u8>);
        impl ForMessage for Text<'_> {
            type Out = serde_json::Result<()>;

            fn call<M: Message>(self, header: &M::Header, elements: &[M::Element]) -> Self::Out {
                serde_json::to_writer(self.0, &Body { header, elements })
            }
        }
        self.text.clear();
        message.apply(Text(&mut self.text))?;
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
        self.put(message).map_err(std::io::Error::from)?;
        if message.time_ns() > 0 {
            self.time_ns = message.time_ns();
        }
        let (channel_id, sequence) = (self.channels[message.topic() as usize], message.seq() as u32);
        if self.time_ns == 0 {
            self.early.push((channel_id, sequence, self.text.clone()));
            return Ok(1);
        }
        self.append_early()?;
        let text = std::mem::take(&mut self.text);
        self.append(channel_id, sequence, &text)?;
        self.text = text;
        Ok(1)
    }

    fn finish(mut self: Box<Self>) -> Result<(), RecordingError> {
        self.append_early()?;
        self.mcap.finish().map_err(failed)?;
        Ok(())
    }
}

/// JSON Schema of a topic's messages.
fn schema(topic: Topic) -> Schema {
    struct Describe(SchemaGenerator);
    impl ForTopic for Describe {
        type Out = Schema;

        fn call<M: Message>(self) -> Schema {
            self.0.into_root_schema_for::<Body<'_, M::Header, M::Element>>()
        }
    }
    // Viewers want the whole schema in one piece.
    let nothing_required = RecursiveTransform(|schema: &mut Schema| {
        schema.remove("required");
    });
    let settings = SchemaSettings::draft07().with(|settings| settings.inline_subschemas = true);
    let mut schema = topic.apply(Describe(settings.with_transform(nothing_required).into_generator()));
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
