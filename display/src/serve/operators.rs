//! What operators ask for, on its way to the trackers.

use std::collections::VecDeque;
use std::sync::Mutex;
use std::sync::PoisonError;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use common::commands::{
    ACCEPTED, ASKED, Command, CommandsHeader, NO_SUCH_TRACK, NO_SUCH_ZONE, TOO_MANY, UNANSWERED, kind_name,
    outcome_name,
};
use common::messages::RecordedRef;
use common::time::monotonic_ns;
use common::topology::{TRACKER, runs};
use tokio::time::{Instant, sleep};

use super::Served;
use super::live::no_such_site;
use super::routes::{as_json, failure};
use crate::picture::place::Placement;
use crate::wire::columns::text;
use crate::wire::operator::Answer;

/// Commands that wait for a tracker at most.
const MOST_WAITING: usize = 64;
/// Whoever asks waits so long for the tracker: a slow antenna takes longer.
const PATIENCE: Duration = Duration::from_secs(5);
/// How often it is looked whether the tracker has answered.
const LOOK: Duration = Duration::from_millis(10);

/// Commands that are not on their way yet.
#[derive(Debug, Default)]
pub(super) struct Operators(Mutex<Waiting>);

#[derive(Debug, Default)]
struct Waiting {
    commands: VecDeque<(usize, Command)>,
    given: u64,
}

impl Operators {
    /// Lets a command for the site at `site` wait; with its identity, or `None` where too many wait.
    fn ask(&self, site: usize, command: &Command) -> Option<Command> {
        let mut waiting = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if waiting.commands.len() == MOST_WAITING {
            return None;
        }
        let now_ns = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_nanos() as u64);
        waiting.given += 1;
        let command = Command { asked_ns: now_ns, id: waiting.given, outcome: ASKED, before_seq: 0, ..*command };
        waiting.commands.push_back((site, command));
        Some(command)
    }

    /// The next command that waits.
    fn next(&self) -> Option<(usize, Command)> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).commands.pop_front()
    }
}

impl Served {
    /// Whether viewers may act.
    pub(super) fn may_act(&self) -> bool {
        self.recording.is_none() && self.sites.first().display.control
    }

    /// The next command for a site that waits.
    pub fn next_command(&self) -> Option<(usize, Command)> {
        self.operators.next()
    }

    /// Whether the tracker of a site has answered a command.
    pub(crate) fn has_answered(&self, site: usize, command: &Command) -> bool {
        self.picture().sites[site].operated.answer(command).is_some()
    }

    /// Answers a command in the place of a tracker that is not there.
    pub(crate) fn answer(&self, site: usize, command: &Command) {
        self.take(site, RecordedRef::Actions(&CommandsHeader::default(), &[*command]), monotonic_ns());
    }

    /// Gives the tracker of a site a command, waits for its answer and says what that is.
    pub(super) async fn operate(
        &self,
        site: &str,
        command: impl FnOnce(&Placement) -> Result<Command, String>,
    ) -> Response {
        if !self.may_act() {
            return failure(StatusCode::FORBIDDEN, "nobody may act here: display.control = true allows it");
        }
        let place = self.picture().site(site).map(|(index, of)| (index, of.place));
        let Some((index, place)) = place else { return failure(StatusCode::NOT_FOUND, &no_such_site(site)) };
        if !runs(&self.sites.all()[index], TRACKER) {
            return failure(StatusCode::CONFLICT, &format!("site `{site}` has no tracker here that could be asked"));
        }
        let command = match command(&place) {
            Ok(command) => command,
            Err(error) => return failure(StatusCode::BAD_REQUEST, &error),
        };
        let Some(asked) = self.operators.ask(index, &command) else {
            return failure(StatusCode::SERVICE_UNAVAILABLE, "too many commands wait for the tracker: try again later");
        };
        let began = Instant::now();
        loop {
            let answer = self.picture().sites[index].operated.answer(&asked);
            match answer {
                Some(outcome) => return answered(outcome, &asked),
                None if began.elapsed() > PATIENCE => {
                    return (StatusCode::ACCEPTED, as_json(text(&Answer { outcome: outcome_name(ASKED) })))
                        .into_response();
                }
                None => sleep(LOOK).await,
            }
        }
    }
}

fn answered(outcome: u32, asked: &Command) -> Response {
    let status = match outcome {
        ACCEPTED => return as_json(text(&Answer { outcome: outcome_name(outcome) })),
        NO_SUCH_TRACK | NO_SUCH_ZONE => StatusCode::NOT_FOUND,
        TOO_MANY => StatusCode::CONFLICT,
        UNANSWERED => StatusCode::SERVICE_UNAVAILABLE,
        _ => StatusCode::BAD_REQUEST,
    };
    let what = match outcome {
        NO_SUCH_TRACK => format!("the tracker has no track {}", asked.track_id),
        NO_SUCH_ZONE => format!("the tracker has no zone `{}`", asked.name),
        TOO_MANY => "the tracker has as many zones or acquisitions as it can have".into(),
        UNANSWERED => "the tracker is not there, or has too much before it".into(),
        _ => format!("the tracker refuses this: {}", kind_name(asked.kind)),
    };
    failure(status, &what)
}
