//! The same blocks in every form of file, with what networks do to packets, whole and cut.

use std::net::SocketAddr;
use std::ops::Range;

use asterix::editions::Editions;
use asterix::recording::{Form, Recording};
use asterix::recovery::{Cause, Unused};
use asterix::report::{SourceId, TargetReport, TimeOfDay};
use asterix::tables::CAT048_1_32;
use asterix::{BlockWriter, cat048};
use etherparse::{EtherType, LinuxSllPacketType, PacketBuilder, PacketBuilderStep, UdpHeader};

const GROUP: [u8; 4] = [239, 192, 86, 68];
const PORT: u16 = 8668;
/// Size of a record, octets.
const RECORD: usize = 11;
const START_S: u64 = 1_740_062_457;

/// Payloads of datagrams: two blocks each.
fn payloads() -> Vec<Vec<u8>> {
    let report = |index: u32| TargetReport {
        source: Some(SourceId { sac: 0, sic: 1 }),
        time_of_day: Some(TimeOfDay { steps: index, period: TimeOfDay::DAY }),
        primary: true,
        polar: Some((1000.0 * f64::from(index), 1.0)),
        ..TargetReport::default()
    };
    let payload = |index: u32| {
        let mut payload = Vec::new();
        for records in [1, 40] {
            let mut block = BlockWriter::new(CAT048_1_32, &mut payload);
            for record in 0..records {
                block.record(|writer| cat048::write(&report(index + record), writer)).expect("it can be written");
            }
        }
        payload
    };
    (0..6).map(payload).collect()
}

/// Time of the packet of a number, ns.
fn time_ns(index: usize) -> u64 {
    START_S * 1_000_000_000 + index as u64 * 123_456_000
}

type Packet = Vec<u8>;

fn with_udp(builder: PacketBuilderStep<UdpHeader>, payload: &[u8]) -> Packet {
    let mut packet = Vec::new();
    builder.write(&mut packet, payload).expect("a packet");
    packet
}

fn ethernet(payload: &[u8]) -> Packet {
    let builder = PacketBuilder::ethernet2([2; 6], [3; 6]).ipv4([10, 0, 0, 1], GROUP, 8).udp(40_000, PORT);
    let mut packet = with_udp(builder, payload);
    packet.resize(packet.len().max(60), 0); // the least that Ethernet sends
    packet
}

fn vlan(payload: &[u8]) -> Packet {
    let builder = PacketBuilder::ethernet2([2; 6], [3; 6]);
    let tagged = builder.single_vlan(100.try_into().expect("a tag")).ipv4([10, 0, 0, 1], GROUP, 8);
    with_udp(tagged.udp(40_000, PORT), payload)
}

fn cooked(payload: &[u8]) -> Packet {
    let builder = PacketBuilder::linux_sll(LinuxSllPacketType::MULTICAST, 6, [2, 2, 2, 2, 2, 2, 0, 0]);
    with_udp(builder.ipv4([10, 0, 0, 1], GROUP, 8).udp(40_000, PORT), payload)
}

fn raw_ip(payload: &[u8]) -> Packet {
    with_udp(PacketBuilder::ipv4([10, 0, 0, 1], GROUP, 8).udp(40_000, PORT), payload)
}

/// The packet of a payload as fragments of an Ethernet, with the number `id`.
fn fragments(payload: &[u8], id: u16) -> Vec<Packet> {
    const HEADER: usize = 20;
    let whole = raw_ip(payload);
    let (header, body) = whole.split_at(HEADER);
    let last = body.len().div_ceil(200) - 1;
    let mut packets = Vec::new();
    for (index, part) in body.chunks(200).enumerate() {
        let mut packet = vec![2, 2, 2, 2, 2, 2, 3, 3, 3, 3, 3, 3];
        packet.extend(EtherType::IPV4.0.to_be_bytes());
        let at = packet.len();
        packet.extend(header);
        packet[at + 2..at + 4].copy_from_slice(&((HEADER + part.len()) as u16).to_be_bytes());
        packet[at + 4..at + 6].copy_from_slice(&id.to_be_bytes());
        let flags = u16::from(index < last) << 13 | (index * 200 / 8) as u16;
        packet[at + 6..at + 8].copy_from_slice(&flags.to_be_bytes());
        packet.extend(part);
        packets.push(packet);
    }
    packets
}

fn pcap(link: u32, packets: &[Packet]) -> Vec<u8> {
    let mut file = Vec::new();
    for word in [0xa1b2_c3d4, 0x0004_0002, 0, 0, 65_535, link] {
        file.extend(u32::to_le_bytes(word));
    }
    for (index, packet) in packets.iter().enumerate() {
        let (seconds, micros) = (time_ns(index) / 1_000_000_000, time_ns(index) % 1_000_000_000 / 1000);
        for word in [seconds as u32, micros as u32, packet.len() as u32, packet.len() as u32] {
            file.extend(word.to_le_bytes());
        }
        file.extend(packet);
    }
    file
}

