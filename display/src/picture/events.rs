//! What has happened, newest last: confirmations, ends, restarts, latencies over budget, warnings.

use std::collections::VecDeque;

use common::health::{Condition, Health};
use common::latency::LATENCY_NAMES;
use common::status::counted_inputs;
use schemars::JsonSchema;
use serde::Serialize;

/// Events of a running chain that are kept.
const KEPT: usize = 4096;
/// Events of a recording that are kept.
const KEPT_OF_RECORDING: usize = 100_000;

/// What kind of thing has happened.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// A track was confirmed.
    Confirmed,
    /// A confirmed track has ended.
    Ended,
    /// A process was started again.
    Restart,
    /// A latency was over its budget.
    OverBudget,
    /// A process says that something is wrong.
    Warning,
    /// Somebody has acted.
    Command,
}

/// Something that has happened, before it has its number.
#[derive(Debug, Clone, PartialEq)]
pub struct Happening {
    /// What.
    pub kind: Kind,
    /// The track that it is about.
    pub track: Option<u64>,
    /// In words.
    pub text: String,
}

/// Something that has happened.
#[derive(Debug, Clone, Serialize, JsonSchema)]
pub struct Event {
    /// Always `event`.
    pub r#type: &'static str,
    /// Its number, from 1 without gaps.
    pub seq: u64,
    /// Measurement time, s UTC.
    pub time_s: f64,
    /// The site that it is about.
    pub site: Option<String>,
    /// What kind of thing.
    pub kind: Kind,
    /// The track that it is about.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub track: Option<u64>,
    /// In words.
    pub text: String,
}

/// The last events.
#[derive(Debug, Clone)]
pub struct EventLog {
    events: VecDeque<Event>,
    last: u64,
    most: usize,
    is_whole: bool,
}

impl Default for EventLog {
    fn default() -> Self {
        Self { events: VecDeque::new(), last: 0, most: KEPT, is_whole: false }
    }
}

impl EventLog {
    /// An empty log for all events of a recording.
    pub fn of_recording() -> Self {
        Self { most: KEPT_OF_RECORDING, ..Self::default() }
    }

    /// The log as the whole of what happens in a recording: playing it adds nothing.
    #[must_use]
    pub fn whole(self) -> Self {
        Self { is_whole: true, ..self }
    }

    /// Adds what has happened, and gives it its number; `None` where it is known already.
    pub fn add(&mut self, time_s: f64, site: Option<&str>, happening: Happening) -> Option<Event> {
        if self.is_whole {
            return None;
        }
        let Happening { kind, track, text } = happening;
        self.last += 1;
        let event = Event { r#type: "event", seq: self.last, time_s, site: site.map(String::from), kind, track, text };
        if self.events.len() == self.most {
            self.events.pop_front();
        }
        self.events.push_back(event.clone());
        Some(event)
    }

    /// The events after the one with this number that are kept.
    pub fn since(&self, seq: u64) -> impl Iterator<Item = &Event> {
        self.events.iter().filter(move |event| event.seq > seq)
    }
}

/// What a report of a process tells that its last one did not.
pub(super) fn of_health(before: &Health, now: &Health) -> Vec<Happening> {
    let process = now.process.as_str();
    let mut happenings = Vec::new();
    let mut happened = |kind, text| happenings.push(Happening { kind, track: None, text });
    if before.session != now.session {
        happened(Kind::Restart, format!("{process} was started again"));
        return happenings;
    }
    for ((name, before), now) in LATENCY_NAMES.iter().zip(&before.latency).zip(&now.latency) {
        let scans = now.misses.saturating_sub(before.misses);
        if scans > 0 {
            let s = if scans == 1 { "" } else { "s" };
            happened(
                Kind::OverBudget,
                format!("{name} over budget in {scans} scan{s}: p99 {:.0} µs so far", now.p99_us),
            );
        }
    }
    if before.condition != now.condition {
        happened(Kind::Warning, format!("{process}: {}", Condition::of(now.condition).text()));
    }
    if let Some(warning) = now.false_alarms.warning().filter(|_| !before.false_alarms.is_off()) {
        happened(Kind::Warning, format!("{process}: {warning}"));
    }
    let lost = |health: &Health| counted_inputs(health).map(|(_, intake)| intake.lost).sum::<u64>();
    let more = lost(now).saturating_sub(lost(before));
    if more > 0 {
        happened(Kind::Warning, format!("{process} has missed {more} messages"));
    }
    happenings
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn events_are_numbered_and_the_oldest_go() {
        let mut log = EventLog::default();
        for number in 1..=KEPT as u64 + 2 {
            let happening = Happening { kind: Kind::Warning, track: None, text: String::new() };
            assert_eq!(log.add(0.0, None, happening).map(|event| event.seq), Some(number));
        }
        assert_eq!(log.since(0).next().map(|event| event.seq), Some(3));
        assert_eq!(log.since(KEPT as u64).count(), 2);
        let mut whole = log.whole();
        let happening = Happening { kind: Kind::Warning, track: None, text: String::new() };
        assert!(whole.add(0.0, None, happening).is_none() && whole.since(0).count() == KEPT);
    }

    #[test]
    fn reports_tell_of_restarts_budgets_and_conditions() {
        let mut before = Health { session: 1, ..Health::default() };
        before.process = "tracker".into();
        let mut now = before;
        assert!(of_health(&before, &now).is_empty());
        now.latency[4].misses = 2;
        now.condition = Condition::Slow as u32;
        let texts: Vec<_> = of_health(&before, &now).into_iter().map(|of| (of.kind, of.text)).collect();
        assert_eq!(texts.len(), 2);
        assert!(texts[0].0 == Kind::OverBudget && texts[0].1.starts_with("end_to_end over budget in 2 scans"));
        assert_eq!(texts[1], (Kind::Warning, "tracker: slow".to_string()));
        now.session = 2;
        let restarted: Vec<_> = of_health(&before, &now).into_iter().map(|of| of.kind).collect();
        assert_eq!(restarted, [Kind::Restart]);
    }
}
