//! Writing a container.

use std::cell::Cell;
use std::collections::BTreeMap;
use std::io::{Seek, SeekFrom, Write};
use std::rc::Rc;

use mcap::records::{MessageHeader, Metadata};

use super::{COUNTS, DESCRIPTION, Description, ENCODING, GAP_SCHEMA, GAPS, encode, schema};
use crate::recording::{Gap, GapReason, LogTime, RecordedRef, RecordingError};
use crate::topic::{TOPICS, Topic};

/// Writes a container. What has been written is on its way to the file after [`Writer::flush`].
pub struct Writer<W: Write + Seek> {
    mcap: mcap::Writer<Counted<W>>,
    channels: [u16; TOPICS],
    gaps: u16,
    payload: Vec<u8>,
    chunk_bytes: u64,
    /// Bytes in the open chunk.
    open_bytes: u64,
    /// Messages in the open chunk, as the gap they would leave.
    open: Vec<Gap>,
    /// Gaps in the open chunk.
    open_gaps: Vec<Gap>,
    /// Messages with their payloads, until a measurement gives them a time.
    log_time: LogTime<(Filed, Vec<u8>)>,
    written: Rc<Cell<u64>>,
    /// Bytes up to the end of the last whole chunk.
    safe: u64,
}

/// Where a message belongs.
#[derive(Debug, Clone, Copy)]
struct Filed {
    channel_id: u16,
    sequence: u32,
}

impl<W: Write + Seek> Writer<W> {
    /// Begins a container; a chunk is closed at `chunk_bytes`. `counts` is what the caller has counted so far
    /// (JSON), for whoever goes on from here.
    ///
    /// # Errors
    /// `out` fails.
    pub fn new(out: W, description: &Description, counts: &str, chunk_bytes: u64) -> Result<Self, RecordingError> {
        let written = Rc::new(Cell::new(0));
        let mut mcap = mcap::WriteOptions::new()
            .library(concat!("radar-chain ", env!("CARGO_PKG_VERSION")))
            .chunk_size(None) // `write` closes chunks itself, to know what is in the file
            .compression(Some(mcap::Compression::Zstd))
            .compression_level(1) // 3 takes twice the time for 5 % less
            .compression_threads(0)
            .disable_seeking(true) // chunks are written in one go
            .create(Counted { out, written: Rc::clone(&written) })
            .map_err(write_error)?;
        mcap.write_metadata(&Metadata { name: DESCRIPTION.into(), metadata: description.to_map() })
            .map_err(write_error)?;
        let metadata = BTreeMap::from([(COUNTS.to_string(), counts.to_string())]);
        mcap.write_metadata(&Metadata { name: COUNTS.into(), metadata }).map_err(write_error)?;
        let mut channels = [0; TOPICS];
        let none = BTreeMap::new();
        let service = |topic: &str| format!("radar/{}/{topic}", description.site);
        for topic in Topic::ALL {
            let (name, source) = schema(topic);
            let schema = mcap.add_schema(name, "rust", source.as_bytes()).map_err(write_error)?;
            channels[topic as usize] =
                mcap.add_channel(schema, &service(topic.name()), ENCODING, &none).map_err(write_error)?;
        }
        let schema = mcap.add_schema("gap/1", "jsonschema", GAP_SCHEMA.as_bytes()).map_err(write_error)?;
        let gaps = mcap.add_channel(schema, &service(GAPS), "json", &none).map_err(write_error)?;
        let mut this = Self {
            mcap,
            channels,
            gaps,
            payload: Vec::new(),
            chunk_bytes,
            open_bytes: 0,
            open: Vec::new(),
            open_gaps: Vec::new(),
            log_time: LogTime::new(description.session),
            written,
            safe: 0,
        };
        this.flush()?;
        Ok(this)
    }

    /// Appends one message.
    ///
    /// # Errors
    /// `out` fails; nothing can be written afterwards.
    pub fn write(&mut self, message: RecordedRef<'_>) -> Result<(), RecordingError> {
        let gap = Gap::of(message, GapReason::Disk);
        if !self.open.iter_mut().any(|open| open.merge(&gap)) {
            self.open.push(gap);
        }
        self.payload.clear();
        encode(message, &mut self.payload)?;
        let channel_id = self.channels[message.topic() as usize];
        self.file(Filed { channel_id, sequence: message.seq() as u32 }, message.time_ns())
    }

