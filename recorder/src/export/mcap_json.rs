//! MCAP with JSON messages, which viewers open without knowing this program.
//!
//! One channel per topic, named as the topic; its schema says what each field is, with units. The times of a message are its
//! measurement time; health, which has none, takes that of the last message that has one, or of the first. The metadata `recording` is what
//! the recording says of itself.
//! Tracks are there a second time, in the messages that viewers draw by themselves ([`super::foxglove`]).
//! What is not known is left out, because viewers take no `null` for a number; so nothing is required.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::BufWriter;

use common::messages::{ForMessage, ForTopic, Message};
use common::recording::container::Description;
use common::recording::{LogTime, RecordedRef, RecordingError};
use common::topic::{TOPICS, Topic};
use mcap::records::{MessageHeader, Metadata};
use schemars::generate::SchemaSettings;
use schemars::transform::RecursiveTransform;
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::Serialize;
use serde_json::Value;

use super::Sink;
use super::foxglove::{self, Viewer};

/// A file of messages.
pub(super) struct McapJson {
    mcap: mcap::Writer<BufWriter<File>>,
    channels: [u16; TOPICS],
    /// Messages as text, until a measurement gives them a time.
    log_time: LogTime<(MessageHeader, Vec<u8>)>,
    text: Vec<u8>,
    /// Where tracks are among the topics: what draws them, and the channels of its messages.
    drawing: Option<Drawing>,
}

/// What draws tracks, and the channels of its messages by their names.
struct Drawing {
    viewer: Viewer,
    channels: BTreeMap<&'static str, u16>,
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
        let tracks = topics.contains(&Topic::Tracks);
        let drawing = tracks.then(|| Drawing::new(description, &mut mcap)).transpose()?;
        let log_time = LogTime::new(description.map_or(0, |description| description.session));
        Ok(Self { mcap, channels, log_time, text: Vec::new(), drawing })
    }

    /// Writes what is drawn after a message of tracks.
    fn draw(&mut self, message: RecordedRef<'_>, time_ns: u64) -> Result<(), RecordingError> {
        let (Some(drawing), RecordedRef::Tracks(header, tracks)) = (&mut self.drawing, message) else {
            return Ok(());
        };
        for (name, body) in drawing.viewer.draw(header, tracks) {
            let Some(&channel_id) = drawing.channels.get(name) else { continue };
            let sequence = message.seq() as u32;
            let header = MessageHeader { channel_id, sequence, log_time: time_ns, publish_time: time_ns };
            self.mcap.write_to_known_channel(&header, body.to_string().as_bytes()).map_err(failed)?;
        }
        Ok(())
    }

    /// Writes what has waited for the first measurement.
    fn file_waiting(&mut self, time_ns: u64) -> Result<(), RecordingError> {
        for (header, text) in self.log_time.take_waiting() {
            let header = MessageHeader { log_time: time_ns, publish_time: time_ns, ..header };
            self.mcap.write_to_known_channel(&header, &text).map_err(failed)?;
        }
        Ok(())
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
        let channel_id = self.channels[message.topic() as usize];
        let header = MessageHeader { channel_id, sequence: message.seq() as u32, log_time: 0, publish_time: 0 };
        match self.log_time.of(message.time_ns()) {
            None => self.log_time.wait((header, std::mem::take(&mut self.text))),
            Some(time_ns) => {
                self.file_waiting(time_ns)?;
                let header = MessageHeader { log_time: time_ns, publish_time: time_ns, ..header };
                self.mcap.write_to_known_channel(&header, &self.text).map_err(failed)?;
                self.draw(message, time_ns)?;
            }
        }
        Ok(1)
    }

    fn finish(mut self: Box<Self>) -> Result<(), RecordingError> {
        let time_ns = self.log_time.at_last();
        self.file_waiting(time_ns)?;
        self.mcap.finish().map_err(failed)?;
        Ok(())
    }
}

impl Drawing {
    fn new(
        description: Option<&Description>,
        mcap: &mut mcap::Writer<BufWriter<File>>,
    ) -> Result<Self, RecordingError> {
        let (viewer, mut channels) = (Viewer::new(description), BTreeMap::new());
        for (name, topic) in viewer.channels() {
            let text = serde_json::to_vec(&foxglove::schema(name)).map_err(std::io::Error::from)?;
            let schema = mcap.add_schema(name, "jsonschema", &text).map_err(failed)?;
            channels.insert(name, mcap.add_channel(schema, topic, "json", &[].into()).map_err(failed)?);
        }
        Ok(Self { viewer, channels })
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
