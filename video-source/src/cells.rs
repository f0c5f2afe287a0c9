//! Codes of cells, packed in octets, to amplitudes.

/// Codes of less than an octet, at most.
const COARSE: usize = 16;
/// Fewer cells than these tell nothing of how power falls beyond a code.
const FEW: u32 = 8;
/// Where the places within steps begin, and their step: an odd number whose multiples are spread evenly.
const FIRST: u64 = 0x243f_6a88_85a3_08d3;
const STEP: u64 = 0x9e37_79b9_7f4a_7c15;

/// How codes lie in octets.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Packing {
    /// Size of a code: 1, 2, 4, 8, 16 or 32 bits.
    pub bits: u8,
    /// Codes of less than an octet begin with its lowest bits; else with the highest, as in ASTERIX.
    pub lowest_first: bool,
    /// The largest code that is an amplitude; larger ones are marks of the radar and count as this one.
    pub most: u32,
}

impl Packing {
    /// Codes of `bits` bits as in ASTERIX.
    pub fn asterix(bits: u8) -> Self {
        Self { bits, lowest_first: false, most: u32::MAX >> (32 - bits) }
    }

    /// Cells in `octets` octets.
    pub fn cells(self, octets: usize) -> usize {
        octets * 8 / usize::from(self.bits)
    }

    /// The amplitude of the largest code.
    pub fn full_scale(self) -> f32 {
        self.most as f32 + 0.5
    }

    /// Writes the amplitudes of the first cells of `octets`, as many as `amplitudes` has: code + ½, or somewhere in the step of a code of
    /// less than an octet (C14).
    ///
    /// # Panics
    /// If there are fewer cells.
    pub fn unpack(self, octets: &[u8], amplitudes: &mut [f32]) {
        assert!(self.cells(octets.len()) >= amplitudes.len(), "{} octets for {} cells", octets.len(), amplitudes.len());
        if self.bits < 8 {
            let per_octet = 8 / usize::from(self.bits);
            let mask = (1_u8 << self.bits) - 1;
            let mut counts = [0_u32; COARSE];
            for (cells, &octet) in amplitudes.chunks_mut(per_octet).zip(octets) {
                for (index, cell) in cells.iter_mut().enumerate() {
                    let place = if self.lowest_first { index } else { per_octet - 1 - index };
                    let code = u32::from(octet >> (place * usize::from(self.bits)) & mask).min(self.most);
                    counts[code as usize] += 1;
                    *cell = code as f32;
                }
            }
            self.spread(octets, &counts, amplitudes);
        } else {
            let middle = |code: u32| code.min(self.most) as f32 + 0.5;
            for (cell, code) in amplitudes.iter_mut().zip(octets.chunks_exact(usize::from(self.bits / 8))) {
                *cell = middle(code.iter().fold(0, |code, &octet| code << 8 | u32::from(octet)));
            }
        }
    }

    /// Draws each code's amplitude from its step. With G(c) cells of code c and more, and power x between c² and (c + 1)²:
    ///
    /// ```text
    /// P(power > x | code c) = (G(x) − G(c + 1)) / (G(c) − G(c + 1)),   ln G linear in x from G(c) to G(c + 1)      (C14)
    /// ```
    fn spread(self, octets: &[u8], counts: &[u32; COARSE], amplitudes: &mut [f32]) {
        let all = f64::from(counts.iter().sum::<u32>());
        if counts.iter().filter(|count| **count > 0).count() < 2 {
            for code in amplitudes {
                *code += 0.5; // of one code alone nothing is known
            }
            return;
        }
        // G(c + 1)/G(c), and the mean of the power's exponential between.
        let mut steps = [(0.0, 1.0); COARSE];
        let mut above = 0;
        for code in (0..COARSE).rev() {
            let (here, width) = (f64::from(above + counts[code]), (2 * code + 1) as f64);
            let slope = if above >= FEW {
                (f64::from(above) / here).ln() / width
            } else if here < all {
                (here / all).ln() / (code * code) as f64 // as from 0 to here
            } else {
                (0.5 / all).ln() / width // half a cell might be stronger
            };
            steps[code] = ((slope * width).exp(), 1.0 / slope);
            above += counts[code];
        }
        let mut places = Places::of(octets);
        for cell in amplitudes {
            let code = *cell as usize;
            // The largest code stands for all that is stronger, too.
            *cell = if code as u32 == self.most {
                self.full_scale()
            } else {
                let (ratio, mean) = steps[code];
                let power = (code * code) as f64 + mean * (1.0 - places.next() * (1.0 - ratio)).ln();
                power.sqrt() as f32
            };
        }
    }
}

