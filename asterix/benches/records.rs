//! Target reports of category 048 to SI units, and system tracks of category 062 to octets.

use std::hint::black_box;

use asterix::cat062::{Accuracy, Movement, SystemTrack};
use asterix::record::Records;
use asterix::report::{Message, SourceId, TargetReport, TimeOfDay};
use asterix::tables::{CAT048_1_32, CAT062_1_21};
use asterix::value::RecordValues;
use asterix::{BlockWriter, cat048};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};

const RECORDS: u32 = 1000;

/// Records of a Mode S radar with a primary channel: what such a radar sends of most targets.
fn reports() -> Vec<u8> {
    let mut octets = Vec::new();
    let mut block = BlockWriter::new(CAT048_1_32, &mut octets);
    for index in 0..RECORDS {
        let report = TargetReport {
            source: Some(SourceId { sac: 25, sic: 7 }),
            time_of_day: Some(TimeOfDay { steps: index * 128, period: TimeOfDay::DAY }),
            primary: true,
            secondary: true,
            polar: Some((f64::from(index) * 300.0, f64::from(index) / 200.0)),
            pressure_height_m: Some(f64::from(index) * 10.0),
            amplitude_db: Some(-60.0),
            mode_3a: Some(0o1234),
            address: Some(index),
            callsign: Some(*b"VLG273T "),
            radial_velocity_mps: Some(-120.0),
            ..TargetReport::default()
        };
        block.record(|record| cat048::write(&report, record)).expect("it can be written");
    }
    octets.split_off(3)
}

fn decode(criterion: &mut Criterion) {
    let octets = reports();
    let mut group = criterion.benchmark_group("cat048_decode");
    group.throughput(Throughput::Elements(RECORDS.into()));
    group.bench_function("to SI units", |bencher| {
        bencher.iter(|| {
            let (mut count, mut range_m) = (0, 0.0);
            for record in Records::new(CAT048_1_32, black_box(&octets), 0) {
                if let Ok(record) = record
                    && let Some(Message::Target(report)) = black_box(Message::of(&record))
                {
                    count += 1;
                    range_m += report.polar.map_or(0.0, |polar| polar.0);
                }
            }
            assert!(count == RECORDS && range_m > 0.0);
        });
    });
    group.bench_function("to a tree of values", |bencher| {
        bencher.iter(|| {
            let records = Records::new(CAT048_1_32, black_box(&octets), 0).flatten();
            assert_eq!(
                records.map(|record| RecordValues::of(&record).items.len()).sum::<usize>(),
                10 * RECORDS as usize
            );
        });
    });
    group.finish();
}

fn encode(criterion: &mut Criterion) {
    let track = SystemTrack {
        source: SourceId { sac: 25, sic: 1 },
        time_of_day: Some(TimeOfDay { steps: 5_529_600, period: TimeOfDay::DAY }),
        position_deg: Some([50.45, 30.52]),
        position_m: Some([1234.5, -6789.0]),
        velocity_mps: Some([12.25, -3.5]),
        acceleration_mps2: Some([0.5, -0.25]),
        height_m: Some(850.0),
        climb_rate_mps: Some(2.0),
        monosensor: true,
        coasted: true,
        track_age_s: Some(60.0),
        plot_age_s: Some(1.0),
        movement: Some(Movement { turn: 1, speed: 0, climb: 1 }),
        accuracy: Some(Accuracy {
            position_m: [12.0, 9.0],
            covariance_m2: -30.0,
            height_m: Some(40.0),
            velocity_mps: [1.0, 1.5],
            acceleration_mps2: Some([0.5, 0.5]),
            climb_rate_mps: Some(1.0),
        }),
        ..SystemTrack::default()
    };
    let mut octets = Vec::new();
    let mut group = criterion.benchmark_group("cat062_encode");
    group.throughput(Throughput::Elements(RECORDS.into()));
    group.bench_function("from SI units", |bencher| {
        bencher.iter(|| {
            octets.clear();
            let mut block = BlockWriter::new(CAT062_1_21, &mut octets);
            for number in 0..RECORDS as u16 {
                let track = black_box(SystemTrack { number, ..track });
                if block.record(|record| track.write(record)).is_err() {
                    block = BlockWriter::new(CAT062_1_21, &mut octets);
                    block.record(|record| track.write(record)).expect("room in a new block");
                }
            }
            assert!(octets.len() > 40 * RECORDS as usize);
        });
    });
    group.finish();
}

criterion_group!(benches, decode, encode);
criterion_main!(benches);
