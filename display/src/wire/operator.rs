//! What operators ask for, and what there is of that at a site.

use std::collections::BTreeMap;

use common::commands::{ACQUIRE, ACQUISITION_ZONE, Command, DROP, EXCLUSION_ZONE, LABEL, MAX_CORNERS, REMOVE_ZONE};
use common::label::Label;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::picture::place::Placement;
use crate::picture::site::SitePicture;

/// What a zone is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ZoneKind {
    /// No track begins by itself.
    Exclusion,
    /// Two plots make a confirmed track.
    Acquisition,
}

/// A zone of a site, in the picture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Zone {
    /// Its name, at most 32 bytes.
    pub name: String,
    /// What it is for.
    pub kind: ZoneKind,
    /// Its corners in order, 3 to 16: east and north, m.
    pub polygon_m: Vec<[f64; 2]>,
}

/// Where a track is to begin.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Acquisition {
    /// East, m.
    pub x_m: f64,
    /// North, m.
    pub y_m: f64,
    /// How far from there it may begin, m; without it, what a target moves in a turn and some cells.
    #[serde(default)]
    pub radius_m: f64,
}

/// The label of a track.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TrackLabel {
    /// At most 32 bytes; empty for none.
    pub label: String,
}

/// What has become of a command.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Answer {
    /// `accepted`, or `asked` where the tracker has not answered in time: an event tells it later.
    pub outcome: &'static str,
}

/// `operator`: the zones of a site and the labels of its tracks, whenever they change.
#[derive(Debug, Serialize, JsonSchema)]
pub struct OperatorMessage<'a> {
    r#type: &'static str,
    site: &'a str,
    zones: Vec<Zone>,
    /// By the numbers of the tracks.
    #[schemars(with = "BTreeMap<String, String>")]
    labels: &'a BTreeMap<u64, String>,
}

impl<'a> OperatorMessage<'a> {
    /// Of this site.
    pub fn new(site: &'a SitePicture) -> Self {
        let (zones, labels) = (Zone::all(site), &site.operated.labels);
        Self { r#type: "operator", site: &site.name, zones, labels }
    }
}

impl Zone {
    /// Those of a site.
    pub fn all(site: &SitePicture) -> Vec<Self> {
        let corner = |&[x, y]: &[f64; 2]| {
            let [x, y, _] = site.place.position_m([x, y, 0.0]);
            [x, y]
        };
        let zone = |command: &Command| Self {
            name: command.name.to_string(),
            kind: if command.kind == EXCLUSION_ZONE { ZoneKind::Exclusion } else { ZoneKind::Acquisition },
            polygon_m: command.corners_m().iter().map(corner).collect(),
        };
        site.operated.zones.iter().map(zone).collect()
    }

    /// The command that sets it, or what is wrong with it.
    pub(crate) fn command(&self, place: &Placement) -> Result<Command, String> {
        let corners = self.polygon_m.len();
        if !(3..=MAX_CORNERS).contains(&corners) {
            return Err(format!("{corners} corners found, expected 3 to {MAX_CORNERS}"));
        }
        let name = named(&self.name)?;
        if ["", ".", ".."].contains(&name.as_str()) {
            return Err(format!("name `{name}` found, expected one that an address can have, of at most 32 bytes"));
        }
        let corners: Vec<_> = self.polygon_m.iter().map(|&corner| of_site(place, corner)).collect();
        let kind = match self.kind {
            ZoneKind::Exclusion => EXCLUSION_ZONE,
            ZoneKind::Acquisition => ACQUISITION_ZONE,
        };
        Ok(Command { name, kind, ..Command::default() }.at(&corners))
    }

    /// The command that removes the zone of this name.
    pub(crate) fn removal(name: &str) -> Result<Command, String> {
        Ok(Command { name: named(name)?, kind: REMOVE_ZONE, ..Command::default() })
    }
}

impl Acquisition {
    /// The command for it, or what is wrong with it.
    pub(crate) fn command(self, place: &Placement) -> Result<Command, String> {
        let Self { x_m, y_m, radius_m } = self;
        if !radius_m.is_finite() || radius_m < 0.0 {
            return Err(format!("radius_m {radius_m} found, expected at least 0"));
        }
        Ok(Command { radius_m, kind: ACQUIRE, ..Command::default() }.at(&[of_site(place, [x_m, y_m])]))
    }
}

impl TrackLabel {
    /// The command for the track `track_id`, or what is wrong with it.
    pub(crate) fn command(&self, track_id: u64) -> Result<Command, String> {
        Ok(Command { track_id, name: named(&self.label)?, kind: LABEL, ..Command::default() })
    }
}

/// The command that ends a track.
pub(crate) fn drop_track(track_id: u64) -> Command {
    Command { track_id, kind: DROP, ..Command::default() }
}

fn of_site(place: &Placement, [x, y]: [f64; 2]) -> [f64; 2] {
    let [x, y, _] = place.of_site_m([x, y, 0.0]);
    [x, y]
}

fn named(text: &str) -> Result<Label, String> {
    let (text, most) = (text.trim(), Label::LONGEST);
    if text.len() > most || text.chars().any(char::is_control) {
        return Err(format!("a name of {} bytes found, expected at most {most} bytes of printable text", text.len()));
    }
    Ok(Label::new(text))
}
