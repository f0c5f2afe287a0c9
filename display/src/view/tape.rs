//! The recording of one site, all its parts, from any time on.

use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};

use common::config::{self, ChainConfig};
use common::process::{BadInput, say};
use common::recording::container::{Blocks, FromChunk, Index, Reader};
use common::recording::{Recorded, parts_from};

/// A part of a recording.
#[derive(Debug, Clone)]
struct Part {
    file: PathBuf,
    index: Index,
}

/// The recording of one site.
#[derive(Debug, Clone)]
pub(crate) struct Tape {
    /// The configuration that it was made with.
    pub(crate) site: ChainConfig,
    parts: Vec<Part>,
}

impl Tape {
    /// Finds out what lies where in a recording and the later parts of its run, without reading them.
    pub(crate) fn open(file: &Path) -> anyhow::Result<Self> {
        let unreadable = |error: std::io::Error| BadInput(format!("cannot open recording {}: {error}", file.display()));
        let mut reader = Reader::new(BufReader::new(File::open(file).map_err(unreadable)?));
        let Some(text) = reader.description().map(|description| description.config.clone()) else {
            let name = file.display();
            return Err(BadInput(format!(
                "{name} does not say which radar it is of: expected a recording (MCAP) of radar-chain"
            ))
            .into());
        };
        let site = config::parse_recorded(file, &text)?;
        let mut parts = Vec::new();
        for part in parts_from(file) {
            let index = File::open(&part).and_then(|mut file| Index::of(&mut file)).map_err(unreadable)?;
            parts.push(Part { file: part, index });
        }
        Ok(Self { site, parts })
    }

    /// Times of the first and the last message, ns UTC; `None` of an empty recording.
    pub(crate) fn extent_ns(&self) -> Option<(u64, u64)> {
        let spans = || self.parts.iter().flat_map(|part| &part.index.spans);
        Some((spans().map(|span| span.from_ns).min()?, spans().map(|span| span.to_ns).max()?))
    }

    pub(crate) fn files(&self) -> usize {
        self.parts.len()
    }

    /// The messages from the chunk on that holds `time_ns`.
    pub(crate) fn from(&self, time_ns: u64) -> Messages {
        let place = self.parts.iter().enumerate().find_map(|(number, part)| {
            let span = part.index.spans.iter().find(|span| span.to_ns >= time_ns)?;
            Some((number, *span))
        });
        let Some((number, span)) = place else { return Messages::default() };
        let Part { file, index } = &self.parts[number];
        let first = match index.open_at(file, &span) {
            Ok(input) => Some(Reader::new(input)),
            Err(error) => {
                say(&format!("cannot read {}: {error}", file.display()));
                None
            }
        };
        let later = self.parts[number + 1..].iter().map(|part| part.file.clone()).collect();
        Messages { first, reader: None, later, time_ns: 0 }
    }
}

/// Messages in the order of the recording.
#[derive(Default)]
pub(crate) struct Messages {
    first: Option<Reader<Blocks<FromChunk>>>,
    reader: Option<Reader<Blocks<BufReader<File>>>>,
    /// Parts that follow, the next one first.
    later: std::collections::VecDeque<PathBuf>,
    time_ns: u64,
}

impl Iterator for Messages {
    /// Time under which a message is found, ns UTC, and the message.
    type Item = (u64, Recorded);

    fn next(&mut self) -> Option<(u64, Recorded)> {
        loop {
            let next = match (&mut self.first, &mut self.reader) {
                (Some(first), _) => first.next(),
                (None, Some(reader)) => reader.next(),
                (None, None) => None,
            };
            match next {
                Some(Ok(message)) => {
                    // Health has no measurement time: it is found where it lies.
                    self.time_ns = self.time_ns.max(message.by_ref().time_ns());
                    return Some((self.time_ns, message));
                }
                // What can be read after it is shown.
                Some(Err(error)) => say(&error.to_string()),
                None => {
                    let file = self.later.pop_front()?;
                    self.first = None;
                    self.reader = match File::open(&file) {
                        Ok(part) => Some(Reader::new(BufReader::new(part))),
                        Err(error) => {
                            say(&format!("cannot read {}: {error}", file.display()));
                            None
                        }
                    };
                }
            }
        }
    }
}
