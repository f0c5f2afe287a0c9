//! A radar's amplitudes as decision statistics.
//!
//! Reports carry amplitudes in dB relative to a reference that is each radar's own. What the tracker needs is
//! z = amplitude over root mean noise power, (C4). Weak plots lie just above the radar's threshold, so the level that a
//! few per cent of the plots stay below stands for it:
//!
//! ```text
//! z = z_T · 10^((A − L) / 20),   z_T² = −ln F
//! ```
//!
//! A: amplitude, dB; L: level, dB, the running 5 % quantile of A; F: probability of false alarm, configured.

/// Share of plots below the level.
const SHARE: f64 = 0.05;
/// How far a plot moves the level at most, dB.
const STEP_DB: f64 = 0.5;
/// Plots during which the level is the lowest amplitude so far.
const FIRST_PLOTS: u32 = 20;
/// F where none is configured.
const ASSUMED_PFA: f64 = 1e-6;

/// The running level of a radar's amplitudes.
#[derive(Debug, Clone)]
pub struct AmplitudeLevel {
    level_db: f64,
    plots: u32,
    threshold: f64,
}

impl AmplitudeLevel {
    /// Of a radar with the probability of false alarm `pfa`; 0 for unknown.
    pub fn new(pfa: f64) -> Self {
        let pfa = if pfa > 0.0 { pfa } else { ASSUMED_PFA };
        Self { level_db: f64::INFINITY, plots: 0, threshold: (-pfa.ln()).sqrt() }
    }

    /// The decision statistic of the next plot; at least that of the threshold.
    pub fn statistic(&mut self, amplitude_db: f64) -> f32 {
        self.plots = self.plots.saturating_add(1);
        if self.plots <= FIRST_PLOTS {
            self.level_db = self.level_db.min(amplitude_db);
        } else {
            self.level_db += STEP_DB * if amplitude_db < self.level_db { SHARE - 1.0 } else { SHARE };
        }
        let above_db = (amplitude_db - self.level_db).max(0.0);
        (self.threshold * 10_f64.powf(above_db / 20.0)) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whatever the reference of a radar and its slow changes: the same plots have the same statistics.
    #[test]
    fn the_level_follows_the_weak_plots_of_any_reference() {
        let spread_db = |index: u32| f64::from(index * 7919 % 100) * 0.3;
        let of = |reference: &dyn Fn(u32) -> f64| {
            let mut level = AmplitudeLevel::new(1e-4);
            let values: Vec<f32> =
                (0..5000).map(|index| level.statistic(reference(index) + spread_db(index))).collect();
            values[4000..].to_vec()
        };
        let (low, high) = (of(&|_| -100.0), of(&|_| 40.0));
        assert!(low.iter().zip(&high).all(|(low, high)| (low - high).abs() < 1e-3 * low));
        let threshold = (-(1e-4_f64).ln()).sqrt();
        let weak = low.iter().filter(|&&z| f64::from(z) <= threshold).count();
        assert!((20..=80).contains(&weak), "{weak} of 1000 at the threshold");
        let most = f64::from(low.iter().copied().fold(0.0, f32::max));
        assert!((most / threshold).log10() * 20.0 > 24.0, "{most}");
        let drifting = of(&|index| -60.0 + f64::from(index) * 0.002);
        let weak = drifting.iter().filter(|&&z| f64::from(z) <= threshold).count();
        assert!((10..=120).contains(&weak), "{weak} of 1000 at the threshold while the reference drifts");
    }
}
