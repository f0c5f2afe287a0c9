//! Noise in video of few bits: every detector keeps the false-alarm rate that is set.

use common::config::{Cfar, ExtractorConfig};
use common::random::{Purpose, generator};
use plot_extractor::cfar::Detector;
use rand::RngExt;
use video_source::cells::Packing;

const RANGES: usize = 512;
const DWELLS: u64 = 1500;
const PFA: f64 = 1e-3;

/// Codes of Rayleigh noise of a mean power of `steps`², packed.
fn spoke(packing: Packing, steps: f64, rng: &mut impl rand::Rng) -> Vec<u8> {
    let per_octet = 8 / usize::from(packing.bits);
    let mut octets = vec![0_u8; RANGES / per_octet];
    for cell in 0..RANGES {
        let amplitude = steps * (-(1.0 - rng.random::<f64>()).ln()).sqrt();
        let code = (amplitude as u32).min(packing.most) as u8;
        octets[cell / per_octet] |= code << ((per_octet - 1 - cell % per_octet) * usize::from(packing.bits));
    }
    octets
}

/// False alarms over those set.
fn rate(cfar: Cfar, bits: u8, steps: f64) -> f64 {
    let config = ExtractorConfig { cfar, pfa: PFA, ..ExtractorConfig::default() };
    let mut detector = Detector::new(&config, RANGES);
    let packing = Packing::asterix(bits);
    let mut rng = generator(11, Purpose::Test, u32::from(bits), 0);
    let (mut amplitudes, mut powers, mut hits) = (vec![0.0; RANGES], vec![0.0; RANGES], Vec::new());
    let mut found = 0;
    for dwell in 0..DWELLS {
        packing.unpack(&spoke(packing, steps, &mut rng), &mut amplitudes);
        hits.clear();
        assert!(detector.detect(dwell as u32 % 360, &amplitudes, &mut powers, &mut hits));
        found += hits.len();
    }
    found as f64 / (PFA * (DWELLS as usize * RANGES) as f64)
}

#[test]
fn noise_of_few_bits_gives_the_false_alarms_that_are_set() {
    for cfar in [Cfar::Ca, Cfar::Go, Cfar::So, Cfar::Os] {
        for (bits, steps) in [(8, 30.0), (4, 3.0), (2, 0.8)] {
            let rate = rate(cfar, bits, steps);
            println!("{cfar:?}, {bits} bits: {rate:.2} times the set rate");
            assert!((0.8..1.25).contains(&rate), "{cfar:?}, {bits} bits: {rate:.2} times the set rate");
        }
    }
}
