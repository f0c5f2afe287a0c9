//! What is missing, by topic and consumer, from positions alone.
//!
//! `seq` is the position of a message in the schedule of its stream. What the recorder itself
//! misses shows as gaps of `seq`. What a stage missed shows in the [`Lineage`] of its results:
//!
//! ```text
//! lost = (last − last of the result before) − taken
//! ```
//!
//! summed over successive results, whoever failed to deliver it: a full queue, a stage that
//! died with messages in its hands, or a source that stood still. A result that the
//! recorder missed hides its lineage: after a gap only what is missing inside the
//! result is counted.

use std::collections::BTreeMap;

use common::health::Intake;
use common::ipc::count_intake;
use common::message::Lineage;
use common::recording::RecordedRef;
use common::services::{TOPIC_NAMES, TOPICS, Topic};

/// Name of the consumer that the recorder itself is.
const RECORDER: &str = "recorder";
/// What was received but could not be written.
const RECORDING: &str = "recording";

/// The fold of positions.
#[derive(Debug, Default)]
pub(crate) struct Losses {
    streams: [Stream; TOPICS],
    extractor: Lineages,
    tracker: Lineages,
    unwritten: [u64; TOPICS],
}

#[derive(Debug, Default, Clone, Copy)]
struct Stream {
    intake: Intake,
    session: u64,
    elements: u64,
}

/// Lineages of one stage's results.
#[derive(Debug, Default, Clone, Copy)]
struct Lineages {
    last_seq: Option<u64>,
    lost: u64,
}

impl Losses {
    /// Notes a message; health has a schedule per process and is never counted as lost.
    pub(crate) fn take(&mut self, message: RecordedRef<'_>) {
        let topic = message.topic();
        let stream = &mut self.streams[topic as usize];
        stream.elements += message.len() as u64;
        if topic == Topic::Health {
            stream.intake.received += 1;
            return;
        }
        let restarts = stream.intake.restarts;
        let missing = count_intake(&mut stream.intake, &mut stream.session, message.session(), message.seq());
        // Between two sessions the stage itself was away: its lineage tells what it missed.
        let hidden = missing > 0 && stream.intake.restarts == restarts;
        match message {
            RecordedRef::Plots(header, _) => self.extractor.take(&header.lineage, hidden),
            RecordedRef::Tracks(header, _) => self.tracker.take(&header.lineage, hidden),
            _ => {}
        }
    }

    /// Notes messages that could not be written to the recording.
    pub(crate) fn not_written(&mut self, topic: Topic, count: u64) {
        self.unwritten[topic as usize] += count;
    }

    /// Messages received, by topic.
    pub(crate) fn received(&self, topic: Topic) -> u64 {
        self.streams[topic as usize].intake.received
    }

    /// What the recorder knows of a topic, for its health.
    pub(crate) fn intake(&self, topic: Topic) -> Intake {
        self.streams[topic as usize].intake
    }

    /// Messages received, by name of the topic.
    pub(crate) fn messages(&self) -> BTreeMap<String, u64> {
        let counts = TOPIC_NAMES.iter().zip(&self.streams);
        counts.map(|(name, stream)| ((*name).to_string(), stream.intake.received)).collect()
    }

    /// Whether a stage began a new session in the run.
    pub(crate) fn restarted(&self) -> bool {
        self.streams.iter().any(|stream| stream.intake.restarts > 0)
    }

    /// Messages lost by topic and consumer; topics nobody sent on are left out.
    pub(crate) fn lost(&self) -> BTreeMap<String, BTreeMap<String, u64>> {
        let mut lost: BTreeMap<String, BTreeMap<String, u64>> = BTreeMap::new();
        let mut note = |topic: &str, consumer: &str, count: u64| {
            lost.entry(topic.to_string()).or_default().insert(consumer.to_string(), count);
        };
        for (index, stream) in self.streams.iter().enumerate() {
            if index != Topic::Health as usize && stream.intake.received > 0 {
                note(TOPIC_NAMES[index], RECORDER, stream.intake.lost);
            }
            if self.unwritten[index] > 0 {
                note(TOPIC_NAMES[index], RECORDING, self.unwritten[index]);
            }
        }
        if self.extractor.last_seq.is_some() {
            note(Topic::Dwells.name(), "plot-extractor", self.extractor.lost);
        }
        if self.tracker.last_seq.is_some() {
            note(Topic::Plots.name(), "tracker", self.tracker.lost);
        }
        lost
    }
}

impl Lineages {
    fn take(&mut self, lineage: &Lineage, hidden: bool) {
        if lineage.session == 0 || lineage.taken == 0 {
            return; // made from nothing upstream
        }
        let before = match self.last_seq {
            Some(last) if !hidden && last < lineage.last_seq => last + 1,
            _ => lineage.first_seq,
        };
        self.lost += (lineage.last_seq + 1).saturating_sub(before).saturating_sub(lineage.taken);
        self.last_seq = Some(lineage.last_seq);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::tracks::TracksHeader;

    fn tracks(session: u64, seq: u64, first: u64, last: u64, taken: u64) -> TracksHeader {
        let lineage = Lineage { session: 9, first_seq: first, last_seq: last, taken };
        TracksHeader { session, seq, lineage, ..TracksHeader::default() }
    }

    fn lost(headers: &[TracksHeader]) -> (u64, u64) {
        let mut losses = Losses::default();
        for header in headers {
            losses.take(RecordedRef::Tracks(header, &[]));
        }
        let lost = losses.lost();
        (lost["plots"]["tracker"], lost["tracks"]["recorder"])
    }

    #[test]
    fn a_whole_stream_loses_nothing() {
        assert_eq!(lost(&[tracks(1, 0, 0, 0, 1), tracks(1, 1, 1, 3, 3), tracks(1, 2, 4, 4, 1)]), (0, 0));
    }

    #[test]
    fn a_dropped_plots_message_is_the_trackers_loss() {
        assert_eq!(lost(&[tracks(1, 0, 0, 0, 1), tracks(1, 1, 1, 4, 2), tracks(1, 2, 6, 6, 1)]), (3, 0));
    }

    #[test]
    fn a_tracker_that_died_with_messages_in_its_hands_lost_them() {
        assert_eq!(lost(&[tracks(1, 0, 0, 0, 1), tracks(2, 4, 4, 4, 1)]), (3, 3));
    }

    #[test]
    fn what_the_recorder_missed_is_not_the_trackers_loss() {
        assert_eq!(lost(&[tracks(1, 0, 0, 0, 1), tracks(1, 4, 4, 4, 1), tracks(1, 5, 5, 6, 1)]), (1, 3));
    }
}
