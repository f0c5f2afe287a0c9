//! A radar that is listened to, on the clock of the test: what arrives when, and what becomes of it.

mod synthetic;

use std::collections::BTreeSet;

use common::config::ChainConfig;
use common::health::Reject;
use common::message::END_OF_SCAN;
use common::plots::{Plot, PlotsHeader};
use common::tracks::{CONFIRMED, Track};
use common::turning::Turning;
use plot_source::Source;
use plot_source::live::{Closed, LiveRadar, Trouble};
use synthetic::{Dialect, MIDNIGHT_NS, Recorder, SOURCE, block, chain, messages, open};
use tracker::Tracker;

const TURNS: u32 = 60;
/// How long datagrams are on their way, s.
const DELAY_S: f64 = 0.02;
const START_S: f64 = 36_000.0;

/// The time of this computer at a true time since the start, ns.
fn now_ns(true_s: f64) -> u64 {
    MIDNIGHT_NS + ((START_S + true_s + DELAY_S) * 1e9) as u64
}

fn live_chain() -> ChainConfig {
    let mut chain = chain();
    chain.plot_source.sigma_range_m = 5.0;
    chain
}

fn listener(chain: &ChainConfig) -> LiveRadar {
    LiveRadar::new(chain).expect("known editions")
}

/// Messages with the time at which they were closed, ns.
type Heard = Vec<(u64, PlotsHeader, Vec<Plot>)>;

/// Hands over datagrams, looks at sectors every 10 ms in between, and 3 s beyond the last datagram.
fn hear(radar: &mut LiveRadar, datagrams: &[(f64, Vec<u8>)]) -> Heard {
    let (mut heard, mut closed) = (Heard::new(), Closed::new());
    let mut close = |radar: &mut LiveRadar, now_ns: u64| {
        radar.close_due(now_ns, &mut closed);
        heard.extend(closed.drain(..).map(|(header, plots)| (now_ns, header, plots)));
    };
    let mut tick = 0.0;
    for (true_s, datagram) in datagrams {
        while tick < *true_s {
            close(radar, now_ns(tick));
            tick += 0.01;
        }
        radar.take(datagram, now_ns(*true_s));
        close(radar, now_ns(*true_s));
    }
    let end_s = tick + 3.0;
    while tick < end_s {
        close(radar, now_ns(tick));
        tick += 0.01;
    }
    heard
}

/// Numbers of the confirmed tracks; the messages must follow each other.
fn confirmed(heard: &Heard) -> BTreeSet<u64> {
    let mut tracker = Tracker::new(&common::config::TrackerConfig::default(), 1).expect("a valid configuration");
    let (mut tracks, mut numbers): (Vec<Track>, _) = (Vec::new(), BTreeSet::new());
    let (mut next_seq, mut last_ns) = (None, 0);
    for (_, header, plots) in heard {
        assert!(next_seq.is_none_or(|seq| seq == header.seq), "{header:?}");
        assert!(header.time_ns > last_ns && header.has(END_OF_SCAN) == (header.sector == 31));
        (next_seq, last_ns) = (Some(header.seq + 1), header.time_ns);
        tracker.process_plots(header, plots, &mut tracks);
        numbers.extend(tracks.iter().filter(|track| track.state_code == CONFIRMED).map(|track| track.id));
    }
    numbers
}

fn plots(heard: &Heard) -> Vec<Plot> {
    heard.iter().flat_map(|(_, _, plots)| plots.clone()).collect()
}

const DIALECTS: [(Dialect, bool, u32); 7] = [
    (Dialect::Surface, true, 0),
    (Dialect::Surface, false, 0),
    (Dialect::Monoradar, true, 0),
    (Dialect::Monoradar, true, 32),
    (Dialect::Monoradar, false, 0),
    (Dialect::Old, true, 0),
    (Dialect::Monoradar, false, 32),
];

