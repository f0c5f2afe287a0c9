//! Why a recording cannot be used at all. Each is one line for the user, exit code 2.

use std::path::PathBuf;

/// Bad records are not errors: they are counted and the rest is used.
#[derive(Debug, thiserror::Error)]
pub enum SourceError {
    /// No file is configured.
    #[error("key `plot_source.file` is empty, expected an ASTERIX recording (--set plot_source.file=FILE)")]
    NoFile,
    /// The file cannot be read.
    #[error("cannot read {}: {cause}", path.display())]
    Read {
        /// Which file.
        path: PathBuf,
        /// Why.
        cause: std::io::Error,
    },
    /// There is not one readable block in the file.
    #[error("{} is not an ASTERIX recording with category 010: no readable record in {bytes} bytes", path.display())]
    NotAsterix {
        /// Which file.
        path: PathBuf,
        /// Its size.
        bytes: usize,
    },
    /// There is no start-of-update-cycle message, so scans cannot be told apart.
    #[error("{} holds no start-of-update-cycle message: scans cannot be told apart", path.display())]
    NoCycle {
        /// Which file.
        path: PathBuf,
    },
}
