//! What is missing, by topic and consumer, from positions and counts.
//!
//! `seq` is the position of a message in the schedule of its stream; the [`Lineage`] of a
//! result counts what its stage has taken and published in its session. Between two
//! results, whatever the recorder missed meanwhile,
//!
//! ```text
//! lost by the stage     = positions passed upstream − messages taken − positions never sent
//! lost by the recorder  = results published − results received
//! ```
//!
//! Both counts begin anew with a session, and positions at the start of the schedule, so that
//! also what came before the first result is told; what came after the last one is told by the end of the [`Schedule`], by the
//! last health of the stages, and by other consumers of a topic. Positions never sent are known of topics that the recorder
//! gets itself; those of dwells, and of plots that a source publishes, count as lost by their consumers: the source that died had them
//! in hand. Only where a stage and the recorder were away together, what the stage took in its last moments counts as lost by the stage.
//!
//! The same counts tell what is missing before a message, live and in a recording, where it has to be
//! what the recorded [`Gap`]s say. Health repeats itself: its gaps are noted, but count as no loss.

use std::collections::BTreeMap;

use common::health::{Health, Intake};
use common::ipc::count_intake;
use common::message::Lineage;
use common::recording::{Gap, GapReason, RecordedRef};
use common::topic::{TOPICS, Topic};
use common::topology::{RECORDER, maker};
use serde::{Deserialize, Serialize};

use crate::books::Books;
use crate::schedule::Schedule;

/// What was received but could not be written.
const RECORDING: &str = "recording";

/// The fold of positions.
#[derive(Debug, Default, Serialize, Deserialize)]
pub(crate) struct Losses {
    schedule: Schedule,
    streams: [Stream; TOPICS],
    /// A recorder before this one has been there.
    rejoined: bool,
    /// Positions that a source had in hand when it died.
    in_hand: [u64; TOPICS],
    /// By the topic of the results.
    lineages: [Lineages; TOPICS],
    /// Positions of results that nobody has sent: what they would have been made from was lost, or who had it died.
    never_sent: [u64; TOPICS],
    /// Reports of each process: session and next position.
    health: BTreeMap<String, HealthStream>,
}

#[derive(Debug, Default, Clone, Copy, Serialize, Deserialize)]
struct Stream {
    intake: Intake,
    session: u64,
    elements: u64,
    unwritten: u64,
    /// No message has come since the recorder began: what is missing, it has not missed by its own slowness.
    joining: bool,
    announced: Announced,
}

/// Missing messages that recorded gaps have told of since the last message of a stream.
#[derive(Debug, Default, Clone, Copy, Serialize, Deserialize)]
struct Announced {
    count: u64,
    /// Those of them that had been received.
    unwritten: u64,
}

#[derive(Debug, Default, Clone, Copy, Serialize, Deserialize)]
struct HealthStream {
    session: u64,
    next_seq: u64,
    joining: bool,
    announced: u64,
}

/// Lineages of one stage's results.
#[derive(Debug, Default, Clone, Copy, Serialize, Deserialize)]
struct Lineages {
    /// Next position upstream.
    next_seq: u64,
    /// Session and counts of the last result.
    last: Option<(u64, Lineage)>,
    lost_upstream: u64,
}

/// What is missing before a message.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Missing {
    /// Messages of which no recorded gap tells.
    pub(crate) gap: Option<Gap>,
    /// Messages of which recorded gaps tell and that are not missing.
    pub(crate) excess: u64,
}

impl Losses {
    /// Nothing seen yet of streams with this schedule.
    pub(crate) fn new(schedule: Schedule) -> Self {
        let lineages = |topic| {
            let next_seq = maker(topic).map_or(0, |(_, upstream)| schedule.first(upstream).unwrap_or(0));
            Lineages { next_seq, ..Lineages::default() }
        };
        Self {
            schedule,
            streams: Topic::ALL.map(|_| Stream { joining: true, ..Stream::default() }),
            lineages: Topic::ALL.map(lineages),
            ..Self::default()
        }
    }

