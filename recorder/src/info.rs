//! What is in a recording.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::io::Read;

use common::recording::container::Reader;
use common::recording::{Recorded, RecordingError};
use common::services::{ALL_TOPICS, Topic};
use common::units::seconds_between;

/// Messages of one topic.
#[derive(Debug, Default, Clone, PartialEq, Eq)]
struct Contents {
    messages: u64,
    elements: u64,
    seq: (u64, u64),
    time_ns: (u64, u64),
    sessions: Vec<u64>,
}

/// Reads a recording to its end and describes it.
///
/// # Errors
/// The recording is damaged before its end; what precedes the damage is in the text of
/// [`describe`] only when it can be read.
pub fn describe<R: Read>(input: R) -> Result<String, RecordingError> {
    let mut reader = Reader::new(input);
    let description = reader.description().cloned().unwrap_or_default();
    let mut topics: BTreeMap<Topic, Contents> = BTreeMap::new();
    let mut damage = None;
    for message in reader.by_ref() {
        match message {
            Ok(message) => note(&mut topics, &message),
            Err(error) => damage = Some(error),
        }
    }
    if topics.is_empty()
        && let Some(error) = damage
    {
        return Err(error);
    }
    let mut text = String::new();
    let state = match (&damage, reader.is_whole()) {
        (Some(error), _) => format!("damaged after {} messages: {error}", reader.messages()),
        (None, true) => "whole".to_string(),
        (None, false) => "cut: readable up to its last whole chunk".to_string(),
    };
    let _ = writeln!(text, "state    {state}");
    let _ = writeln!(
        text,
        "run      {} part {} session {} seed {} version {}",
        description.run, description.part, description.session, description.seed, description.version
    );
    let _ = writeln!(
        text,
        "{:<8}{:>10}{:>12}{:>12}{:>12}{:>12}{:>10}",
        "topic", "messages", "elements", "first", "last", "span s", "sessions"
    );
    for topic in ALL_TOPICS {
        if let Some(contents) = topics.get(&topic) {
            let _ = writeln!(
                text,
                "{:<8}{:>10}{:>12}{:>12}{:>12}{:>12.3}{:>10}",
                topic.name(),
                contents.messages,
                contents.elements,
                contents.seq.0,
                contents.seq.1,
                seconds_between(contents.time_ns.0, contents.time_ns.1),
                contents.sessions.len()
            );
        }
    }
    Ok(text)
}

fn note(topics: &mut BTreeMap<Topic, Contents>, message: &Recorded) {
    let message = message.by_ref();
    let (seq, time_ns) = (message.seq(), message.time_ns());
    let contents = topics.entry(message.topic()).or_insert_with(|| Contents {
        seq: (seq, seq),
        time_ns: (time_ns, time_ns),
        ..Contents::default()
    });
    contents.messages += 1;
    contents.elements += message.len() as u64;
    contents.seq.1 = seq;
    contents.time_ns.1 = contents.time_ns.1.max(time_ns);
    if !contents.sessions.contains(&message.session()) {
        contents.sessions.push(message.session());
    }
}
