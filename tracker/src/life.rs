//! From two plots to the end: existence, counts, and the target's amplitude (T18), (T19).
//!
//! ```text
//! r⁻ = p r,   L = 1 − D P_G + D Σ_m e_m λ_m / ρ_c,   r = L r⁻ / (1 − r⁻ + L r⁻)      (T18)
//! Ŝ(r) = r⁻⁴ · mean of r_m⁴ (q_m − t₀ − 1) over the track's own plots                (T19)
//! ```
//!
//! (T18) is Mušicki, Evans & Stanković (1994) without rebirth: a target that was lost starts a new track. (T19) holds
//! because the part of an exponential power above a threshold has the same mean as the whole, and because power
//! falls with the fourth power of the range; a prior counts for some scans, old plots are forgotten.

use common::amplitude::{Detector, TargetStatistics};
use common::config::{Logic, TrackerConfig};
use common::tracks::{COASTING, CONFIRMED, TENTATIVE, TERMINATED};
use common::units::{from_db, to_db};

/// Existence is kept this far from certainty, so that a lost target is given up in time.
const SUREST: f64 = 1.0 - 1e-6;
/// Share of older plots that is kept per plot in the estimate of amplitude.
const FORGETTING: f64 = 0.95;
/// Range of the estimated signal-to-noise ratio, dB.
const SNR_RANGE_DB: (f64, f64) = (3.0, 40.0);
/// The statistics are renewed when the estimate has moved this far, dB.
const SNR_STEP_DB: f64 = 0.25;

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

/// What is known of a target's amplitude.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Amplitude {
    /// Σ weight · (q − t₀ − 1) (r/km)⁴, prior included.
    power: f64,
    /// Σ weight, prior included.
    scans: f64,
    statistics: TargetStatistics,
    snr_db: f64,
}

impl Amplitude {
    /// Before any plot, at a range.
    pub fn prior(range_m: f64, config: &TrackerConfig, detector: &Detector) -> Self {
        let scans = config.snr_prior_scans;
        let snr = from_db(config.snr_db);
        Self {
            power: scans * snr * spreading(range_m),
            scans,
            statistics: detector.target(config.swerling, snr),
            snr_db: config.snr_db,
        }
    }

    /// A plot of power `q` that is the target's with probability `weight` (T19).
    pub fn learn(&mut self, q: f64, weight: f64, range_m: f64, detector: &Detector) {
        let keep = 1.0 - (1.0 - FORGETTING) * weight;
        self.power = keep * self.power + weight * (q - detector.threshold - 1.0) * spreading(range_m);
        self.scans = keep * self.scans + weight;
    }

    /// Renews D and λ for a target now at `range_m`.
    pub fn look(&mut self, range_m: f64, config: &TrackerConfig, detector: &Detector) {
        if config.snr_prior_scans <= 0.0 {
            return;
        }
        let snr = self.power / self.scans / spreading(range_m);
        let snr_db = to_db(snr.max(1e-3)).clamp(SNR_RANGE_DB.0, SNR_RANGE_DB.1);
        if (snr_db - self.snr_db).abs() > SNR_STEP_DB {
            self.snr_db = snr_db;
            self.statistics = detector.target(config.swerling, from_db(snr_db));
        }
    }

    /// Ŝ, dB.
    pub fn snr_db(&self) -> f64 {
        self.snr_db
    }

    /// D and λ of the estimate.
    pub fn statistics(&self) -> &TargetStatistics {
        &self.statistics
    }
}

/// (r/km)⁴; nearer than 10 m nothing changes any more.
fn spreading(range_m: f64) -> f64 {
    (range_m.max(10.0) / 1000.0).powi(4)
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::config::Swerling;
    use common::random::{Purpose, generator};
    use rand_distr::{Distribution, Exp};

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

    #[test]
    fn the_mean_excess_finds_the_signal_to_noise_ratio() {
        let config = TrackerConfig { snr_db: 12.0, ..TrackerConfig::default() };
        let detector = Detector::new(1e-6, 0);
        let mut amplitude = Amplitude::prior(1000.0, &config, &detector);
        let mut rng = generator(3, Purpose::Test, 0, 0);
        let power = Exp::new(1.0 / (1.0 + from_db(20.0))).expect("positive");
        let mut mean = 0.0;
        for scan in 0..2000 {
            let q = power.sample(&mut rng);
            if q > detector.threshold {
                amplitude.learn(q, 1.0, 1000.0, &detector);
            }
            amplitude.look(1000.0, &config, &detector);
            if scan >= 1000 {
                mean += amplitude.snr_db() / 1000.0;
            }
        }
        assert!((mean - 20.0).abs() < 0.7, "{mean}");
        amplitude.look(2000.0, &config, &detector);
        assert!((amplitude.snr_db() - (20.0 - 12.04)).abs() < 2.5, "{}", amplitude.snr_db());
        assert_eq!(config.swerling, Swerling::One);
    }
}