    /// Notes that this recorder takes over from an earlier one: what is missing before the next messages was sent while none was there.
    pub(crate) fn rejoin(&mut self) {
        self.rejoined = true;
        self.streams.iter_mut().for_each(|stream| stream.joining = true);
        self.health.values_mut().for_each(|stream| stream.joining = true);
    }

    /// Notes a message and says what is missing before it.
    pub(crate) fn take(&mut self, message: RecordedRef<'_>) -> Missing {
        let topic = message.topic();
        self.schedule.take(message);
        let stream = &mut self.streams[topic as usize];
        stream.elements += message.len() as u64;
        if let RecordedRef::HealthReports(_, reports) = message {
            stream.intake.received += 1;
            return reports.first().map_or_else(Missing::default, |health| self.take_health(health));
        }
        let known = stream.intake.received > 0;
        let first = if known { stream.intake.last_seq + 1 } else { self.schedule.first(topic).unwrap_or(0) };
        let session = stream.session;
        let lost_before = stream.intake.lost;
        let mut missing = count_intake(&mut stream.intake, &mut stream.session, message.session(), message.seq());
        let lineage = message.lineage();
        if let Some(lineage) = &lineage {
            missing = self.lineages[topic as usize].take(message.session(), lineage);
            let unsent = message.seq().saturating_sub(first).saturating_sub(missing);
            if self.schedule.is_of_source(topic) && known && session != message.session() {
                // The source that died had more of its scan in hand: nobody gets it any more.
                self.in_hand[topic as usize] += unsent;
                missing += unsent;
            } else {
                self.never_sent[topic as usize] += unsent;
            }
        }
        let Announced { count: announced, unwritten } = std::mem::take(&mut stream.announced);
        let positions_alone = lineage.is_none();
        if positions_alone && !known {
            // Where the schedule does not tell what was before, nothing else does.
            let is_complete = self.schedule.is_complete(topic);
            missing = if is_complete { message.seq().saturating_sub(first) } else { announced };
        }
        stream.intake.received += unwritten;
        stream.intake.lost = lost_before + missing.saturating_sub(unwritten);
        let joining = std::mem::take(&mut stream.joining);
        let reason = match () {
            () if joining => GapReason::Away,
            () if positions_alone && session != message.session() => GapReason::Sender,
            () => GapReason::Queue,
        };
        let count = missing.saturating_sub(announced);
        let last_seq = message.seq().saturating_sub(1).max(first);
        let gap = Gap { topic, session: message.session(), first_seq: first, last_seq, count, reason };
        Missing { gap: (count > 0).then_some(gap), excess: announced.saturating_sub(missing) }
    }

    fn take_health(&mut self, health: &Health) -> Missing {
        let begin = HealthStream { session: health.session, next_seq: health.seq, ..HealthStream::default() };
        let stream = self.health.entry(health.process.to_string()).or_insert(begin);
        if stream.session != health.session {
            // What a process said before it has said anything here is not missed.
            *stream = HealthStream { announced: stream.announced, ..begin };
        }
        let (first_seq, missing) = (stream.next_seq, health.seq.saturating_sub(stream.next_seq));
        stream.next_seq = health.seq + 1;
        let reason = if std::mem::take(&mut stream.joining) { GapReason::Away } else { GapReason::Queue };
        let announced = std::mem::take(&mut stream.announced);
        let count = missing.saturating_sub(announced);
        let last_seq = health.seq.saturating_sub(1);
        let gap = Gap { topic: Topic::HealthReports, session: health.session, first_seq, last_seq, count, reason };
        Missing { gap: (count > 0).then_some(gap), excess: announced.saturating_sub(missing) }
    }

    /// Whether a message comes a second time.
    pub(crate) fn has_taken(&self, message: RecordedRef<'_>) -> bool {
        let stream = &self.streams[message.topic() as usize];
        let Intake { received, last_seq, .. } = stream.intake;
        received > 0 && stream.session == message.session() && message.seq() <= last_seq
    }

