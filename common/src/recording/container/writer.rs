//! Writing a container.

use std::cell::Cell;
use std::collections::BTreeMap;
use std::io::{Seek, SeekFrom, Write};
use std::rc::Rc;

use mcap::records::{MessageHeader, Metadata};

use super::{COUNTS, DESCRIPTION, Description, ENCODING, GAP_SCHEMA, GAPS, encode, schema};
use crate::recording::{Gap, GapReason, RecordedRef, RecordingError};
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
    /// Measurement time of the last message that has one, ns UTC; 0 before the first.
    time_ns: u64,
    /// What came before any measurement time was known: it gets the first one, so that no file begins in 1970.
    early: Vec<Early>,
    written: Rc<Cell<u64>>,
    /// Bytes up to the end of the last whole chunk.
    safe: u64,
}

/// A message without a time.
struct Early {
    channel_id: u16,
    seq: u64,
    payload: Vec<u8>,
}

/// Messages that wait for the first measurement time.
const MOST_EARLY: usize = 1000;

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
            time_ns: 0,
            early: Vec::new(),
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
        if message.time_ns() > 0 {
            self.time_ns = message.time_ns();
            self.append_early()?;
        }
        self.append(self.channels[message.topic() as usize], message.seq())
    }

    /// Appends the note that messages are missing here.
    ///
    /// # Errors
    /// As [`Writer::write`].
    pub fn write_gap(&mut self, gap: &Gap) -> Result<(), RecordingError> {
        self.open_gaps.push(*gap);
        self.payload = serde_json::to_vec(gap).map_err(std::io::Error::from)?;
        self.append(self.gaps, gap.first_seq)
    }

    /// Appends the payload with the measurement time, once there is one.
    fn append(&mut self, channel_id: u16, seq: u64) -> Result<(), RecordingError> {
        if self.time_ns == 0 && self.early.len() < MOST_EARLY {
            self.early.push(Early { channel_id, seq, payload: self.payload.clone() });
            return Ok(());
        }
        self.append_now(channel_id, seq)
    }

    fn append_early(&mut self) -> Result<(), RecordingError> {
        if self.early.is_empty() {
            return Ok(());
        }
        let payload = std::mem::take(&mut self.payload);
        for early in std::mem::take(&mut self.early) {
            self.payload = early.payload;
            self.append_now(early.channel_id, early.seq)?;
        }
        self.payload = payload;
        Ok(())
    }

    fn append_now(&mut self, channel_id: u16, seq: u64) -> Result<(), RecordingError> {
        let time_ns = self.time_ns;
        let header = MessageHeader { channel_id, sequence: seq as u32, log_time: time_ns, publish_time: time_ns };
        self.open_bytes += self.payload.len() as u64;
        self.mcap.write_to_known_channel(&header, &self.payload).map_err(write_error)?;
        if self.open_bytes >= self.chunk_bytes { self.flush() } else { Ok(()) }
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

    /// Closes the chunk, so that everything so far survives the end of the process.
    ///
    /// # Errors
    /// `out` fails; nothing can be written afterwards.
    pub fn flush(&mut self) -> Result<(), RecordingError> {
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
        self.append_early()?;
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::health::{Health, HealthHeader};
    use crate::plots::PlotsHeader;

    #[test]
    fn a_recording_begins_with_its_first_measurement() {
        const FIRST_NS: u64 = 1_767_225_600_000_000_000;
        let mut file = std::io::Cursor::new(Vec::new());
        let mut writer = Writer::new(&mut file, &Description::default(), "", 1 << 20).expect("a container");
        let header = |seq| HealthHeader { session: 1, seq };
        writer.write(RecordedRef::HealthReports(&header(0), &[Health::default()])).expect("written");
        writer.flush().expect("written");
        let plots = PlotsHeader { time_ns: FIRST_NS, ..PlotsHeader::default() };
        writer.write(RecordedRef::Plots(&plots, &[])).expect("written");
        writer.write(RecordedRef::HealthReports(&header(1), &[Health::default()])).expect("written");
        writer.finish().expect("written");
        let file = file.into_inner();
        let summary = mcap::Summary::read(&file).expect("a whole file").expect("with a summary");
        let stats = summary.stats.expect("statistics");
        assert_eq!((stats.message_start_time, stats.message_end_time), (FIRST_NS, FIRST_NS));
        assert_eq!(stats.message_count, 3);
    }
}
