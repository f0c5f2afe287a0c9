//! What one site sees: the last scan of its plots, its living tracks, its targets.

use std::collections::{BTreeMap, VecDeque};

use common::clutter_map::{ClutterCell, ClutterMapHeader};
use common::config::{ChainConfig, Source};
use common::message::Stamps;
use common::plots::{Plot, PlotsHeader};
use common::system_tracks::{SystemTrack, SystemTracksHeader};
use common::tracks::{Models, TERMINATED, Track, TracksHeader, kind_name};
use common::truth::{TruthHeader, TruthTarget};

use super::events::{Happening, Kind};
use super::operated::Operated;
use super::place::Placement;

/// Scans of plots that are kept: those that the updates of the last scan have used can be from the scan before.
const SCANS_OF_PLOTS: u32 = 2;
/// A track that has not been told of for so many scans has ended, and its last message was lost.
const SILENT_SCANS: u32 = 3;

/// The picture of one site.
#[derive(Debug)]
pub struct SitePicture {
    /// Its name.
    pub name: String,
    /// Where it stands in the picture.
    pub place: Placement,
    /// Nearest and farthest range that it sees, m; the latter `None` where it is not known.
    pub ranges_m: (f64, Option<f64>),
    /// α: half width of the tracker's gates in standard deviations.
    pub gate_alpha: f64,
    /// Messages of plots of the last scans, oldest first.
    pub plots: VecDeque<(PlotsHeader, Vec<Plot>)>,
    /// Living tracks by number.
    pub tracks: BTreeMap<u64, Tracked>,
    /// Header of the last tracks.
    pub tracks_header: Option<TracksHeader>,
    /// True targets of the last scan.
    pub truth: Option<(TruthHeader, Vec<TruthTarget>)>,
    /// System tracks of the last cycle.
    pub system_tracks: Option<(SystemTracksHeader, Vec<SystemTrack>)>,
    /// Where false plots fall.
    pub clutter_map: Option<(ClutterMapHeader, Vec<ClutterCell>)>,
    /// Names of the models of motion of its tracks; empty before the first one.
    pub models: Vec<String>,
    /// What operators have done.
    pub operated: Operated,
    turns: Vec<Happening>,
}

/// A living track.
#[derive(Debug, Clone, Copy)]
pub struct Tracked {
    /// Its last update.
    pub track: Track,
    /// The scan of that.
    pub scan: u32,
    /// Where the message of that has been, and CLOCK_MONOTONIC when it came, ns.
    pub way: (Stamps, u64),
}

impl SitePicture {
    /// An empty picture of a site.
    pub fn new(site: &ChainConfig, place: Placement) -> Self {
        Self {
            name: site.site.name.clone(),
            place,
            ranges_m: ranges_m(site),
            gate_alpha: site.tracker.gate_alpha,
            plots: VecDeque::new(),
            tracks: BTreeMap::new(),
            tracks_header: None,
            truth: None,
            system_tracks: None,
            clutter_map: None,
            models: Vec::new(),
            operated: Operated::default(),
            turns: Vec::new(),
        }
    }

    /// Notes the plots of a sector.
    pub(super) fn take_plots(&mut self, header: &PlotsHeader, plots: &[Plot]) {
        // Another run, or a recording that was moved back.
        if self.plots.back().is_some_and(|(last, _)| header.seq <= last.seq) {
            self.plots.clear();
        }
        let kept = u64::from(header.sectors_per_scan.max(1)) * u64::from(SCANS_OF_PLOTS);
        let mut room = Vec::new();
        while self.plots.front().is_some_and(|(first, _)| first.seq + kept <= header.seq) {
            room = self.plots.pop_front().map(|(_, plots)| plots).unwrap_or_default();
        }
        room.clear();
        room.extend_from_slice(plots);
        self.plots.push_back((*header, room));
    }

