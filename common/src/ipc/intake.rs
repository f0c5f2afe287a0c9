//! Counting what a consumer gets and what it misses.

use crate::health::Intake;

/// Notes message `seq` of `session` and returns how many are missing before it.
///
/// A position counts once: what lies between two messages is lost, whether the queue
/// dropped it or a publisher died. Going back is a restart of the run, not a loss, and
/// what came before the first message was never meant for this consumer.
pub fn count_intake(intake: &mut Intake, last_session: &mut u64, session: u64, seq: u64) -> u64 {
    let first = intake.received == 0;
    intake.received += 1;
    let expected = intake.last_seq.saturating_add(1);
    let missing = if first { 0 } else { seq.saturating_sub(expected) };
    if !first && *last_session != session {
        intake.restarts += 1;
    }
    *last_session = session;
    intake.last_seq = seq;
    intake.lost += missing;
    missing
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gaps_restarts_and_rewinds_are_told_apart() {
        let (mut intake, mut session) = (Intake::default(), 0);
        let mut take = |s, seq| count_intake(&mut intake, &mut session, s, seq);
        assert_eq!(take(7, 10), 0); // joins late
        assert_eq!(take(7, 11), 0);
        assert_eq!(take(7, 15), 3); // queue dropped three
        assert_eq!(take(8, 20), 4); // publisher died and came back
        assert_eq!(take(9, 0), 0); // a new run
        assert_eq!(take(9, 1), 0);
        assert_eq!((intake.received, intake.lost, intake.restarts), (6, 7, 2));
    }
}
