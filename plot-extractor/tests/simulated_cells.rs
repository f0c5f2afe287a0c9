//! The extractor on simulated cells: false alarms, one plot per target, stated errors.

use std::convert::Infallible;

use common::angle;
use common::config::{ChainConfig, MotionConfig, Swerling, TargetConfig};
use common::geometry::{Polar, range_rate_mps};
use common::health::Reject;
use common::plots::{Plot, PlotsHeader};
use plot_extractor::PlotExtractor;
use radar_sim::DwellSimulator;

/// All plots of `scans`, and the headers of their messages.
fn extract(chain: &ChainConfig, scans: u32) -> (Vec<PlotsHeader>, Vec<Plot>) {
    let mut simulator = DwellSimulator::new(chain).expect("valid scenario");
    let mut extractor = PlotExtractor::new(&chain.extractor, &chain.radar);
    let mut amplitudes = vec![0.0; simulator.cells()];
    let (mut headers, mut plots) = (Vec::new(), Vec::new());
    for scan in 0..scans {
        for dwell in 0..chain.radar.dwells_per_scan {
            simulator.fill(scan, dwell, &mut amplitudes);
            let taken = extractor.take(&simulator.header(scan, dwell), &amplitudes, 1, |header, found| {
                headers.push(*header);
                plots.extend_from_slice(found);
                Ok::<(), Infallible>(())
            });
            assert_eq!(taken, Ok(None));
        }
    }
    (headers, plots)
}

fn quiet_radar() -> ChainConfig {
    let mut chain = ChainConfig::default();
    chain.sim.clutter.range_m = 0.0;
    chain
}

/// 25 million cells at F = 10⁻³ and 10⁻⁴, edges of the range extent included: the count of
/// hits within five standard errors.
#[test]
fn false_alarms_are_as_many_as_set() {
    for pfa in [1e-3, 1e-4] {
        let mut chain = quiet_radar();
        chain.extractor.pfa = pfa;
        let (headers, _) = extract(&chain, 1);
        assert_eq!(headers.len(), 32);
        let cells: u64 = headers.iter().map(|header| header.cells).sum();
        assert_eq!(cells, 1040 * 58 * 6 * 70);
        let hits: u64 = headers.iter().map(|header| header.detections).sum();
        let expected = cells as f64 * pfa;
        assert!((hits as f64 - expected).abs() < 5.0 * expected.sqrt(), "{hits} of {expected}");
    }
}

/// Coverage grows without gaps and never stays back by more than an open cluster.
#[test]
fn coverage_is_continuous() {
    let mut chain = quiet_radar();
    chain.radar.elevations = 4;
    let (headers, _) = extract(&chain, 3);
    for pair in headers.windows(2) {
        let turn = f64::from(pair[1].scan - pair[0].scan) * std::f64::consts::TAU;
        assert!((pair[0].covered_to_rad - turn - pair[1].covered_from_rad).abs() < 1e-9);
        assert!(pair[1].covered_to_rad >= pair[1].covered_from_rad);
        assert_eq!(pair[1].seq, pair[0].seq + 1);
    }
}

/// Targets all over the volume, also across north: one plot each scan, and the mean
/// normalised squared error per axis within 0.8…1.25; where the floor of errors counts, no larger.
#[test]
fn each_target_gives_one_plot_whose_errors_are_as_stated() {
    assert_one_plot_with_its_error([18.0, 22.0, 28.0, 36.0], 0.8);
    assert_one_plot_with_its_error([45.0, 50.0, 55.0, 60.0], 0.4);
}

