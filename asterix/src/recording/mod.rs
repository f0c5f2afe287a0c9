//! Recordings: blocks in files of several forms.
//!
//! | form | what it is | times |
//! |---|---|---|
//! | blocks | blocks back to back (`.ast`, `.raw`) | none |
//! | final | frames of the recorder FINAL around the blocks | day of the recording and time, 10 ms |
//! | pcap, pcapng | packets of a network: Ethernet with VLAN, Linux cooked, IP; fragments put together | ns or µs |

mod framed;
mod pcap;
mod pcapng;
mod udp;

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::net::SocketAddr;
use std::ops::Range;

use crate::block::Blocks;
use crate::editions::Editions;
use crate::record::{Record, Records};
use crate::recovery::{Cause, Unused, records};

/// How a file holds blocks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// Back to back.
    Blocks,
    /// In frames of the recorder FINAL.
    Final,
    /// In UDP packets of a pcap capture.
    Pcap,
    /// In UDP packets of a pcapng capture.
    PcapNg,
}

impl Form {
    /// The form of the file that begins with `bytes`.
    pub fn of(bytes: &[u8]) -> Self {
        if pcap::is_capture(bytes) {
            Self::Pcap
        } else if pcapng::is_capture(bytes) {
            Self::PcapNg
        } else if framed::is_framed(bytes) {
            Self::Final
        } else {
            Self::Blocks
        }
    }
}

/// Blocks that were received together.
#[derive(Debug, Clone, PartialEq)]
pub struct Datagram<'a> {
    /// When, ns since 1970, or since midnight before the recording began; none in a file of blocks.
    pub time_ns: Option<u64>,
    /// Where it was sent to; none in files without packets.
    pub destination: Option<SocketAddr>,
    /// Where it begins in the file; for one that was put together of fragments, where the last one begins.
    pub offset: usize,
    /// The blocks.
    pub bytes: Cow<'a, [u8]>,
}

/// A recording, taken apart.
#[derive(Debug, Clone)]
pub struct Recording<'a> {
    /// Its form.
    pub form: Form,
    /// What it holds, in the order of the file.
    pub datagrams: Vec<Datagram<'a>>,
    /// Parts of the file that hold no packet, though one should be there.
    pub lost: Vec<Unused>,
    /// Packets without UDP.
    pub other_packets: u64,
    /// Datagrams to places where no ASTERIX is sent to.
    pub foreign: BTreeMap<SocketAddr, u64>,
}

/// A record with what is known of its way.
#[derive(Debug, Clone, Copy)]
pub struct Received<'a> {
    /// The record.
    pub record: Record<'a>,
    /// As [`Datagram::time_ns`].
    pub time_ns: Option<u64>,
    /// As [`Datagram::destination`].
    pub destination: Option<SocketAddr>,
}

impl<'a> Recording<'a> {
    /// Takes a file apart and leaves out of a capture what is no ASTERIX.
    pub fn new(bytes: &'a [u8], editions: &Editions) -> Self {
        let mut recording = Self::whole(bytes);
        recording.leave_out_foreign(editions);
        recording
    }

    /// Takes a file apart, with every datagram that is in it.
    pub fn whole(bytes: &'a [u8]) -> Self {
        let form = Form::of(bytes);
        let mut recording =
            Self { form, datagrams: Vec::new(), lost: Vec::new(), other_packets: 0, foreign: BTreeMap::new() };
        match form {
            Form::Blocks => {
                let whole = Datagram { time_ns: None, destination: None, offset: 0, bytes: Cow::Borrowed(bytes) };
                recording.datagrams.push(whole);
            }
            Form::Final => framed::frames(bytes, &mut recording),
            Form::Pcap => recording.take_packets(pcap::packets(bytes)),
            Form::PcapNg => recording.take_packets(pcapng::packets(bytes)),
        }
        recording
    }

    /// All its records, in the order of the file, and between them what was not used.
    pub fn records<'r>(&'r self, editions: &'r Editions) -> impl Iterator<Item = Result<Received<'r>, Unused>> + 'r {
        let lost = self.lost.iter().cloned().map(Err);
        let read = self.datagrams.iter().flat_map(move |datagram| {
            let (time_ns, destination) = (datagram.time_ns, datagram.destination);
            records(editions, &datagram.bytes, datagram.offset)
                .map(move |record| record.map(|record| Received { record, time_ns, destination }))
        });
        lost.chain(read)
    }

    fn take_packets(&mut self, packets: impl Iterator<Item = Result<Packet<'a>, Range<usize>>>) {
        let mut reassembly = udp::Reassembly::default();
        for packet in packets {
            match packet.map(|packet| reassembly.take(&packet)) {
                Ok(udp::Taken::Datagram(datagram)) => self.datagrams.push(datagram),
                Ok(udp::Taken::Fragment) => {}
                Ok(udp::Taken::Other) => self.other_packets += 1,
                Ok(udp::Taken::Bad(place)) => self.lose(place, "a packet that is cut off or damaged"),
                Err(place) => self.lose(place, "no packet of a capture"),
            }
        }
        for place in reassembly.incomplete() {
            self.lose(place, "a packet of which fragments are missing");
        }
    }

    fn lose(&mut self, place: Range<usize>, why: &'static str) {
        self.lost.push(Unused::Unread { place, cause: Cause::Capture(why) });
    }

    /// A capture holds what else was on the network. ASTERIX is what goes to a place that one good datagram goes to.
    fn leave_out_foreign(&mut self, editions: &Editions) {
        let mut is_asterix: BTreeMap<SocketAddr, bool> = BTreeMap::new();
        for datagram in &self.datagrams {
            if let Some(destination) = datagram.destination {
                let known = is_asterix.entry(destination).or_default();
                *known = *known || is_good(&datagram.bytes, editions);
            }
        }
        self.datagrams.retain(|datagram| {
            let Some(destination) = datagram.destination.filter(|destination| !is_asterix[destination]) else {
                return true;
            };
            *self.foreign.entry(destination).or_default() += 1;
            false
        });
    }
}

/// Whether all bytes are blocks, at least one of them of a known category and that one readable.
fn is_good(bytes: &[u8], editions: &Editions) -> bool {
    let mut has_records = false;
    Blocks::new(bytes).all(|block| {
        block.is_ok_and(|block| match editions.of(block.category) {
            Some(edition) => {
                let mut records = Records::new(edition, block.records, 0).peekable();
                has_records |= records.peek().is_some();
                records.all(|record| record.is_ok())
            }
            None => true,
        })
    }) && has_records
}

/// A packet of a capture.
#[derive(Debug, Clone, Copy)]
struct Packet<'a> {
    time_ns: Option<u64>,
    link: u16,
    /// Bytes that were captured.
    bytes: &'a [u8],
    offset: usize,
}
