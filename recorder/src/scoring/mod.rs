//! How good plots and tracks are, measured against truth while they pass.
//!
//! - [`cooperative`]: truth from transponders: which share of the moving ones is followed.
//! - [`simulated`]: truth of the simulator: confirmation, losses, duplicates, errors, GOSPA.
//! - `roster`: the tracks themselves, with truth or without.
//! - [`detection`]: plots of the simulator's cells: detection, false alarms, accuracy.
//!
//! All of them keep a few seconds of messages and sums, never a whole run, so they are
//! folded live for months or over a recording. Each topic has to come in order of time;
//! topics may be apart by a minute.

mod clutter_region;
pub mod cooperative;
pub mod detection;
mod offset;
pub mod path;
mod reach;
mod roster;
pub mod simulated;
mod state_error;

use common::config::{ChainConfig, Source};
use common::plots::{Plot, PlotsHeader};
use common::report::{Detection, Tracking};
use common::tracks::{Track, TracksHeader};
use common::truth::{TruthHeader, TruthTarget};

use cooperative::Cooperative;
use detection::PlotScore;
use roster::Roster;
use simulated::Simulated;

/// All scores of a run, by the kind of truth that its source has.
#[derive(Debug)]
pub struct Scoring {
    plots: PlotScore,
    tracks: TrackScore,
    roster: Roster,
}

#[derive(Debug)]
enum TrackScore {
    Cooperative(Box<Cooperative>),
    Simulated(Box<Simulated>),
}

impl Scoring {
    /// Nothing seen yet.
    pub fn new(config: &ChainConfig) -> Self {
        let tracks = match config.origin() {
            Source::PlotSource | Source::VideoSource | Source::External => {
                TrackScore::Cooperative(Box::new(Cooperative::new(&config.recorder.scoring)))
            }
            Source::RadarSim | Source::Replay | Source::Fusion | Source::Link => {
                TrackScore::Simulated(Box::new(Simulated::new(config)))
            }
        };
        Self { plots: PlotScore::new(config), tracks, roster: Roster::new(config.radar.scan_period_s) }
    }

    /// Takes the plots of a sector.
    pub fn plots(&mut self, header: &PlotsHeader, plots: &[Plot]) {
        self.plots.plots(header, plots);
        self.roster.see(header.scan_period_s);
        match &mut self.tracks {
            TrackScore::Cooperative(score) => score.see(header),
            TrackScore::Simulated(score) => score.see(header),
        }
    }

    /// Takes the tracks of a sector.
    pub fn tracks(&mut self, header: &TracksHeader, tracks: &[Track]) {
        self.roster.tracks(header, tracks);
        match &mut self.tracks {
            TrackScore::Cooperative(score) => score.tracks(header, tracks),
            TrackScore::Simulated(score) => score.tracks(header, tracks),
        }
    }

    /// Takes the truth of a scan.
    pub fn truth(&mut self, header: &TruthHeader, targets: &[TruthTarget]) {
        match &mut self.tracks {
            TrackScore::Cooperative(score) => score.truth(header, targets),
            TrackScore::Simulated(score) => {
                self.plots.truth(header, targets);
                score.truth(header, targets);
            }
        }
    }

    /// The scores, of everything taken so far. Nothing more can be taken afterwards that
    /// is older than what has been taken.
    pub fn finish(&mut self) -> (Detection, Tracking) {
        let tracking = match &mut self.tracks {
            TrackScore::Cooperative(score) => score.finish(),
            TrackScore::Simulated(score) => score.finish(),
        };
        (self.plots.finish(), Tracking { tracks: self.roster.finish(), ..tracking })
    }
}