    /// Takes note of a recorded gap, which comes before the message that shows it.
    pub(crate) fn announce(&mut self, gap: &Gap) {
        if gap.topic == Topic::HealthReports {
            let stream = self.health.values_mut().find(|stream| stream.session == gap.session);
            if let Some(stream) = stream.filter(|stream| stream.next_seq <= gap.last_seq) {
                stream.announced += gap.count;
            }
            return;
        }
        let stream = &mut self.streams[gap.topic as usize];
        if stream.intake.received > 0 && gap.last_seq <= stream.intake.last_seq && gap.session == stream.session {
            return; // counted before this file began
        }
        stream.announced.count += gap.count;
        if gap.reason == GapReason::Disk {
            stream.announced.unwritten += gap.count;
            stream.unwritten += gap.count;
        }
    }

    /// Notes messages that were received but could not be written to the recording.
    pub(crate) fn not_written(&mut self, topic: Topic, count: u64) {
        self.streams[topic as usize].unwritten += count;
    }

    /// Messages received, by topic.
    pub(crate) fn received(&self, topic: Topic) -> u64 {
        self.streams[topic as usize].received()
    }

    /// What the recorder knows of a topic, for its health.
    pub(crate) fn intake(&self, topic: Topic) -> Intake {
        self.streams[topic as usize].intake
    }

    /// Messages received, by name of the topic.
    pub(crate) fn messages(&self) -> BTreeMap<String, u64> {
        Topic::ALL.into_iter().map(|topic| (topic.name().to_string(), self.received(topic))).collect()
    }

    /// Whether a stage began a new session in the run.
    pub(crate) fn restarted(&self) -> bool {
        self.streams.iter().any(|stream| stream.intake.restarts > 0)
    }

    /// Positions of a topic that a source had in hand when it died.
    pub(crate) fn in_hand(&self, topic: Topic) -> u64 {
        self.in_hand[topic as usize]
    }

    /// Where the streams begin and end.
    pub(crate) fn schedule(&self) -> &Schedule {
        &self.schedule
    }

    /// The position after the last one of a topic, as far as it is known: the one that was seen last, or the end of the schedule of
    /// a topic whose positions are all sent. Results are not, but of a recorder that was away until the end it is all that is known.
    pub(crate) fn end(&self, topic: Topic) -> u64 {
        let stream = &self.streams[topic as usize];
        let seen = if stream.intake.received > 0 { stream.intake.last_seq + 1 } else { 0 };
        if self.goes_by_schedule(topic) { seen.max(self.schedule.end(topic)) } else { seen }
    }

    fn goes_by_schedule(&self, topic: Topic) -> bool {
        let was_away = self.rejoined && self.streams[topic as usize].joining && maker(topic).is_some();
        was_away || self.schedule.is_complete(topic)
    }

    /// Whether a stage that reads `topic` must have lost messages, even if none of its results has been seen.
    pub(crate) fn is_owed(&self, topic: Topic) -> bool {
        self.goes_by_schedule(topic) && self.schedule.end(topic) > self.schedule.first(topic).unwrap_or(0)
    }

    /// Messages that the recorder has missed after the last one that it has received of a topic: `told` are those that their
    /// publisher or another consumer tells of.
    pub(crate) fn missed_at_end(&self, topic: Topic, told: u64) -> u64 {
        let stream = &self.streams[topic as usize];
        let is_taken = stream.intake.received > 0 || topic != Topic::Dwells; // dwells only where they are recorded
        let first = self.schedule.first(topic).unwrap_or(0);
        let next = if stream.intake.received > 0 { stream.intake.last_seq + 1 } else { first };
        told.max(if is_taken { self.end(topic).saturating_sub(next) } else { 0 })
    }

