//! All detectors but CA-CFAR, which has its own: against their definitions, and in noise.

use common::amplitude::{MapMemory, NoiseEstimate, rank};
use common::random::{Purpose, generator};
use proptest::prelude::*;
use radar_sim::noise;

use super::*;

const KINDS: [Cfar; 4] = [Cfar::Go, Cfar::So, Cfar::Os, Cfar::ClutterMap];

fn config(cfar: Cfar, guard_cells: u32, reference_cells: u32, pfa: f64) -> ExtractorConfig {
    ExtractorConfig { cfar, pfa, guard_cells, reference_cells, ..ExtractorConfig::default() }
}

/// Estimate of the noise and threshold of each cell by definition, in double precision; none without reference cells.
fn plain(config: &ExtractorConfig, profile: &[f32], cell: usize) -> Option<(f64, f64)> {
    let (guard, reference) = (config.guard_cells as usize, config.reference_cells as usize);
    let powers = |cells: std::ops::Range<usize>| -> Vec<f64> {
        profile[cells].iter().map(|&amplitude| f64::from(amplitude).powi(2)).collect()
    };
    let before = powers(cell.saturating_sub(guard + reference)..cell.saturating_sub(guard));
    let end = profile.len();
    let after = powers((cell + guard + 1).min(end)..(cell + guard + reference + 1).min(end));
    let counts = (before.len() as u32, after.len() as u32);
    let mean = |cells: &[f64]| cells.iter().sum::<f64>() / cells.len() as f64;
    if counts == (0, 0) {
        return None;
    }
    let (noise, estimate) = match config.cfar {
        Cfar::Os => {
            let mut all = [before, after].concat();
            all.sort_by(f64::total_cmp);
            (NoiseEstimate::Ordered(counts.0 + counts.1), all[rank(counts.0 + counts.1) as usize - 1])
        }
        Cfar::Go if counts.0 == 0 || counts.1 == 0 => {
            (NoiseEstimate::Greater(counts.0, counts.1), mean(&[before, after].concat()))
        }
        Cfar::So if counts.0 == 0 || counts.1 == 0 => {
            (NoiseEstimate::Smaller(counts.0, counts.1), mean(&[before, after].concat()))
        }
        Cfar::Go => (NoiseEstimate::Greater(counts.0, counts.1), mean(&before).max(mean(&after))),
        _ => (NoiseEstimate::Smaller(counts.0, counts.1), mean(&before).min(mean(&after))),
    };
    let unit = estimate / noise.mean();
    Some((unit, unit * noise.factor(config.pfa)))
}

proptest! {
    /// Amplitudes are whole numbers, so that sums of squares are exact.
    #[test]
    fn fast_paths_equal_their_definitions(
        kind in 0_usize..3, rows in 1_usize..20, ranges in 1_usize..90, guard in 0_u32..4, reference in 2_u32..20, seed in any::<u64>(),
    ) {
        let config = config(KINDS[kind], guard, reference, 0.013_579);
        let mut state = seed | 1;
        let amplitudes: Vec<f32> = (0..rows * ranges).map(|_| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let draw = (state >> 33) % 97;
            if draw == 0 { 60.0 } else { (draw % 7) as f32 }
        }).collect();
        let mut cfar = Detector::new(&config, ranges);
        let (mut powers, mut hits) = (vec![0.0; amplitudes.len()], Vec::new());
        for _ in 0..2 { // the second time with used scratch
            hits.clear();
            prop_assert!(cfar.detect(0, &amplitudes, &mut powers, &mut hits));
        }
        let mut expected = Vec::new();
        for (row, profile) in amplitudes.chunks(ranges).enumerate() {
            for cell in 0..ranges {
                let power = f64::from(profile[cell]).powi(2);
                if let Some((noise, _)) = plain(&config, profile, cell).filter(|&(_, threshold)| power > threshold) {
                    expected.push(((row * ranges + cell) as u32, noise));
                }
            }
        }
        prop_assert_eq!(hits.len(), expected.len());
        for (hit, (cell, noise)) in hits.iter().zip(expected) {
            prop_assert_eq!(hit.cell, cell);
            prop_assert!((f64::from(hit.noise) - noise).abs() <= 1e-5 * noise, "{} != {}", hit.noise, noise);
        }
    }

    #[test]
    fn the_map_averages_each_cell_over_its_scans(memory in 2_u32..12, seed in any::<u64>(), cells in 1_usize..5000) {
        let mut cfar = ClutterMapCfar::new(2 * memory, 1e-2);
        let weights = MapMemory::new(2 * memory);
        let mut means = [vec![0.0_f64; cells], vec![0.0; cells]];
        let mut amplitudes = vec![0.0; cells];
        let mut powers = vec![0.0; cells];
        for scan in 0..20_u32 {
            for dwell in 0..2 {
                noise::fill(&mut amplitudes, &mut generator(seed, Purpose::Test, scan, dwell));
                let mut hits = Vec::new();
                prop_assert!(cfar.detect(dwell, &amplitudes, &mut powers, &mut hits));
                let factor = NoiseEstimate::Averaged { memory: 2 * memory, scans: scan }.factor(1e-2);
                let mut found = hits.iter().peekable();
                for (cell, (mean, &power)) in means[dwell as usize].iter_mut().zip(&powers).enumerate() {
                    let margin = f64::from(power) - factor * *mean;
                    let is_hit = found.next_if(|hit| hit.cell as usize == cell).is_some();
                    let is_clear = scan == 0 || margin.abs() > 1e-4 * f64::from(power);
                    prop_assert!(is_hit == (scan > 0 && margin > 0.0) || !is_clear, "scan {scan}, cell {cell}");
                    *mean += weights.weight_of(scan + 1) * (f64::from(power) - *mean);
                }
                prop_assert!(found.next().is_none());
            }
        }
    }
}

