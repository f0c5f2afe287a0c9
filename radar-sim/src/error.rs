//! Why a scenario cannot be simulated.

/// Mistakes in a scenario that only show when its files are read.
#[derive(Debug, thiserror::Error)]
pub enum SimError {
    /// A recorded flight cannot be read.
    #[error("target `{target}`: cannot read flight {file}: {reason}")]
    Flight {
        /// Name of the target.
        target: String,
        /// The CSV file.
        file: String,
        /// Why, and what was expected.
        reason: String,
    },
}
