//! What the tracks of a site were made of, and what operators call them: remembered from the other topics of the site.

use std::collections::{HashMap, VecDeque};

use common::commands::{ACCEPTED, Command, LABEL};
use common::plots::{Plot, PlotsHeader};
use common::system_tracks::{Contributor, SystemTrack, SystemTracksHeader};
use common::tracks::Track;

/// Messages of plots that are kept, in scans: a track leaves with the sector that completes it.
const SCANS_KEPT: usize = 2;

/// Plots, local tracks and labels by the tracks that they belong to.
#[derive(Debug, Default)]
pub struct Origins {
    /// Sectors of the last scans by `seq`, ascending.
    sectors: VecDeque<Sector>,
    plots_session: u64,
    /// Local tracks of system tracks.
    contributors: HashMap<u64, Vec<Contributor>>,
    contributors_session: u64,
    labels: HashMap<u64, String>,
    /// Number of each site of the chain as a unit.
    units: Vec<u8>,
}

/// The plots of a message.
#[derive(Debug, Default)]
struct Sector {
    seq: u64,
    source_id: u32,
    plots: Vec<Plot>,
}

impl Origins {
    /// Of a chain whose sites are units of these numbers.
    pub fn new(units: Vec<u8>) -> Self {
        Self { units, ..Self::default() }
    }

    /// Remembers the plots of a sector.
    pub fn take_plots(&mut self, header: &PlotsHeader, plots: &[Plot]) {
        let follows = self.sectors.back().is_none_or(|last| last.seq < header.seq);
        if std::mem::replace(&mut self.plots_session, header.lineage.session) != header.lineage.session || !follows {
            self.sectors.clear();
        }
        let is_full = self.sectors.len() >= SCANS_KEPT * header.sectors_per_scan as usize;
        let mut sector = if is_full { self.sectors.pop_front() } else { None }.unwrap_or_default();
        (sector.seq, sector.source_id) = (header.seq, header.source_id);
        sector.plots.clear();
        sector.plots.extend_from_slice(plots);
        self.sectors.push_back(sector);
    }

    /// Remembers what system tracks are made of.
    pub fn take_system_tracks(&mut self, header: &SystemTracksHeader, tracks: &[SystemTrack]) {
        if std::mem::replace(&mut self.contributors_session, header.session) != header.session {
            self.contributors.clear();
        }
        for track in tracks {
            let count = (track.contributor_count as usize).min(track.contributors.len());
            if track.ended == 0 && count > 0 {
                self.contributors.insert(track.id, track.contributors[..count].to_vec());
            } else {
                self.contributors.remove(&track.id);
            }
        }
    }

    /// Remembers a label.
    pub fn take_action(&mut self, action: &Command) {
        if (action.kind, action.outcome) != (LABEL, ACCEPTED) {
            return;
        }
        let name = action.name.to_string();
        if name.is_empty() {
            self.labels.remove(&action.track_id);
        } else {
            self.labels.insert(action.track_id, name);
        }
    }

    /// Forgets the label of a track that has ended.
    pub fn forget(&mut self, id: u64) {
        self.labels.remove(&id);
    }

    /// The plot that was most probably the track's in its last update, if there was one and it is still known, and SAC (high byte) and
    /// SIC (low byte) of its radar, 0 where plots do not say.
    pub fn plot(&self, track: &Track) -> Option<(u32, &Plot)> {
        let at = self.sectors.binary_search_by_key(&track.best_plot_seq, |sector| sector.seq).ok()?;
        let sector = &self.sectors[at];
        Some((sector.source_id, sector.plots.get(track.best_plot_index as usize)?))
    }

    /// Unit and number of each local track that a system track is made of.
    pub fn contributors(&self, id: u64) -> impl Iterator<Item = (u8, u64)> {
        let of = self.contributors.get(&id).into_iter().flatten();
        of.filter_map(|of| Some((*self.units.get(of.site as usize)?, of.id)))
    }

    /// What operators call a track.
    pub fn label(&self, id: u64) -> Option<&str> {
        self.labels.get(&id).map(String::as_str)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::label::Label;
    use common::message::Lineage;
    use common::system_tracks::CONTRIBUTORS;

    fn sector(session: u64, seq: u64) -> PlotsHeader {
        PlotsHeader {
            seq,
            sectors_per_scan: 2,
            lineage: Lineage { session, ..Lineage::default() },
            ..PlotsHeader::default()
        }
    }

    #[test]
    fn the_plot_of_a_track_is_found_for_two_scans() {
        let mut origins = Origins::default();
        let at = |range_m: f64| Plot { range_m, ..Plot::default() };
        let track = |seq: u64, index: u32| Track { best_plot_seq: seq, best_plot_index: index, ..Track::EMPTY };
        for seq in 10..15 {
            origins.take_plots(&sector(1, seq), &[at(seq as f64), at(100.0 + seq as f64)]);
        }
        assert_eq!(origins.plot(&track(14, 1)).map(|(_, plot)| plot.range_m), Some(114.0));
        assert_eq!(origins.plot(&track(11, 0)).map(|(_, plot)| plot.range_m), Some(11.0));
        for (seq, index) in [(10, 0), (14, 2), (14, u32::MAX), (15, 0)] {
            assert_eq!(origins.plot(&track(seq, index)), None, "{seq} {index}");
        }
        origins.take_plots(&sector(2, 13), &[]);
        assert_eq!(origins.plot(&track(14, 1)), None, "that was another start of the source");
    }

    #[test]
    fn system_tracks_have_contributors_until_they_end() {
        let mut origins = Origins::new(vec![7, 8]);
        let mut contributors = [Contributor::default(); CONTRIBUTORS];
        contributors[0] = Contributor { id: 30, site: 1, reserved: 0 };
        contributors[1] = Contributor { id: 31, site: 9, reserved: 0 };
        let system = SystemTrack { id: 5, contributors, contributor_count: 2, ..SystemTrack::default() };
        let header = SystemTracksHeader::default();
        origins.take_system_tracks(&header, &[system]);
        assert_eq!(origins.contributors(5).collect::<Vec<_>>(), [(8, 30)]);
        origins.take_system_tracks(&header, &[SystemTrack { ended: 1, ..system }]);
        assert_eq!(origins.contributors(5).count(), 0);
    }

    #[test]
    fn labels_are_those_that_were_accepted_last() {
        let mut origins = Origins::default();
        let mut say = |name: &str, outcome: u32| {
            let command = Command { track_id: 7, name: Label::new(name), outcome, ..Command::new(LABEL, 1, 1) };
            origins.take_action(&command);
            origins.label(7).map(str::to_string)
        };
        assert_eq!(say("blue", ACCEPTED).as_deref(), Some("blue"));
        assert_eq!(say("red", common::commands::NO_SUCH_TRACK).as_deref(), Some("blue"));
        assert_eq!(say("", ACCEPTED), None);
        say("blue", ACCEPTED);
        origins.forget(7);
        assert_eq!(origins.label(7), None);
    }
}
