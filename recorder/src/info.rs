//! What is in a recording.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::io::Read;

use common::recording::container::{Blocks, Entry, Reader};
use common::recording::{GapReason, RecordedRef, RecordingError};
use common::topic::Topic;
use common::units::{MIB, seconds_between};

/// Messages of one topic.
#[derive(Debug, Default, Clone, PartialEq, Eq)]
struct Contents {
    messages: u64,
    elements: u64,
    seq: (u64, u64),
    time_ns: (u64, u64),
    sessions: Vec<u64>,
}

/// What is said of all messages.
#[derive(Debug, Default)]
struct Summary {
    topics: BTreeMap<Topic, Contents>,
    /// Gaps and messages missing in them.
    gaps: BTreeMap<(Topic, GapReason), (u64, u64)>,
    damage: Option<RecordingError>,
}

/// Reads a recording of `length` bytes to its end and describes it; `parts` files of its run are there.
///
/// # Errors
/// The recording is damaged before its first message. Later damage is in the text.
pub fn describe<R: Read>(input: R, length: u64, parts: usize) -> Result<String, RecordingError> {
    let mut reader = Reader::new(input);
    let description = reader.description().cloned().unwrap_or_default();
    let mut summary = Summary::of(&mut reader);
    if summary.topics.is_empty()
        && let Some(error) = summary.damage.take()
    {
        return Err(error);
    }
    let state = match (&summary.damage, reader.is_whole()) {
        (Some(error @ RecordingError::NotSupported { .. }), _) => {
            format!("not read after {} messages: {error}", reader.messages())
        }
        (Some(error), _) => format!("damaged after {} messages: {error}", reader.messages()),
        (None, true) => "whole".to_string(),
        (None, false) => "cut: readable up to its last whole chunk".to_string(),
    };
    let mut text = String::new();
    let _ = writeln!(text, "state    {state}");
    let _ = writeln!(
        text,
        "run      {} part {} session {} seed {} version {}",
        description.run, description.part, description.session, description.seed, description.version
    );
    let span_s = summary.span_s();
    let _ = writeln!(
        text,
        "size     {:.3} MiB in {span_s:.3} s; parts of the run from here on: {parts}",
        length as f64 / MIB
    );
    summary.write(&mut text);
    Ok(text)
}

impl Summary {
    fn of<R: Read>(reader: &mut Reader<Blocks<R>>) -> Self {
        let mut summary = Self::default();
        while let Some(entry) = reader.next_entry() {
            match entry {
                Ok(Entry::Message(message)) => summary.note(message.by_ref()),
                Ok(Entry::Gap(gap)) => {
                    let (gaps, missing) = summary.gaps.entry((gap.topic, gap.reason)).or_default();
                    (*gaps, *missing) = (*gaps + 1, *missing + gap.count);
                }
                Err(error) => summary.damage = Some(error),
            }
        }
        summary
    }

    fn note(&mut self, message: RecordedRef<'_>) {
        let (seq, time_ns) = (message.seq(), message.time_ns());
        let contents = self.topics.entry(message.topic()).or_insert_with(|| Contents {
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

    /// From the first to the last measurement of any topic, s.
    fn span_s(&self) -> f64 {
        let timed = || self.topics.iter().filter(|(topic, _)| topic.is_data()).map(|(_, contents)| contents.time_ns);
        let (first, last) = (timed().map(|(first, _)| first).min(), timed().map(|(_, last)| last).max());
        first.zip(last).map_or(0.0, |(first, last)| seconds_between(first, last))
    }

    fn write(&self, text: &mut String) {
        let _ = writeln!(
            text,
            "{:<8}{:>10}{:>12}{:>12}{:>12}{:>12}{:>12}{:>10}",
            "topic", "messages", "elements", "per s", "first", "last", "span s", "sessions"
        );
        let span_s = self.span_s();
        for topic in Topic::ALL {
            let Some(contents) = self.topics.get(&topic) else { continue };
            let rate = if span_s > 0.0 { format!("{:.2}", contents.messages as f64 / span_s) } else { "-".to_string() };
            let _ = writeln!(
                text,
                "{:<8}{:>10}{:>12}{rate:>12}{:>12}{:>12}{:>12.3}{:>10}",
                topic.name(),
                contents.messages,
                contents.elements,
                contents.seq.0,
                contents.seq.1,
                seconds_between(contents.time_ns.0, contents.time_ns.1),
                contents.sessions.len()
            );
        }
        for (&(topic, reason), (gaps, missing)) in &self.gaps {
            let _ = writeln!(text, "missing  {}: {missing} in {gaps} gaps ({})", topic.name(), reason.in_words());
        }
        if self.gaps.is_empty() {
            let _ = writeln!(text, "missing  nothing");
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::plots::{Plot, PlotsHeader};
    use common::recording::Gap;
    use common::recording::container::{Description, Writer};

    #[test]
    fn gaps_rates_and_sizes_are_said() {
        let mut file = std::io::Cursor::new(Vec::new());
        let mut writer = Writer::new(&mut file, &Description::default(), "", 1 << 20).expect("memory");
        for seq in 0..41_u64 {
            let header = PlotsHeader {
                seq,
                session: 1 + seq / 40,
                time_ns: 5_000_000_000 + seq * 250_000_000,
                ..PlotsHeader::default()
            };
            writer.write(RecordedRef::Plots(&header, &[Plot::default(); 3])).expect("memory");
            if seq == 7 || seq == 9 {
                let gap = Gap {
                    topic: Topic::Tracks,
                    session: 1,
                    first_seq: seq,
                    last_seq: seq + 3,
                    count: 4,
                    reason: GapReason::Queue,
                };
                writer.write_gap(&gap).expect("memory");
            }
        }
        writer.finish().expect("memory");
        let text = describe(file.get_ref().as_slice(), 3 << 19, 2).expect("a recording");
        assert!(text.contains("1.500 MiB in 10.000 s; parts of the run from here on: 2"), "{text}");
        let line: Vec<&str> =
            text.lines().find(|line| line.starts_with("plots")).unwrap_or_default().split_whitespace().collect();
        assert_eq!(line, ["plots", "41", "123", "4.10", "0", "40", "10.000", "2"]);
        assert!(text.contains("missing  tracks: 8 in 2 gaps (queue full)"), "{text}");
    }
}
