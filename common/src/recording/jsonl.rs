//! JSON lines: one object per message,
//! `{"topic":"plots","header":{…},"elements":[…]}`.
//!
//! Of plots, nearly everything may be left out. A number that is not known is `null`.
//! Numbers are written with as many digits as it takes to read them back unchanged.
//! Dwells have no text form: they would take 10⁹ bytes per second.

use std::io::{BufRead, Write};

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;

use super::plain_plots::PlainPlots;
use super::{Recorded, RecordedRef, RecordingError};
use crate::messages::{ForMessage, ForTopic, Message};
use crate::topic::Topic;

/// A line as it is written.
#[derive(Serialize)]
struct LineOut<'a, H, E> {
    topic: &'static str,
    header: &'a H,
    elements: &'a [E],
}

/// A line of which only the topic is understood yet.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct LineIn<'a> {
    topic: String,
    #[serde(borrow)]
    header: Option<&'a RawValue>,
    #[serde(borrow)]
    elements: &'a RawValue,
}

/// Writes messages as JSON lines.
#[derive(Debug)]
pub struct Writer<W: Write> {
    out: W,
}

impl<W: Write> Writer<W> {
    /// A writer; give it a buffered `out`.
    pub fn new(out: W) -> Self {
        Self { out }
    }

    /// Appends one message.
    ///
    /// # Errors
    /// `out` fails, or the message is a dwell.
    pub fn write(&mut self, message: RecordedRef<'_>) -> Result<(), RecordingError> {
        struct Line<'a, W>(&'a mut W);
        impl<W: Write> ForMessage for Line<'_, W> {
            type Out = serde_json::Result<()>;

            fn call<M: Message>(self, header: &M::Header, elements: &[M::Element]) -> Self::Out {
                serde_json::to_writer(self.0, &LineOut { topic: M::TOPIC.name(), header, elements })
            }
        }
        if message.topic().is_bulk() {
            let text = format!("{} have no text form", message.topic().name());
            return Err(RecordingError::Io(std::io::Error::new(std::io::ErrorKind::Unsupported, text)));
        }
        message.apply(Line(&mut self.out)).map_err(std::io::Error::from)?;
        Ok(self.out.write_all(b"\n")?)
    }

    /// Writes out what is buffered.
    ///
    /// # Errors
    /// `out` fails.
    pub fn finish(mut self) -> Result<(), RecordingError> {
        Ok(self.out.flush()?)
    }
}

/// Reads messages from JSON lines; empty lines are skipped. Ends after the first line that cannot be read at all.
#[derive(Debug)]
pub struct Reader<R: BufRead> {
    input: R,
    line: String,
    number: u64,
    failed: bool,
    plain: PlainPlots,
}

impl<R: BufRead> Reader<R> {
    /// A reader from the start of `input`.
    pub fn new(input: R) -> Self {
        Self { input, line: String::new(), number: 0, failed: false, plain: PlainPlots::default() }
    }
}

impl<R: BufRead> Iterator for Reader<R> {
    type Item = Result<Recorded, RecordingError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.failed {
            return None;
        }
        loop {
            self.line.clear();
            self.number += 1;
            match self.input.read_line(&mut self.line) {
                Ok(0) => return None,
                Ok(_) if self.line.trim().is_empty() => {}
                Ok(_) => {
                    let line = self.number;
                    let parsed = parse(&self.line, &mut self.plain);
                    return Some(parsed.map_err(|message| RecordingError::Line { line, message }));
                }
                Err(error) => {
                    self.failed = true; // not text: every further line would say the same
                    return Some(Err(RecordingError::Line { line: self.number, message: error.to_string() }));
                }
            }
        }
    }
}

fn parse(line: &str, plain: &mut PlainPlots) -> Result<Recorded, String> {
    struct Parse<'a>(&'a LineIn<'a>);
    impl ForTopic for Parse<'_> {
        type Out = Result<Recorded, String>;

        fn call<M: Message>(self) -> Self::Out {
            let (header, elements) = parts::<M::Header, M::Element>(self.0)?;
            Ok(M::recorded(header, elements))
        }
    }
    let parsed: LineIn<'_> = serde_json::from_str(line).map_err(|error| error.to_string())?;
    if let Some(topic) = Topic::from_name(&parsed.topic).filter(|topic| !topic.is_bulk()) {
        let whole = topic.apply(Parse(&parsed));
        if topic != Topic::Plots || whole.is_ok() {
            return whole;
        }
        let (header, plots) = plain.complete(parsed.header.map(RawValue::get), parsed.elements.get())?;
        return Ok(Recorded::Plots(header, plots));
    }
    let readable = Topic::ALL.iter().filter(|topic| !topic.is_bulk()).map(|topic| topic.name());
    let names: Vec<&str> = readable.collect();
    let (last, others) = names.split_last().expect("some topics have a text form");
    Err(format!("topic `{}`: expected {} or {last}", parsed.topic, others.join(", ")))
}

fn parts<H: DeserializeOwned, E: DeserializeOwned>(line: &LineIn<'_>) -> Result<(H, Vec<E>), String> {
    let header = line.header.ok_or("missing field `header`")?;
    let header = serde_json::from_str(header.get()).map_err(|error| format!("header: {error}"))?;
    let elements = serde_json::from_str(line.elements.get()).map_err(|error| format!("elements: {error}"))?;
    Ok((header, elements))
}