    /// Notes the tracks of a sector; those that have ended without a word.
    pub(super) fn take_tracks(&mut self, header: &TracksHeader, tracks: &[Track], taken_ns: u64) -> Vec<Track> {
        let of_another = self.tracks_header.is_some_and(|last| last.numbering() != header.numbering());
        let mut gone = if of_another { self.forget_tracks() } else { Vec::new() };
        for track in &gone {
            self.lose(track, "with its tracker");
        }
        self.tracks_header = Some(*header);
        for track in tracks {
            self.note_models(track);
            let before = self.tracks.get(&track.id).is_some_and(|of| of.track.is_confirmed());
            if track.is_confirmed() && !before {
                self.turn(Kind::Confirmed, track.id, format!("track {} confirmed", track.id));
            }
            if track.state_code == TERMINATED {
                if before {
                    self.turn(
                        Kind::Ended,
                        track.id,
                        format!("track {} ended after {} scans", track.id, track.age_scans),
                    );
                }
                self.tracks.remove(&track.id);
                self.operated.forget_label(track.id);
            } else {
                self.tracks
                    .insert(track.id, Tracked { track: *track, scan: header.scan, way: (header.stamps, taken_ns) });
            }
        }
        if header.sector == 0 {
            let is_silent = |of: &&Tracked| header.scan.saturating_sub(of.scan) > SILENT_SCANS;
            let silent: Vec<_> = self.tracks.values().filter(is_silent).map(|of| of.track).collect();
            for track in silent {
                self.tracks.remove(&track.id);
                self.lose(&track, "without a last message");
                gone.push(track);
            }
        }
        gone.into_iter().map(|track| Track { state_code: TERMINATED, ..track }).collect()
    }

    /// Notes the end of a track that its tracker has not told of.
    fn lose(&mut self, track: &Track, how: &str) {
        self.operated.forget_label(track.id);
        if track.is_confirmed() {
            self.turn(Kind::Ended, track.id, format!("track {} ended {how}", track.id));
        }
    }

    /// Notes the system tracks of a cycle.
    pub(super) fn take_system_tracks(&mut self, header: &SystemTracksHeader, tracks: &[SystemTrack]) {
        self.system_tracks = Some((*header, tracks.to_vec()));
    }

    /// Confirmations and ends since the last call.
    pub(super) fn take_turns(&mut self) -> Vec<Happening> {
        std::mem::take(&mut self.turns)
    }

    /// The plots of the last scan, oldest first.
    pub fn last_scan(&self) -> impl Iterator<Item = &(PlotsHeader, Vec<Plot>)> {
        let last = self.plots.back().map_or(0, |(header, _)| header.seq + 1);
        let from = self.plots.back().map_or(0, |(header, _)| last.saturating_sub(header.sectors_per_scan.into()));
        self.plots.iter().filter(move |(header, _)| header.seq >= from)
    }

    /// A plot by the `seq` of its message and its index in that, while it is kept.
    pub fn plot(&self, seq: u64, index: u32) -> Option<&Plot> {
        let place = self.plots.binary_search_by_key(&seq, |(header, _)| header.seq).ok()?;
        self.plots[place].1.get(index as usize)
    }

    fn turn(&mut self, kind: Kind, track: u64, text: String) {
        self.turns.push(Happening { kind, track: Some(track), text });
    }

    fn forget_tracks(&mut self) -> Vec<Track> {
        std::mem::take(&mut self.tracks).into_values().map(|of| of.track).collect()
    }

    fn note_models(&mut self, track: &Track) {
        let count = usize::from(track.models).min(track.model_kind.len());
        if count > self.models.len() {
            let models = Models { count, kind: track.model_kind, ..Models::default() };
            self.models = names_of(&models);
        }
    }
}

/// Nearest and farthest range that a radar sees, m.
fn ranges_m(site: &ChainConfig) -> (f64, Option<f64>) {
    let radar = &site.radar;
    match site.origin() {
        Source::RadarSim | Source::VideoSource => {
            let first_edge = radar.range_first_m - radar.range_step_m / 2.0;
            (first_edge.max(0.0), Some(first_edge + radar.range_step_m * f64::from(radar.ranges)))
        }
        Source::PlotSource => (0.0, Some(site.plot_source.coverage_range_m)),
        _ => (0.0, None),
    }
}