    /// Messages lost by topic and consumer, with what `books` know of the end; topics nobody sent on are left out.
    pub(crate) fn lost(&self, books: &Books) -> BTreeMap<String, BTreeMap<String, u64>> {
        let mut lost: BTreeMap<String, BTreeMap<String, u64>> = BTreeMap::new();
        let mut note = |topic: &str, consumer: &str, count: u64| {
            lost.entry(topic.to_string()).or_default().insert(consumer.to_string(), count);
        };
        for topic in Topic::ALL {
            let (name, stream) = (topic.name(), &self.streams[topic as usize]);
            let missed = self.missed_at_end(topic, books.told(topic, stream.received() + stream.intake.lost));
            if topic.is_data() && (stream.intake.received > 0 || missed > 0) {
                note(name, RECORDER, stream.intake.lost + missed);
            } else if topic.is_counted() && stream.intake.lost > 0 {
                // No schedule says when there is one: only what is missing between two of them is known.
                note(name, RECORDER, stream.intake.lost);
            }
            if stream.unwritten > 0 {
                note(name, RECORDING, stream.unwritten);
            }
            let Some((stage, upstream)) = maker(topic) else { continue };
            let lineages = &self.lineages[topic as usize];
            let end = self.end(upstream);
            if lineages.has_upstream() || self.is_owed(upstream) {
                // Those that came after its last result are lost too, but for what it says that it has taken.
                let last = end.saturating_sub(lineages.next_seq).saturating_sub(books.taken_unseen(topic));
                let missing = lineages.lost_upstream + last;
                note(upstream.name(), stage.name, missing.saturating_sub(self.never_sent(upstream, books)));
            }
        }
        lost
    }
}

impl Losses {
    /// Positions of a topic that nobody has sent: those that another consumer has had are not among them.
    pub(crate) fn never_sent(&self, topic: Topic, books: &Books) -> u64 {
        let stream = &self.streams[topic as usize];
        let hidden = books.hidden(topic, stream.received() + stream.intake.lost);
        self.never_sent[topic as usize].saturating_sub(hidden)
    }
}

impl Stream {
    /// Messages received, those of which only a recorded gap tells included.
    fn received(&self) -> u64 {
        self.intake.received + self.announced.unwritten
    }
}

impl Lineages {
    /// Notes a result and gives how many have been lost on their way to the recorder before it.
    fn take(&mut self, session: u64, lineage: &Lineage) -> u64 {
        let last = self.last.filter(|&(last_session, _)| last_session == session).map(|(_, lineage)| lineage);
        let (taken, published) = last.map_or((0, 0), |last| (last.taken_in_session, last.published_before + 1));
        if lineage.session != 0 {
            let passed = (lineage.last_seq.saturating_add(1)).saturating_sub(self.next_seq);
            self.lost_upstream += passed.saturating_sub(lineage.taken_in_session.saturating_sub(taken));
            self.next_seq = lineage.last_seq.saturating_add(1);
        }
        self.last = Some((session, *lineage));
        lineage.published_before.saturating_sub(published)
    }

