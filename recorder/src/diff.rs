//! Whether two recordings hold the same results.
//!
//! Compared are the messages of each topic in their order, in everything but stamps and
//! sessions, which no two runs share. Health is about processes, not results, and is left out.

use std::collections::VecDeque;

use common::recording::{Recorded, RecordingError, container};
use common::topic::{TOPICS, Topic};

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
            if topic.is_data()
                && let Some(difference) = topics[topic as usize].add(comparable(message), of_first)
            {
                return Ok(Some(format!("{}: {difference}", topic.name())));
            }
        }
    }
    let unpaired = Topic::ALL.into_iter().find(|&topic| !topics[topic as usize].waiting.is_empty());
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
        if encoded(a) != encoded(b) {
            return Some(format!("message {}, {}", self.compared, describe(a, b)));
        }
        self.compared += 1;
        None
    }
}

/// The bytes of a message: every bit of every number counts, so −0 is not 0 and NaN is the same NaN.
fn encoded(message: &Recorded) -> Vec<u8> {
    let mut bytes = Vec::new();
    // Writing to memory fails for no message that was read.
    container::encode(message.by_ref(), &mut bytes).expect("a message has a form in bytes");
    bytes
}

/// The message without what differs from run to run.
fn comparable(mut message: Recorded) -> Recorded {
    message.header_mut().make_comparable();
    if let Recorded::Truth(_, targets) = &mut message {
        for target in targets.iter_mut().filter(|target| target.snr_db.is_nan()) {
            target.snr_db = f32::NAN; // not known is not known, whichever NaN says so
        }
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

#[cfg(test)]
mod tests {
    use super::*;
    use common::dwell::DwellHeader;
    use common::plots::{Plot, PlotsHeader};
    use common::tracks::{Track, TracksHeader};
    use common::truth::{TruthHeader, TruthTarget};

    fn differ(a: &Recorded, b: &Recorded) -> bool {
        let one = |message: &Recorded| std::iter::once(Ok(message.clone()));
        first_difference(one(a), one(b)).expect("whole").is_some()
    }

    fn track(change: impl FnOnce(&mut TracksHeader, &mut Track)) -> Recorded {
        let (mut header, mut track) = (TracksHeader::default(), Track::default());
        change(&mut header, &mut track);
        Recorded::Tracks(header, vec![track])
    }

    #[test]
    fn every_bit_of_headers_and_elements_counts() {
        let plain = track(|_, _| {});
        assert!(!differ(&plain, &plain));
        assert!(differ(&plain, &track(|header, _| header.alive = 1)));
        assert!(differ(&plain, &track(|header, _| header.lineage.taken = 1)));
        assert!(differ(&plain, &track(|_, track| track.id = 1)));
        assert!(differ(&plain, &track(|_, track| track.state[0] = f64::from_bits(1))));
        assert!(differ(&plain, &track(|_, track| track.snr_db = f32::from_bits(1))));
        assert!(differ(&plain, &track(|_, track| track.covariance[44] = -0.0)));
        assert!(differ(&plain, &track(|_, track| track.used[5].weight = -0.0)));
        let dwell = |cell| Recorded::Dwells(DwellHeader::default(), vec![cell]);
        assert!(!differ(&dwell(0.0), &dwell(0.0)) && differ(&dwell(0.0), &dwell(-0.0)));
        let plot = |pfa, snr_db| {
            Recorded::Plots(PlotsHeader { pfa, ..PlotsHeader::default() }, vec![Plot { snr_db, ..Plot::default() }])
        };
        assert!(!differ(&plot(0.0, 0.0), &plot(0.0, 0.0)));
        assert!(differ(&plot(0.0, 0.0), &plot(-0.0, 0.0)) && differ(&plot(0.0, 0.0), &plot(0.0, -0.0)));
    }

    #[test]
    fn not_a_number_equals_itself_and_nothing_else() {
        let nan = || track(|_, track| track.weight_none = f64::NAN);
        assert!(!differ(&nan(), &nan()));
        assert!(differ(&nan(), &track(|_, _| {})));
        let truth =
            |snr_db| Recorded::Truth(TruthHeader::default(), vec![TruthTarget { snr_db, ..TruthTarget::default() }]);
        assert!(!differ(&truth(f32::NAN), &truth(-f32::NAN)), "not known");
        assert!(differ(&truth(f32::NAN), &truth(0.0)));
    }

    #[test]
    fn stamps_and_sessions_do_not_count() {
        let plain = track(|_, _| {});
        assert!(!differ(&plain, &track(|header, _| header.session = 7)));
        assert!(!differ(&plain, &track(|header, _| header.stamps.tracks_out_ns = 7)));
        assert!(!differ(&plain, &track(|header, _| header.lineage.session = 7)));
    }
}
