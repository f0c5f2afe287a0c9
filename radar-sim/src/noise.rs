//! Receiver noise: the amplitude of a complex normal number of unit mean power, in every cell.
//!
//! ```text
//! a = √(−ln u),  u uniform on (0, 1):   a² is exponential with mean 1 (C2)
//! ```

use rand::Rng;

/// Cells drawn at a time: the random bits stay in the first-level cache.
const BLOCK: usize = 1024;

/// Fills `amplitudes` with noise amplitudes. One 32-bit word of `rng` makes one cell, so
/// the result depends on the generator alone and not on the machine: no fused
/// operations, and square root and conversions are exactly rounded everywhere.
pub fn fill(amplitudes: &mut [f32], rng: &mut impl Rng) {
    let mut bytes = [0_u8; 4 * BLOCK];
    for block in amplitudes.chunks_mut(BLOCK) {
        let bytes = &mut bytes[..4 * block.len()];
        rng.fill_bytes(bytes);
        rayleigh(bytes, block);
    }
}

/// [`amplitude`] of each four bytes.
#[multiversion::multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl", "x86_64+avx2", "x86_64+sse4.1"))]
fn rayleigh(bytes: &[u8], amplitudes: &mut [f32]) {
    for (amplitude_of_cell, word) in amplitudes.iter_mut().zip(bytes.chunks_exact(4)) {
        *amplitude_of_cell = amplitude(u32::from_le_bytes([word[0], word[1], word[2], word[3]]));
    }
}

/// √(−ln u) for u = (⌊word/2⌋ + ½) 2⁻³¹: u never is 0 or, before rounding, 1, and the tail
/// reaches to a² = 22.2 (probability 2·10⁻¹⁰), far beyond any threshold of use.
#[expect(clippy::inline_always, reason = "must be compiled with the instructions of its caller")]
#[inline(always)]
fn amplitude(word: u32) -> f32 {
    // 31 bits: conversion from signed integers is one instruction on every machine.
    let x = (word >> 1).cast_signed() as f32 + 0.5;
    let power = 31.0 * std::f32::consts::LN_2 - natural_logarithm(x);
    power.max(0.0).sqrt()
}

/// ln x for normal positive x, absolute error below 4·10⁻⁷ for x < 2³¹.
///
/// x = 2^e·(1+f) with 1+f in [√½, √2); ln(1+f) = 2 artanh(s) with s = f/(2+f), as a series in
/// s² up to s⁹, whose remainder is below 2·10⁻⁹.
#[inline(always)]
fn natural_logarithm(x: f32) -> f32 {
    const SQRT_HALF: u32 = 0x3f35_04f3;
    let bits = x.to_bits().wrapping_sub(SQRT_HALF);
    let exponent = bits.cast_signed() >> 23;
    let f = f32::from_bits((bits & 0x007f_ffff) + SQRT_HALF) - 1.0;
    let s = f / (2.0 + f);
    let s2 = s * s;
    let series = 2.0 / 9.0;
    let series = series * s2 + 2.0 / 7.0;
    let series = series * s2 + 2.0 / 5.0;
    let series = series * s2 + 2.0 / 3.0;
    let series = series * s2 + 2.0;
    exponent as f32 * std::f32::consts::LN_2 + s * series
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::random::{Purpose, generator};

    #[test]
    fn logarithm_agrees_with_the_library() {
        for step in 1..2_000_000_u32 {
            let x = (step * 1073) as f32 + 0.5;
            let exact = f64::from(x).ln();
            assert!((f64::from(natural_logarithm(x)) - exact).abs() < 3e-6, "{x}");
        }
        // Near u = 1 the power is small and must keep its relative precision.
        let x = (1_u32 << 31) as f32 * 0.999;
        let power = 31.0 * std::f32::consts::LN_2 - natural_logarithm(x);
        assert!((f64::from(power) + 0.999_f64.ln()).abs() < 4e-6);
    }

    /// Shares of cells above t must be e^(−t), within five standard errors of 20 million cells.
    #[test]
    fn power_is_exponential_out_to_the_tail() {
        let mut rng = generator(11, Purpose::Noise, 0, 0);
        let mut cells = vec![0.0_f32; 20_000_000];
        fill(&mut cells, &mut rng);
        for t in [0.01, 0.5, 1.0, 3.0, 6.0, 9.0, 12.0, 14.0] {
            let expected = (-t_f64(t)).exp() * cells.len() as f64;
            let found = cells.iter().filter(|&&a| a * a > t).count() as f64;
            assert!((found - expected).abs() < 5.0 * expected.sqrt() + 1.0, "{t}: {found} of {expected}");
        }
        let mean = cells.iter().map(|&a| f64::from(a * a)).sum::<f64>() / cells.len() as f64;
        assert!((mean - 1.0).abs() < 5.0 / (cells.len() as f64).sqrt());
    }

    fn t_f64(t: f32) -> f64 {
        f64::from(t)
    }

    /// The fast path is the plain formula, cell by cell, whatever instructions it uses.
    #[test]
    fn fast_path_equals_its_plain_twin() {
        let mut cells = vec![0.0_f32; 3001];
        fill(&mut cells, &mut generator(1, Purpose::Noise, 2, 3));
        let mut rng = generator(1, Purpose::Noise, 2, 3);
        let mut bytes = vec![0_u8; 4 * cells.len()];
        for block in bytes.chunks_mut(4 * BLOCK) {
            rng.fill_bytes(block);
        }
        for (cell, word) in cells.iter().zip(bytes.chunks_exact(4)) {
            let plain = amplitude(u32::from_le_bytes([word[0], word[1], word[2], word[3]]));
            assert_eq!(cell.to_bits(), plain.to_bits());
        }
    }
}
