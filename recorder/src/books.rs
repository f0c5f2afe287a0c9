//! Books: what was sent, by topic and consumer, from the counts of those who sent it, beside what was received and lost.
//!
//! [`crate::losses`] adds up gaps, message by message; here only the last counts of each session matter, those that
//! processes give in their health among them: what a queue dropped after the last message received is known by these alone.

use std::collections::BTreeMap;

use common::message::Lineage;
use common::recording::RecordedRef;
use common::report::Book;
use common::topic::{TOPICS, Topic};
use common::topology::{RECORDER, Stage, maker};
use serde::{Deserialize, Serialize};

use crate::losses::Losses;

/// The fold of counts.
#[derive(Debug, Default, Serialize, Deserialize)]
pub(crate) struct Books {
    /// First and last position in the schedule, by topic.
    spans: [Option<(u64, u64)>; TOPICS],
    /// Results of a stage published, by topic and session of the stage, as the last one received says.
    published: [BTreeMap<u64, u64>; TOPICS],
    /// The same as the stages' health says.
    announced: [BTreeMap<u64, u64>; TOPICS],
    /// What stages say of their input, by the topic of their results.
    intakes: [StageIntake; TOPICS],
}

/// What a stage says of its input.
#[derive(Debug, Default, Serialize, Deserialize)]
struct StageIntake {
    /// Messages taken, by session of the stage, as its results say.
    taken: BTreeMap<u64, u64>,
    /// The same as the stage has said when it ended: all of them have gone into results.
    at_end: BTreeMap<u64, u64>,
    /// Position after the last one that went into a result.
    passed: u64,
}

impl Books {
    /// Notes a message; health has no schedule.
    pub(crate) fn take(&mut self, message: RecordedRef<'_>) {
        let topic = message.topic();
        if let RecordedRef::HealthReports(_, reports) = message {
            for health in reports {
                let stage = Stage::from_name(health.process.as_str());
                let Some((stage, &results)) = stage.and_then(|stage| Some((stage, stage.outputs.first()?))) else {
                    continue;
                };
                if let Some(input) = stage.inputs.first().filter(|_| health.ended == 1) {
                    let taken = health.inputs().find(|(topic, _)| *topic == input.topic.name());
                    let taken = taken.map_or(0, |(_, intake)| intake.received);
                    self.intakes[results as usize].at_end.insert(health.session, taken);
                }
                let announced = self.announced[results as usize].entry(health.session).or_default();
                *announced = (*announced).max(health.messages_out);
            }
            return;
        }
        let seq = message.seq();
        let (first, last) = self.spans[topic as usize].unwrap_or((seq, seq));
        self.spans[topic as usize] = Some((first.min(seq), last.max(seq)));
        let Some(lineage) = message.lineage() else { return };
        self.intakes[topic as usize].take(message.session(), &lineage);
        let published = self.published[topic as usize].entry(message.session()).or_default();
        *published = (*published).max(lineage.published_before + 1);
    }

    /// Results that the recorder has missed after the last one of a session that it has received; 0 of topics whose
    /// messages do not count themselves.
    fn tail(&self, topic: Topic) -> u64 {
        let published = &self.published[topic as usize];
        if published.is_empty() && maker(topic).is_none() {
            return 0;
        }
        let seen = |session| published.get(session).copied().unwrap_or(0);
        let announced = &self.announced[topic as usize];
        announced.iter().map(|(session, &count)| count.saturating_sub(seen(session))).sum()
    }

    /// Results that another consumer has taken beyond those that the recorder has `accounted` for: they were sent when it was away
    /// together with their stage.
    pub(crate) fn hidden(&self, topic: Topic, accounted: u64) -> u64 {
        let consumers = Topic::ALL.into_iter().filter(|&results| maker(results).is_some_and(|(_, from)| from == topic));
        let taken = consumers.map(|results| self.intakes[results as usize].taken()).max().unwrap_or(0);
        if self.published[topic as usize].is_empty() { 0 } else { taken.saturating_sub(accounted) }
    }

    /// Results beyond those that the recorder has `accounted` for, of which their publisher or another consumer tells.
    pub(crate) fn told(&self, topic: Topic, accounted: u64) -> u64 {
        self.tail(topic).max(self.hidden(topic, accounted))
    }

