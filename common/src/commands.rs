//! `commands`: what an operator asks of the tracker of a site; `actions`: what the tracker has made of it.
//!
//! A command says before which plots it acts, so that a replay of the recorded actions acts in the same place
//! ([`crate::recording::commands_of`]).

use std::io;

use iceoryx2::prelude::ZeroCopySend;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::label::Label;
use crate::message::{Header, Place};
use crate::recording::row::{Row, Table, Value};

/// Commands in one message.
pub const MAX_COMMANDS: usize = 1;
/// Most corners of a zone.
pub const MAX_CORNERS: usize = 16;
/// Most zones of a site.
pub const MAX_ZONES: usize = 64;

/// [`Command::kind`]: a track is to begin near the first corner.
pub const ACQUIRE: u32 = 1;
/// [`Command::kind`]: a track is to end.
pub const DROP: u32 = 2;
/// [`Command::kind`]: a track gets a name, or loses it.
pub const LABEL: u32 = 3;
/// [`Command::kind`]: a zone in which no track begins by itself.
pub const EXCLUSION_ZONE: u32 = 4;
/// [`Command::kind`]: a zone in which two plots make a confirmed track.
pub const ACQUISITION_ZONE: u32 = 5;
/// [`Command::kind`]: a zone goes.
pub const REMOVE_ZONE: u32 = 6;

/// [`Command::outcome`] of what is asked for.
pub const ASKED: u32 = 0;
/// [`Command::outcome`]: carried out, or for [`ACQUIRE`] begun.
pub const ACCEPTED: u32 = 1;
/// [`Command::outcome`]: the tracker has no such track.
pub const NO_SUCH_TRACK: u32 = 2;
/// [`Command::outcome`]: the tracker has no such zone.
pub const NO_SUCH_ZONE: u32 = 3;
/// [`Command::outcome`]: there is no room for more zones.
pub const TOO_MANY: u32 = 4;
/// [`Command::outcome`]: the command makes no sense, a zone of two corners for example.
pub const REFUSED: u32 = 5;
/// [`Command::outcome`] of [`ACQUIRE`], later: the track `track_id` has begun.
pub const ACQUIRED: u32 = 6;
/// [`Command::outcome`] of [`ACQUIRE`], later: no track could begin there.
pub const EXPIRED: u32 = 7;

/// [`Command::outcome`] that the display gives where no tracker can be asked.
pub const UNANSWERED: u32 = 8;

/// Name of a [`Command::kind`].
pub fn kind_name(kind: u32) -> &'static str {
    match kind {
        ACQUIRE => "acquire",
        DROP => "drop",
        LABEL => "label",
        EXCLUSION_ZONE => "exclusion",
        ACQUISITION_ZONE => "acquisition",
        REMOVE_ZONE => "remove_zone",
        _ => "not_known",
    }
}

/// Name of a [`Command::outcome`].
pub fn outcome_name(outcome: u32) -> &'static str {
    match outcome {
        ASKED => "asked",
        ACCEPTED => "accepted",
        NO_SUCH_TRACK => "no_such_track",
        NO_SUCH_ZONE => "no_such_zone",
        TOO_MANY => "too_many",
        REFUSED => "refused",
        ACQUIRED => "acquired",
        EXPIRED => "expired",
        UNANSWERED => "unanswered",
        _ => "not_known",
    }
}

/// Something that an operator asks of the tracker of a site, and what has become of it.
#[derive(Debug, Default, Clone, Copy, PartialEq, Serialize, Deserialize, ZeroCopySend, JsonSchema)]
#[type_name("radar/Command/1")]
#[repr(C)]
pub struct Command {
    /// When it was asked for, ns UTC; with `id` its identity.
    pub asked_ns: u64,
    /// Number that whoever asks has given it.
    pub id: u64,
    /// Position of the plots before which it acts; of what is asked for, the earliest: 0 for at once.
    pub before_seq: u64,
    /// The track meant, or the one that [`ACQUIRED`] tells of.
    pub track_id: u64,
    /// How far from the corner a track of [`ACQUIRE`] may begin, m; 0 for what a target moves in a turn and some cells.
    pub radius_m: f64,
    /// Place of [`ACQUIRE`], or corners of a zone in order: east and north of the antenna, m.
    pub corners_m: [[f64; 2]; MAX_CORNERS],
    /// Name of the zone, or the label of the track.
    pub name: Label,
    /// [`ACQUIRE`] and others.
    pub kind: u32,
    /// [`ASKED`] and others.
    pub outcome: u32,
    /// How many corners there are.
    pub corners: u32,
    /// Always 0: no undefined bytes.
    pub reserved: u32,
}

