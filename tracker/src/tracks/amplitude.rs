//! What is known of a target's signal-to-noise ratio (T19), (T20.5).
//!
//! ```text
//! Ŝ = mean of q_m − t − 1 over the track's own plots, t the threshold that they exceeded            (T19)
//! ```
//!
//! This holds because the part of an exponential power above a threshold has the same mean as the whole. A prior counts for some
//! scans, and old plots are forgotten faster than a target's range and aspect change its power. Statistics are averaged over an
//! interval about Ŝ (T20.5).

use common::amplitude::{Detector, TargetStatistics};
use common::config::TrackerConfig;
use common::units::{from_db, to_db};

/// Share of older plots that is kept per plot in the estimate of amplitude.
const FORGETTING: f64 = 0.95;
/// Range of the estimated signal-to-noise ratio, dB.
const SNR_RANGE_DB: (f64, f64) = (3.0, 40.0);
/// The statistics are renewed when the estimate has moved this far, dB.
const SNR_STEP_DB: f64 = 0.25;

/// What is known of a target's amplitude.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Amplitude {
    /// Σ weight · (q − t − 1), prior included.
    power: f64,
    /// Σ weight, prior included.
    scans: f64,
    statistics: TargetStatistics,
    snr_db: f64,
}

impl Amplitude {
    /// Before any plot.
    pub fn prior(config: &TrackerConfig, detector: &Detector) -> Self {
        let scans = config.snr_prior_scans;
        Self {
            power: scans * from_db(config.snr_db),
            scans,
            statistics: detector.target_within(config.swerling, config.snr_db, config.snr_spread_db),
            snr_db: config.snr_db,
        }
    }

    /// Of a track that a tracker before has followed for `plots` plots and took to be of `snr_db`.
    pub fn before(config: &TrackerConfig, detector: &Detector, snr_db: f64, plots: u32) -> Self {
        let mut amplitude = Self::prior(config, detector);
        if config.snr_prior_scans > 0.0 {
            amplitude.scans = (amplitude.scans + f64::from(plots)).min(1.0 / (1.0 - FORGETTING));
            amplitude.power = amplitude.scans * from_db(snr_db);
            amplitude.renew_statistics(config, detector);
        }
        amplitude
    }

    /// A plot of power `q`, one of those above `threshold`, that is the target's with probability `weight` (T19).
    pub fn learn(&mut self, q: f64, weight: f64, threshold: f64) {
        let keep = 1.0 - (1.0 - FORGETTING) * weight;
        self.power = keep * self.power + weight * (q - threshold - 1.0);
        self.scans = keep * self.scans + weight;
    }

    /// Renews D and λ.
    pub fn renew_statistics(&mut self, config: &TrackerConfig, detector: &Detector) {
        if config.snr_prior_scans <= 0.0 {
            return;
        }
        let snr = self.power / self.scans;
        let snr_db = to_db(snr.max(1e-3)).clamp(SNR_RANGE_DB.0, SNR_RANGE_DB.1);
        if (snr_db - self.snr_db).abs() > SNR_STEP_DB {
            self.snr_db = snr_db;
            self.statistics = detector.target_within(config.swerling, snr_db, config.snr_spread_db);
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

#[cfg(test)]
mod tests {
    use super::*;
    use common::config::Swerling;
    use common::random::{Purpose, generator};
    use rand_distr::{Distribution, Exp};

    /// Whatever the threshold: the detector's, and the higher one of a scan (T20.2).
    #[test]
    fn the_mean_excess_finds_the_signal_to_noise_ratio() {
        let config = TrackerConfig { snr_db: 12.0, ..TrackerConfig::default() };
        let detector = Detector::new(1e-6, 0);
        for (true_db, raised) in [(20.0, 0.0), (20.0, 40.0), (14.0, 30.0)] {
            let threshold = detector.threshold + raised;
            let mut amplitude = Amplitude::prior(&config, &detector);
            let mut rng = generator(3, Purpose::Test, 0, 0);
            let power = Exp::new(1.0 / (1.0 + from_db(true_db))).expect("positive");
            let (mut mean, mut seen) = (0.0, 0);
            while seen < 3000 {
                let q = power.sample(&mut rng);
                if q <= threshold {
                    continue;
                }
                seen += 1;
                amplitude.learn(q, 1.0, threshold);
                amplitude.renew_statistics(&config, &detector);
                if seen > 1000 {
                    mean += amplitude.snr_db() / 2000.0;
                }
            }
            assert!((mean - true_db).abs() < 0.7, "{true_db} dB, raised by {raised}: {mean}");
        }
        assert_eq!(config.swerling, Swerling::One);
    }
}