/// Names of models: their kinds, numbered where there are several of one.
fn names_of(models: &Models) -> Vec<String> {
    let kinds = &models.kind[..models.count];
    let name = |(index, &kind): (usize, &u16)| {
        let name = kind_name(kind).unwrap_or("model");
        let (all, before) = (kinds.iter(), kinds[..index].iter());
        let same = |of: &&u16| **of == kind;
        if all.filter(same).count() > 1 { format!("{name}_{}", before.filter(same).count() + 1) } else { name.into() }
    };
    kinds.iter().enumerate().map(name).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::tracks::{CONFIRMED, KIND_CONSTANT_VELOCITY, KIND_COORDINATED_TURN, TENTATIVE};

    fn site() -> SitePicture {
        SitePicture::new(&ChainConfig::default(), Placement::default())
    }

    fn tracks(seq: u64, session: u64) -> TracksHeader {
        let (scan, sector) = ((seq / 4) as u32, (seq % 4) as u32);
        TracksHeader { seq, session, scan, sector, sectors_per_scan: 4, ..TracksHeader::default() }
    }

    fn track(id: u64, state_code: u32) -> Track {
        Track { id, state_code, ..Track::EMPTY }
    }

    #[test]
    fn plots_are_kept_for_two_scans_and_found_by_message_and_index() {
        let mut site = site();
        for seq in 0..11 {
            let header = PlotsHeader { seq, sectors_per_scan: 4, ..PlotsHeader::default() };
            site.take_plots(&header, &[Plot { range_m: seq as f64, ..Plot::default() }]);
        }
        assert_eq!(site.plots.len(), 8);
        assert_eq!(site.last_scan().map(|(header, _)| header.seq).collect::<Vec<_>>(), [7, 8, 9, 10]);
        assert_eq!(site.plot(5, 0).map(|plot| plot.range_m as u64), Some(5));
        assert!(site.plot(2, 0).is_none() && site.plot(5, 1).is_none());
        site.take_plots(&PlotsHeader { seq: 4, ..PlotsHeader::default() }, &[]);
        assert_eq!(site.plots.len(), 1, "moved back: what was ahead is of another time");
    }

    #[test]
    fn a_track_ends_by_its_word_by_silence_or_with_its_tracker() {
        let mut site = site();
        site.take_tracks(&tracks(0, 1), &[track(1, TENTATIVE), track(2, CONFIRMED), track(3, CONFIRMED)], 0);
        site.take_tracks(&tracks(4, 1), &[track(1, CONFIRMED), track(2, TERMINATED)], 0);
        let kinds: Vec<_> = site.take_turns().iter().map(|of| (of.kind, of.track)).collect();
        let confirmed = |id| (Kind::Confirmed, Some(id));
        assert_eq!(kinds, [confirmed(2), confirmed(3), confirmed(1), (Kind::Ended, Some(2))]);
        // The last message of 3 was lost: it is gone when nobody has told of it for more than three scans.
        assert!(site.take_tracks(&tracks(12, 1), &[track(1, CONFIRMED)], 0).is_empty());
        let gone = site.take_tracks(&tracks(16, 1), &[track(1, CONFIRMED)], 0);
        assert_eq!(gone.iter().map(|of| (of.id, of.state_code)).collect::<Vec<_>>(), [(3, TERMINATED)]);
        let gone = site.take_tracks(&tracks(17, 2), &[track(1_000_001, TENTATIVE)], 0);
        assert_eq!(gone.iter().map(|of| of.id).collect::<Vec<_>>(), [1]);
        assert_eq!(site.tracks.keys().copied().collect::<Vec<_>>(), [1_000_001]);
    }

    #[test]
    fn models_of_one_kind_are_numbered() {
        let mut models = Models::default();
        for kind in [KIND_CONSTANT_VELOCITY, KIND_COORDINATED_TURN, KIND_COORDINATED_TURN] {
            models.push(kind, 0.3, 0.0);
        }
        assert_eq!(names_of(&models), ["constant_velocity", "coordinated_turn_1", "coordinated_turn_2"]);
    }
}
