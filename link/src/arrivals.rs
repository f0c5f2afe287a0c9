//! What of a link has arrived: each message once, in order, and what is missing counted.

use crate::envelope::Envelope;

/// The stream of one sender, as it comes.
#[derive(Debug, Default)]
pub struct Arrivals {
    session: Option<u64>,
    next: u64,
    lost: u64,
    repeated: u64,
    restarts: u64,
    gap: bool,
}

/// What to do with an envelope.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Arrival {
    /// The message is the next one: it is delivered.
    Next,
    /// It has been delivered already, or there is none.
    Nothing,
    /// Earlier ones are still missing: the sender has them and will send all again.
    Early,
}

impl Arrivals {
    /// Takes the next envelope.
    pub fn take(&mut self, envelope: &Envelope) -> Arrival {
        match self.session.replace(envelope.session) {
            Some(session) if session == envelope.session => {}
            // A sender that has just started has sent nothing before: what it no longer has is lost.
            Some(_) => (self.restarts, self.next) = (self.restarts + 1, 0),
            // What was sent before this receiver started has been delivered to the one before it, or to nobody that there was.
            None => self.next = envelope.oldest,
        }
        self.lost += envelope.oldest.saturating_sub(self.next);
        self.next = self.next.max(envelope.oldest);
        self.gap = envelope.number > self.next;
        if envelope.message.is_none() {
            return Arrival::Nothing;
        }
        match envelope.number.cmp(&self.next) {
            std::cmp::Ordering::Less => {
                self.repeated += 1;
                Arrival::Nothing
            }
            std::cmp::Ordering::Equal => {
                self.next += 1;
                Arrival::Next
            }
            std::cmp::Ordering::Greater => Arrival::Early,
        }
    }

    /// Number of the message that is expected next.
    pub fn next(&self) -> u64 {
        self.next
    }

    /// Whether later messages have arrived before the next one.
    pub fn has_gap(&self) -> bool {
        self.gap
    }

    /// Messages that the sender has given up before they arrived.
    pub fn lost(&self) -> u64 {
        self.lost
    }

    /// Messages that came more than once.
    pub fn repeated(&self) -> u64 {
        self.repeated
    }

    /// Times that the sender has been started again.
    pub fn restarts(&self) -> u64 {
        self.restarts
    }
}

#[cfg(test)]
mod tests {
    use std::collections::VecDeque;

    use proptest::prelude::*;

    use super::*;
    use crate::envelope::Enclosed;
    use crate::window::Window;

    /// A sender and a receiver with a network between them that loses, repeats, cuts and delays, for so many steps and then no more.
    struct Wire {
        window: Window<u64>,
        arrivals: Arrivals,
        there: VecDeque<(u64, u64, u64)>,
        back: VecDeque<(u64, bool)>,
        delivered: Vec<u64>,
        now_ns: u64,
    }

    impl Wire {
        fn envelope(number: u64, oldest: u64, has_message: bool) -> Envelope {
            let message = has_message.then(|| Enclosed::new(common::topic::Topic::Tracks, &[]));
            Envelope { session: 1, number, oldest, sent_ns: 0, offset: None, message }
        }

        /// What happens in 10 ms; `fate` of each message on the way: lost, repeated, or delivered.
        fn step(&mut self, fate: impl Fn(usize) -> u8) {
            self.now_ns += 10_000_000;
            while let Some((number, message)) = self.window.next_to_send(self.now_ns) {
                self.there.push_back((number, self.window.oldest(), message));
            }
            for (index, (number, oldest, message)) in self.there.drain(..).enumerate() {
                for _ in 0..fate(index) {
                    if self.arrivals.take(&Self::envelope(number, oldest, true)) == Arrival::Next {
                        self.delivered.push(message);
                    }
                    self.back.push_back((self.arrivals.next(), self.arrivals.has_gap()));
                }
            }
            if self.now_ns.is_multiple_of(100_000_000) && fate(0) > 0 {
                self.arrivals.take(&Self::envelope(self.window.end(), self.window.oldest(), false));
                self.back.push_back((self.arrivals.next(), false));
            }
            for (index, (next, gap)) in self.back.drain(..).enumerate() {
                if fate(index + 1) > 0 {
                    self.window.confirm(next, gap, self.now_ns);
                }
            }
        }
    }

    proptest! {
        /// Whatever the network does: each message is delivered once and in order, or counted as lost; with room, none is lost.
        #[test]
        fn every_message_is_delivered_or_counted(
            lossless in any::<bool>(),
            fates in proptest::collection::vec(0_u8..3, 1..40),
            cuts in proptest::collection::vec(0_usize..120, 0..4),
            burst in 1_u64..20,
        ) {
            let mut wire = Wire {
                window: Window::new(50),
                arrivals: Arrivals::default(),
                there: VecDeque::new(),
                back: VecDeque::new(),
                delivered: Vec::new(),
                now_ns: 0,
            };
            wire.arrivals.take(&Wire::envelope(0, 0, false));
            let mut made = 0;
            for step in 0..120 {
                for _ in 0..burst {
                    if !lossless || wire.window.has_room() {
                        wire.window.push(made, 8);
                        made += 1;
                    }
                }
                let cut = cuts.iter().any(|&from| (from..from + 30).contains(&step));
                wire.step(|index| if cut { 0 } else { fates[(step + index) % fates.len()] });
            }
            for _ in 0..400 {
                wire.step(|_| 1);
            }
            prop_assert!(wire.window.is_empty());
            prop_assert_eq!(wire.arrivals.next(), made);
            prop_assert_eq!(wire.delivered.len() as u64 + wire.arrivals.lost(), made);
            prop_assert!(wire.delivered.is_sorted_by(|a, b| a < b));
            prop_assert!(!lossless || wire.arrivals.lost() == 0);
            prop_assert!(wire.arrivals.lost() <= wire.window.given_up());
        }
    }

    #[test]
    fn ends_that_start_again_find_each_other() {
        let mut arrivals = Arrivals::default();
        let of = |session, number, oldest, message| Envelope { session, ..Wire::envelope(number, oldest, message) };
        assert_eq!(arrivals.take(&of(1, 40, 38, true)), Arrival::Early);
        assert_eq!(arrivals.take(&of(1, 38, 38, true)), Arrival::Next);
        assert_eq!((arrivals.lost(), arrivals.next()), (0, 39));
        // The sender begins anew, and had to give up two messages before it was heard.
        assert_eq!(arrivals.take(&of(2, 2, 2, true)), Arrival::Next);
        assert_eq!((arrivals.lost(), arrivals.restarts(), arrivals.next()), (2, 1, 3));
        // A beat tells of the end of what was sent.
        assert_eq!(arrivals.take(&of(2, 5, 3, false)), Arrival::Nothing);
        assert!(arrivals.has_gap());
    }
}