/// Cells over threshold in noise, and how many there should be: 26 million cells at 10⁻³, a hundred million at
/// 10⁻⁴, so that four standard errors are at most 4 % of it.
#[test]
fn false_alarms_in_noise_are_as_set() {
    const RANGES: usize = 512;
    for kind in KINDS {
        for (pfa, blocks) in [(1e-3, 100), (1e-4, 400)] {
            let (mut amplitudes, mut powers, mut hits) = (vec![0.0; 512 * RANGES], vec![0.0; 512 * RANGES], Vec::new());
            let mut cfar = Detector::new(&config(kind, 2, 16, pfa), RANGES);
            let (mut counted, mut tested) = (0, 0);
            for block in 0..blocks {
                noise::fill(&mut amplitudes, &mut generator(7, Purpose::Test, block, 0));
                hits.clear();
                assert!(cfar.detect(0, &amplitudes, &mut powers, &mut hits));
                counted += hits.len();
                tested += if kind == Cfar::ClutterMap && block == 0 { 0 } else { amplitudes.len() };
            }
            let expected = pfa * tested as f64;
            let ratio = counted as f64 / expected;
            assert!((ratio - 1.0).abs() < 4.0 / expected.sqrt() && expected > 10_000.0, "{kind:?}, {pfa}: {ratio}");
        }
    }
}

/// A region of clutter 15 dB above the noise: behind its edge the greater window holds clutter alone, so that GO-CFAR has the false
/// alarms of that one window; CA-CFAR without its search for hulls would have those of a mean that is half noise, OS-CFAR has more
/// than GO, and SO-CFAR takes the clutter for targets.
#[test]
fn at_the_edge_of_clutter_the_greater_window_holds() {
    const RANGES: usize = 128;
    const EDGE: usize = 64;
    let rate = |cfar: Cfar| {
        let mut detector = Detector::new(&config(cfar, 2, 16, 1e-3), RANGES);
        let (mut amplitudes, mut powers, mut hits) = (vec![0.0; 2048 * RANGES], vec![0.0; 2048 * RANGES], Vec::new());
        let mut at_edge = 0;
        for block in 0..40 {
            noise::fill(&mut amplitudes, &mut generator(8, Purpose::Test, block, 0));
            for profile in amplitudes.chunks_mut(RANGES) {
                profile[EDGE..].iter_mut().for_each(|amplitude| *amplitude *= 31.6_f32.sqrt());
            }
            hits.clear();
            assert!(detector.detect(0, &amplitudes, &mut powers, &mut hits));
            at_edge += hits.iter().filter(|hit| (EDGE..EDGE + 3).contains(&(hit.cell as usize % RANGES))).count();
        }
        f64::from(at_edge as u32) / (40.0 * 2048.0 * 3.0)
    };
    let greater = NoiseEstimate::Greater(16, 16);
    let of_one_window = NoiseEstimate::Mean(16).survival(greater.factor(1e-3) / greater.mean());
    let [go, so, os] = [Cfar::Go, Cfar::So, Cfar::Os].map(rate);
    // 800 false alarms: four standard errors are 14 %.
    assert!((go / of_one_window - 1.0).abs() < 0.14, "GO {go}, of one window {of_one_window}");
    assert!(os > 3.0 * go && so > 3.0 * os, "GO {go}, OS {os}, SO {so}");
}

/// Beside a target of equal strength, SO- and OS-CFAR keep the probability that CA-CFAR loses.
#[test]
fn a_second_target_hides_none_from_smaller_windows_and_ranks() {
    let mut profile = vec![1.0; 101];
    (profile[50], profile[56], profile[60]) = (8.0, 12.0, 12.0);
    for (cfar, seen) in [(Cfar::So, true), (Cfar::Os, true), (Cfar::Go, false)] {
        let (mut powers, mut hits) = (vec![0.0; 101], Vec::new());
        assert!(Detector::new(&config(cfar, 2, 16, 1e-6), 101).detect(0, &profile, &mut powers, &mut hits));
        assert_eq!(hits.iter().any(|hit| hit.cell == 50), seen, "{cfar:?}: {hits:?}");
    }
}

#[test]
fn impossible_amplitudes_are_refused() {
    for kind in KINDS {
        for bad in [f32::NAN, f32::INFINITY, -1.0, -f32::NAN] {
            let mut amplitudes = vec![1.0; 140];
            amplitudes[77] = bad;
            let (mut powers, mut hits) = (vec![0.0; 140], Vec::new());
            let mut cfar = Detector::new(&config(kind, 2, 16, 1e-3), 70);
            assert!(!cfar.detect(0, &amplitudes, &mut powers, &mut hits), "{kind:?}, {bad}");
            assert!(hits.is_empty());
        }
    }
}