/// Each radar gives its five tracks, with every plot, in sectors that are closed in time once the turn is known.
#[test]
fn every_radar_is_heard_in_time() {
    for (dialect, has_service, sector_messages) in DIALECTS {
        for turn_s in [1.0, 4.0] {
            let recorder =
                Recorder { dialect, has_service, sector_messages, turn_s: &|_| turn_s, ..Recorder::default() };
            let mut chain = live_chain();
            chain.plot_source.scan_period_s = 0.8 * turn_s;
            let mut radar = listener(&chain);
            let heard = hear(&mut radar, &recorder.timed_blocks(TURNS));
            let case = format!("{dialect:?} {has_service} {sector_messages} {turn_s}: {:?}", radar.events());
            assert_eq!(confirmed(&heard).len(), 5, "{case}");
            let searched = if has_service || sector_messages > 0 { 3 } else { 21 };
            let missing = (5 * TURNS) as usize - plots(&heard).len();
            assert!(missing <= 5, "{missing} plots missing, {case}");
            for (closed_ns, header, _) in &heard[32 * (searched + 1)..] {
                let late_s = (*closed_ns as f64 - header.time_ns as f64) * 1e-9 - DELAY_S;
                let limit_s = if sector_messages > 0 { 0.03 * turn_s } else { chain.plot_source.latency_s };
                // After the last message of the radar only time closes sectors.
                let limit_s = if header.scan + 4 > TURNS { chain.plot_source.latency_s } else { limit_s };
                assert!((-0.03 * turn_s..=limit_s + 0.03 * turn_s).contains(&late_s), "{late_s} s late, {case}");
            }
        }
    }
}

/// The plots of a radar that is listened to are those of its recording.
#[test]
fn plots_are_those_of_the_recording() {
    let recorder = Recorder { dialect: Dialect::Monoradar, ..Recorder::default() };
    let blocks = recorder.timed_blocks(TURNS);
    let heard = plots(&hear(&mut listener(&live_chain()), &blocks));
    let bytes: Vec<u8> = blocks.iter().flat_map(|(_, block)| block.clone()).collect();
    let recorded: Vec<Plot> =
        messages(open(&live_chain(), &bytes).expect("a recording")).flat_map(|(_, plots)| plots).collect();
    assert!(heard.len() > 250 && recorded.ends_with(&heard));
}

/// Reports of the second line, which is late, and malformed datagrams change nothing and are counted.
#[test]
fn doubled_lines_and_malformed_datagrams_change_nothing() {
    let recorder = Recorder { dialect: Dialect::Monoradar, sector_messages: 32, ..Recorder::default() };
    let single = recorder.timed_blocks(TURNS);
    let alone = hear(&mut listener(&live_chain()), &single);
    let mut doubled = single.clone();
    doubled.extend(single.iter().map(|(time_s, datagram)| (time_s + 0.004, datagram.clone())));
    let malformed: [Vec<u8>; 5] = [
        vec![0xff; 20],
        vec![48, 0, 200, 0xf0, 1],
        block(48, &[0xf0, 0, 7, 1]),
        block(21, &[0x80, 0, 7]),
        block(48, &[0x01, 0x01, 0x01, 0x01, 0x80, 0x00]),
    ];
    for (index, (time_s, _)) in single.iter().enumerate() {
        doubled.extend(malformed.iter().cycle().skip(index).take(5).map(|datagram| (*time_s, datagram.clone())));
    }
    doubled.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut radar = listener(&live_chain());
    let heard = hear(&mut radar, &doubled);
    assert_eq!(plots(&heard), plots(&alone));
    assert_eq!(radar.events().repeated, single.len() as u64);
    let count = single.len() as u64;
    let rejected = |reason| radar.rejected().of(reason);
    assert_eq!((rejected(Reject::BadHeader), rejected(Reject::OtherCategory)), (2 * count, count));
    assert_eq!((rejected(Reject::TruncatedRecord), rejected(Reject::UnknownItem)), (count, count));
}

