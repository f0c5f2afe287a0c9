//! Frames as datagrams, to an address or a group.

use std::io;
use std::net::{Ipv6Addr, SocketAddr, UdpSocket};
use std::time::Instant;

use common::config::OutputConfig;
use common::process::{say, tell};
use rustix::net::sockopt;

use super::{Counts, Event, Line};

/// One datagram for each frame.
#[derive(Debug)]
pub struct Datagrams {
    name: String,
    socket: UdpSocket,
    to: SocketAddr,
    counts: Counts,
    fails: bool,
}

impl Datagrams {
    /// To `to`; a group is reached by the interface of the configuration.
    ///
    /// # Errors
    /// The system refuses the interface or has no sockets.
    pub fn open(name: &str, to: SocketAddr, config: &OutputConfig) -> io::Result<Self> {
        let own: SocketAddr = if to.is_ipv4() { ([0, 0, 0, 0], 0).into() } else { (Ipv6Addr::UNSPECIFIED, 0).into() };
        let socket = UdpSocket::bind(own)?;
        socket.set_nonblocking(true)?;
        if to.ip().is_multicast() {
            sockopt::set_ip_multicast_if(&socket, &config.interface)?;
            socket.set_multicast_ttl_v4(config.hops.into())?;
        }
        Ok(Self { name: name.into(), socket, to, counts: Counts::default(), fails: false })
    }
}

impl Line for Datagrams {
    fn send(&mut self, frame: &[u8]) {
        match self.socket.send_to(frame, self.to) {
            Ok(_) => {
                self.counts.sent += 1;
                if std::mem::take(&mut self.fails) {
                    tell(&format!("output `{}`: udp://{} takes datagrams again", self.name, self.to));
                }
            }
            Err(error) => {
                if !std::mem::replace(&mut self.fails, true) {
                    say(&format!("output `{}`: udp://{}: {error}: datagrams are dropped", self.name, self.to));
                }
                self.counts.dropped += 1;
            }
        }
    }

    fn attend(&mut self, _: Instant, _: &mut Vec<Event>) {}

    fn counts(&self) -> Counts {
        self.counts
    }

    fn is_waiting(&self) -> bool {
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn a_frame_is_a_datagram_and_one_that_is_too_large_is_dropped() {
        let receiver = UdpSocket::bind("127.0.0.1:0").expect("a port");
        receiver.set_read_timeout(Some(Duration::from_secs(60))).expect("a limit");
        let to = receiver.local_addr().expect("an address");
        let mut line = Datagrams::open("x", to, &OutputConfig::default()).expect("a socket");
        line.send(b"one");
        line.send(&vec![0; 100_000]);
        line.send(b"two");
        assert_eq!(line.counts(), Counts { sent: 2, dropped: 1 });
        let mut room = [0; 16];
        for expected in [&b"one"[..], b"two"] {
            let length = receiver.recv(&mut room).expect("a datagram");
            assert_eq!(&room[..length], expected);
        }
    }

    #[test]
    fn an_interface_that_is_not_there_is_refused() {
        let config = OutputConfig { interface: [192, 0, 2, 1].into(), ..OutputConfig::default() };
        let group = ([239, 2, 3, 1], 6969).into();
        assert!(Datagrams::open("x", group, &config).is_err());
    }
}
