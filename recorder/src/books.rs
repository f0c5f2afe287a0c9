//! Books: what was sent, by topic and consumer, from the counts of those who sent it, beside what was received and lost.
//!
//! [`crate::losses`] adds up gaps, message by message; here only the last counts of each session matter, those that
//! processes give in their health among them: what a queue dropped after the last message received is known by these alone.

use std::collections::BTreeMap;

use common::message::Lineage;
use common::recording::RecordedRef;
use common::report::Book;
use common::services::{TOPICS, Topic};
use serde::{Deserialize, Serialize};

use crate::losses::{Losses, RECORDER};

/// The fold of counts.
#[derive(Debug, Default, Serialize, Deserialize)]
pub(crate) struct Books {
    /// First and last position in the schedule, by topic.
    spans: [Option<(u64, u64)>; TOPICS],
    /// Results of a stage published, by topic and session of the stage, as the last one received says.
    published: [BTreeMap<u64, u64>; TOPICS],
    /// The same as the stages' health says.
    announced: [BTreeMap<u64, u64>; TOPICS],
    extractor: Stage,
    tracker: Stage,
}

/// What a stage says of its input.
#[derive(Debug, Default, Serialize, Deserialize)]
struct Stage {
    /// Messages taken, by session of the stage.
    taken: BTreeMap<u64, u64>,
    /// Position after the last one that went into a result.
    passed: u64,
}

impl Books {
    /// Notes a message; health has no schedule.
    pub(crate) fn take(&mut self, message: RecordedRef<'_>) {
        let topic = message.topic();
        if let RecordedRef::Health(_, reports) = message {
            for health in reports {
                let Some(topic) = results_of(health.process()) else { continue };
                let announced = self.announced[topic as usize].entry(health.session).or_default();
                *announced = (*announced).max(health.messages_out);
            }
            return;
        }
        let seq = message.seq();
        let (first, last) = self.spans[topic as usize].unwrap_or((seq, seq));
        self.spans[topic as usize] = Some((first.min(seq), last.max(seq)));
        let (stage, session, lineage) = match message {
            RecordedRef::Plots(header, _) => (&mut self.extractor, header.session, &header.lineage),
            RecordedRef::Tracks(header, _) => (&mut self.tracker, header.session, &header.lineage),
            _ => return,
        };
        stage.take(session, lineage);
        let published = self.published[topic as usize].entry(session).or_default();
        *published = (*published).max(lineage.published_before + 1);
    }

    /// Results that the recorder has missed after the last one of a session that it has received.
    pub(crate) fn tail(&self, topic: Topic) -> u64 {
        let seen = |session| self.published[topic as usize].get(session).copied().unwrap_or(0);
        let announced = &self.announced[topic as usize];
        announced.iter().map(|(session, &count)| count.saturating_sub(seen(session))).sum()
    }

    /// The books with what `losses` has counted. Schedules of stages begin at `first_dwell` and `first_sector`.
    pub(crate) fn balance(&self, losses: &Losses, first_dwell: u64, first_sector: u64) -> Vec<Book> {
        let lost = losses.lost();
        let mut books = Vec::new();
        let mut enter = |topic: Topic, consumer: &str, sent: u64, received: u64| {
            let gaps = lost.get(topic.name()).and_then(|of| of.get(consumer)).copied().unwrap_or(0);
            let lost = gaps + if consumer == RECORDER { self.tail(topic) } else { 0 };
            books.push(Book { topic: topic.name().into(), consumer: consumer.into(), sent, received, lost });
        };
        if self.extractor.passed > 0 {
            enter(Topic::Dwells, "plot-extractor", self.extractor.passed - first_dwell, self.extractor.taken());
        }
        if self.tracker.passed > 0 {
            let span = self.spans[Topic::Plots as usize].map_or(0, |(_, last)| (last + 1).saturating_sub(first_sector));
            let published: u64 = self.published[Topic::Plots as usize].values().sum();
            let passed = (self.tracker.passed - first_sector).max(span);
            let never_sent = span.saturating_sub(published);
            // Of a session's end that neither a message nor a health report has told, only the tracker knows.
            let taken = self.tracker.taken();
            enter(Topic::Plots, "tracker", passed.saturating_sub(never_sent).max(taken), taken);
        }
        for topic in [Topic::Dwells, Topic::Plots, Topic::Tracks, Topic::Truth] {
            let Some((first, last)) = self.spans[topic as usize] else { continue };
            let published: u64 = self.published[topic as usize].values().sum();
            let sent = if published > 0 { published + self.tail(topic) } else { last + 1 - first };
            enter(topic, RECORDER, sent, losses.received(topic));
        }
        books
    }
}

/// The topic whose messages a process counts in its health, of those whose results count themselves.
fn results_of(process: &str) -> Option<Topic> {
    match process {
        "plot-extractor" | "plot-source" => Some(Topic::Plots),
        "tracker" => Some(Topic::Tracks),
        _ => None,
    }
}

impl Stage {
    fn take(&mut self, session: u64, lineage: &Lineage) {
        if lineage.session != 0 {
            let taken = self.taken.entry(session).or_default();
            *taken = (*taken).max(lineage.taken_in_session);
            self.passed = self.passed.max(lineage.last_seq + 1);
        }
    }

    fn taken(&self) -> u64 {
        self.taken.values().sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::losses::tests::tracks;

    #[test]
    fn books_balance_with_the_losses_found_gap_by_gap() {
        let (mut books, mut losses) = (Books::default(), Losses::new(0, 0));
        // A queue drops, the tracker dies with plots in its hands, the recorder misses results.
        let stream =
            [tracks(1, 2, 1, 0), tracks(1, 3, 2, 1), tracks(1, 9, 5, 4), tracks(2, 14, 1, 0), tracks(2, 20, 7, 6)];
        for header in &stream {
            books.take(RecordedRef::Tracks(header, &[]));
            losses.take(RecordedRef::Tracks(header, &[]));
        }
        let balance = books.balance(&losses, 0, 0);
        assert_eq!(balance.len(), 2, "{balance:?}");
        assert!(balance.iter().all(Book::balances), "{balance:?}");
        assert_eq!((balance[0].sent, balance[0].received), (21, 5 + 7));
        assert_eq!((balance[1].sent, balance[1].received), (5 + 7, 5));
    }
}