    /// Appends the note that messages are missing here.
    ///
    /// # Errors
    /// As [`Writer::write`].
    pub fn write_gap(&mut self, gap: &Gap) -> Result<(), RecordingError> {
        self.open_gaps.push(*gap);
        self.payload = serde_json::to_vec(gap).map_err(std::io::Error::from)?;
        self.file(Filed { channel_id: self.gaps, sequence: gap.first_seq as u32 }, 0)
    }

    /// Writes the payload under its time, after those that have waited for one; or lets it wait.
    fn file(&mut self, filed: Filed, time_ns: u64) -> Result<(), RecordingError> {
        let Some(time_ns) = self.log_time.of(time_ns) else {
            self.log_time.wait((filed, self.payload.clone()));
            return Ok(());
        };
        self.append_waiting(time_ns)?;
        let payload = std::mem::take(&mut self.payload);
        self.append(filed, &payload, time_ns)?;
        self.payload = payload;
        if self.open_bytes >= self.chunk_bytes { self.flush() } else { Ok(()) }
    }

    fn append_waiting(&mut self, time_ns: u64) -> Result<(), RecordingError> {
        let waiting = self.log_time.take_waiting();
        waiting.iter().try_for_each(|(filed, payload)| self.append(*filed, payload, time_ns))
    }

    fn append(&mut self, filed: Filed, payload: &[u8], time_ns: u64) -> Result<(), RecordingError> {
        let Filed { channel_id, sequence } = filed;
        let header = MessageHeader { channel_id, sequence, log_time: time_ns, publish_time: time_ns };
        self.open_bytes += payload.len() as u64;
        self.mcap.write_to_known_channel(&header, payload).map_err(write_error)
    }

    /// Messages that are not in a whole chunk of the file yet: missing if writing fails now.
    pub fn unsaved(&self) -> &[Gap] {
        &self.open
    }

    /// Gaps that are not in a whole chunk of the file yet.
    pub fn unsaved_gaps(&self) -> &[Gap] {
        &self.open_gaps
    }

    /// Bytes given to the file so far.
    pub fn bytes(&self) -> u64 {
        self.written.get()
    }

    /// Bytes up to the end of the last whole chunk.
    pub fn safe_bytes(&self) -> u64 {
        self.safe
    }

    /// Closes the chunk, so that everything so far survives the end of the process, but for what was said before the first
    /// measurement and waits for it.
    ///
    /// # Errors
    /// `out` fails; nothing can be written afterwards.
    pub fn flush(&mut self) -> Result<(), RecordingError> {
        if self.log_time.is_waiting() {
            return Ok(()); // nothing else is in the chunk
        }
        self.mcap.flush().map_err(write_error)?;
        self.open.clear();
        self.open_gaps.clear();
        self.open_bytes = 0;
        self.safe = self.written.get();
        Ok(())
    }

    /// Writes index and end.
    ///
    /// # Errors
    /// `out` fails: the file ends after its last whole chunk.
    pub fn finish(mut self) -> Result<(), RecordingError> {
        let time_ns = self.log_time.at_last();
        self.append_waiting(time_ns)?;
        self.mcap.finish().map_err(write_error)?;
        self.mcap.into_inner().flush().map_err(RecordingError::Io)
    }
}

impl<W: Write + Seek> std::fmt::Debug for Writer<W> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Writer").field("channels", &self.channels).finish_non_exhaustive()
    }
}

/// Counts what is written.
struct Counted<W> {
    out: W,
    written: Rc<Cell<u64>>,
}

impl<W: Write> Write for Counted<W> {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        let count = self.out.write(bytes)?;
        self.written.set(self.written.get() + count as u64);
        Ok(count)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.out.flush()
    }
}

impl<W: Seek> Seek for Counted<W> {
    fn seek(&mut self, to: SeekFrom) -> std::io::Result<u64> {
        self.out.seek(to)
    }
}

fn write_error(error: mcap::McapError) -> RecordingError {
    match error {
        mcap::McapError::Io(error) => RecordingError::Io(error),
        other => RecordingError::Container { message: other.to_string() },
    }
}