    /// Messages that the stage which makes `results` has taken for results that the recorder has not seen.
    pub(crate) fn taken_unseen(&self, results: Topic) -> u64 {
        let intake = &self.intakes[results as usize];
        intake.taken() - intake.taken.values().sum::<u64>()
    }

    /// The books with what `losses` has counted.
    pub(crate) fn balance(&self, losses: &Losses) -> Vec<Book> {
        let (lost, schedule) = (losses.lost(self), losses.schedule());
        let first_seq = |topic| schedule.first(topic).unwrap_or(0);
        let mut books = Vec::new();
        let mut enter = |topic: Topic, consumer: &str, sent: u64, received: u64| {
            let lost = lost.get(topic.name()).and_then(|of| of.get(consumer)).copied().unwrap_or(0);
            books.push(Book { topic: topic.name().into(), consumer: consumer.into(), sent, received, lost });
        };
        for results in Topic::ALL {
            let Some((stage, topic)) = maker(results) else { continue };
            let (intake, first) = (&self.intakes[results as usize], first_seq(topic));
            let end = losses.end(topic);
            if intake.passed == 0 && !losses.is_owed(topic) {
                continue;
            }
            let counts_itself = maker(topic).is_some();
            let span = self.spans[topic as usize].map_or(0, |(_, last)| (last + 1).saturating_sub(first));
            let passed = intake.passed.max(end).saturating_sub(first).max(span);
            let accounted = self.published(topic)
                + losses.in_hand(topic)
                + self.hidden(topic, losses.received(topic) + losses.intake(topic).lost);
            let never_sent = if counts_itself { span.saturating_sub(accounted) } else { 0 };
            // Of a session's end that neither a message nor a health report has told, only the stage knows.
            let taken = intake.taken();
            enter(topic, stage.name, passed.saturating_sub(never_sent).max(taken), taken);
        }
        for topic in Topic::of_data() {
            let accounted = losses.received(topic) + losses.intake(topic).lost;
            let missed = losses.missed_at_end(topic, self.told(topic, accounted));
            let span = self.spans[topic as usize];
            if span.is_none() && missed == 0 {
                continue;
            }
            let published = self.published(topic) + losses.in_hand(topic);
            // Of a topic that does not count itself, all positions of its schedule or those between first and last.
            let passed = span.map_or(0, |(first, last)| {
                let first = if schedule.is_complete(topic) { first_seq(topic) } else { first };
                last + 1 - first
            });
            let sent = if published > 0 { published } else { passed };
            enter(topic, RECORDER, sent + missed, losses.received(topic));
        }
        books
    }

    /// Results published on a topic, as the last one received of each session says.
    fn published(&self, topic: Topic) -> u64 {
        self.published[topic as usize].values().sum()
    }
}

impl StageIntake {
    fn take(&mut self, session: u64, lineage: &Lineage) {
        if lineage.session != 0 {
            let taken = self.taken.entry(session).or_default();
            *taken = (*taken).max(lineage.taken_in_session);
            self.passed = self.passed.max(lineage.last_seq + 1);
        }
    }

    fn taken(&self) -> u64 {
        let beyond =
            |(session, &taken): (&u64, &u64)| taken.saturating_sub(self.taken.get(session).copied().unwrap_or(0));
        self.taken.values().sum::<u64>() + self.at_end.iter().map(beyond).sum::<u64>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::losses::tests::tracks;
    use crate::schedule::Schedule;

    #[test]
    fn books_balance_with_the_losses_found_gap_by_gap() {
        let (mut books, mut losses) = (Books::default(), Losses::new(Schedule::default()));
        // A queue drops, the tracker dies with plots in its hands, the recorder misses results.
        let stream =
            [tracks(1, 2, 1, 0), tracks(1, 3, 2, 1), tracks(1, 9, 5, 4), tracks(2, 14, 1, 0), tracks(2, 20, 7, 6)];
        for header in &stream {
            books.take(RecordedRef::Tracks(header, &[]));
            losses.take(RecordedRef::Tracks(header, &[]));
        }
        let balance = books.balance(&losses);
        assert_eq!(balance.len(), 2, "{balance:?}");
        assert!(balance.iter().all(Book::balances), "{balance:?}");
        assert_eq!((balance[0].sent, balance[0].received), (21, 5 + 7));
        assert_eq!((balance[1].sent, balance[1].received), (5 + 7, 5));
    }
}
