//! The files of a run: `<site>-<run>.000.mcap`, `.001.mcap` and so on, one per start of the recorder.

use std::fs::File;
use std::io::{BufReader, BufWriter};
use std::path::{Path, PathBuf};

use common::config::ChainConfig;
use common::recording::container::{Description, Reader, Writer};
use common::recording::{RecordedRef, RecordingError};

/// A recording being written.
pub type PartWriter = Writer<BufWriter<File>>;

/// Where the files of one run are.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Run {
    directory: PathBuf,
    stem: String,
}

impl Run {
    /// The run `id` of a chain.
    pub fn new(config: &ChainConfig, id: &str) -> Self {
        Self { directory: PathBuf::from(&config.recorder.directory), stem: format!("{}-{id}", config.site.name) }
    }

    /// The file with this number.
    pub fn part(&self, number: u32) -> PathBuf {
        self.directory.join(format!("{}.{number:03}.mcap", self.stem))
    }

    /// The files that there are already, in order.
    pub fn earlier_parts(&self) -> Vec<PathBuf> {
        (0..u32::MAX).map(|number| self.part(number)).take_while(|path| path.exists()).collect()
    }

    /// Begins the next file.
    ///
    /// # Errors
    /// The folder or the file cannot be made or written.
    pub fn create_part(
        &self,
        config: &ChainConfig,
        description: &Description,
    ) -> Result<(PathBuf, PartWriter), RecordingError> {
        let path = self.part(description.part);
        let opening = |cause| RecordingError::Open { path: path.clone(), cause };
        std::fs::create_dir_all(&self.directory).map_err(opening)?;
        let file = File::create_new(&path).map_err(opening)?;
        let chunk_bytes = u64::from(config.recorder.chunk_kib) * 1024;
        let begun = Writer::new(BufWriter::new(file), &config.site.name, description, chunk_bytes);
        match begun.and_then(|mut writer| writer.flush().map(|()| writer)) {
            Ok(writer) => Ok((path, writer)),
            Err(error) => {
                let _ = std::fs::remove_file(&path); // an empty file is no recording
                Err(opening(std::io::Error::other(error.to_string())))
            }
        }
    }
}

/// Gives every whole message of a file to `take`. A file that is cut or damaged ends there.
///
/// # Errors
/// The file cannot be opened.
pub fn read_whole(path: &Path, mut take: impl FnMut(RecordedRef<'_>)) -> Result<(), RecordingError> {
    let file = File::open(path).map_err(|cause| RecordingError::Open { path: path.to_path_buf(), cause })?;
    for message in Reader::new(BufReader::with_capacity(1 << 20, file)).map_while(Result::ok) {
        take(message.by_ref());
    }
    Ok(())
}
