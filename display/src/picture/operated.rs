//! What operators have done at a site: its zones, the labels of its tracks, and what has become of their commands.

use std::collections::{BTreeMap, VecDeque};

use common::commands::{
    ACCEPTED, ACQUIRE, ACQUIRED, Command, DROP, EXPIRED, LABEL, REMOVE_ZONE, kind_name, outcome_name,
};

use super::events::{Happening, Kind};

/// Answers that are kept for those who wait for them.
const KEPT: usize = 256;

/// What operators have done.
#[derive(Debug, Default)]
pub struct Operated {
    /// The zones, each as the command that has set it, in axes of the site.
    pub zones: Vec<Command>,
    /// Labels of living tracks by number.
    pub labels: BTreeMap<u64, String>,
    answers: VecDeque<Command>,
}

impl Operated {
    /// Notes what the tracker has made of a command; what has happened, in words.
    pub(super) fn take(&mut self, action: &Command) -> Happening {
        if action.outcome == ACCEPTED {
            self.carry_out(action);
        }
        if !matches!(action.outcome, ACQUIRED | EXPIRED) {
            if self.answers.len() == KEPT {
                self.answers.pop_front();
            }
            self.answers.push_back(*action);
        }
        let track = matches!(action.kind, DROP | LABEL) || action.outcome == ACQUIRED;
        Happening { kind: Kind::Command, track: track.then_some(action.track_id), text: in_words(action) }
    }

    fn carry_out(&mut self, action: &Command) {
        if action.sets_zone() || action.kind == REMOVE_ZONE {
            self.zones.retain(|zone| zone.name != action.name);
            self.zones.extend(action.sets_zone().then_some(*action));
        }
        if action.kind == LABEL {
            self.labels.remove(&action.track_id);
            if !action.name.is_empty() {
                self.labels.insert(action.track_id, action.name.to_string());
            }
        }
    }

    /// Forgets the label of a track that has ended.
    pub(super) fn forget_label(&mut self, id: u64) {
        self.labels.remove(&id);
    }

    /// What has become of a command, once the tracker has said so.
    pub fn answer(&self, command: &Command) -> Option<u32> {
        let is_it = |answer: &&Command| (answer.asked_ns, answer.id) == (command.asked_ns, command.id);
        self.answers.iter().rev().find(is_it).map(|answer| answer.outcome)
    }
}

fn in_words(action: &Command) -> String {
    let Command { track_id, name, kind, outcome, .. } = action;
    let asked = match *kind {
        ACQUIRE => "acquire a track".to_string(),
        DROP => format!("drop track {track_id}"),
        LABEL if name.is_empty() => format!("take the label of track {track_id} away"),
        LABEL => format!("label track {track_id} {name}"),
        REMOVE_ZONE => format!("remove zone {name}"),
        other => format!("{} zone {name}", kind_name(other)),
    };
    let result = match *outcome {
        ACQUIRED => format!("track {track_id} has begun"),
        EXPIRED => "none could begin there".into(),
        other => outcome_name(other).replace('_', " "),
    };
    format!("operator: {asked}: {result}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::commands::{EXCLUSION_ZONE, NO_SUCH_TRACK};
    use common::label::Label;

    #[test]
    fn zones_and_labels_are_those_that_were_accepted_last() {
        let mut operated = Operated::default();
        let mut take = |kind, track_id, name: &str, outcome| {
            let command = Command { track_id, name: Label::new(name), outcome, ..Command::new(kind, 1, track_id) };
            operated.take(&command).text
        };
        assert_eq!(take(LABEL, 7, "blue", ACCEPTED), "operator: label track 7 blue: accepted");
        assert_eq!(take(LABEL, 8, "red", NO_SUCH_TRACK), "operator: label track 8 red: no such track");
        take(EXCLUSION_ZONE, 0, "hill", ACCEPTED);
        take(EXCLUSION_ZONE, 1, "hill", ACCEPTED);
        take(EXCLUSION_ZONE, 2, "town", ACCEPTED);
        take(REMOVE_ZONE, 3, "town", ACCEPTED);
        assert_eq!(operated.zones.iter().map(|zone| (zone.name.as_str(), zone.id)).collect::<Vec<_>>(), [("hill", 1)]);
        assert_eq!(operated.labels, BTreeMap::from([(7, "blue".to_string())]));
        assert_eq!(operated.answer(&Command::new(LABEL, 1, 8)), Some(NO_SUCH_TRACK));
        assert_eq!(operated.answer(&Command::new(LABEL, 1, 9)), None);
        operated.forget_label(7);
        assert!(operated.labels.is_empty());
    }
}
