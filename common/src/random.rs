//! Random numbers that depend on what they are for, never on time or thread.

use chacha20::ChaCha8Rng;
use rand::SeedableRng;

use crate::fnv::fnv1a;

/// What a draw is for: one independent stream of numbers each.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum Purpose {
    /// Receiver noise of every cell.
    Noise = 1,
    /// Fluctuation of a target's amplitude and its phase.
    Fluctuation = 2,
    /// Ground clutter.
    Clutter = 3,
    /// Drawn measurements in experiments.
    Measurement = 4,
    /// Drawn trajectories in experiments.
    Trajectory = 5,
    /// Phase of a target's echo.
    Phase = 7,
    /// Tests.
    Test = 6,
    /// Resampling of results for their intervals.
    Resampling = 8,
    /// Which stage is killed when.
    Chaos = 9,
}

/// The generator for one purpose at one place in the run (scan and dwell, or run and step).
///
/// `ChaCha8`: the same numbers on every machine, and any place is reached at once.
pub fn generator(seed: u64, purpose: Purpose, scan: u32, dwell: u32) -> ChaCha8Rng {
    let mut key = [0_u8; 32];
    key[..8].copy_from_slice(&seed.to_le_bytes());
    key[8..12].copy_from_slice(&(purpose as u32).to_le_bytes());
    key[12..16].copy_from_slice(&scan.to_le_bytes());
    key[16..20].copy_from_slice(&dwell.to_le_bytes());
    ChaCha8Rng::from_seed(key)
}

/// The seed of everything random about the thing `name`: another for every name.
pub fn seed_for(seed: u64, name: &str) -> u64 {
    fnv1a(seed, name.as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::Rng;

    #[test]
    fn streams_differ_by_every_part_of_the_key_and_repeat() {
        let first = |seed, purpose, scan, dwell| generator(seed, purpose, scan, dwell).next_u64();
        let base = first(1, Purpose::Noise, 2, 3);
        assert_eq!(base, first(1, Purpose::Noise, 2, 3));
        assert_ne!(base, first(2, Purpose::Noise, 2, 3));
        assert_ne!(base, first(1, Purpose::Clutter, 2, 3));
        assert_ne!(base, first(1, Purpose::Noise, 3, 3));
        assert_ne!(base, first(1, Purpose::Noise, 2, 4));
    }
}