/// Records of other sensors are counted and left alone; a report after its sector is late.
#[test]
fn what_cannot_be_used_is_counted() {
    let recorder = Recorder { dialect: Dialect::Monoradar, sector_messages: 32, ..Recorder::default() };
    let other = Recorder { source: [3, 9], turn_s: &|_| 1.7, ..recorder };
    let mut datagrams = recorder.timed_blocks(TURNS);
    let own = hear(&mut listener(&live_chain()), &datagrams);
    let foreign = other.timed_blocks(10);
    datagrams.extend(foreign.iter().cloned());
    let late = datagrams.iter().position(|(time_s, datagram)| *time_s > 30.0 && datagram[0] == 48).expect("a report");
    datagrams[late].0 += 0.5;
    datagrams.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut radar = listener(&live_chain());
    let before = {
        let mut radar = listener(&live_chain());
        hear(&mut radar, &recorder.timed_blocks(TURNS));
        radar.rejected().of(Reject::Late)
    };
    let heard = hear(&mut radar, &datagrams);
    assert_eq!(plots(&heard).len(), plots(&own).len() - 1);
    assert_eq!(radar.rejected().of(Reject::ForeignSource), foreign.len() as u64);
    assert_eq!(radar.rejected().of(Reject::Late), before + 1);
}

/// A radar that stops: its tracks end. It comes back in another phase, with another clock: new tracks begin.
#[test]
fn a_radar_may_stop_and_come_back() {
    for sector_messages in [0, 32] {
        for clock_s in [0.0, 3000.0, -7.3] {
            let recorder = Recorder { dialect: Dialect::Monoradar, sector_messages, ..Recorder::default() };
            let again = Recorder { clock_s: &move |true_s| START_S + true_s + 100.37 + clock_s, ..recorder };
            let mut datagrams = recorder.timed_blocks(40);
            datagrams.extend(again.timed_blocks(40).into_iter().map(|(time_s, block)| (time_s + 100.37, block)));
            let mut radar = listener(&live_chain());
            let heard = hear(&mut radar, &datagrams);
            let case = format!("{sector_messages} {clock_s}: {:?}", radar.events());
            assert_eq!(confirmed(&heard).len(), 10, "{case}");
            assert!(heard.len() >= 32 * 136, "{} sectors, {case}", heard.len());
            assert!(plots(&heard).len() > 5 * 70, "{} plots, {case}", plots(&heard).len());
        }
    }
}

/// A clock that is set, forwards or backwards, and midnight: tracks live on.
#[test]
fn a_clock_may_be_set() {
    for by_s in [-4000.0, -2.6, 2.6, 4000.0] {
        let clock_s = move |true_s: f64| START_S + true_s + if true_s < 30.0 { 0.0 } else { by_s };
        let recorder =
            Recorder { dialect: Dialect::Monoradar, sector_messages: 32, clock_s: &clock_s, ..Recorder::default() };
        let mut radar = listener(&live_chain());
        let heard = hear(&mut radar, &recorder.timed_blocks(TURNS));
        assert_eq!(confirmed(&heard).len(), 5, "{by_s}: {:?}", radar.events());
        assert_eq!(radar.events().clock_set, 1, "{by_s}: {:?}", radar.events());
    }
}

/// Turns that change their time are followed, with and without sector messages.
#[test]
fn a_turn_may_change() {
    for (sector_messages, has_service) in [(0, true), (32, true), (0, false)] {
        let recorder = Recorder {
            dialect: Dialect::Monoradar,
            sector_messages,
            has_service,
            turn_s: &|turn| 2.0 + 0.004 * f64::from(turn),
            ..Recorder::default()
        };
        let mut chain = live_chain();
        chain.plot_source.scan_period_s = 2.0;
        let mut radar = listener(&chain);
        let heard = hear(&mut radar, &recorder.timed_blocks(TURNS));
        assert_eq!(confirmed(&heard).len(), 5, "{sector_messages} {has_service}: {:?}", radar.events());
        assert_eq!(radar.events().moved, 0);
    }
}

