//! What the fusion is told: tuning, and the sites.

use std::f64::consts::FRAC_PI_2;

use common::geodesy::Position;

use crate::motion::Motion;
use crate::registration::Bias;

/// Tuning of the fusion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// How targets move.
    pub motion: Motion,
    /// Probability that local and system track of one target are within the gate.
    pub gate_probability: f64,
    /// Equal decisions in a row before a local track is attached, or two system tracks merge.
    pub attach_after: u32,
    /// Equal decisions in a row before local tracks of a formation change places.
    pub exchange_after: u32,
    /// Reports in a row outside the gate before a local track is released.
    pub release_after: u32,
    /// Time that a system track lives without contributors where a site should see it, s.
    pub coast_s: f64,
    /// The same where no site can see it, s.
    pub hidden_s: f64,
    /// Reports farther than this from the time of the last cycle, or of its message, are refused, s.
    pub patience_s: f64,
    /// Periods without a report after which a local track has ended.
    pub silent_periods: f64,
    /// Share of what a cycle says of biases that counts: the errors of a track's states are alike from scan to scan.
    pub registration_share: f64,
    /// Time after which that is forgotten to 1/e, s.
    pub registration_memory_s: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            motion: Motion { noise: [0.5, 300.0], stay_s: [1000.0, 30.0] },
            gate_probability: 0.999,
            attach_after: 3,
            exchange_after: 5,
            release_after: 4,
            coast_s: 15.0,
            hidden_s: 60.0,
            patience_s: 60.0,
            silent_periods: 3.5,
            registration_share: 0.2,
            registration_memory_s: 600.0,
        }
    }
}

/// A site as the fusion knows it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Site {
    /// Where its antenna stands.
    pub position: Position,
    /// Least and greatest range, m.
    pub range_m: [f64; 2],
    /// Least and greatest elevation, rad.
    pub elevation_rad: [f64; 2],
    /// Time of a turn, s.
    pub period_s: f64,
    /// Standard deviations of its biases of range, azimuth, elevation and time; m, rad, rad, s; 0 for what has none.
    pub bias: Bias,
}

impl Site {
    /// The whole sphere of elevations, rad.
    pub const ALL_ELEVATIONS_RAD: [f64; 2] = [-FRAC_PI_2, FRAC_PI_2];
}

/// What has become of reports, by site.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
pub struct Counts {
    /// Absorbed as what an update has brought.
    pub absorbed: u64,
    /// Absorbed by covariance intersection: the update was not that of a Kalman filter.
    pub intersected: u64,
    /// Of a track that is part of no system track yet.
    pub waiting: u64,
    /// Older than the last of the same track, or the same again.
    pub repeated: u64,
    /// With numbers that are no estimate.
    pub unsound: u64,
    /// Too far from the time of the last cycle, or of their message.
    pub untimely: u64,
    /// Local tracks released because they no longer fitted.
    pub released: u64,
    /// Kept out of system tracks because most of the site's did not fit them.
    pub kept_out: u64,
    /// Times that the site's tracks fitted nobody and one bias has explained it.
    pub realigned: u64,
}

impl Counts {
    /// All reports that were of the time.
    pub(crate) fn taken(&self) -> u64 {
        self.absorbed + self.intersected + self.waiting + self.kept_out + self.repeated
    }
}
