//! Batch runs: recorded plots in, recorded tracks out, no shared memory.

use std::convert::Infallible;
use std::io::Write;

use common::recording::jsonl::Writer;
use common::recording::{Recorded, RecordedRef, RecordingError};
use common::time::monotonic_ns;
use common::tracks::{Track, TracksHeader};

use crate::orders::Orders;
use crate::process::header_of;
use crate::tracker::Tracker;

/// What a batch run did.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
pub struct Summary {
    /// Plots messages taken.
    pub messages: u64,
    /// Scans among them.
    pub scans: u64,
    /// Plots in them.
    pub plots: u64,
    /// Input rejected, of any reason.
    pub rejected: u64,
    /// Time spent in the tracker itself, ns.
    pub tracker_ns: u64,
    /// Number of the last track that was started, from 1.
    pub tracks: u64,
}

/// Runs all plots of `messages` through the tracker, with `orders` between them, and writes its tracks; other topics are
/// passed over.
///
/// # Errors
/// A message cannot be read, or `out` fails.
pub fn replay<W: Write>(
    messages: impl Iterator<Item = Result<Recorded, RecordingError>>,
    tracker: &mut Tracker,
    mut orders: Orders,
    out: &mut Writer<W>,
) -> Result<Summary, RecordingError> {
    let mut summary = Summary::default();
    let mut tracks: Vec<Track> = Vec::new();
    let mut scan = None;
    for message in messages {
        let Recorded::Plots(header, plots) = message? else { continue };
        let begin_ns = monotonic_ns();
        let Ok(()) = orders.carry_out(tracker, &header, |_, _, _| Ok::<_, Infallible>(()));
        let processed = tracker.process_plots(&header, &plots, &mut tracks);
        summary.tracker_ns += monotonic_ns() - begin_ns;
        summary.plots += plots.len() as u64;
        summary.rejected += processed.rejected.total();
        summary.scans += u64::from(scan != Some((header.session, header.scan)));
        scan = Some((header.session, header.scan));
        summary.tracks = tracks.iter().map(|track| track.id).max().unwrap_or(0).max(summary.tracks);
        let tracks_header =
            TracksHeader { session: header.session, ..header_of(&header, &processed, summary.messages, 0) };
        summary.messages += 1;
        out.write(RecordedRef::Tracks(&tracks_header, &tracks))?;
    }
    Ok(summary)
}