/// Targets exactly where sectors begin are in the sectors that begin there: their reports come after the message.
#[test]
fn a_target_where_a_sector_begins_is_not_late() {
    let recorder = Recorder { dialect: Dialect::Monoradar, sector_messages: 32, ..Recorder::default() };
    let mut datagrams: Vec<(f64, Vec<u8>)> = recorder.timed_blocks(TURNS);
    datagrams.retain(|(_, datagram)| datagram[0] == 34);
    let reports: Vec<(f64, Vec<u8>)> = datagrams
        .iter()
        .enumerate()
        .map(|(index, (time_s, datagram))| {
            let azimuth = (index % 32 * 2048) as u16;
            // The time of the message, and 5 km.
            let report = [&[0xf0, 0, 7][..], &datagram[7..10], &[0x20, 2, 0], &azimuth.to_be_bytes()].concat();
            (time_s + 0.001, block(48, &report))
        })
        .collect();
    datagrams.extend(reports);
    datagrams.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut radar = listener(&live_chain());
    let heard = hear(&mut radar, &datagrams);
    assert_eq!(plots(&heard).len() as u64 + radar.rejected().of(Reject::Late), u64::from(32 * TURNS));
    let full = heard.iter().filter(|(_, _, plots)| plots.len() == 1).count();
    assert!(full >= 32 * (TURNS as usize - 3), "{full} sectors with their plot, {:?}", radar.events());
}

/// Reports and sector messages of category 048 and 034 with other azimuths, shares of a turn.
fn with_azimuths(datagrams: &mut [(f64, Vec<u8>)], azimuth: impl Fn(f64) -> f64) {
    for (_, datagram) in datagrams {
        match datagram[..] {
            [48, .., high, low] => {
                let turned = azimuth(f64::from(u16::from_be_bytes([high, low])) / 65_536.0).rem_euclid(1.0);
                let octets = ((turned * 65_536.0).round() as u32 as u16).to_be_bytes();
                datagram.splice(12.., octets);
            }
            [34, _, _, 0xf0, .., last] => {
                let turned = azimuth(f64::from(last) / 256.0).rem_euclid(1.0);
                datagram[10] = (turned * 256.0).round() as u32 as u8;
            }
            _ => {}
        }
    }
}

/// What the antenna may tell: sector messages a turn, and whether north markers come.
const SERVICES: [(u32, bool); 4] = [(0, true), (0, false), (32, true), (32, false)];

/// Where each message leaves the tracks, east and north, by number; `side` is -1 for a mirrored world.
fn tracks_of(messages: impl Iterator<Item = (PlotsHeader, Vec<Plot>)>, side: f64) -> Vec<(u64, [f64; 2])> {
    let mut tracker = Tracker::new(&common::config::TrackerConfig::default(), 1).expect("a valid configuration");
    let (mut tracks, mut all) = (Vec::<Track>::new(), Vec::new());
    for (header, plots) in messages {
        tracker.process_plots(&header, &plots, &mut tracks);
        all.extend(tracks.iter().map(|track| (track.id, [side * track.position_m()[0], track.position_m()[1]])));
    }
    all
}

#[track_caller]
fn assert_same_tracks(one: &[(u64, [f64; 2])], other: &[(u64, [f64; 2])]) {
    assert_eq!(one.len(), other.len());
    for (a, b) in one.iter().zip(other) {
        let distance_m = f64::hypot(a.1[0] - b.1[0], a.1[1] - b.1[1]);
        assert!(a.0 == b.0 && distance_m < 0.01, "{a:?} {b:?}");
    }
}

