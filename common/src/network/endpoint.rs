//! Where datagrams are received and sent.

use std::fmt;
use std::io;
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr, UdpSocket};
use std::str::FromStr;
use std::time::Duration;

use rustix::net::{AddressFamily, SocketType, netdevice, sockopt};

/// Room for datagrams that wait in the kernel; it gives less where its own limit is lower.
const WAITING_BYTES: usize = 8 << 20;
/// Largest payload of a datagram, bytes.
pub const LARGEST_DATAGRAM: usize = 65_535;

/// Where datagrams are received or sent to: `udp://ADDRESS:PORT`, and for a group of multicast `?interface=NAME` or an address of it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Endpoint {
    /// Own address or group, and port.
    pub address: SocketAddr,
    /// Interface on which a group is joined or reached; none: the one that the routes choose.
    pub interface: Option<String>,
}

/// Why nothing can be received at an endpoint, or sent to it.
#[derive(Debug, thiserror::Error)]
pub enum NetworkError {
    /// The text names no endpoint.
    #[error("`{0}` is no endpoint on a network, expected udp://ADDRESS:PORT or udp://GROUP:PORT?interface=NAME")]
    NoEndpoint(String),
    /// There is no such interface.
    #[error("{endpoint}: no interface `{interface}` on this machine")]
    NoInterface {
        /// The endpoint.
        endpoint: Endpoint,
        /// The interface.
        interface: String,
    },
    /// The system refuses the address, the port or the group.
    #[error("cannot {verb} {endpoint}: {cause}")]
    Refused {
        /// What was to be done.
        verb: &'static str,
        /// The endpoint.
        endpoint: Endpoint,
        /// Why.
        cause: io::Error,
    },
}

impl FromStr for Endpoint {
    type Err = NetworkError;

    fn from_str(text: &str) -> Result<Self, NetworkError> {
        let refuse = || NetworkError::NoEndpoint(text.into());
        let rest = text.strip_prefix("udp://").ok_or_else(refuse)?;
        let (address, interface) = match rest.split_once('?') {
            Some((address, query)) => (address, Some(query.strip_prefix("interface=").ok_or_else(refuse)?.to_string())),
            None => (rest, None),
        };
        let address: SocketAddr = address.parse().map_err(|_| refuse())?;
        let is_usable = address.port() != 0 && (interface.is_none() || address.ip().is_multicast());
        if is_usable { Ok(Self { address, interface }) } else { Err(refuse()) }
    }
}

impl fmt::Display for Endpoint {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "udp://{}", self.address)?;
        self.interface.as_ref().map_or(Ok(()), |interface| write!(out, "?interface={interface}"))
    }
}

impl Endpoint {
    /// Receives there. Others on this machine may join the same group at the same port; an own address is one program's.
    /// Reading gives up after `patience`.
    ///
    /// # Errors
    /// [`NetworkError`].
    pub fn open(&self, patience: Duration) -> Result<UdpSocket, NetworkError> {
        let refused = |cause: io::Error| self.refused("receive at", cause);
        let family = if self.address.is_ipv4() { AddressFamily::INET } else { AddressFamily::INET6 };
        let open = || -> io::Result<UdpSocket> {
            let socket = rustix::net::socket(family, SocketType::DGRAM, None)?;
            if self.address.ip().is_multicast() {
                sockopt::set_socket_reuseaddr(&socket, true)?;
            }
            sockopt::set_socket_recv_buffer_size(&socket, WAITING_BYTES)?;
            // Bound to the group, it receives nothing of other groups at the same port.
            rustix::net::bind(&socket, &self.address)?;
            let socket = UdpSocket::from(socket);
            socket.set_read_timeout(Some(patience))?;
            Ok(socket)
        };
        let socket = open().map_err(refused)?;
        if self.address.ip().is_multicast() {
            let index = self.interface_index(&socket)?;
            match self.address.ip() {
                IpAddr::V4(group) => {
                    let address = self.interface_address().unwrap_or(Ipv4Addr::UNSPECIFIED);
                    sockopt::set_ip_add_membership_with_ifindex(&socket, &group, &address, index)
                }
                IpAddr::V6(group) => sockopt::set_ipv6_add_membership(&socket, &group, index),
            }
            .map_err(|cause| refused(cause.into()))?;
        }
        Ok(socket)
    }

