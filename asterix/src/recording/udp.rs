//! UDP datagrams in the packets of a capture.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::net::{IpAddr, SocketAddr};
use std::ops::Range;

use etherparse::defrag::IpDefragPool;
use etherparse::err::packet::SliceError;
use etherparse::{NetSlice, SlicedPacket, TransportSlice, UdpSlice};

use super::{Datagram, Packet};

/// Kinds of link, by the numbers of captures.
const NULL: u16 = 0;
const ETHERNET: u16 = 1;
const RAW_IP: [u16; 4] = [12, 101, 228, 229];
const LOOP: u16 = 108;
const LINUX_COOKED: u16 = 113;
const LINUX_COOKED_2: u16 = 276;
/// Octets in front of the IP packet.
const NULL_HEADER: usize = 4;
const LINUX_COOKED_2_HEADER: usize = 20;

/// Packets whose fragments are waited for, at most; older ones are given up.
const MOST_INCOMPLETE: usize = 256;

/// What became of a packet.
pub(super) enum Taken<'a> {
    /// It is a datagram, or the last missing part of one.
    Datagram(Datagram<'a>),
    /// Other parts of its datagram are missing.
    Fragment,
    /// It holds no UDP.
    Other,
    /// It is cut off or damaged.
    Bad(Range<usize>),
}

/// Sender, receiver and number that the fragments of a packet have in common.
type Identity = (IpAddr, IpAddr, u32);

/// Fragments that wait for the others.
#[derive(Default)]
pub(super) struct Reassembly {
    pool: IpDefragPool<(), ()>,
    /// Where the first fragment of each packet lies.
    waiting: BTreeMap<Identity, Range<usize>>,
    given_up: Vec<Range<usize>>,
}

impl Reassembly {
    pub(super) fn take<'a>(&mut self, packet: &Packet<'a>) -> Taken<'a> {
        let place = packet.offset..packet.offset + packet.bytes.len();
        let sliced = match slice(packet) {
            Ok(Some(sliced)) => sliced,
            Ok(None) => return Taken::Other,
            Err(_) => return Taken::Bad(place),
        };
        let Some(receiver) = receiver(&sliced) else { return Taken::Other };
        if let Some(identity) = fragment(&sliced) {
            let Ok(whole) = self.pool.process_sliced_packet(&sliced, (), ()) else { return Taken::Bad(place) };
            let Some(whole) = whole else {
                self.wait(identity, place);
                return Taken::Fragment;
            };
            self.waiting.remove(&identity);
            let Ok(udp) = UdpSlice::from_slice(&whole.payload) else { return Taken::Other };
            let destination = Some(SocketAddr::new(receiver, udp.destination_port()));
            let bytes = Cow::Owned(udp.payload().to_vec());
            return Taken::Datagram(Datagram { time_ns: packet.time_ns, destination, offset: packet.offset, bytes });
        }
        let Some(TransportSlice::Udp(udp)) = sliced.transport else { return Taken::Other };
        let payload = udp.payload();
        // The payload ends where the packet does, but for octets that fill up an Ethernet frame.
        let offset = packet.offset + (payload.as_ptr() as usize - packet.bytes.as_ptr() as usize);
        let destination = Some(SocketAddr::new(receiver, udp.destination_port()));
        Taken::Datagram(Datagram { time_ns: packet.time_ns, destination, offset, bytes: Cow::Borrowed(payload) })
    }

    fn wait(&mut self, identity: Identity, place: Range<usize>) {
        self.waiting.entry(identity).or_insert(place);
        if self.waiting.len() > MOST_INCOMPLETE {
            self.given_up.extend(std::mem::take(&mut self.waiting).into_values());
            self.pool = IpDefragPool::new();
        }
    }

    /// First fragments of the packets of which others are missing.
    pub(super) fn incomplete(self) -> impl Iterator<Item = Range<usize>> {
        self.given_up.into_iter().chain(self.waiting.into_values())
    }
}

/// The layers of a packet; none for links that are not known.
fn slice<'a>(packet: &Packet<'a>) -> Result<Option<SlicedPacket<'a>>, SliceError> {
    let after = |octets: usize| packet.bytes.get(octets..).unwrap_or_default();
    match packet.link {
        ETHERNET => SlicedPacket::from_ethernet(packet.bytes).map(Some),
        LINUX_COOKED => SlicedPacket::from_linux_sll(packet.bytes).map(Some),
        LINUX_COOKED_2 => SlicedPacket::from_ip(after(LINUX_COOKED_2_HEADER)).map(Some),
        NULL | LOOP => SlicedPacket::from_ip(after(NULL_HEADER)).map(Some),
        link if RAW_IP.contains(&link) => SlicedPacket::from_ip(packet.bytes).map(Some),
        _ => Ok(None),
    }
}

fn receiver(sliced: &SlicedPacket<'_>) -> Option<IpAddr> {
    match sliced.net.as_ref()? {
        NetSlice::Ipv4(ip) => Some(ip.header().destination_addr().into()),
        NetSlice::Ipv6(ip) => Some(ip.header().destination_addr().into()),
        NetSlice::Arp(_) => None,
    }
}

/// Of which packet this is a part, if it is one.
fn fragment(sliced: &SlicedPacket<'_>) -> Option<Identity> {
    match sliced.net.as_ref()? {
        NetSlice::Ipv4(ip) if ip.header().is_fragmenting_payload() => {
            let header = ip.header();
            Some((header.source_addr().into(), header.destination_addr().into(), header.identification().into()))
        }
        NetSlice::Ipv6(ip) => {
            let header = ip.header();
            let identification = ip.extensions().clone().into_iter().find_map(|extension| match extension {
                etherparse::Ipv6ExtensionSlice::Fragment(part) if part.is_fragmenting_payload() => {
                    Some(part.identification())
                }
                _ => None,
            })?;
            Some((header.source_addr().into(), header.destination_addr().into(), identification))
        }
        _ => None,
    }
}