/// Whatever the radar says of its antenna: turning counter-clockwise, it gives the mirrored tracks, heard and from a file, and
/// how it turns is learnt.
#[test]
fn an_antenna_that_turns_counter_clockwise_gives_the_mirrored_tracks() {
    for (sector_messages, has_service) in SERVICES {
        let case = format!("{sector_messages} {has_service}");
        let recorder = Recorder { dialect: Dialect::Monoradar, sector_messages, has_service, ..Recorder::default() };
        let usual = recorder.timed_blocks(TURNS);
        let mut other = usual.clone();
        with_azimuths(&mut other, |turned| -turned);
        // Known beforehand: the same from the first plot on.
        let [heard, mirrored] =
            [(&usual, Turning::Clockwise), (&other, Turning::CounterClockwise)].map(|(blocks, turning)| {
                let mut chain = live_chain();
                chain.plot_source.turning = Some(turning);
                let heard = hear(&mut listener(&chain), blocks);
                assert!(heard.iter().all(|(_, header, _)| header.turning() == turning), "{case}");
                heard
            });
        let of = |heard: &Heard, side| tracks_of(heard.iter().map(|(_, header, plots)| (*header, plots.clone())), side);
        assert_same_tracks(&of(&heard, 1.0), &of(&mirrored, -1.0));
        // Learnt.
        let mut radar = listener(&live_chain());
        let heard = hear(&mut radar, &other);
        let events = radar.events();
        assert_eq!((radar.turning(), radar.trouble()), (Some(Turning::CounterClockwise), None), "{case} {events:?}");
        assert_eq!(confirmed(&heard).len(), 5, "{case} {events:?}");
        assert!(plots(&heard).len() > 5 * (TURNS as usize - 12), "{} plots, {case} {events:?}", plots(&heard).len());
        // Of a file.
        let [usual, other] = [&usual, &other].map(|blocks| {
            let bytes: Vec<u8> = blocks.iter().flat_map(|(_, block)| block.clone()).collect();
            open(&live_chain(), &bytes).expect("a recording")
        });
        let is_said = |source: &Source| source.notes().iter().any(|note| note.contains("counter-clockwise"));
        assert!(is_said(&other) && !is_said(&usual), "{case} {:?}", other.notes());
        assert_same_tracks(&tracks_of(messages(usual), 1.0), &tracks_of(messages(other), -1.0));
    }
}

/// A radar that goes on turning the other way is followed, and says so.
#[test]
fn an_antenna_may_change_its_direction() {
    for (sector_messages, has_service) in SERVICES {
        let recorder = Recorder { dialect: Dialect::Monoradar, sector_messages, has_service, ..Recorder::default() };
        let mut datagrams = recorder.timed_blocks(2 * TURNS);
        let half = datagrams.partition_point(|(time_s, _)| *time_s < f64::from(TURNS));
        with_azimuths(&mut datagrams[half..], |turned| -turned);
        let mut radar = listener(&live_chain());
        hear(&mut radar, &datagrams[..half]);
        assert_eq!(radar.turning(), Some(Turning::Clockwise), "{sector_messages} {has_service}");
        let heard = hear(&mut radar, &datagrams[half..]);
        let case = format!("{sector_messages} {has_service} {:?}", radar.events());
        assert_eq!((radar.turning(), radar.trouble()), (Some(Turning::CounterClockwise), None), "{case}");
        assert!(plots(&heard).len() > 5 * (TURNS as usize - 30), "{} plots, {case}", plots(&heard).len());
    }
}

/// An antenna that stands and sees all around has the rhythm of its reports for scans, heard and from a file: each target is one
/// track.
#[test]
fn an_antenna_that_stands_gives_the_same_tracks() {
    for (period_s, given) in [(1.0, None), (4.0, None), (4.0, Some(Turning::Standing))] {
        let recorder = Recorder { dialect: Dialect::Monoradar, turn_s: &|_| period_s, ..Recorder::default() };
        let datagrams = recorder.bursts(TURNS);
        let mut chain = live_chain();
        chain.plot_source.turning = given;
        let mut radar = listener(&chain);
        let heard = hear(&mut radar, &datagrams);
        let case = format!("{period_s} {given:?} {:?}", radar.events());
        assert_eq!((radar.turning(), radar.trouble()), (Some(Turning::Standing), None), "{case}");
        assert_eq!(confirmed(&heard).len(), 5, "{case}");
        assert!(plots(&heard).len() >= 5 * (TURNS as usize - 1), "{} plots, {case}", plots(&heard).len());
        assert!(radar.turn_s().is_some_and(|turn_s| (turn_s - period_s).abs() < 0.02 * period_s), "{case}");
        let bytes: Vec<u8> = datagrams.iter().flat_map(|(_, block)| block.clone()).collect();
        let source = open(&chain, &bytes).expect("a recording");
        assert!(source.notes().iter().any(|note| note.contains("the antenna stands")), "{:?}", source.notes());
        let heard: Heard = messages(source).map(|(header, plots)| (0, header, plots)).collect();
        assert_eq!((confirmed(&heard).len(), plots(&heard).len()), (5, 5 * TURNS as usize), "{case}");
    }
}

