//! Observers: subscribers that no publisher waits for, and what their full queues have discarded.

use std::sync::{Arc, Mutex, PoisonError};

use crate::health::ObserverLoss;
use crate::label::Label;
use crate::topic::Topic;

/// Messages that full queues of observers have discarded, by topic and observer. Clones share the counts.
#[derive(Debug, Default, Clone)]
pub struct ObserverLosses(Arc<Mutex<Vec<ObserverLoss>>>);

impl ObserverLosses {
    /// Counts a message that `observer` has no room for.
    pub(super) fn count(&self, topic: Topic, observer: &str) {
        self.count_many(topic, observer, 1);
    }

    /// Counts what `observer` has no room for: messages, or what was made of them for a system outside.
    pub fn count_many(&self, topic: Topic, observer: &str, count: u64) {
        let (topic, observer) = (Label::new(topic.name()), Label::new(observer));
        let mut losses = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        match losses.iter_mut().find(|loss| (loss.topic, loss.observer) == (topic, observer)) {
            Some(loss) => loss.lost += count,
            None => losses.push(ObserverLoss { topic, observer, lost: count }),
        }
    }

    /// The counts so far.
    pub fn counts(&self) -> Vec<ObserverLoss> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}
