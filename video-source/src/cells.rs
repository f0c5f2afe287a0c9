//! Codes of cells, packed in octets, to amplitudes.

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

    /// Writes the amplitudes of the first cells of `octets`, as many as `amplitudes` has: code + ½.
    ///
    /// # Panics
    /// If there are fewer cells.
    pub fn unpack(self, octets: &[u8], amplitudes: &mut [f32]) {
        assert!(self.cells(octets.len()) >= amplitudes.len(), "{} octets for {} cells", octets.len(), amplitudes.len());
        let amplitude = |code: u32| code.min(self.most) as f32 + 0.5;
        if self.bits < 8 {
            let per_octet = 8 / usize::from(self.bits);
            let mask = (1_u8 << self.bits) - 1;
            for (cells, &octet) in amplitudes.chunks_mut(per_octet).zip(octets) {
                for (index, cell) in cells.iter_mut().enumerate() {
                    let place = if self.lowest_first { index } else { per_octet - 1 - index };
                    *cell = amplitude((octet >> (place * usize::from(self.bits)) & mask).into());
                }
            }
        } else {
            for (cell, code) in amplitudes.iter_mut().zip(octets.chunks_exact(usize::from(self.bits / 8))) {
                *cell = amplitude(code.iter().fold(0, |code, &octet| code << 8 | u32::from(octet)));
            }
        }
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
        assert_eq!(unpack(Packing::asterix(1), 9), [1.5, 0.5, 1.5, 1.5, 0.5, 0.5, 0.5, 1.5, 0.5]);
        assert_eq!(unpack(Packing::asterix(2), 5), [2.5, 3.5, 0.5, 1.5, 0.5]);
        assert_eq!(unpack(Packing::asterix(4), 4), [11.5, 1.5, 2.5, 15.5]);
        assert_eq!(unpack(Packing::asterix(8), 4), [177.5, 47.5, 0.5, 7.5]);
        assert_eq!(unpack(Packing::asterix(16), 2), [45_359.5, 7.5]);
        assert_eq!(unpack(Packing::asterix(32), 1), [f32::from_bits(0x4f31_2f00)]);
        let halo = Packing { bits: 4, lowest_first: true, most: 13 };
        assert_eq!(unpack(halo, 4), [1.5, 11.5, 13.5, 2.5]);
        assert_eq!(halo.full_scale().to_bits(), 13.5_f32.to_bits());
    }
}
