//! How often targets manoeuvre, learned from all system tracks.
//!
//! ```text
//! τ₀ = (s + Σ p₀ Δt) / (1 + Σ p₁ Δt / τ₁)          sums over the last 100 s; before it, one manoeuvre in s
//! ```
//!
//! Time spent in manoeuvres over the mean time of one says how many there were. Where nobody turns none is expected, and the system tracks are as
//! accurate as straight flight allows; where many do, the next turn is no surprise.

use super::Fusion;

/// Time after which what was seen is forgotten to 1/e, s.
const MEMORY_S: f64 = 100.0;

impl Fusion {
    /// Learns from the cycle of `step_s` s that ends now.
    pub(super) fn learn_manoeuvres(&mut self, step_s: f64) {
        let keep = (-step_s / MEMORY_S).exp();
        self.flown_s = self.flown_s.map(|time_s| time_s * keep);
        for system in self.systems.iter().filter(|system| system.alive && !system.contributors.is_empty()) {
            for (time_s, probability) in self.flown_s.iter_mut().zip(system.state.probability()) {
                *time_s += probability * step_s;
            }
        }
        let [straight_s, manoeuvre_s] = self.settings.motion.stay_s;
        let [straight, manoeuvring] = self.flown_s;
        self.motion.stay_s[0] = (straight_s + straight) / (1.0 + manoeuvring / manoeuvre_s);
    }
}
