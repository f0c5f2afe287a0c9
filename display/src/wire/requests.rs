//! What clients ask for over the WebSocket: one JSON object, every key optional.

use schemars::JsonSchema;
use serde::{Deserialize, Deserializer};

use super::video::Fineness;

/// Finest video that can be asked for: as many lines and cells as a radar may have.
const FINEST: u32 = 65_536;

/// A message of a client.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Request {
    /// What to send from now on, in the place of what was wanted before.
    pub want: Option<Want>,
    /// How tables are sent.
    pub encoding: Option<Encoding>,
    /// The track to explain at each update; `null` for none.
    #[schemars(with = "Option<Follow>")]
    pub follow: Following,
    /// Is sent back with the server's clock.
    pub ping: Option<serde_json::Value>,
    /// Recording: play, times recorded time.
    pub play: Option<f64>,
    /// Recording: stand still.
    pub pause: Option<bool>,
    /// Recording: go to this measurement time, s UTC.
    pub seek: Option<f64>,
    /// Recording: go on by single steps.
    pub step: Option<Step>,
    /// Recording: how many steps, backwards if negative.
    pub by: Option<i32>,
}

/// What a client wants to be sent.
#[expect(clippy::struct_excessive_bools, reason = "each kind of message is wanted or not")]
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Want {
    /// Radar video, no finer than this.
    #[serde(deserialize_with = "fineness")]
    #[schemars(with = "Option<Fineness>")]
    pub video: Option<Fineness>,
    /// Plots.
    pub plots: bool,
    /// Tracks.
    pub tracks: bool,
    /// True targets.
    pub truth: bool,
    /// System tracks.
    pub system_tracks: bool,
    /// Where false plots fall.
    pub maps: bool,
    /// What `status --json` says, about once a second.
    pub health: bool,
    /// What happens.
    pub events: bool,
}

/// How tables are sent.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Encoding {
    /// Columns in binary frames.
    #[default]
    Binary,
    /// Rows in JSON.
    Json,
}

/// Which track a client follows from now on.
#[derive(Debug, Default, Clone, PartialEq, Eq)]
pub enum Following {
    /// Nothing is said of it.
    #[default]
    AsBefore,
    /// None.
    None,
    /// This one.
    Track(Follow),
}

impl<'de> Deserialize<'de> for Following {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Ok(Option::deserialize(deserializer)?.map_or(Self::None, Self::Track))
    }
}

/// A track of a site.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Follow {
    /// Name of the site.
    pub site: String,
    /// Number of the track.
    pub track: u64,
}

/// A step through a recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Step {
    /// To the next sector.
    Sector,
    /// To the next scan.
    Scan,
}

/// What a client wants of the player of a recording.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Playback {
    /// Play, times recorded time.
    Play(f64),
    /// Stand still.
    Pause,
    /// Go to this measurement time, s UTC.
    Seek(f64),
    /// Go on by so many steps.
    Step(Step, i32),
    /// Show the present time again, as it comes with what has led to it: somebody wants more of it.
    Again,
}

impl Request {
    /// Reads a message.
    ///
    /// # Errors
    /// What was found and what was expected, in one line.
    pub fn parse(text: &str) -> Result<Self, String> {
        serde_json::from_str(text).map_err(|error| error.to_string())
    }

    /// What it wants of the player, in order.
    pub fn playback(&self) -> impl Iterator<Item = Playback> {
        let seek = self.seek.map(Playback::Seek);
        let step = self.step.map(|step| Playback::Step(step, self.by.unwrap_or(1)));
        let play = self.play.map(Playback::Play);
        let pause = self.pause.filter(|&pause| pause).map(|_| Playback::Pause);
        [seek, step, play, pause].into_iter().flatten()
    }
}

fn fineness<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Fineness>, D::Error> {
    #[derive(Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Wanted {
        lines: u32,
        ranges: u32,
    }
    let wanted = Option::<Wanted>::deserialize(deserializer)?;
    let bounded = |cells: u32| cells.clamp(1, FINEST);
    Ok(wanted.map(|Wanted { lines, ranges }| Fineness { lines: bounded(lines), ranges: bounded(ranges) }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_optional_and_unknown_ones_are_refused_by_name() {
        let request =
            Request::parse(r#"{"want": {"video": {"lines": 1024, "ranges": 0}, "tracks": true}}"#).expect("valid");
        let want = request.want.expect("wanted");
        assert_eq!((want.video, want.tracks, want.plots), (Some(Fineness { lines: 1024, ranges: 1 }), true, false));
        assert_eq!((request.encoding, request.follow), (None, Following::AsBefore));
        let error = Request::parse(r#"{"wants": {}}"#).expect_err("unknown");
        assert!(error.contains("wants") && error.contains("want"), "{error}");
        assert!(Request::parse("[1]").is_err() && Request::parse("").is_err());
    }

    #[test]
    fn following_nothing_is_not_the_same_as_saying_nothing() {
        let follow = |text: &str| Request::parse(text).expect("valid").follow;
        assert_eq!(follow("{}"), Following::AsBefore);
        assert_eq!(follow(r#"{"follow": null}"#), Following::None);
        let track = Follow { site: "uav".into(), track: 3 };
        assert_eq!(follow(r#"{"follow": {"site": "uav", "track": 3}}"#), Following::Track(track));
    }

    #[test]
    fn a_recording_is_moved_and_then_played() {
        let request = Request::parse(r#"{"play": 2.0, "seek": 7.5, "step": "scan", "by": -1}"#).expect("valid");
        let wanted: Vec<_> = request.playback().collect();
        assert_eq!(wanted, [Playback::Seek(7.5), Playback::Step(Step::Scan, -1), Playback::Play(2.0)]);
    }
}