/// Big-endian, with the finer of the two resolutions.
fn pcap_of_nanoseconds(packets: &[Packet]) -> Vec<u8> {
    let mut file = Vec::new();
    for word in [0xa1b2_3c4d, 0x0002_0004, 0, 0, 65_535, 1] {
        file.extend(u32::to_be_bytes(word));
    }
    for (index, packet) in packets.iter().enumerate() {
        let (seconds, nanos) = (time_ns(index) / 1_000_000_000, time_ns(index) % 1_000_000_000);
        for word in [seconds as u32, nanos as u32, packet.len() as u32, packet.len() as u32] {
            file.extend(word.to_be_bytes());
        }
        file.extend(packet);
    }
    file
}

/// One interface, whose times are in ns and are an hour late, and a block of a kind that no reader knows.
fn pcapng(packets: &[Packet]) -> Vec<u8> {
    const HOUR_S: u64 = 3600;
    let block = |kind: u32, body: &[u8]| {
        let padded = body.len().next_multiple_of(4);
        let length = (padded as u32 + 12).to_le_bytes();
        let mut block = [&kind.to_le_bytes()[..], &length, body].concat();
        block.resize(padded + 8, 0);
        block.extend(length);
        block
    };
    let words = |words: &[u32]| words.iter().flat_map(|word| word.to_le_bytes()).collect::<Vec<u8>>();
    let mut file = block(0x0a0d_0d0a, &words(&[0x1a2b_3c4d, 1, u32::MAX, u32::MAX]));
    let resolution = [9, 0, 1, 0, 9, 0, 0, 0];
    let offset = [&[14, 0, 8, 0][..], &HOUR_S.to_le_bytes()].concat();
    file.extend(block(1, &[&words(&[1, 65_535])[..], &resolution, &offset, &[0; 4]].concat()));
    for (index, packet) in packets.iter().enumerate() {
        file.extend(block(0x0bad, b"unknown"));
        let ticks = time_ns(index) - HOUR_S * 1_000_000_000;
        let length = packet.len() as u32;
        let header = words(&[0, (ticks >> 32) as u32, ticks as u32, length, length]);
        file.extend(block(6, &[&header[..], packet].concat()));
    }
    file
}

fn framed(payloads: &[Vec<u8>]) -> Vec<u8> {
    let frame = |index: usize, payload: &Vec<u8>| {
        let [high, low] = (payload.len() as u16 + 12).to_be_bytes();
        [&[high, low, 0, 1, 3, 0, 0, index as u8], &payload[..], &[0xa5; 4]].concat()
    };
    payloads.iter().enumerate().flat_map(|(index, payload)| frame(index, payload)).collect()
}

/// Octets of all records, and of each datagram its time and destination.
fn read(file: &[u8]) -> (Vec<Vec<u8>>, Vec<Unused>, Recording<'_>) {
    let editions = Editions::default();
    let recording = Recording::new(file, &editions);
    let (mut records, mut unused) = (Vec::new(), Vec::new());
    for received in recording.records(&editions) {
        match received {
            Ok(received) => records.push(received.record.bytes.to_vec()),
            Err(cause) => unused.push(cause),
        }
    }
    (records, unused, recording)
}

#[test]
fn every_form_holds_the_same_records() {
    let payloads = payloads();
    let (expected, unused, blocks) = read(&payloads.concat()).clone_parts();
    assert_eq!((expected.len(), unused.len(), blocks), (6 * 41, 0, Form::Blocks));
    let all = |packet: fn(&[u8]) -> Packet| payloads.iter().map(|payload| packet(payload)).collect::<Vec<Packet>>();
    let captures = [
        (pcap(1, &all(ethernet)), Form::Pcap),
        (pcap(1, &all(vlan)), Form::Pcap),
        (pcap(113, &all(cooked)), Form::Pcap),
        (pcap(101, &all(raw_ip)), Form::Pcap),
        (pcap_of_nanoseconds(&all(ethernet)), Form::Pcap),
        (pcapng(&all(vlan)), Form::PcapNg),
    ];
    for (file, form) in captures {
        let (records, unused, recording) = read(&file);
        assert_eq!((recording.form, &unused), (form, &vec![]));
        assert!(records == expected);
        for (index, datagram) in recording.datagrams.iter().enumerate() {
            assert_eq!(datagram.time_ns, Some(time_ns(index)));
            assert_eq!(datagram.destination, Some(SocketAddr::from((GROUP, PORT))));
        }
    }
    let file = framed(&payloads);
    let (records, unused, recording) = read(&file);
    assert_eq!((recording.form, unused, records == expected), (Form::Final, vec![], true));
    assert_eq!(recording.datagrams[2].time_ns, Some(20_000_000));
}