fn assert_one_plot_with_its_error(snr_db: [f64; 4], least: f64) {
    let mut chain = quiet_radar();
    chain.extractor.pfa = 1e-6;
    let mut state = 1_u64;
    let mut uniform = |low: f64, high: f64| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        low + (high - low) * (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let count = 60;
    for number in 0..count {
        // 6° apart in azimuth, the first one on north itself
        let place = Polar {
            range_m: uniform(400.0, 4900.0),
            azimuth_rad: (6.0 * f64::from(number) + uniform(-0.3, 0.3)).to_radians(),
            elevation_rad: uniform(1.0, 19.0).to_radians(),
        };
        chain.sim.targets.push(TargetConfig {
            name: format!("target {number}"),
            motion: MotionConfig::Straight {
                position_m: place.to_enu().into(),
                velocity_mps: [uniform(-40.0, 40.0), uniform(-40.0, 40.0), uniform(-2.0, 2.0)],
            },
            rcs_m2: None,
            snr_db: Some(snr_db[number as usize % 4]),
            swerling: Swerling::Zero,
            first_scan: 0,
        });
    }
    let scans = 4;
    let (_, plots) = extract(&chain, scans);
    let simulator = DwellSimulator::new(&chain).expect("valid scenario");
    let (mut truth, mut sums, mut found, mut doubled, mut missed) = (Vec::new(), [0.0; 4], 0, 0, 0);
    for scan in 0..scans {
        simulator.truth(scan, &mut truth);
        for target in &truth {
            let place = Polar::from_enu(&target.position_m().into());
            if place.range_m > 4900.0 {
                continue;
            }
            let rate = range_rate_mps(&target.position_m().into(), &target.velocity_mps().into());
            let near: Vec<&Plot> = plots
                .iter()
                .filter(|plot| {
                    plot.time_ns.abs_diff(target.time_ns) < 20_000_000
                        && (plot.range_m - place.range_m).abs() < 250.0
                        && angle::difference(plot.azimuth_rad, place.azimuth_rad).abs() < 0.03
                        && (plot.elevation_rad - place.elevation_rad).abs() < 0.03
                })
                .collect();
            missed += u32::from(near.is_empty());
            doubled += near.len().saturating_sub(1);
            let Some(plot) = near.iter().max_by(|a, b| a.statistic.total_cmp(&b.statistic)) else { continue };
            found += 1;
            let errors = [
                (plot.range_m - place.range_m) / f64::from(plot.sigma_range_m),
                angle::difference(plot.azimuth_rad, place.azimuth_rad) / f64::from(plot.sigma_azimuth_rad),
                (plot.elevation_rad - place.elevation_rad) / f64::from(plot.sigma_elevation_rad),
                (plot.range_rate_mps - rate) / f64::from(plot.sigma_range_rate_mps),
            ];
            for (sum, error) in sums.iter_mut().zip(errors) {
                *sum += error * error;
            }
        }
    }
    assert!(missed <= found / 20, "{missed} missed, {found} found");
    assert!(doubled <= 1, "{doubled} targets with two plots");
    for (axis, sum) in ["range", "azimuth", "elevation", "range rate"].iter().zip(sums) {
        let mean = sum / f64::from(found);
        assert!((least..1.25).contains(&mean), "{axis}: {mean}");
    }
}

/// Lost sectors, a rewound stream and foreign headers: every plot stays at its own time,
/// nothing panics, the books of the lineage stay exact.
#[test]
fn gaps_and_rewinds_are_survived() {
    let mut chain = quiet_radar();
    chain.radar.elevations = 4;
    chain.extractor.pfa = 1e-3;
    let mut simulator = DwellSimulator::new(&chain).expect("valid scenario");
    let mut extractor = PlotExtractor::new(&chain.extractor, &chain.radar);
    let mut amplitudes = vec![0.0; simulator.cells()];
    let (mut headers, mut taken) = (Vec::new(), 0);
    let order = (0..700).chain(900..1040).chain(500..800).chain([3, 1039, 5]);
    for (count, dwell) in order.enumerate() {
        simulator.fill(1, dwell, &mut amplitudes);
        let mut header = simulator.header(1, dwell);
        header.session = 1 + u64::from(count > 850);
        let cut = if count % 97 == 5 { 10 } else { 0 };
        if count % 101 == 7 {
            header.azimuth_rad = f64::NAN;
        }
        taken += u64::from(header.azimuth_rad.is_finite());
        let cells = &amplitudes[cut..];
        let result = extractor.take(&header, cells, 1, |header, plots| {
            let turn_ns = 1_000_000_000;
            assert!(plots.iter().all(|plot| plot.time_ns.abs_diff(header.time_ns) < turn_ns));
            headers.push(*header);
            Ok::<(), Infallible>(())
        });
        let expected = if header.azimuth_rad.is_nan() {
            Some(Reject::BadHeader)
        } else if cut > 0 {
            Some(Reject::LengthMismatch)
        } else {
            None
        };
        assert_eq!(result, Ok(expected), "dwell {dwell}");
    }
    let in_messages: u64 = headers.iter().map(|header| header.lineage.taken).sum();
    assert!(taken - in_messages <= 33, "all but the open sector: {taken} {in_messages}");
}
