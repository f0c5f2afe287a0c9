//! The times under which messages are filed in a container.
//!
//! A message has its measurement time. One without (health, gaps) has that of the last message that has one: it was said
//! about then. Before the first measurement nothing is known, so messages wait for it: a recording begins with its first
//! measurement, and a viewer does not show the years since 1970.

/// Messages that wait at most; a chain may wait for its source for long.
const MOST_WAITING: usize = 1000;

/// Gives messages of type `T` their times.
#[derive(Debug)]
pub struct LogTime<T> {
    /// That of the last message that has one, ns UTC; 0 before the first.
    time_ns: u64,
    /// Stands for a measurement that does not come, ns UTC.
    otherwise_ns: u64,
    waiting: Vec<T>,
}

impl<T> LogTime<T> {
    /// Without a message yet. Where no measurement comes, messages are filed under `otherwise_ns` UTC.
    pub fn new(otherwise_ns: u64) -> Self {
        Self { time_ns: 0, otherwise_ns, waiting: Vec::new() }
    }

    /// The time, ns UTC, under which a message is to be filed whose measurement time is `time_ns`, 0 if it has none; first
    /// those that have waited ([`LogTime::take_waiting`]). `None`: it has to wait.
    pub fn of(&mut self, time_ns: u64) -> Option<u64> {
        if time_ns > 0 {
            self.time_ns = time_ns;
        } else if self.waiting.len() >= MOST_WAITING {
            return Some(self.at_last());
        }
        (self.time_ns > 0).then_some(self.time_ns)
    }

    /// The time of what still waits at the end.
    pub fn at_last(&mut self) -> u64 {
        if self.time_ns == 0 {
            self.time_ns = self.otherwise_ns;
        }
        self.time_ns
    }

    /// Lets a message wait.
    pub fn wait(&mut self, message: T) {
        self.waiting.push(message);
    }

    /// Those that have waited, in their order.
    pub fn take_waiting(&mut self) -> Vec<T> {
        std::mem::take(&mut self.waiting)
    }

    /// Whether messages wait.
    pub fn is_waiting(&self) -> bool {
        !self.waiting.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_before_the_first_measurement_have_its_time() {
        let mut log = LogTime::new(9);
        for name in ["a", "b"] {
            assert_eq!(log.of(0), None);
            log.wait(name);
        }
        assert_eq!((log.of(500), log.take_waiting()), (Some(500), vec!["a", "b"]));
        assert_eq!((log.of(0), log.of(700), log.of(0), log.is_waiting()), (Some(500), Some(700), Some(700), false));
    }

    #[test]
    fn a_measurement_is_not_waited_for_for_ever() {
        let mut log = LogTime::new(9);
        for message in 0..MOST_WAITING {
            assert_eq!(log.of(0), None);
            log.wait(message);
        }
        assert_eq!((log.of(0), log.take_waiting().len()), (Some(9), MOST_WAITING));
    }
}