const _: () = assert!(size_of::<Command>() == 344 && align_of::<Command>() == 8);

impl Command {
    /// Something asked for.
    pub fn new(kind: u32, asked_ns: u64, id: u64) -> Self {
        Self { asked_ns, id, kind, ..Self::default() }
    }

    /// With these corners, of which there are at most [`MAX_CORNERS`].
    #[must_use]
    pub fn at(mut self, corners_m: &[[f64; 2]]) -> Self {
        let count = corners_m.len().min(MAX_CORNERS);
        self.corners_m[..count].copy_from_slice(&corners_m[..count]);
        Self { corners: count as u32, ..self }
    }

    /// The corners.
    pub fn corners_m(&self) -> &[[f64; 2]] {
        &self.corners_m[..(self.corners as usize).min(MAX_CORNERS)]
    }

    /// Whether it is about a zone that is there from now on.
    pub fn sets_zone(&self) -> bool {
        matches!(self.kind, EXCLUSION_ZONE | ACQUISITION_ZONE)
    }
}

/// Header of a command or an action.
#[derive(Debug, Default, Clone, Copy, PartialEq, Serialize, Deserialize, ZeroCopySend, JsonSchema)]
#[type_name("radar/CommandsHeader/1")]
#[repr(C)]
#[repr(align(64))]
pub struct CommandsHeader {
    /// Position in the stream of its publisher, from 0.
    pub seq: u64,
    /// Session of the publisher.
    pub session: u64,
    /// Measurement time of the plots before which it acts, ns UTC; 0 of what is asked for.
    pub time_ns: u64,
    /// CLOCK_MONOTONIC just before publishing, ns.
    pub out_ns: u64,
    /// Always 0: no undefined bytes.
    pub reserved: [u64; 4],
}

const _: () = assert!(size_of::<CommandsHeader>() == 64 && align_of::<CommandsHeader>() == 64);

impl Header for CommandsHeader {
    fn place(&self) -> Place {
        let Self { session, seq, time_ns, .. } = *self;
        Place { session, seq, time_ns, flags: 0, scan: None }
    }

    fn each_stamp(&mut self, visit: &mut dyn FnMut(&mut u64)) {
        visit(&mut self.out_ns);
    }

    fn make_comparable(&mut self) {
        (self.session, self.out_ns) = (0, 0);
    }
}

impl Row<CommandsHeader> for Command {
    fn put_row(&self, header: &CommandsHeader, table: &mut dyn Table) -> io::Result<()> {
        table.put("seq", Value::U64(header.seq))?;
        table.put("time_ns", Value::U64(header.time_ns))?;
        table.put("asked_ns", Value::U64(self.asked_ns))?;
        table.put("id", Value::U64(self.id))?;
        table.put("kind_name", Value::Text(kind_name(self.kind)))?;
        table.put("outcome_name", Value::Text(outcome_name(self.outcome)))?;
        table.put("before_seq", Value::U64(self.before_seq))?;
        table.put("track_id", Value::U64(self.track_id))?;
        table.put("name", Value::Text(self.name.as_str()))?;
        table.put("corners", Value::U32(self.corners))?;
        table.put("x_m", Value::F64(self.corners_m[0][0]))?;
        table.put("y_m", Value::F64(self.corners_m[0][1]))?;
        table.put("radius_m", Value::F64(self.radius_m))
    }
}