/// A rotating antenna that has stopped goes on to report what it sees in one direction, and turns again.
#[test]
fn an_antenna_that_is_stopped_stands() {
    for (sector_messages, has_service) in SERVICES {
        let recorder = Recorder { dialect: Dialect::Monoradar, sector_messages, has_service, ..Recorder::default() };
        let mut datagrams = recorder.timed_blocks(3 * TURNS);
        let begins = |turns: u32| datagrams.partition_point(|(time_s, _)| *time_s < f64::from(turns));
        let (stops, starts) = (begins(TURNS), begins(2 * TURNS));
        with_azimuths(&mut datagrams[stops..starts], |_| 0.3);
        let mut radar = listener(&live_chain());
        hear(&mut radar, &datagrams[..stops]);
        let case = format!("{sector_messages} {has_service}");
        assert_eq!((radar.turning(), radar.trouble()), (Some(Turning::Clockwise), None), "{case}");
        let heard = hear(&mut radar, &datagrams[stops..starts]);
        let events = radar.events();
        assert_eq!((radar.turning(), radar.trouble()), (Some(Turning::Standing), None), "{case} {events:?}");
        assert!(plots(&heard).len() > 5 * 20, "{} plots, {case} {events:?}", plots(&heard).len());
        hear(&mut radar, &datagrams[starts..]);
        let events = radar.events();
        assert_eq!((radar.turning(), radar.trouble()), (Some(Turning::Clockwise), None), "{case} {events:?}");
    }
}

/// Times and azimuths that fit no antenna are said.
#[test]
fn reports_that_fit_no_antenna_are_said() {
    let recorder = Recorder { dialect: Dialect::Monoradar, has_service: false, ..Recorder::default() };
    let mut datagrams = recorder.timed_blocks(TURNS);
    let next = std::cell::Cell::new(0_u32);
    with_azimuths(&mut datagrams, |_| {
        next.set(next.get() + 1);
        f64::from(next.get() * next.get() * 37 % 101) / 101.0
    });
    let mut radar = listener(&live_chain());
    assert!(hear(&mut radar, &datagrams).is_empty());
    assert_eq!(radar.trouble(), Some(Trouble::NoTurn));
}

/// Whatever the sectors of the radar's messages and those of the configuration: no plot is late for it.
#[test]
fn sectors_need_not_be_those_of_the_messages() {
    for (sectors, delay_s) in [(32, 0.0), (24, 0.0), (10, 0.0), (100, 0.0), (32, 0.1)] {
        let recorder =
            Recorder { dialect: Dialect::Monoradar, sector_messages: 32, turn_s: &|_| 2.0, ..Recorder::default() };
        let mut chain = live_chain();
        (chain.plot_source.sectors_per_scan, chain.plot_source.sector_delay_s) = (sectors, delay_s);
        let mut radar = listener(&chain);
        let heard = hear(&mut radar, &recorder.timed_blocks(TURNS));
        let late = radar.rejected().of(Reject::Late);
        assert!(late <= 15, "{sectors} sectors: {late} reports late");
        let (closed_ns, header, _) = &heard[heard.len() / 2];
        let late_s = (*closed_ns as f64 - header.time_ns as f64) * 1e-9 - DELAY_S;
        // A message of the radar tells up to a 32nd of a scan later that a sector is complete.
        assert!(late_s < 0.02 + delay_s + 2.0 / 32.0, "{sectors} sectors {delay_s}: {late_s} s late");
        assert!(radar.events().timed_out < 4 * u64::from(sectors), "{:?}", radar.events());
    }
}