/// The parts that a test keeps of what was read.
trait CloneParts {
    fn clone_parts(self) -> (Vec<Vec<u8>>, Vec<Unused>, Form);
}

impl CloneParts for (Vec<Vec<u8>>, Vec<Unused>, Recording<'_>) {
    fn clone_parts(self) -> (Vec<Vec<u8>>, Vec<Unused>, Form) {
        (self.0, self.1, self.2.form)
    }
}

#[test]
fn fragments_are_put_together_in_any_order() {
    let payloads = payloads();
    let (expected, ..) = read(&payloads.concat());
    let mut packets: Vec<Vec<Packet>> =
        payloads.iter().enumerate().map(|(index, payload)| fragments(payload, 100 + index as u16)).collect();
    assert!(packets.iter().all(|parts| parts.len() > 2));
    packets[1].reverse();
    packets[3].swap(0, 1);
    let (records, unused, _) = read(&pcap(1, &packets.concat()));
    assert!(records == expected && unused.is_empty(), "{unused:?}");

    packets[2].remove(1);
    let file = pcap(1, &packets.concat());
    let (records, unused, _) = read(&file);
    assert_eq!(records.len(), 5 * 41);
    let [Unused::Unread { cause: Cause::Capture(why), .. }] = &unused[..] else { panic!("{unused:?}") };
    assert_eq!(*why, "a packet of which fragments are missing");
}

#[test]
fn other_datagrams_are_told_apart() {
    let payloads = payloads();
    let text = b"$RATTM,01,1.0,45.0,T,5.0,90.0,T,0.5,10.0,N,,T,,,,A*00\r\n";
    let other =
        with_udp(PacketBuilder::ethernet2([2; 6], [3; 6]).ipv4([10, 0, 0, 1], GROUP, 8).udp(40_000, 10_110), text);
    let arp = [&[2; 6][..], &[3; 6], &EtherType::ARP.0.to_be_bytes(), &[0, 1, 8, 0, 6, 4, 0, 1], &[0; 20]].concat();
    let packets = [ethernet(&payloads[0]), other.clone(), arp, other, ethernet(&payloads[1])];
    let file = pcap(1, &packets);
    let (records, unused, recording) = read(&file);
    assert_eq!((records.len(), unused, recording.other_packets), (82, vec![], 1));
    assert_eq!(recording.foreign.into_iter().collect::<Vec<_>>(), [(SocketAddr::from((GROUP, 10_110)), 2)]);
}

/// A damaged datagram among good ones to one place is ASTERIX that cannot be read, no other protocol.
#[test]
fn damaged_datagrams_are_counted_to_the_byte() {
    let mut payloads = payloads();
    let length = payloads[1].len();
    payloads[1].truncate(length - 5);
    let packets: Vec<Packet> = payloads.iter().map(|payload| ethernet(payload)).collect();
    let (records, unused, _) = read(&pcap(1, &packets));
    assert_eq!(records.len(), 6 * 41 - 1);
    let place = |unused: &Unused| match unused {
        Unused::Unread { place, cause: Cause::Cut } => place.clone(),
        other => panic!("{other:?}"),
    };
    let places: Vec<Range<usize>> = unused.iter().map(place).collect();
    assert_eq!(places.iter().map(Range::len).collect::<Vec<_>>(), [RECORD - 5]);
}

/// Wherever a file is cut: the records before the cut are there, the bytes behind them are counted, nothing panics.
#[test]
fn a_cut_file_yields_what_lies_before_the_cut() {
    let payloads = &payloads()[..2];
    let packets: Vec<Packet> = payloads.iter().map(|payload| vlan(payload)).collect();
    // Less than a frame does not tell that it is one.
    let frame = framed(&payloads[..1]).len();
    for (file, least) in
        [(pcap(1, &packets), 0), (pcapng(&packets), 0), (framed(payloads), frame), (payloads.concat(), 0)]
    {
        let (all, ..) = read(&file);
        let mut most = 0;
        for cut in least..=file.len() {
            let (records, unused, _) = read(&file[..cut]);
            assert!(records.len() >= most && all.starts_with(&records), "cut at {cut}");
            most = records.len();
            let lost: usize = unused
                .iter()
                .map(|unused| match unused {
                    Unused::Unread { place, .. } => place.len(),
                    Unused::Category { bytes, .. } => *bytes,
                })
                .sum();
            assert!(lost <= cut, "cut at {cut}: {unused:?}");
        }
        assert_eq!(most, 82);
    }
}
