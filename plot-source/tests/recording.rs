//! The decoder and the source on a real recording, whole, cut and spoilt.
//!
//! Expected counts were made with an independent decoder (see the README of the data).

use std::path::Path;

use asterix::editions::Editions;
use asterix::recovery::{Cause, Unused, records};
use asterix::report::{Message, Service, SourceId, TargetReport};
use common::config::{self, ChainConfig};
use common::health::Reject;
use common::message::{END_OF_SCAN, END_OF_STREAM};
use common::truth::{AIRBORNE, ON_GROUND, PLANAR, VEHICLE};
use plot_source::{Source, SourceError};
use proptest::prelude::*;

const RADAR: &[u8] = include_bytes!("data/lebl-smr-30s.ast");
const TRUTH: &[u8] = include_bytes!("data/lebl-mlat-30s.ast");

/// Records of the radar.
const RADAR_RECORDS: usize = 148;
/// Start-of-cycle messages of the radar.
const RADAR_CYCLES: usize = 29;
/// Records of the multilateration.
const TRUTH_RECORDS: usize = 388;
/// Reports of its fixed monitors.
const TRUTH_MONITORS: u64 = 178;

fn chain() -> ChainConfig {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../config/smr.toml");
    config::load(Some(&path), &[]).expect("a valid configuration")
}

fn source(radar: &[u8], truth: Option<&[u8]>) -> Result<Source, SourceError> {
    let truth = truth.map(|bytes| (Path::new("truth.ast"), bytes));
    Source::decode(&chain(), (Path::new("radar.ast"), radar), truth)
}

/// All messages of a recording without a bad byte.
fn messages(bytes: &[u8]) -> Vec<Message> {
    let editions = Editions::default();
    let records = records(&editions, bytes, 0).map(|record| record.expect("no record is bad"));
    records.map(|record| Message::of(&record).expect("a known category")).collect()
}

fn reports(messages: &[Message]) -> Vec<TargetReport> {
    let reports = messages.iter().filter_map(|message| match message {
        Message::Target(report) => Some(*report),
        Message::Service(_) => None,
    });
    reports.collect()
}

#[test]
fn every_record_of_the_radar_is_read() {
    let messages = messages(RADAR);
    assert_eq!(messages.len(), RADAR_RECORDS);
    let is_cycle =
        |message: &&Message| matches!(message, Message::Service(message) if message.service == Service::North);
    assert_eq!(messages.iter().filter(is_cycle).count(), RADAR_CYCLES);
    assert!(messages.iter().all(|message| message.source() == Some(SourceId { sac: 0, sic: 7 })));
    let reports = reports(&messages);
    let first = reports[0];
    assert_eq!(first.time_of_day.map(|time| time.steps), Some((28_801.562_5 * 128.0) as u32));
    let (range_m, azimuth_rad) = first.polar.expect("a position");
    assert!((range_m - 1059.0).abs() < 1e-9 && (azimuth_rad.to_degrees() - 15.62).abs() < 0.01);
    // Polar and Cartesian position of a record are the same place, to rounding.
    for report in &reports {
        if let (Some((range_m, azimuth_rad)), Some((x_m, y_m))) = (report.polar, report.cartesian_m) {
            let (sin, cos) = azimuth_rad.sin_cos();
            assert!((range_m * sin - x_m).hypot(range_m * cos - y_m) < 1.5);
        }
    }
}

#[test]
fn every_record_of_the_multilateration_is_read() {
    let messages = messages(TRUTH);
    assert_eq!(messages.len(), TRUTH_RECORDS);
    let callsigns: Vec<[u8; 8]> = reports(&messages).iter().filter_map(|report| report.callsign).collect();
    assert!(callsigns.contains(b"RYR63GY "), "{callsigns:?}");
    assert!(messages.iter().all(|message| message.source() == Some(SourceId { sac: 0, sic: 107 })));
}

#[test]
fn plots_tell_time_range_and_azimuth_and_nothing_else() {
    let source = source(RADAR, None).expect("a recording");
    let scans = source.scans();
    let mut next_seq = 0;
    for scan in source {
        assert_eq!(scan.plots.len(), 32);
        for (header, plots) in &scan.plots {
            assert_eq!(header.seq, next_seq);
            next_seq += 1;
            for plot in plots {
                assert!((header.covered_from_rad..header.covered_to_rad).contains(&plot.azimuth_rad));
                assert_eq!((plot.flags, plot.target_id, plot.source_id), (0, 0, 7));
                // The antenna was where the plot is, to 9° of its turn.
                let turned_s = header.scan_period_s * (plot.azimuth_rad / std::f64::consts::TAU);
                let passed_s = (plot.time_ns as f64 - scan.begin_ns as f64) * 1e-9;
                assert!((turned_s - passed_s).abs() < 0.025 * header.scan_period_s, "{turned_s} {passed_s}");
            }
        }
        let last = &scan.plots[31].0;
        assert!(last.has(END_OF_SCAN));
        assert_eq!(last.has(END_OF_STREAM), last.scan + 1 == scans);
    }
    assert_eq!(next_seq, u64::from(scans) * 32);
}

