//! Why a recording cannot be used at all. Each is one line for the user, exit code 2.

use std::path::PathBuf;

/// Bad records are not errors: they are counted and the rest is used.
#[derive(Debug, thiserror::Error)]
pub enum SourceError {
    /// No file is configured.
    #[error("key `plot_source.file` is empty, expected an ASTERIX recording (--set plot_source.file=FILE)")]
    NoFile,
    /// An edition is configured that is not known.
    #[error("key `plot_source.editions`: {0}")]
    Edition(#[from] asterix::editions::EditionError),
    /// The file cannot be read.
    #[error("cannot read {}: {cause}", path.display())]
    Read {
        /// Which file.
        path: PathBuf,
        /// Why.
        cause: std::io::Error,
    },
    /// What is named is no file.
    #[error(
        "key `plot_source.file` is `{name}`, expected the name of a file: key `plot_source.listen` takes sources on a network"
    )]
    NotAFile {
        /// What was named.
        name: String,
    },
    /// A recording is to be scored by a sensor on a network.
    #[error("key `plot_source.truth` is `{name}`, expected the name of a file as for `plot_source.file`")]
    TruthNotAFile {
        /// What was named.
        name: String,
    },
    /// There is not one readable record in the file.
    #[error("{} is not an ASTERIX recording with category 001, 010 or 048: {found}", path.display())]
    NotAsterix {
        /// Which file.
        path: PathBuf,
        /// What was found.
        found: String,
    },
    /// It is a table of plots, but not one line holds a plot.
    #[error("{} is a table of plots without a plot: {why}", path.display())]
    NoRow {
        /// Which file.
        path: PathBuf,
        /// What is wrong with the first line.
        why: String,
    },
    /// The records of the file are of other sensors than the site's, or of several that could be it.
    #[error("{} holds records of {found}: expected those of one sensor, named by keys `site.sac` and `site.sic`", path.display())]
    WhichSource {
        /// Which file.
        path: PathBuf,
        /// Sensors with their records.
        found: String,
    },
    /// There is nothing to tell scans apart by.
    #[error(
        "{} holds no start-of-update-cycle message or north marker with a time, and its reports do not turn evenly: \
         scans cannot be told apart",
        path.display()
    )]
    NoCycle {
        /// Which file.
        path: PathBuf,
    },
}