    /// A socket that may send there, with [`UdpSocket::send_to`].
    ///
    /// # Errors
    /// [`NetworkError`].
    pub fn sender(&self) -> Result<UdpSocket, NetworkError> {
        let refused = |cause: io::Error| self.refused("send to", cause);
        let own: IpAddr =
            if self.address.is_ipv4() { Ipv4Addr::UNSPECIFIED.into() } else { Ipv6Addr::UNSPECIFIED.into() };
        let socket = UdpSocket::bind((own, 0)).map_err(refused)?;
        if self.interface.is_some() {
            let index = self.interface_index(&socket)?;
            if self.address.is_ipv4() {
                let address = self.interface_address().unwrap_or(Ipv4Addr::UNSPECIFIED);
                sockopt::set_ip_multicast_if_with_ifindex(&socket, &Ipv4Addr::UNSPECIFIED, &address, index)
            } else {
                sockopt::set_ipv6_multicast_if(&socket, index)
            }
            .map_err(|cause| refused(cause.into()))?;
        }
        Ok(socket)
    }

    fn refused(&self, verb: &'static str, cause: io::Error) -> NetworkError {
        NetworkError::Refused { verb, endpoint: self.clone(), cause }
    }

    /// The interface as one of its addresses.
    fn interface_address(&self) -> Option<Ipv4Addr> {
        self.interface.as_ref()?.parse().ok()
    }

    /// Number of the interface; 0 if it is to be chosen by its address or by the routes.
    fn interface_index(&self, socket: &UdpSocket) -> Result<u32, NetworkError> {
        match &self.interface {
            Some(interface) if self.interface_address().is_none() => netdevice::name_to_index(socket, interface)
                .map_err(|_| NetworkError::NoInterface { endpoint: self.clone(), interface: interface.clone() }),
            _ => Ok(0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn endpoints_are_told_from_other_texts() {
        for text in ["udp://127.0.0.1:8600", "udp://239.1.1.1:8600?interface=lo", "udp://[ff02::1]:8600?interface=lo"] {
            assert_eq!(text.parse::<Endpoint>().expect(text).to_string(), text);
        }
        for text in [
            "radar.ast",
            "udp://:8600",
            "udp://127.0.0.1",
            "udp://127.0.0.1:0",
            "udp://127.0.0.1:1?interface=lo",
            "udp://239.1.1.1:1?port=2",
        ] {
            assert!(text.parse::<Endpoint>().expect_err(text).to_string().contains(text));
        }
    }

    #[test]
    fn what_cannot_be_received_is_said_in_one_line() {
        let open = |text: &str| text.parse::<Endpoint>().expect(text).open(Duration::from_millis(1));
        let absent = open("udp://239.1.1.1:38600?interface=absent0").expect_err("no such interface").to_string();
        assert_eq!(absent, "udp://239.1.1.1:38600?interface=absent0: no interface `absent0` on this machine");
        let taken = UdpSocket::bind("127.0.0.1:0").expect("a free port");
        let text = format!("udp://{}", taken.local_addr().expect("an address"));
        let busy = open(&text).expect_err("busy").to_string();
        assert!(busy.starts_with(&format!("cannot receive at {text}: Address already in use")), "{busy}");
    }

    #[test]
    fn a_group_is_heard_on_its_interface() {
        // A port that was free a moment ago.
        let port = UdpSocket::bind("127.0.0.1:0").and_then(|socket| socket.local_addr()).expect("a port").port();
        let endpoint: Endpoint = format!("udp://239.255.86.1:{port}?interface=127.0.0.1").parse().expect("an endpoint");
        let sockets = [(); 2].map(|()| endpoint.open(Duration::from_secs(10)).expect("the group can be joined"));
        let sender = UdpSocket::bind("127.0.0.1:0").expect("a sender");
        sockopt::set_ip_multicast_if(&sender, &Ipv4Addr::LOCALHOST).expect("the loopback sends groups");
        sender.send_to(b"plots", endpoint.address).expect("sent");
        for socket in sockets {
            let mut bytes = [0; 16];
            assert_eq!(socket.recv(&mut bytes).expect("received"), 5);
        }
    }
}
