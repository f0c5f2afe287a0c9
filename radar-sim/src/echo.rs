//! Complex echoes that are added to the noise of a dwell.

/// Echoes of one dwell, cell by cell. Several targets and clutter add up as complex
/// amplitudes before the noise comes in, so close targets interfere as they do in reality.
#[derive(Debug, Default)]
pub struct Echoes {
    cells: Vec<(u32, f32, f32)>,
}

impl Echoes {
    /// Forgets all echoes.
    pub fn clear(&mut self) {
        self.cells.clear();
    }

    /// Adds the complex amplitude (re, im) to a cell, in units of the root mean noise power.
    pub fn add(&mut self, cell: usize, re: f64, im: f64) {
        self.cells.push((cell as u32, re as f32, im as f32));
    }

    /// Turns noise amplitudes ρ into |s + n|. The noise's phase θ is uniform and independent
    /// of ρ, so it needs drawing only here: |s + n|² = (Re s + ρ cos θ)² + (Im s + ρ sin θ)².
    pub fn apply(&mut self, amplitudes: &mut [f32], mut phase: impl FnMut() -> f32) {
        self.cells.sort_unstable_by_key(|&(cell, _, _)| cell);
        let mut rest = self.cells.as_slice();
        while let Some(&(cell, _, _)) = rest.first() {
            let count = rest.iter().take_while(|echo| echo.0 == cell).count();
            let (same, after) = rest.split_at(count);
            let (re, im) = same.iter().fold((0.0, 0.0), |(re, im), echo| (re + echo.1, im + echo.2));
            let noise = amplitudes[cell as usize];
            let (sin, cos) = phase().sin_cos();
            amplitudes[cell as usize] = (re + noise * cos).hypot(im + noise * sin);
            rest = after;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise;
    use common::random::{Purpose, generator};
    use rand::RngExt;

    /// A constant echo of power S in unit noise: mean power 1 + S, variance 1 + 2S.
    #[test]
    fn echo_in_noise_has_the_moments_of_rice() {
        let cells = 200_000;
        let mut amplitudes = vec![0.0; cells];
        noise::fill(&mut amplitudes, &mut generator(3, Purpose::Noise, 0, 0));
        let mut echoes = Echoes::default();
        for cell in 0..cells {
            echoes.add(cell, 1.0, 0.0);
            echoes.add(cell, 1.0, 2.0); // together S = 8
        }
        let mut rng = generator(3, Purpose::Test, 0, 0);
        echoes.apply(&mut amplitudes, || rng.random::<f32>() * std::f32::consts::TAU);
        let n = cells as f64;
        let mean = amplitudes.iter().map(|&a| f64::from(a).powi(2)).sum::<f64>() / n;
        let variance = amplitudes.iter().map(|&a| (f64::from(a).powi(2) - mean).powi(2)).sum::<f64>() / n;
        assert!((mean - 9.0).abs() < 5.0 * (17.0 / n).sqrt(), "{mean}");
        assert!((variance - 17.0).abs() < 0.5, "{variance}");
    }
}