#[test]
fn truth_is_registered_and_monitors_are_left_out() {
    let source = source(RADAR, Some(TRUTH)).expect("recordings");
    assert_eq!(source.rejected().of(Reject::FixedMonitor), TRUTH_MONITORS);
    let mut vehicles = 0;
    for scan in source {
        let (header, targets) = scan.truth.expect("truth");
        assert_eq!(header.time_ns, scan.plots[31].0.time_ns);
        for target in targets {
            assert!((scan.begin_ns..header.time_ns).contains(&target.time_ns));
            assert!(target.has(PLANAR) && target.target_id != 0 && target.snr_db.is_nan());
            vehicles += usize::from(target.has(VEHICLE));
            assert!(target.has(ON_GROUND) != target.has(AIRBORNE));
        }
    }
    assert!(vehicles > 0);
}

/// Aircraft and the plots of them agree within metres only if both sides are registered right.
#[test]
fn plots_lie_on_the_truth() {
    let mut distances = Vec::new();
    for scan in source(RADAR, Some(TRUTH)).expect("recordings") {
        let targets: Vec<_> = scan.truth.into_iter().flat_map(|(_, targets)| targets).collect();
        for plot in scan.plots.iter().flat_map(|(_, plots)| plots) {
            let (sin, cos) = plot.azimuth_rad.sin_cos();
            let nearest = targets.iter().filter(|target| !target.has(VEHICLE)).map(|target| {
                let dt_s = (plot.time_ns as f64 - target.time_ns as f64) * 1e-9;
                let [x, y, _] = target.position_m();
                let [vx, vy, _] = target.velocity_mps();
                (plot.range_m * sin - x - vx * dt_s).hypot(plot.range_m * cos - y - vy * dt_s)
            });
            distances.extend(nearest.min_by(f64::total_cmp).filter(|&distance| distance < 50.0));
        }
    }
    distances.sort_by(f64::total_cmp);
    assert!(distances.len() > 20, "{}", distances.len());
    let median = distances[distances.len() / 2];
    assert!(median < 6.0, "{median}");
}

/// Wherever a recording is cut, everything before the cut is there and the cut is counted once.
#[test]
fn a_cut_recording_yields_everything_before_the_cut() {
    let starts: Vec<usize> = {
        let mut starts = vec![0];
        while let Some(&[_, high, low]) = RADAR.get(starts[starts.len() - 1]..).and_then(|rest| rest.first_chunk()) {
            starts.push(starts[starts.len() - 1] + usize::from(u16::from_be_bytes([high, low])));
        }
        starts
    };
    for cut in 0..RADAR.len() {
        let whole = starts.partition_point(|&start| start <= cut) - 1;
        let (mut read, mut unused) = (0, Vec::new());
        for record in records(&Editions::default(), &RADAR[..cut], 0) {
            match record {
                Ok(_) => read += 1,
                Err(cause) => unused.push(cause),
            }
        }
        assert_eq!(read, whole, "cut at {cut}");
        let inside = starts[whole] != cut;
        assert_eq!(unused.len(), usize::from(inside), "cut at {cut}");
        assert!(unused.iter().all(|cause| matches!(cause, Unused::Unread { cause: Cause::Cut, .. })), "cut at {cut}");
    }
}

#[test]
fn what_is_no_recording_is_named_in_one_line() {
    let message = |result: Result<Source, SourceError>| result.expect_err("must be refused").to_string();
    let text = message(source(b"root:x:0:0:root:/root:/bin/bash\n", None));
    assert!(text.starts_with("radar.ast is not an ASTERIX recording") && !text.contains('\n'), "{text}");
    assert!(message(source(b"", None)).contains("0 bytes"));
    assert!(message(source(RADAR, Some(b"no"))).starts_with("truth.ast is not"));
    assert!(message(source(&RADAR[..60], None)).contains("no start-of-update-cycle"));
    let mut config = chain();
    config.plot_source.file = env!("CARGO_MANIFEST_DIR").into();
    let text = message(Source::open(&config));
    assert!(text.starts_with("cannot read ") && text.contains("directory"), "{text}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Spoilt bytes never stop the source: it gives its scans or one error.
    #[test]
    fn spoilt_bytes_do_no_harm(spoilt in prop::collection::vec((0..RADAR.len(), any::<u8>()), 1..40)) {
        let mut bytes = RADAR.to_vec();
        for (place, value) in spoilt {
            bytes[place] = value;
        }
        if let Ok(source) = source(&bytes, Some(TRUTH)) {
            for scan in source.take(200) {
                prop_assert_eq!(scan.plots.len(), 32);
                prop_assert!(scan.plots.iter().flat_map(|(_, plots)| plots).all(|plot| plot.range_m > 0.0));
            }
        }
    }

    #[test]
    fn random_bytes_do_no_harm(bytes in prop::collection::vec(any::<u8>(), 0..2000)) {
        let _ = source(&bytes, None).map(|source| source.take(50).count());
    }
}
