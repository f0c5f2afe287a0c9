//! What is written of a report or a track is read again, to half a step of each item.

use asterix::block::Blocks;
use asterix::cat062::{Accuracy, Movement, SystemTrack, UnitTrack};
use asterix::cat065::{Operation, SystemStatus};
use asterix::definition::Edition;
use asterix::editions::Editions;
use asterix::record::{Record, Records};
use asterix::report::{Artificial, Message, Service, ServiceMessage, SourceId, TargetReport, TimeOfDay};
use asterix::tables::{CAT034_1_29, CAT048_1_32, CAT062_1_21, CAT065_1_6};
use asterix::{BlockWriter, EncodeError, RecordWriter, cat034, cat048};
use proptest::option;
use proptest::prelude::*;

/// Writes one record and hands it to `read`.
fn written<T>(
    edition: &'static Edition,
    write: impl FnOnce(&mut RecordWriter<'_>) -> Result<(), EncodeError>,
    read: impl FnOnce(&Record<'_>) -> T,
) -> T {
    let mut datagram = Vec::new();
    BlockWriter::new(edition, &mut datagram).record(write).expect("it can be written");
    let block = Blocks::new(&datagram).next().expect("a block").expect("it can be read");
    let mut records = Records::new(Editions::default().of(block.category).expect("known"), block.records, block.offset);
    let record = records.next().expect("a record").expect("it can be read");
    assert!(records.next().is_none());
    read(&record)
}

fn time() -> impl Strategy<Value = Option<TimeOfDay>> {
    option::of((0..TimeOfDay::DAY).prop_map(|steps| TimeOfDay { steps, period: TimeOfDay::DAY }))
}

fn source() -> impl Strategy<Value = SourceId> {
    (any::<u8>(), any::<u8>()).prop_map(|(sac, sic)| SourceId { sac, sic })
}

fn assert_near(found: Option<f64>, expected: Option<f64>, step: f64) {
    assert_eq!(found.is_some(), expected.is_some());
    if let (Some(found), Some(expected)) = (found, expected) {
        assert!((found - expected).abs() <= step * 0.5 + 1e-9 * expected.abs(), "{found} {expected} {step}");
    }
}

fn assert_pairs_near(found: Option<[f64; 2]>, expected: Option<[f64; 2]>, step: f64) {
    for axis in 0..2 {
        assert_near(found.map(|pair| pair[axis]), expected.map(|pair| pair[axis]), step);
    }
}

proptest! {
    #[test]
    fn plots_come_back(
        source in source(),
        time_of_day in time(),
        flags: [bool; 5],
        polar in option::of((0.0..474_000.0, 0.0..std::f64::consts::TAU)),
        heights in (option::of(-300.0..60_000.0), option::of(-1000.0..60_000.0)),
        radial_velocity_mps in option::of(-511.0..511.0),
        amplitude_db in option::of(-128.0..127.0),
        codes in (option::of(0_u16..4096), option::of(0_u32..1 << 24), option::of("[A-Z0-9 ]{8}")),
    ) {
        let report = TargetReport {
            source: Some(source),
            time_of_day,
            primary: flags[0],
            secondary: flags[1],
            extrapolated: !flags[0] && !flags[1],
            artificial: Artificial { simulated: flags[2], test: flags[3], monitor: flags[4] },
            polar,
            pressure_height_m: heights.0,
            height_m: heights.1,
            radial_velocity_mps,
            amplitude_db,
            mode_3a: codes.0,
            address: codes.1,
            callsign: codes.2.map(|text| text.into_bytes().try_into().expect("eight characters")),
            ..TargetReport::default()
        };
        let read = written(CAT048_1_32, |record| cat048::write(&report, record), Message::of);
        let Some(Message::Target(read)) = read else { panic!("{read:?}") };
        assert_near(read.polar.map(|it| it.0), polar.map(|it| it.0), 1852.0 / 256.0);
        let turned = read.polar.zip(polar).map(|(read, sent)| (read.1 - sent.1).sin());
        assert_near(turned, polar.map(|_| 0.0), std::f64::consts::TAU / 65_536.0);
        assert_near(read.pressure_height_m, heights.0, 30.48 / 4.0);
        assert_near(read.height_m, heights.1, 25.0 * 0.3048);
        assert_near(read.radial_velocity_mps, radial_velocity_mps, 1.0);
        assert_near(read.amplitude_db, amplitude_db, 1.0);
        let rounded = TargetReport {
            polar: read.polar,
            pressure_height_m: read.pressure_height_m,
            height_m: read.height_m,
            radial_velocity_mps: read.radial_velocity_mps,
            amplitude_db: read.amplitude_db,
            ..report
        };
        prop_assert_eq!(read, rounded);
    }

    #[test]
    fn service_messages_come_back(source in source(), time_of_day in time(), sector in option::of(0_u8..255), turn in option::of(1_u16..)) {
        let message = ServiceMessage {
            source: Some(source),
            service: if sector.is_some() { Service::Sector } else { Service::North },
            time_of_day,
            azimuth_rad: sector.map(|sector| f64::from(sector) / 256.0 * std::f64::consts::TAU),
            turn_s: turn.map(|turn| f64::from(turn) / 128.0),
        };
        let read = written(CAT034_1_29, |record| cat034::write(&message, record), Message::of);
        prop_assert_eq!(read, Some(Message::Service(message)));
    }

    #[test]
    fn system_tracks_come_back(
        source in source(),
        number: u16,
        service: Option<u8>,
        time_of_day in time(),
        flags: [bool; 6],
        position_deg in option::of([-90.0..90.0, -180.0..180.0]),
        position_m in option::of([-4e6..4e6, -4e6..4e6]),
        velocity_mps in option::of([-8000.0..8000.0, -8000.0..8000.0]),
        acceleration_mps2 in option::of([-31.0..31.0, -31.0..31.0]),
        vertical in (option::of(-400.0..45_000.0), option::of(-900.0..900.0)),
        ages_s in (option::of(0.0..63.0), option::of(0.0..63.0)),
        movement in option::of((0_u8..4, 0_u8..4, 0_u8..4)),
        errors in option::of(([0.0..30_000.0, 0.0..30_000.0], -1e8..1e8, [0.0..63.0, 0.0..63.0], option::of(0.0..480.0))),
        plot in option::of((any::<u8>(), 0.0..470_000.0, 0.0..6.0)),
        units in prop::collection::vec((any::<u8>(), 0..=UnitTrack::LARGEST_NUMBER), 0..=9),
    ) {
        let of_unit = |&(unit, number): &(u8, u16)| UnitTrack { unit, number };
        let track = SystemTrack {
            source,
            service,
            number,
            time_of_day,
            position_deg,
            position_m,
            velocity_mps,
            acceleration_mps2,
            height_m: vertical.0,
            climb_rate_mps: vertical.1,
            composed: std::array::from_fn(|link| units.get(link).map(of_unit)),
            monosensor: flags[0],
            tentative: flags[1],
            simulated: flags[2],
            first: flags[3],
            last: flags[4],
            coasted: flags[5],
            track_age_s: ages_s.0,
            plot_age_s: ages_s.1,
            movement: movement.map(|(turn, speed, climb)| Movement { turn, speed, climb }),
            accuracy: errors.map(|(position_m, covariance_m2, velocity_mps, height_m)| Accuracy {
                position_m,
                covariance_m2,
                height_m,
                velocity_mps,
                acceleration_mps2: None,
                climb_rate_mps: None,
            }),
            plot: plot.map(|(sic, range_m, azimuth_rad)| (SourceId { sac: 1, sic }, range_m, azimuth_rad)),
        };
        let read = written(CAT062_1_21, |record| track.write(record), SystemTrack::read);
        assert_pairs_near(read.position_deg, position_deg, 180.0 / f64::from(1 << 25));
        assert_pairs_near(read.position_m, position_m, 0.5);
        assert_pairs_near(read.velocity_mps, velocity_mps, 0.25);
        assert_pairs_near(read.acceleration_mps2, acceleration_mps2, 0.25);
        assert_near(read.height_m, vertical.0, 6.25 * 0.3048);
        assert_near(read.climb_rate_mps, vertical.1, 6.25 * 0.3048 / 60.0);
        assert_near(read.track_age_s, ages_s.0, 0.25);
        assert_near(read.plot_age_s, ages_s.1, 0.25);
        assert_pairs_near(read.accuracy.map(|it| it.position_m), track.accuracy.map(|it| it.position_m), 0.5);
        let root = |of: &SystemTrack| of.accuracy.map(|it| it.covariance_m2.abs().sqrt().copysign(it.covariance_m2));
        assert_near(root(&read), root(&track), 0.5);
        let exact = |of: SystemTrack| {
            (of.source, of.service, of.number, of.time_of_day, of.movement, of.plot.map(|plot| plot.0),
            [of.monosensor, of.tentative, of.simulated, of.first, of.last, of.coasted])
        };
        prop_assert_eq!(exact(read), exact(track));
    }

    #[test]
    fn status_comes_back(source in source(), service: Option<u8>, time_of_day in time(), overload: bool) {
        for operation in [Operation::Operational, Operation::Degraded, Operation::NotConnected, Operation::Unknown] {
            let status = SystemStatus { source, service, time_of_day, operation, overload };
            prop_assert_eq!(written(CAT065_1_6, |record| status.write(record), SystemStatus::read), Some(status));
        }
    }
}

#[test]
fn what_an_item_cannot_hold_is_named_and_the_block_stays_as_it_was() {
    let mut datagram = Vec::new();
    let mut block = BlockWriter::new(CAT048_1_32, &mut datagram);
    let report = TargetReport { polar: Some((1e6, 0.0)), ..TargetReport::default() };
    let error = block.record(|record| cat048::write(&report, record)).expect_err("too far").to_string();
    assert!(error.starts_with("item 040: value 539.9") && error.ends_with("0 to 255.99609375 expected"), "{error}");
    assert_eq!(block.octets(), 3);
    let report = TargetReport { callsign: Some(*b"VLG273T "), ..TargetReport::default() };
    let error = loop {
        if let Err(error) = block.record(|record| cat048::write(&report, record)) {
            break error;
        }
    };
    assert!(matches!(error, EncodeError::BlockTooLong { category: 48, octets: 65_536.. }), "{error}");
    let octets = block.octets();
    assert_eq!(octets, datagram.len());
    let block = Blocks::new(&datagram).next().expect("a block").expect("it can be read");
    assert!(Records::new(CAT048_1_32, block.records, 0).all(|record| record.is_ok()));
}