/// Reports that come behind the message that ends their sector are waited for once the first ones have been late, but no longer
/// than `latency_s`.
#[test]
fn reports_that_come_late_are_waited_for() {
    for (late_s, lost_at_most, longest_s) in [(0.0, 5, 0.04), (0.1, 12, 0.18), (0.3, 16, 0.45), (0.9, 300, 0.52)] {
        let recorder = Recorder { dialect: Dialect::Monoradar, sector_messages: 32, ..Recorder::default() };
        let mut datagrams = recorder.timed_blocks(TURNS);
        let reports = datagrams.iter_mut().filter(|(_, datagram)| datagram[0] == 48);
        for (index, (time_s, _)) in reports.enumerate() {
            *time_s += late_s * (index * 3 % 4) as f64 / 3.0;
        }
        datagrams.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut radar = listener(&live_chain());
        let heard = hear(&mut radar, &datagrams);
        let lost = radar.rejected().of(Reject::Late);
        assert!(lost <= lost_at_most && (late_s < 0.5 || lost > 60), "{late_s} s: {lost} reports lost");
        let waited = heard[640..32 * 50].iter().map(|(closed_ns, header, _)| closed_ns - header.time_ns);
        let waited_s = waited.max().expect("sectors") as f64 * 1e-9 - DELAY_S;
        assert!(waited_s <= longest_s, "{late_s} s: waited for {waited_s} s");
    }
}

/// Of a radar that says no more than when it passes north, reports that come after it said so are used.
#[test]
fn a_north_marker_alone_closes_nothing() {
    let recorder = Recorder { dialect: Dialect::Surface, ..Recorder::default() };
    let mut datagrams = recorder.timed_blocks(TURNS);
    let is_report = |datagram: &[u8]| datagram.len() > recorder.timed_blocks(1)[0].1.len();
    for (time_s, _) in datagrams.iter_mut().filter(|(_, datagram)| is_report(datagram)) {
        *time_s += 0.3;
    }
    datagrams.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut radar = listener(&live_chain());
    let heard = hear(&mut radar, &datagrams);
    let (late, used) = (radar.rejected().of(Reject::Late), plots(&heard).len());
    assert!(late <= 20 && used >= 5 * (TURNS as usize - 5), "{late} late, {used} used");
}

/// A single sector message with a wrong azimuth closes nothing, and a single wrong time sets no clock.
#[test]
fn wrong_messages_cost_nothing() {
    let recorder = Recorder { dialect: Dialect::Monoradar, sector_messages: 32, ..Recorder::default() };
    let mut datagrams = recorder.timed_blocks(TURNS);
    let mut radar = listener(&live_chain());
    let expected = plots(&hear(&mut radar, &datagrams));
    let wrong: Vec<(f64, Vec<u8>)> = datagrams
        .iter()
        .filter(|(time_s, datagram)| datagram[3] == 0xf0 && datagram[0] == 34 && *time_s > 10.0)
        .step_by(7)
        .map(|(time_s, datagram)| {
            let mut wrong = datagram.clone();
            wrong[10] = wrong[10].wrapping_add(90);
            (time_s + 0.001, wrong)
        })
        .collect();
    // Three in a row whose times differ from each other as well.
    let hours = (1..=3_u8).map(|hour| (20.5, block(34, &[&[0xe0], &SOURCE[..], &[1, 7 * hour, 0, hour]].concat())));
    datagrams.extend(wrong.iter().cloned().chain(hours));
    datagrams.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut radar = listener(&live_chain());
    assert_eq!(plots(&hear(&mut radar, &datagrams)), expected, "{:?}", radar.events());
    assert_eq!((radar.events().astray, radar.events().clock_set), (wrong.len() as u64, 0));
    assert_eq!(radar.rejected().of(Reject::NoTime), 3);
}

