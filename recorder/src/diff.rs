//! Whether two recordings hold the same results.
//!
//! Compared are the messages of each topic in their order, in everything but stamps and
//! sessions, which no two runs share. Health is about processes, not results, and is left out.

use std::collections::VecDeque;

use common::message::{Lineage, Stamps};
use common::recording::{Recorded, RecordingError};
use common::services::{ALL_TOPICS, TOPICS, Topic};

/// The first difference, in words; `None` if there is none.
///
/// # Errors
/// A recording is damaged before its end.
pub fn first_difference(
    mut a: impl Iterator<Item = Result<Recorded, RecordingError>>,
    mut b: impl Iterator<Item = Result<Recorded, RecordingError>>,
) -> Result<Option<String>, RecordingError> {
    let mut topics: [Pairing; TOPICS] = std::array::from_fn(|_| Pairing::default());
    loop {
        let (left, right) = (a.next().transpose()?, b.next().transpose()?);
        if left.is_none() && right.is_none() {
            break;
        }
        for (message, of_first) in [(left, true), (right, false)] {
            let Some(message) = message else { continue };
            let topic = message.by_ref().topic();
            if topic != Topic::Health
                && let Some(difference) = topics[topic as usize].add(comparable(message), of_first)
            {
                return Ok(Some(format!("{}: {difference}", topic.name())));
            }
        }
    }
    let unpaired = ALL_TOPICS.into_iter().find(|&topic| !topics[topic as usize].waiting.is_empty());
    Ok(unpaired.map(|topic| {
        let Pairing { of_first, compared, .. } = topics[topic as usize];
        let shorter = if of_first { "second" } else { "first" };
        format!("{}: the {shorter} ends after {compared} messages", topic.name())
    }))
}

/// Messages of one topic: those of one recording that wait for their partners in the other.
#[derive(Debug, Default)]
struct Pairing {
    waiting: VecDeque<Recorded>,
    of_first: bool,
    compared: u64,
}

impl Pairing {
    fn add(&mut self, message: Recorded, of_first: bool) -> Option<String> {
        if self.waiting.is_empty() || self.of_first == of_first {
            self.waiting.push_back(message);
            self.of_first = of_first;
            return None;
        }
        let partner = self.waiting.pop_front()?;
        let (a, b) = if of_first { (&message, &partner) } else { (&partner, &message) };
        if a != b {
            return Some(format!("message {}, {}", self.compared, describe(a, b)));
        }
        self.compared += 1;
        None
    }
}

/// The message without what differs from run to run.
fn comparable(mut message: Recorded) -> Recorded {
    let anonymous = |lineage: Lineage| Lineage { session: 0, ..lineage };
    match &mut message {
        Recorded::Dwells(header, _) => (header.session, header.source_out_ns) = (0, 0),
        Recorded::Plots(header, _) => {
            (header.session, header.stamps) = (0, Stamps::default());
            header.lineage = anonymous(header.lineage);
        }
        Recorded::Tracks(header, _) => {
            (header.session, header.stamps) = (0, Stamps::default());
            header.lineage = anonymous(header.lineage);
        }
        Recorded::Truth(header, targets) => {
            (header.session, header.source_out_ns) = (0, 0);
            for target in targets.iter_mut().filter(|target| target.snr_db.is_nan()) {
                target.snr_db = f32::NEG_INFINITY; // not known equals not known
            }
        }
        Recorded::Health(..) => {}
    }
    message
}

fn describe(a: &Recorded, b: &Recorded) -> String {
    let (a, b) = (a.by_ref(), b.by_ref());
    if a.seq() != b.seq() {
        format!("positions {} and {}", a.seq(), b.seq())
    } else if a.len() != b.len() {
        format!("position {}: {} and {} elements", a.seq(), a.len(), b.len())
    } else {
        let (a_text, b_text) = (format!("{a:?}"), format!("{b:?}"));
        let common = a_text.bytes().zip(b_text.bytes()).take_while(|(a, b)| a == b).count();
        // From the start of the field that differs.
        let start = a_text[..common].rfind(", ").map_or(0, |start| start + 2);
        let excerpt = |text: &str| text.get(start..).unwrap_or("").chars().take(60).collect::<String>();
        format!("position {}: `{}` and `{}`", a.seq(), excerpt(&a_text), excerpt(&b_text))
    }
}
