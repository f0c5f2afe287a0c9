//! What is missing, by topic and consumer, from positions and counts.
//!
//! `seq` is the position of a message in the schedule of its stream; the [`Lineage`] of a
//! result counts what its stage has taken and published in its session. Between two
//! results, whatever the recorder missed meanwhile,
//!
//! ```text
//! lost by the stage     = positions passed upstream − messages taken
//! lost by the recorder  = results published − results received
//! ```
//!
//! Both counts begin anew with a session, and positions at the start of the schedule, so that
//! also what came before the first result is told. Only where a stage and the recorder were away
//! together, what the stage took in its last moments counts as lost by the stage.

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
    /// Next position upstream.
    next_seq: u64,
    /// Session and counts of the last result.
    last: Option<(u64, Lineage)>,
    lost_upstream: u64,
    lost_results: u64,
}

impl Losses {
    /// Nothing seen yet of streams whose schedules begin at these positions.
    pub(crate) fn new(first_dwell: u64, first_sector: u64) -> Self {
        let from = |next_seq| Lineages { next_seq, ..Lineages::default() };
        Self { extractor: from(first_dwell), tracker: from(first_sector), ..Self::default() }
    }

    /// Notes a message; health has a schedule per process and is never counted as lost.
    pub(crate) fn take(&mut self, message: RecordedRef<'_>) {
        let topic = message.topic();
        let stream = &mut self.streams[topic as usize];
        stream.elements += message.len() as u64;
        if topic == Topic::Health {
            stream.intake.received += 1;
            return;
        }
        count_intake(&mut stream.intake, &mut stream.session, message.session(), message.seq());
        let lineages = match message {
            RecordedRef::Plots(header, _) => self.extractor.take(header.session, &header.lineage),
            RecordedRef::Tracks(header, _) => self.tracker.take(header.session, &header.lineage),
            _ => return,
        };
        stream.intake.lost = lineages;
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
        if self.extractor.has_upstream() {
            note(Topic::Dwells.name(), "plot-extractor", self.extractor.lost_upstream);
        }
        if self.tracker.has_upstream() {
            note(Topic::Plots.name(), "tracker", self.tracker.lost_upstream);
        }
        lost
    }
}

impl Lineages {
    /// Notes a result and gives how many have been lost on their way to the recorder so far.
    fn take(&mut self, session: u64, lineage: &Lineage) -> u64 {
        let last = self.last.filter(|&(last_session, _)| last_session == session).map(|(_, lineage)| lineage);
        let (taken, published) = last.map_or((0, 0), |last| (last.taken_in_session, last.published_before + 1));
        self.lost_results += lineage.published_before.saturating_sub(published);
        if lineage.session != 0 {
            let passed = (lineage.last_seq.saturating_add(1)).saturating_sub(self.next_seq);
            self.lost_upstream += passed.saturating_sub(lineage.taken_in_session.saturating_sub(taken));
            self.next_seq = lineage.last_seq.saturating_add(1);
        }
        self.last = Some((session, *lineage));
        self.lost_results
    }

    /// Whether the results are made from messages of another process.
    fn has_upstream(&self) -> bool {
        self.last.is_some_and(|(_, lineage)| lineage.session != 0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::tracks::TracksHeader;

    /// A tracks message: session, position, plots taken in the session, tracks published before.
    fn tracks(session: u64, seq: u64, taken_in_session: u64, published_before: u64) -> TracksHeader {
        let lineage =
            Lineage { session: 9, first_seq: seq, last_seq: seq, taken: 1, taken_in_session, published_before };
        TracksHeader { session, seq, lineage, ..TracksHeader::default() }
    }

    /// Plots lost by the tracker, tracks lost by the recorder.
    fn lost(headers: &[TracksHeader]) -> (u64, u64) {
        let mut losses = Losses::new(0, 0);
        for header in headers {
            losses.take(RecordedRef::Tracks(header, &[]));
        }
        let lost = losses.lost();
        (lost["plots"]["tracker"], lost["tracks"]["recorder"])
    }

    #[test]
    fn a_whole_stream_loses_nothing() {
        assert_eq!(lost(&[tracks(1, 0, 1, 0), tracks(1, 1, 2, 1), tracks(1, 2, 3, 2)]), (0, 0));
    }

    #[test]
    fn dropped_plots_are_the_trackers_loss_also_before_its_first_result() {
        assert_eq!(lost(&[tracks(1, 2, 1, 0), tracks(1, 6, 2, 1)]), (2 + 3, 0));
    }

    #[test]
    fn a_tracker_that_died_lost_what_it_had_in_its_hands() {
        assert_eq!(lost(&[tracks(1, 0, 1, 0), tracks(2, 4, 1, 0)]), (3, 0));
    }

    #[test]
    fn what_the_recorder_missed_is_not_the_trackers_loss() {
        assert_eq!(lost(&[tracks(1, 0, 1, 0), tracks(1, 4, 5, 4), tracks(1, 6, 6, 5)]), (1, 3));
    }

    #[test]
    fn a_recorder_that_comes_late_knows_what_it_has_missed() {
        assert_eq!(lost(&[tracks(1, 20, 21, 20), tracks(1, 21, 22, 21)]), (0, 20));
    }
}