/// A radar whose messages of the antenna end is followed by its reports, though its turn goes on changing.
#[test]
fn messages_of_the_antenna_may_end() {
    let turn_s = |turn: u32| 2.0 + 0.004 * f64::from(turn);
    let recorder = Recorder { dialect: Dialect::Monoradar, turn_s: &turn_s, ..Recorder::default() };
    let mut datagrams = recorder.timed_blocks(3 * TURNS);
    datagrams.retain(|(time_s, datagram)| datagram[0] == 48 || *time_s < 40.0);
    let mut radar = listener(&live_chain());
    let heard = hear(&mut radar, &datagrams);
    assert_eq!(confirmed(&heard).len(), 5, "{:?}", radar.events());
    let last_s = turn_s(3 * TURNS);
    assert!(radar.turn_s().is_some_and(|found_s| (found_s - last_s).abs() < 0.02), "{:?}", radar.turn_s());
}

/// A radar without messages of its antenna that comes back in another phase is found again.
#[test]
fn a_radar_without_service_may_come_back() {
    let recorder = Recorder { dialect: Dialect::Monoradar, has_service: false, ..Recorder::default() };
    let again = Recorder { clock_s: &|true_s| START_S + true_s + 100.37, ..recorder };
    let mut datagrams = recorder.timed_blocks(TURNS);
    datagrams.extend(again.timed_blocks(TURNS).into_iter().map(|(time_s, block)| (time_s + 100.37, block)));
    let mut radar = listener(&live_chain());
    let heard = hear(&mut radar, &datagrams);
    assert_eq!((radar.events().moved, radar.trouble()), (1, None), "{:?}", radar.events());
    let last = &heard[heard.len() - 20 * 32..];
    assert!(last.iter().map(|(_, _, plots)| plots.len()).sum::<usize>() > 5 * 14, "{:?}", radar.rejected());
}

/// Silence of more than half a day is no other clock.
#[test]
fn a_radar_may_be_silent_for_half_a_day() {
    let recorder = Recorder { dialect: Dialect::Monoradar, sector_messages: 32, ..Recorder::default() };
    let silence_s = 50_000.0;
    let again = Recorder { clock_s: &|true_s| (START_S + true_s + 50_000.0) % 86_400.0, ..recorder };
    let mut radar = listener(&live_chain());
    hear(&mut radar, &recorder.timed_blocks(10));
    for (time_s, datagram) in again.timed_blocks(10) {
        radar.take(&datagram, now_ns(time_s + silence_s));
    }
    assert_eq!((radar.events().clock_set, radar.rejected().of(Reject::NoTime)), (0, 0));
}

/// What floods in takes no more memory than two messages of a sector hold, and what has come due meanwhile than a scan.
#[test]
fn memory_is_bounded_whatever_comes() {
    let recorder = Recorder { dialect: Dialect::Monoradar, sector_messages: 32, ..Recorder::default() };
    let mut radar = listener(&live_chain());
    hear(&mut radar, &recorder.timed_blocks(10));
    let datagrams = recorder.timed_blocks(TURNS);
    let (time_s, report) = datagrams.iter().find(|(time_s, it)| *time_s > 14.0 && it[0] == 48).expect("a report");
    for range in 1..=10_000_u16 {
        let mut flood = report.clone();
        flood.splice(10..12, range.to_be_bytes());
        radar.take(&flood, now_ns(*time_s));
    }
    let mut closed = Closed::new();
    radar.close_due(now_ns(*time_s), &mut closed);
    closed.clear();
    radar.close_due(now_ns(*time_s) + 1_000_000_000, &mut closed);
    let message = closed.iter().find(|(_, plots)| !plots.is_empty()).expect("the sector of the flood");
    assert!(message.0.left_out > 0 && message.1.len() == common::plots::MAX_PLOTS);
    let taken = message.1.len() as u64 + u64::from(message.0.left_out);
    assert_eq!(taken + radar.rejected().of(Reject::Full), 10_000);
    closed.clear();
    radar.close_due(now_ns(time_s + 1e6), &mut closed);
    assert_eq!(closed.len(), 32);
}
