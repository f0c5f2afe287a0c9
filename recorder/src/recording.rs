//! The recording of a run being written: its parts, their rotation, and what becomes of it when the disk is full.
//!
//! ```text
//! writing ──error──▶ interrupted: counts what is not written, tries again every 3 s ──▶ a new part, which begins
//!    │                                                                                  with the gaps
//!    └──size or age──▶ the next part; the oldest files go when all together are too large
//! ```

use std::fs::File;
use std::io::{BufWriter, Seek, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use common::config::{ChainConfig, RecorderConfig};
use common::recording::container::{Description, Writer};
use common::recording::{Gap, GapReason, RecordedRef, RecordingError, part_name, parts_of};
use tracing::{info, warn};

use crate::fold::Files;
use crate::retention::Retention;

/// What has been written is on its way to the disk after this time at the latest.
const FLUSH_INTERVAL: Duration = Duration::from_secs(1);
/// Pause before the next attempt after writing has failed.
const RETRY_INTERVAL: Duration = Duration::from_secs(3);
/// Gaps that are kept for the report.
pub(crate) const LISTED_GAPS: usize = 1000;

/// A run's recording.
#[derive(Debug)]
pub struct Recording {
    directory: PathBuf,
    stem: String,
    description: Description,
    limits: Limits,
    part: Option<Part>,
    /// When to try again after writing has failed.
    retry_at: Option<Instant>,
    /// Gaps that no file tells of yet.
    pending: Vec<Gap>,
    /// Messages that have not been written since [`Recording::take_unwritten`].
    unwritten: Vec<Gap>,
    retention: Retention,
    files: Files,
    failed: bool,
}

#[derive(Debug, Clone, Copy)]
struct Limits {
    chunk_bytes: u64,
    part_bytes: u64,
    part_age: Duration,
}

/// The file being written.
#[derive(Debug)]
struct Part {
    path: PathBuf,
    writer: Writer<BufWriter<File>>,
    began: Instant,
    flushed: Instant,
    /// Bytes before its first message.
    start: u64,
}

impl Limits {
    fn new(config: &RecorderConfig) -> Self {
        let unlimited = |value: u32, unit: u64| if value == 0 { u64::MAX } else { u64::from(value) * unit };
        let part_mib = config.part_mib();
        if part_mib != config.rotate_mib {
            info!("a new part begins at {part_mib} MiB, half of recorder.total_mib");
        }
        Self {
            chunk_bytes: u64::from(config.chunk_kib) << 10,
            part_bytes: unlimited(part_mib, 1 << 20),
            part_age: Duration::from_secs(unlimited(config.rotate_s, 1)),
        }
    }
}

impl Recording {
    /// The recording of the run `id`, of which no file is written yet.
    pub fn new(config: &ChainConfig, id: &str, session: u64) -> Self {
        let description = Description {
            site: config.site.name.clone(),
            config: config.to_toml(),
            version: env!("CARGO_PKG_VERSION").to_string(),
            seed: config.run.seed,
            session,
            run: id.to_string(),
            part: 0,
        };
        Self {
            directory: PathBuf::from(&config.recorder.directory),
            stem: format!("{}-{id}", config.site.name),
            description,
            limits: Limits::new(&config.recorder),
            part: None,
            retry_at: None,
            pending: Vec::new(),
            unwritten: Vec::new(),
            retention: Retention::new(&config.site.name, config.recorder.total_mib),
            files: Files::default(),
            failed: false,
        }
    }

    /// The files of the run that there are already, in order.
    pub fn earlier_parts(&self) -> Vec<PathBuf> {
        parts_of(&self.directory, &self.stem).into_iter().map(|(_, path)| path).collect()
    }

    /// Begins the first part that this recorder writes; `counts` is what the run has counted so far.
    ///
    /// # Errors
    /// The folder or the file cannot be made or written.
    pub fn begin(&mut self, counts: &str) -> Result<(), RecordingError> {
        let last = parts_of(&self.directory, &self.stem).last().map(|&(number, _)| number);
        self.description.part = last.map_or(0, |number| number + 1);
        self.files.parts = self.description.part;
        self.begin_part(counts)
    }

    /// Goes on without a file for now and tries again later.
    pub fn interrupt(&mut self, error: &RecordingError) {
        warn!("the recording is interrupted, the chain goes on: {error}");
        self.failed = true;
        self.retry_at = Some(Instant::now() + RETRY_INTERVAL);
    }

    fn begin_part(&mut self, counts: &str) -> Result<(), RecordingError> {
        let path = self.directory.join(part_name(&self.stem, self.description.part));
        let opening = |cause| RecordingError::Open { path: path.clone(), cause };
        std::fs::create_dir_all(&self.directory).map_err(opening)?;
        let file = File::create_new(&path).map_err(opening)?;
        match Writer::new(BufWriter::new(file), &self.description, counts, self.limits.chunk_bytes) {
            Ok(writer) => {
                let (now, start) = (Instant::now(), writer.bytes());
                self.files.last = Some(path.display().to_string());
                self.files.parts = self.description.part + 1;
                self.retention.look(&self.directory, &path);
                self.part = Some(Part { path, writer, began: now, flushed: now, start });
                self.keep_total();
                Ok(())
            }
            Err(error) => {
                let _ = std::fs::remove_file(&path); // an empty file is no recording
                Err(opening(std::io::Error::other(error.to_string())))
            }
        }
    }

    /// Removes the oldest files while all together are over the limit, but never the one being written.
    fn keep_total(&mut self) {
        let own = self.part.as_ref().map_or(0, |part| part.writer.bytes());
        self.files.removed += self.retention.keep(own);
    }

    /// Closes the chunk, begins the next part or tries again where that is due. To be called before a message
    /// is counted: `counts` goes into the part that begins with it.
    pub fn keep_up(&mut self, counts: impl FnOnce() -> String) {
        self.keep_up_at(Instant::now(), counts);
    }

    fn keep_up_at(&mut self, now: Instant, counts: impl FnOnce() -> String) {
        let Some(part) = &mut self.part else {
            if self.retry_at.is_some_and(|at| now >= at) {
                self.retry_at = Some(now + RETRY_INTERVAL);
                self.resume(&counts());
            }
            return;
        };
        let has_messages = part.writer.safe_bytes() > part.start;
        if has_messages
            && (part.writer.bytes() >= self.limits.part_bytes
                || now.saturating_duration_since(part.began) >= self.limits.part_age)
        {
            if self.close_part()
                && let Err(error) = self.begin_part(&counts())
            {
                self.interrupt(&error);
            }
        } else if now.saturating_duration_since(part.flushed) >= FLUSH_INTERVAL {
            part.flushed = now;
            self.keep_writing(Writer::flush);
        }
        self.keep_total();
    }

    /// Begins a new part after writing has failed, with what is missing.
    fn resume(&mut self, counts: &str) {
        if self.begin_part(counts).is_err() {
            return; // said when it began
        }
        self.retry_at = None;
        for gap in std::mem::take(&mut self.pending) {
            self.write_gap(gap);
        }
        if let Some(part) = &self.part {
            info!("the recording goes on in {}", part.path.display());
        }
    }

    /// Appends a message.
    pub fn write(&mut self, message: RecordedRef<'_>) {
        if self.part.is_some() {
            self.keep_writing(|writer| writer.write(message));
        } else {
            self.lose(Gap::of(message, GapReason::Disk));
        }
    }

    /// Appends the note that messages are missing here.
    pub fn write_gap(&mut self, gap: Gap) {
        if self.part.is_some() {
            self.list(&gap);
            self.keep_writing(|writer| writer.write_gap(&gap));
        } else {
            self.remember(gap);
        }
    }

    /// Lists a gap that an earlier part tells of.
    pub fn list(&mut self, gap: &Gap) {
        if self.files.gaps.len() < LISTED_GAPS {
            self.files.gaps.push(*gap);
        }
    }

    fn lose(&mut self, gap: Gap) {
        self.unwritten.push(gap);
        self.remember(gap);
    }

    fn remember(&mut self, gap: Gap) {
        if !self.pending.iter_mut().any(|pending| pending.merge(&gap)) {
            self.pending.push(gap);
        }
    }

    /// Messages that have been received and could not be written since the last call.
    pub fn take_unwritten(&mut self) -> impl Iterator<Item = Gap> {
        std::mem::take(&mut self.unwritten).into_iter()
    }

    /// Does something with the part being written. When that fails, the part ends with its last whole chunk.
    fn keep_writing(&mut self, write: impl FnOnce(&mut Writer<BufWriter<File>>) -> Result<(), RecordingError>) {
        let Some(part) = &mut self.part else { return };
        let Err(error) = write(&mut part.writer) else { return };
        self.interrupt(&error);
        let Some(Part { path, writer, start, .. }) = self.part.take() else { return };
        let (safe, messages, gaps) = (writer.safe_bytes(), writer.unsaved().to_vec(), writer.unsaved_gaps().to_vec());
        drop(writer); // which still tries to write an end
        self.files.gaps.retain(|gap| !gaps.contains(gap));
        for gap in gaps {
            self.remember(gap);
        }
        for gap in messages {
            self.lose(gap);
        }
        if safe > start {
            cut(&path, safe);
            self.description.part += 1;
        } else if let Err(error) = std::fs::remove_file(&path) {
            warn!("{} holds nothing and cannot be removed: {error}", path.display());
            self.description.part += 1;
        }
    }

    /// Closes the part being written; whether there still is one once its messages are in the file.
    fn close_part(&mut self) -> bool {
        self.keep_writing(Writer::flush);
        let Some(Part { path, writer, .. }) = self.part.take() else { return false };
        self.description.part += 1;
        if let Err(error) = close(&path, writer) {
            warn!("{} has no index, its messages are whole: {error}", path.display());
            self.failed = true;
        }
        true
    }

    /// Whether anything was not written.
    pub fn has_failed(&self) -> bool {
        self.failed
    }

    /// Closes the part being written.
    pub fn finish(&mut self, counts: impl FnOnce() -> String) -> Files {
        if self.part.is_none() && self.retry_at.is_some() {
            self.resume(&counts()); // the last chance to say what is missing
        }
        self.close_part();
        for gap in std::mem::take(&mut self.pending) {
            self.list(&gap);
        }
        std::mem::take(&mut self.files)
    }
}

/// Writes the end of a part. Where that fails, the file ends with its last whole chunk.
fn close<W: Write + Seek>(path: &Path, writer: Writer<W>) -> Result<(), RecordingError> {
    let safe = writer.safe_bytes();
    writer.finish().inspect_err(|_| cut(path, safe))
}

/// Cuts off what follows the last whole chunk.
fn cut(path: &Path, safe: u64) {
    let cut = File::options().write(true).open(path).and_then(|file| file.set_len(safe));
    if let Err(error) = cut {
        warn!("{} ends with a broken record: {error}", path.display());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    use common::dwell::DwellHeader;
    use common::plots::PlotsHeader;

    use crate::verify::Verification;

    fn config(folder: &Path) -> ChainConfig {
        let mut config = ChainConfig::default();
        config.site.name = "north".into();
        config.recorder.directory = folder.display().to_string();
        (config.recorder.rotate_mib, config.recorder.rotate_s, config.recorder.total_mib) = (0, 0, 0);
        config.recorder.chunk_kib = 64;
        config
    }

    /// Writes a dwell of `kib` KiB that does not compress.
    fn write_noise(recording: &mut Recording, seq: u64, kib: usize) {
        let mut bits = seq ^ 0x9e37_79b9_7f4a_7c15;
        let mut next = || {
            bits = bits.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            f32::from_bits((bits >> 33) as u32)
        };
        let cells: Vec<f32> = (0..kib * 256).map(|_| next()).collect();
        let header = DwellHeader { seq, session: 3, time_ns: 1 + seq, ..DwellHeader::default() };
        recording.write(RecordedRef::Dwells(&header, &cells));
    }

    fn verify(parts: &[PathBuf]) -> (String, u64) {
        let mut verification = Verification::default();
        for part in parts {
            let bytes = std::fs::read(part).expect("a part");
            verification.file(&part.display().to_string(), bytes.len() as u64, bytes.as_slice());
        }
        verification.finish()
    }

    #[test]
    fn a_part_ends_at_its_age_but_not_before_and_not_empty() {
        let folder = tempfile::tempdir().expect("a folder");
        let mut config = config(folder.path());
        config.recorder.rotate_s = 60;
        let mut recording = Recording::new(&config, "1", 3);
        let before = Instant::now();
        recording.begin("").expect("a file");
        let age = Duration::from_secs(60);
        let just_before = before + Duration::new(59, 999_999_999);
        recording.keep_up_at(Instant::now() + age, String::new);
        assert_eq!(recording.earlier_parts().len(), 1, "a part without messages goes on");
        for part in 1..4_u64 {
            let header = PlotsHeader { seq: part - 1, session: 3, time_ns: part, ..PlotsHeader::default() };
            recording.write(RecordedRef::Plots(&header, &[]));
            recording.keep_writing(Writer::flush);
            if part == 1 {
                recording.keep_up_at(just_before, String::new);
                assert_eq!(recording.earlier_parts().len(), 1);
            }
            recording.keep_up_at(Instant::now() + age, String::new);
            assert_eq!(recording.earlier_parts().len() as u64, 1 + part);
        }
        assert_eq!(recording.finish(String::new).parts, 4);
        let (text, findings) = verify(&recording.earlier_parts());
        assert_eq!(findings, 0, "{text}");
    }

    #[test]
    fn a_part_ends_at_its_size() {
        let folder = tempfile::tempdir().expect("a folder");
        let mut config = config(folder.path());
        config.recorder.rotate_mib = 1;
        let mut recording = Recording::new(&config, "1", 3);
        recording.begin("").expect("a file");
        for seq in 0..30 {
            recording.keep_up(String::new);
            write_noise(&mut recording, seq, 128);
        }
        recording.finish(String::new);
        let parts = recording.earlier_parts();
        assert_eq!(parts.len(), 4, "30 times 128 KiB");
        for part in &parts[..3] {
            let bytes = std::fs::metadata(part).expect("a part").len();
            assert!((1 << 20..(1 << 20) + (192 << 10)).contains(&bytes), "{bytes}");
        }
        let (text, findings) = verify(&parts);
        assert_eq!(findings, 0, "{text}");
    }

    /// A file with room for so many bytes.
    struct Disk {
        file: File,
        room: usize,
    }

    impl Write for Disk {
        fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
            let fits = bytes.len().min(self.room);
            if fits == 0 && !bytes.is_empty() {
                return Err(std::io::ErrorKind::StorageFull.into());
            }
            let count = self.file.write(&bytes[..fits])?;
            self.room -= count;
            Ok(count)
        }

        fn flush(&mut self) -> std::io::Result<()> {
            self.file.flush()
        }
    }

    impl Seek for Disk {
        fn seek(&mut self, to: std::io::SeekFrom) -> std::io::Result<u64> {
            self.file.seek(to)
        }
    }

    #[test]
    fn an_end_that_finds_no_room_is_an_error_and_leaves_whole_chunks() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("north-1.000.mcap");
        let write = |room| {
            let disk = Disk { file: File::create(&path).expect("a file"), room };
            let mut writer = Writer::new(BufWriter::new(disk), &Description::default(), "", 1 << 20).expect("room");
            for seq in 0..10 {
                let header = PlotsHeader { seq, session: 3, time_ns: 1 + seq, ..PlotsHeader::default() };
                writer.write(RecordedRef::Plots(&header, &[])).expect("room");
            }
            writer.flush().expect("room");
            (writer.safe_bytes(), close(&path, writer))
        };
        let (safe, closed) = write(usize::MAX);
        closed.expect("room for the end");
        let whole = std::fs::metadata(&path).expect("a file").len();
        assert!(whole > safe + 100);
        for room in [safe, safe + 50, whole - 1] {
            let (safe, closed) = write(usize::try_from(room).expect("a length"));
            assert!(closed.is_err(), "room for {room} of {whole} bytes");
            assert_eq!(std::fs::metadata(&path).expect("a file").len(), safe);
            let bytes = std::fs::read(&path).expect("a file");
            assert_eq!(common::recording::container::Reader::new(bytes.as_slice()).flatten().count(), 10);
        }
    }
}
