//! Ways of targets over the earth, for maps: from the tracks and the truth of a recording whose radar has a place.

use std::collections::BTreeMap;

use common::config::ChainConfig;
use common::geodesy::{LocalFrame, Position};
use common::recording::container::Description;
use common::recording::{RecordedRef, RecordingError};
use common::topic::Topic;
use common::tracks::{Track, pack};
use common::truth::{PLANAR, TruthTarget};

use super::places::configuration;

/// The topics that targets move in.
pub(super) const TOPICS: [Topic; 2] = [Topic::Tracks, Topic::Truth];
/// A standard error of the height above this says that there is no height, m.
const NO_HEIGHT_M: f64 = 2000.0;

/// Where a target was at a time.
#[derive(Debug, Clone, Copy)]
pub(super) struct Point {
    /// ns UTC.
    pub(super) time_ns: u64,
    /// Where.
    pub(super) place: Position,
    /// The height of the place is measured.
    pub(super) has_height: bool,
    /// East, north and up of the radar, m.
    pub(super) position_m: [f64; 3],
    /// m/s.
    pub(super) velocity_mps: [f64; 3],
    /// Probability that there is a target.
    pub(super) existence: f64,
}

/// The way of one target.
#[derive(Debug, Default)]
pub(super) struct Path {
    /// For people.
    pub(super) name: String,
    /// In order of time.
    pub(super) points: Vec<Point>,
}

/// The ways of all targets of one topic.
#[derive(Debug)]
pub(super) struct Paths {
    /// Configuration of the recorded chain.
    pub(super) chain: ChainConfig,
    /// Where the radar stands.
    pub(super) radar: Position,
    frame: LocalFrame,
    /// By session of the numbers and number of the target.
    by_target: BTreeMap<(u64, u64), Path>,
}

impl Paths {
    /// Of no messages so far.
    ///
    /// # Errors
    /// The recording does not say where its radar stands.
    pub(super) fn new(description: Option<&Description>) -> Result<Self, RecordingError> {
        let chain = configuration(description)?;
        let unplaced = || {
            std::io::Error::other(
                "the recorded radar has no place, expected site.position: `radar-chain run --replay FILE --speed max --set \
                 'site.position={ latitude_deg = …, longitude_deg = …, height_m = … }'` records it with one",
            )
        };
        let radar = chain.site.position.ok_or_else(unplaced)?;
        Ok(Self { frame: LocalFrame::new(&radar), radar, chain, by_target: BTreeMap::new() })
    }

    /// Takes a message; how many points it has given. Tracks that are not confirmed give none.
    pub(super) fn take(&mut self, message: RecordedRef<'_>) -> u64 {
        match message {
            RecordedRef::Tracks(header, tracks) => {
                let confirmed = tracks.iter().filter(|track| track.is_confirmed());
                confirmed.map(|track| self.take_track(header.numbering(), track)).sum()
            }
            RecordedRef::Truth(_, targets) => targets.iter().map(|target| self.take_truth(target)).sum(),
            _ => 0,
        }
    }

    fn take_track(&mut self, session: u64, track: &Track) -> u64 {
        let variance = track.covariance[pack(6, 6)];
        let has_height = variance > 0.0 && variance.sqrt() < NO_HEIGHT_M;
        let name = || format!("track {}", track.id);
        let (position_m, velocity_mps) = (track.position_m(), track.velocity_mps());
        let existence = track.existence;
        self.add((session, track.id), name, track.time_ns, position_m, velocity_mps, has_height, existence)
    }

    fn take_truth(&mut self, target: &TruthTarget) -> u64 {
        let [x, vx, _, y, vy, _, z, vz, _] = target.state;
        let configured = self.chain.sim.targets.get((target.target_id as usize).wrapping_sub(1));
        let name = configured.map_or_else(|| format!("target {:06X}", target.target_id), |of| of.name.clone());
        let has_height = !target.has(PLANAR);
        let key = (0, target.target_id.into());
        self.add(key, || name, target.time_ns, [x, y, z], [vx, vy, vz], has_height, 1.0)
    }

    #[expect(clippy::too_many_arguments, reason = "they are the fields of a point and whose it is")]
    fn add(
        &mut self,
        key: (u64, u64),
        name: impl FnOnce() -> String,
        time_ns: u64,
        position_m: [f64; 3],
        velocity_mps: [f64; 3],
        has_height: bool,
        existence: f64,
    ) -> u64 {
        let finite = position_m.iter().chain(&velocity_mps).all(|value| value.is_finite());
        let path = self.by_target.entry(key).or_insert_with(|| Path { name: name(), points: Vec::new() });
        // A run that was started again may tell of the same time once more.
        let is_news = finite && path.points.last().is_none_or(|last| last.time_ns < time_ns);
        if is_news {
            let place = self.frame.place(position_m);
            path.points.push(Point { time_ns, place, has_height, position_m, velocity_mps, existence });
        }
        u64::from(is_news)
    }

    /// Numbers and ways of the targets that were anywhere.
    pub(super) fn iter(&self) -> impl Iterator<Item = (u64, &Path)> {
        self.by_target.iter().filter(|(_, path)| !path.points.is_empty()).map(|((_, id), path)| (*id, path))
    }
}
