//! From two plots to the end: existence and counts (T18).
//!
//! ```text
//! r⁻ = p r,   L = 1 − D P_G + D Σ_m e_m λ_m / ρ_c,   r = L r⁻ / (1 − r⁻ + L r⁻)      (T18)
//! ```
//!
//! (T18) is Mušicki, Evans & Stanković (1994) without rebirth: a target that was lost starts a new track.

use common::config::{Logic, TrackerConfig};
use common::tracks::{COASTING, CONFIRMED, TENTATIVE, TERMINATED, Track};

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

    /// Of a track of two plots that an operator has asked for.
    pub fn confirmed(existence: f64) -> Self {
        Self { state: CONFIRMED, existence: existence.min(SUREST), started_at: existence, age: 2, hits: 2, misses: 0 }
    }

    /// Of a track that a tracker before has followed, as it has told.
    pub fn before(track: &Track) -> Self {
        let existence = track.existence.clamp(0.0, SUREST);
        Self {
            state: track.state_code,
            existence,
            started_at: existence,
            age: track.age_scans,
            hits: track.hits,
            misses: track.misses,
        }
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
    use proptest::prelude::*;

    /// Scans without a plot until a track that was sure ends, each with the evidence `ratio`.
    fn scans_to_the_end(ratio: f64, config: &TrackerConfig) -> u32 {
        let mut life = Life::start(0.1, config);
        for _ in 0..100 {
            life.observe(50.0, true, config);
        }
        assert_eq!(life.state, CONFIRMED);
        let mut scans = 0;
        while life.state != TERMINATED {
            life.observe(ratio, false, config);
            scans += 1;
            assert!(life.state == TERMINATED || life.state == COASTING);
        }
        scans
    }

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
    }

    /// (T20.6): however long it has lived, ln L of about −10 ends a track, soon where D is large and later where it is small.
    #[test]
    fn a_lost_track_ends_when_its_score_has_fallen_by_ten() {
        let config = TrackerConfig { confirmed_misses: 1000, ..TrackerConfig::default() };
        let odds = |r: f64| (r / (1.0 - r)).ln();
        let fall = odds(config.survival_probability) - odds(config.delete_existence);
        assert!((fall - 10.1).abs() < 0.1, "{fall}");
        for d in [0.95, 0.7, 0.5, 0.3] {
            let scans = f64::from(scans_to_the_end(1.0 - d, &config));
            // Survival takes its share where the end is far away.
            let most = (fall / -(1.0 - d).ln()).ceil();
            assert!(scans <= most && scans >= 0.75 * most, "D {d}: {scans} of {most}");
        }
        assert_eq!(scans_to_the_end(0.05, &config), 4);
    }

    /// Where nothing is to be seen for certain (D = 0), the count of misses ends it.
    #[test]
    fn a_track_that_nothing_speaks_against_ends_by_its_misses() {
        let config = TrackerConfig::default();
        assert_eq!(scans_to_the_end(1.0, &config), config.confirmed_misses);
    }

    proptest! {
        /// For p = 1 the odds are the exponential of the sum of ln L (T20.6), up to the cap.
        #[test]
        fn existence_is_the_score(ratios in prop::collection::vec(0.5..3.0_f64, 1..30), start in 0.01..0.9_f64) {
            let config = TrackerConfig {
                survival_probability: 1.0 - 1e-16, delete_existence: 1e-12, tentative_misses: 1000, ..TrackerConfig::default()
            };
            let mut life = Life::start(start, &config);
            let mut score = (start / (1.0 - start)).ln();
            for ratio in ratios {
                life.observe(ratio, true, &config);
                score = (score + ratio.ln()).min((SUREST / (1.0 - SUREST)).ln());
                let odds = (life.existence / (1.0 - life.existence)).ln();
                prop_assert!((odds - score).abs() < 1e-6 * score.abs().max(1.0), "{odds} {score}");
            }
        }

        /// Any evidence leaves a probability.
        #[test]
        fn existence_stays_a_probability(
            scans in prop::collection::vec((prop_oneof![Just(0.0), Just(f64::MAX), Just(1e-300), 0.0..1e6_f64], any::<bool>()), 1..60),
            start in 1e-5..0.99_f64,
        ) {
            let config = TrackerConfig::default();
            let mut life = Life::start(start, &config);
            for (ratio, hit) in scans {
                life.observe(ratio, hit, &config);
                prop_assert!((0.0..=SUREST).contains(&life.existence), "{}", life.existence);
            }
        }
    }
}
