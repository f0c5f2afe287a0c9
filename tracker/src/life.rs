//! From two plots to the end: existence and counts (T18).
//!
//! ```text
//! r⁻ = p r,   L = 1 − D P_G + D Σ_m e_m λ_m / ρ_c,   r = L r⁻ / (1 − r⁻ + L r⁻)      (T18)
//! ```
//!
//! (T18) is Mušicki, Evans & Stanković (1994) without rebirth: a target that was lost starts a new track.

use common::config::{Logic, TrackerConfig};
use common::tracks::{COASTING, CONFIRMED, TENTATIVE, TERMINATED};

/// Existence is kept this far from certainty, so that a lost target is given up in time.
const SUREST: f64 = 1.0 - 1e-6;

/// Life cycle of one track.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Life {
    /// `TENTATIVE` and so on of [`common::tracks`].
    pub state: u32,
    /// r.
    pub existence: f64,
    /// r at the start: a track does not end for having begun in doubt.
    pub started_at: f64,
    /// Scans since the first plot.
    pub age: u32,
    /// Scans with a credible plot.
    pub hits: u32,
    /// Scans without, in a row.
    pub misses: u32,
}

impl Life {
    /// Of a track of two plots that exists with probability `existence`.
    pub fn start(existence: f64, config: &TrackerConfig) -> Self {
        let mut life = Self { state: TENTATIVE, existence, started_at: existence, age: 2, hits: 2, misses: 0 };
        if config.logic == Logic::MOfN && config.confirm_hits <= 2 {
            life.state = CONFIRMED;
        }
        life
    }

    /// Confirmed or coasting.
    pub fn is_confirmed(&self) -> bool {
        self.state == CONFIRMED || self.state == COASTING
    }

    /// One scan that was seen: L of (T18) and whether a credible plot was in the gate.
    pub fn observe(&mut self, existence_ratio: f64, hit: bool, config: &TrackerConfig) {
        self.age += 1;
        if self.state == TERMINATED {
            return;
        }
        let prior = config.survival_probability * self.existence;
        let support = existence_ratio.min(1e12) * prior;
        self.existence = (support / (1.0 - prior + support)).min(SUREST);
        if hit {
            self.hits += 1;
            self.misses = 0;
        } else {
            self.misses += 1;
        }
        let confirmed = self.is_confirmed();
        let ends = match config.logic {
            Logic::Existence => self.existence < config.delete_existence.min(0.3 * self.started_at),
            Logic::MOfN => !confirmed && self.age > config.confirm_scans,
        };
        let limit = if confirmed { config.confirmed_misses } else { config.tentative_misses };
        let believed = self.hits >= config.confirm_hits
            && match config.logic {
                Logic::Existence => self.existence >= config.confirm_existence,
                Logic::MOfN => self.age <= config.confirm_scans,
            };
        self.state = if confirmed || (believed && hit) {
            if self.misses >= limit || (ends && self.misses > 0) {
                TERMINATED
            } else if hit {
                CONFIRMED
            } else {
                COASTING
            }
        } else if self.misses >= limit || ends {
            TERMINATED
        } else {
            TENTATIVE
        };
    }

    /// Scans whose results were lost: nothing was learnt, but time has passed. More than may be missed end the track.
    pub fn pass(&mut self, scans: u32, config: &TrackerConfig) {
        self.age += scans;
        let limit = if self.is_confirmed() { config.confirmed_misses } else { config.tentative_misses };
        if scans > limit {
            self.state = TERMINATED;
        } else if self.state == CONFIRMED {
            self.state = COASTING;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn certainty_grows_and_fades() {
        let config = TrackerConfig::default();
        let mut life = Life::start(0.1, &config);
        for _ in 0..4 {
            life.observe(50.0, true, &config);
        }
        assert_eq!(life.state, CONFIRMED);
        life.observe(0.1, false, &config);
        assert_eq!(life.state, COASTING);
        let mut scans = 1;
        while life.state != TERMINATED {
            life.observe(0.1, false, &config);
            scans += 1;
        }
        assert!((3..=8).contains(&scans), "{scans}");
    }
}