/// Places within a step, evenly distributed; the same for the same octets, so that the same video gives the same plots.
struct Places(u64);

impl Places {
    fn of(octets: &[u8]) -> Self {
        let (whole, _) = octets.as_chunks();
        Self(whole.iter().fold(FIRST, |seed, chunk| (seed ^ u64::from_le_bytes(*chunk)).wrapping_mul(STEP)))
    }

    /// 0 … 1, by SplitMix64.
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(STEP);
        let mut mixed = (self.0 ^ self.0 >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((mixed ^ mixed >> 31) >> 11) as f64 / (1_u64 << 53) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_of_all_sizes() {
        let octets = [0b1011_0001, 0x2f, 0x00, 0x07];
        let unpack = |packing: Packing, cells: usize| {
            let mut amplitudes = vec![0.0; cells];
            packing.unpack(&octets, &mut amplitudes);
            amplitudes
        };
        let codes = |amplitudes: Vec<f32>| amplitudes.into_iter().map(|amplitude| amplitude as u32).collect::<Vec<_>>();
        assert_eq!(codes(unpack(Packing::asterix(1), 9)), [1, 0, 1, 1, 0, 0, 0, 1, 0]);
        assert_eq!(codes(unpack(Packing::asterix(2), 5)), [2, 3, 0, 1, 0]);
        assert_eq!(codes(unpack(Packing::asterix(4), 4)), [11, 1, 2, 15]);
        assert_eq!(
            unpack(Packing::asterix(4), 4),
            unpack(Packing::asterix(4), 4),
            "the same video is the same amplitudes"
        );
        assert_eq!(unpack(Packing::asterix(8), 4), [177.5, 47.5, 0.5, 7.5]);
        assert_eq!(unpack(Packing::asterix(16), 2), [45_359.5, 7.5]);
        assert_eq!(unpack(Packing::asterix(32), 1), [f32::from_bits(0x4f31_2f00)]);
        let halo = Packing { bits: 4, lowest_first: true, most: 13 };
        assert_eq!(codes(unpack(halo, 4)), [1, 11, 13, 2]);
        assert_eq!(unpack(halo, 4)[2].to_bits(), halo.full_scale().to_bits());
        assert_eq!(halo.full_scale().to_bits(), 13.5_f32.to_bits());
    }

    /// Rayleigh noise of any strength in steps comes out as it was before it was coded.
    #[test]
    fn noise_is_spread_as_noise() {
        for steps in [0.5_f64, 0.8, 3.0] {
            let cells = 200_000;
            let packing = Packing::asterix(4);
            let mut octets = vec![0_u8; cells / 2];
            for cell in 0..cells {
                // Quantiles in an order without meaning.
                let quantile = ((cell * 7_919 % cells) as f64 + 0.5) / cells as f64;
                let code = (steps * (-(1.0 - quantile).ln()).sqrt()) as u8;
                octets[cell / 2] |= code << (4 * (1 - cell % 2));
            }
            let mut amplitudes = vec![0.0; cells];
            packing.unpack(&octets, &mut amplitudes);
            for power in [0.05, 0.3, 0.7, 1.0, 2.0, 4.0] {
                let limit = (power * steps * steps).sqrt() as f32;
                let above = amplitudes.iter().filter(|&&amplitude| amplitude > limit).count() as f64 / cells as f64;
                assert!((above / (-power).exp() - 1.0).abs() < 0.05, "{steps} steps, {power}: {above}");
            }
        }
    }
}