    /// Whether the results are made from messages of another process.
    fn has_upstream(&self) -> bool {
        self.last.is_some_and(|(_, lineage)| lineage.session != 0)
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use common::health::HealthHeader;
    use common::tracks::TracksHeader;

    /// A tracks message: session, position, plots taken in the session, tracks published before.
    pub(crate) fn tracks(session: u64, seq: u64, taken_in_session: u64, published_before: u64) -> TracksHeader {
        let lineage =
            Lineage { session: 9, first_seq: seq, last_seq: seq, taken: 1, taken_in_session, published_before };
        TracksHeader { session, seq, lineage, ..TracksHeader::default() }
    }

    /// Plots lost by the tracker, tracks lost by the recorder.
    fn lost(headers: &[TracksHeader]) -> (u64, u64) {
        let mut losses = Losses::new(Schedule::default());
        for header in headers {
            losses.take(RecordedRef::Tracks(header, &[]));
        }
        let lost = losses.lost(&Books::default());
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

    /// Ten scans of 8 sectors and 64 dwells, with one truth each.
    fn simulated() -> (Losses, Books) {
        let mut config = common::config::ChainConfig::default();
        (config.run.scans, config.radar.dwells_per_scan, config.radar.sectors_per_scan) = (10, 64, 8);
        (Losses::new(Schedule::new(&config)), Books::default())
    }

    #[test]
    fn what_comes_after_the_last_message_is_known_from_the_schedule() {
        let (mut losses, mut books) = simulated();
        let truth = |seq| common::truth::TruthHeader { seq, ..Default::default() };
        let plots = |seq| {
            let lineage = Lineage {
                session: 3,
                last_seq: seq * 8 + 7,
                taken: 8,
                taken_in_session: (seq + 1) * 8,
                published_before: seq,
                ..Lineage::default()
            };
            common::plots::PlotsHeader { session: 2, seq, lineage, ..Default::default() }
        };
        let mut take = |message: RecordedRef<'_>| {
            books.take(message);
            losses.take(message);
        };
        // The first truth and the last ones are missed, and the extractor dies for good after 5 scans.
        (2..5).for_each(|scan| take(RecordedRef::Truth(&truth(scan), &[])));
        (0..40).for_each(|seq| take(RecordedRef::Plots(&plots(seq), &[])));
        (0..40).for_each(|seq| take(RecordedRef::Tracks(&tracks(1, seq, seq + 1, seq), &[])));
        let lost = losses.lost(&books);
        assert_eq!((lost["truth"]["recorder"], lost["dwells"]["plot-extractor"]), (2 + 5, 640 - 320));
        assert_eq!((lost["plots"]["tracker"], lost["plots"]["recorder"], lost["tracks"]["recorder"]), (0, 0, 0));
        let balance = books.balance(&losses);
        assert!(balance.iter().all(common::report::Book::balances), "{balance:?}");
        let sent = |topic: &str| balance.iter().find(|book| book.topic == topic).map(|book| book.sent);
        assert_eq!((sent("truth"), sent("dwells"), sent("plots")), (Some(10), Some(640), Some(40)));
    }

    #[test]
    fn of_a_recorder_that_was_away_until_the_end_nothing_is_forgotten() {
        let (mut losses, books) = simulated();
        losses.rejoin();
        let lost = losses.lost(&books);
        let all = [
            ("dwells", "plot-extractor", 640),
            ("plots", "tracker", 80),
            ("plots", "recorder", 80),
            ("tracks", "recorder", 80),
        ];
        for (topic, consumer, count) in all {
            assert_eq!(lost[topic][consumer], count, "{topic} by {consumer}");
        }
        let balance = books.balance(&losses);
        assert_eq!(balance.len(), 5, "{balance:?}");
        assert!(balance.iter().all(common::report::Book::balances), "{balance:?}");
    }

    #[test]
    fn results_that_another_consumer_has_had_were_sent() {
        let (mut losses, mut books) = (Losses::new(Schedule::default()), Books::default());
        let plots = |session, seq| {
            let lineage = Lineage { session: 9, ..Lineage::default() };
            common::plots::PlotsHeader { session, seq, lineage, ..Default::default() }
        };
        // Extractor and recorder die together: of ten plots the tracker took nine, the recorder saw two.
        for message in [plots(1, 0), plots(2, 10)] {
            books.take(RecordedRef::Plots(&message, &[]));
            losses.take(RecordedRef::Plots(&message, &[]));
        }
        let last = tracks(1, 10, 10, 0);
        books.take(RecordedRef::Tracks(&last, &[]));
        losses.take(RecordedRef::Tracks(&last, &[]));
        let lost = losses.lost(&books);
        assert_eq!((lost["plots"]["recorder"], lost["plots"]["tracker"]), (8, 0));
        let balance = books.balance(&losses);
        let sent: Vec<u64> = balance.iter().filter(|book| book.topic == "plots").map(|book| book.sent).collect();
        assert_eq!(sent, [10, 10], "{balance:?}");
    }

    #[test]
    fn a_recorder_that_comes_late_knows_what_it_has_missed() {
        assert_eq!(lost(&[tracks(1, 20, 21, 20), tracks(1, 21, 22, 21)]), (0, 20));
    }

    #[test]
    fn a_gap_says_what_lies_between_two_messages_and_why() {
        let mut losses = Losses::new(Schedule::default());
        let mut missing = |header: TracksHeader| losses.take(RecordedRef::Tracks(&header, &[])).gap;
        let gap = |session, first_seq, last_seq, count, reason| {
            Some(Gap { topic: Topic::Tracks, session, first_seq, last_seq, count, reason })
        };
        assert_eq!(missing(tracks(1, 20, 21, 20)), gap(1, 0, 19, 20, GapReason::Away));
        assert_eq!(missing(tracks(1, 21, 22, 21)), None);
        // Of five positions the tracker has published on three.
        assert_eq!(missing(tracks(1, 27, 26, 25)), gap(1, 22, 26, 3, GapReason::Queue));
    }

    #[test]
    fn a_recorded_gap_explains_what_is_missing_and_no_more() {
        let mut losses = Losses::new(Schedule::default());
        let first = losses.take(RecordedRef::Tracks(&tracks(1, 0, 1, 0), &[]));
        assert_eq!(first, Missing::default());
        let gap =
            Gap { topic: Topic::Tracks, session: 1, first_seq: 1, last_seq: 4, count: 4, reason: GapReason::Disk };
        losses.announce(&gap);
        assert_eq!(losses.take(RecordedRef::Tracks(&tracks(1, 5, 6, 5), &[])), Missing::default());
        // They had been received: the recorder's queue has lost none.
        assert_eq!((losses.received(Topic::Tracks), losses.lost(&Books::default())["tracks"]["recorder"]), (6, 0));
        assert_eq!(losses.lost(&Books::default())["tracks"]["recording"], 4);

        losses.announce(&Gap { first_seq: 6, last_seq: 7, count: 2, ..gap });
        let found = losses.take(RecordedRef::Tracks(&tracks(1, 9, 10, 9), &[]));
        assert_eq!(found.gap.map(|gap| (gap.count, gap.reason)), Some((1, GapReason::Queue)));
        losses.announce(&Gap { first_seq: 10, last_seq: 12, count: 3, ..gap });
        assert_eq!(losses.take(RecordedRef::Tracks(&tracks(1, 11, 12, 11), &[])).excess, 2);
    }

    #[test]
    fn counts_go_on_where_they_were_written_down() {
        let mut losses = Losses::new(Schedule::default());
        losses.take(RecordedRef::Tracks(&tracks(1, 0, 1, 0), &[]));
        losses.not_written(Topic::Tracks, 1);
        let text = serde_json::to_string(&losses).expect("JSON");
        let mut again: Losses = serde_json::from_str(&text).expect("JSON");
        // The gap that the new file begins with is in the counts already.
        again.announce(&Gap::of(RecordedRef::Tracks(&tracks(1, 0, 1, 0), &[]), GapReason::Disk));
        assert_eq!(again.take(RecordedRef::Tracks(&tracks(1, 1, 2, 1), &[])), Missing::default());
        assert_eq!((again.received(Topic::Tracks), again.lost(&Books::default())["tracks"]["recording"]), (2, 1));
    }

    #[test]
    fn health_is_counted_by_process_and_no_loss() {
        let mut losses = Losses::new(Schedule::default());
        let mut missing = |name: &str, session, seq| {
            let mut health = Health { session, seq, ..Health::default() };
            health.process = name.into();
            losses.take(RecordedRef::HealthReports(&HealthHeader { session, seq }, &[health])).gap.map(|gap| gap.count)
        };
        assert_eq!(missing("tracker", 1, 4), None);
        assert_eq!(missing("radar-sim", 2, 0), None);
        assert_eq!(missing("tracker", 1, 7), Some(2));
        assert_eq!(missing("tracker", 3, 2), None);
        assert_eq!(missing("tracker", 3, 3), None);
        assert!(losses.lost(&Books::default()).is_empty());
    }
}
