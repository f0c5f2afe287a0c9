//! Dwells that are no picture of targets: jammed ones and saturated ones (C14).
//!
//! Targets, and land, lie at some ranges. Pulses of another transmitter that turn up in a receiver lie at all of them, strong and in
//! dozens. Such a dwell would be a thousand plots at one azimuth; it is recognised, counted and left out. Noise jamming gives no
//! plots: a CFAR follows it, until the receiver is at its full scale.

use crate::cfar::Hit;

/// Parts of the ranges in which hits are looked for.
const PARTS: usize = 16;
/// Hits in so many of them, at least, are not of targets.
const PARTS_JAMMED: u32 = 12;
/// Nor are fewer echoes than these a thousand plots: the least number, and the least share of the ranges.
const LEAST_ECHOES: usize = 16;
const LEAST_SHARE: f64 = 0.04;
/// Weaker hits, power over noise, are those of noise, of rain and of the lowest codes of video.
const STRONG: f32 = 20.0;
/// So many times the hits that noise gives are not noise.
const TIMES_NOISE: f64 = 8.0;
/// Share of cells at full scale of a saturated dwell.
const SATURATED: f64 = 0.25;

/// Whether strong echoes of a dwell lie all over its ranges: at least 16, one for every 25 ranges and eight times as many as noise
/// gives, in 12 of 16 parts of the ranges. Neighbouring hits, by ascending cell, are one echo.
pub fn is_jammed(hits: &[Hit], cells: usize, ranges: usize, pfa: f64) -> bool {
    let least = LEAST_SHARE * ranges as f64 + TIMES_NOISE * pfa * cells as f64;
    if hits.len() < LEAST_ECHOES || (hits.len() as f64) < least {
        return false;
    }
    let (mut echoes, mut parts, mut last) = (0, 0_u16, None);
    for cell in hits.iter().filter(|hit| hit.power >= STRONG * hit.noise).map(|hit| hit.cell) {
        echoes += usize::from(last.is_none_or(|last| cell > last + 1));
        parts |= 1 << (cell as usize % ranges * PARTS / ranges);
        last = Some(cell);
    }
    echoes >= LEAST_ECHOES && echoes as f64 >= least && parts.count_ones() >= PARTS_JAMMED
}

/// Whether a quarter of the cells are at `full_scale`; never where there is none (0).
pub fn is_saturated(amplitudes: &[f32], full_scale: f32) -> bool {
    let at_full_scale = || amplitudes.iter().filter(|&&amplitude| amplitude >= full_scale).count();
    full_scale > 0.0 && at_full_scale() as f64 > SATURATED * amplitudes.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hits(cells: impl Iterator<Item = u32>) -> Vec<Hit> {
        cells.map(|cell| Hit { cell, power: 30.0, noise: 1.0 }).collect()
    }

    #[test]
    fn pulses_all_over_the_ranges_are_jamming_and_land_is_not() {
        let every_tenth = hits((0..100).map(|index| index * 10));
        assert!(is_jammed(&every_tenth, 1024, 1024, 1e-4));
        let land = hits(300..700);
        assert!(!is_jammed(&land, 1024, 1024, 1e-4));
        let ships = hits((0..24).map(|index| index / 2 * 80 + index % 2));
        assert!(!is_jammed(&ships, 1024, 1024, 1e-4));
        // Rain and speckle of the lowest code, over cells that are 0.
        let speckle: Vec<Hit> = every_tenth.iter().map(|hit| Hit { power: 2.25, noise: 0.25, ..*hit }).collect();
        assert!(!is_jammed(&speckle, 1024, 1024, 1e-4));
        // As many as a high probability of false alarm gives.
        assert!(!is_jammed(&every_tenth, 1024, 1024, 0.05));
    }

    #[test]
    fn a_quarter_at_full_scale_is_saturated() {
        let mut amplitudes = vec![1.0; 100];
        amplitudes[..25].fill(255.5);
        assert!(!is_saturated(&amplitudes, 255.5));
        amplitudes[25] = 255.5;
        assert!(is_saturated(&amplitudes, 255.5) && !is_saturated(&amplitudes, 0.0));
    }
}
