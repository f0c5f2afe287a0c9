//! Batch runs: recorded dwells in, plots out, no shared memory.

use std::io::Write;

use common::plots::PlotsHeader;
use common::recording::jsonl::Writer;
use common::recording::{Recorded, RecordedRef, RecordingError};

use crate::PlotExtractor;

/// What a batch run did.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
pub struct Summary {
    /// Dwells taken.
    pub dwells: u64,
    /// Dwells not used, of any reason.
    pub rejected: u64,
    /// Plots found.
    pub plots: u64,
}

/// Runs all dwells of `messages` through the extractor and writes its plots; other topics are passed over.
///
/// # Errors
/// A message cannot be read, or `out` fails.
pub fn replay<W: Write>(
    messages: impl Iterator<Item = Result<Recorded, RecordingError>>,
    extractor: &mut PlotExtractor,
    out: &mut Writer<W>,
) -> Result<Summary, RecordingError> {
    let mut summary = Summary::default();
    for message in messages {
        let Recorded::Dwells(header, amplitudes) = message? else { continue };
        let session = header.session;
        let reject = extractor.take(&header, &amplitudes, 0, |header, plots| {
            summary.plots += plots.len() as u64;
            out.write(RecordedRef::Plots(&PlotsHeader { session, ..*header }, plots))
        })?;
        summary.dwells += 1;
        summary.rejected += u64::from(reject.is_some());
    }
    Ok(summary)
}
