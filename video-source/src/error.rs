//! Why a recording cannot be used at all. Each is one line for the user, exit code 2.

use std::path::PathBuf;

/// Bad spokes are not errors: they are counted and the rest is used.
#[derive(Debug, thiserror::Error)]
pub enum VideoError {
    /// No file is configured.
    #[error(
        "keys `video_source.file` and `video_source.listen` are empty, expected a recording of radar video or a place on a network (--set \
         video_source.file=FILE)"
    )]
    NoFile,
    /// The file cannot be read.
    #[error("cannot read {}: {cause}", path.display())]
    Read {
        /// Which file.
        path: PathBuf,
        /// Why.
        cause: std::io::Error,
    },
    /// There is not one spoke in the file.
    #[error("{} holds no radar video: {found} found, ASTERIX category 240 or spokes of a HALO radar expected", path.display())]
    NoVideo {
        /// Which file.
        path: PathBuf,
        /// What was found.
        found: String,
    },
    /// The spokes do not lie as the configuration says.
    #[error(
        "{} holds {found} spokes in a turn, key `radar.dwells_per_scan` says {expected} (--set radar.dwells_per_scan={found})",
        path.display()
    )]
    Spokes {
        /// Which file.
        path: PathBuf,
        /// As many as their spacing makes.
        found: u32,
        /// As many as are configured.
        expected: u32,
    },
}
