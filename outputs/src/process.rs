//! The process `outputs`: an observer of the tracks of a site, which sends them on.

use std::io;
use std::net::{SocketAddr, UdpSocket};
use std::process::ExitCode;

use common::config::Source;
use common::ipc::{Flow, Station, Watchdog, attend};
use common::message::END_OF_STREAM;
use common::messages::Tracks;
use common::process::{BadInput, StageArgs, say, stop_requested, tell};
use common::topic::Topic;

use crate::datagrams::TrackDatagrams;

/// Name of the process.
pub const NAME: &str = "outputs";

/// Sends the tracks of a site to `to` as ASTERIX until the chain ends or the process is asked to stop. Nothing is ever
/// waited for: what cannot be sent at once is dropped and counted.
///
/// # Errors
/// Configuration, the address, or shared memory.
pub fn send_tracks(args: &StageArgs, to: SocketAddr, tentative: bool) -> anyhow::Result<ExitCode> {
    let (chain, sites) = (args.load()?, args.load_sites()?);
    let is_simulated = match chain.run.source {
        Source::Fusion => sites.all().iter().any(|site| site.run.source == Source::RadarSim),
        source => source == Source::RadarSim,
    };
    let mut line = Line::open(to).map_err(|error| BadInput(format!("cannot send to udp://{to}: {error}")))?;
    let mut out = TrackDatagrams::new(&chain, is_simulated, tentative);
    if chain.site.position.is_none() {
        say("key `site.position` is not set: tracks are sent without latitude, longitude and height");
    }
    let station = Station::enter(NAME, &chain)?;
    let (wake, tracks) = (station.wake(Topic::Tracks)?, station.subscriber::<Tracks>()?);
    let mut missed = 0;
    attend(&[&wake], &Watchdog::new(&chain, NAME), || -> anyhow::Result<Flow> {
        while let Some(message) = tracks.receive()? {
            missed += message.missing;
            for datagram in out.datagrams(message.header(), message.elements()) {
                line.send(&datagram);
            }
            if message.header().has(END_OF_STREAM) {
                return Ok(Flow::End);
            }
        }
        Ok(if stop_requested() { Flow::End } else { Flow::Wait })
    })?;
    let (sent, dropped, not_sent) = (line.sent, line.dropped, out.not_sent());
    tell(&format!(
        "udp://{to}: {sent} datagrams sent, {dropped} dropped; {not_sent} tracks out of range, {missed} messages missed"
    ));
    Ok(ExitCode::SUCCESS)
}

/// Where datagrams go.
struct Line {
    socket: UdpSocket,
    to: SocketAddr,
    sent: u64,
    dropped: u64,
    fails: bool,
}

impl Line {
    fn open(to: SocketAddr) -> io::Result<Self> {
        let own: SocketAddr = if to.is_ipv4() { ([0, 0, 0, 0], 0).into() } else { ([0_u16; 8], 0).into() };
        let socket = UdpSocket::bind(own)?;
        socket.set_nonblocking(true)?;
        Ok(Self { socket, to, sent: 0, dropped: 0, fails: false })
    }

    fn send(&mut self, datagram: &[u8]) {
        match self.socket.send_to(datagram, self.to) {
            Ok(_) => (self.sent, self.fails) = (self.sent + 1, false),
            Err(error) => {
                if !std::mem::replace(&mut self.fails, true) {
                    say(&format!("udp://{}: {error}; datagrams are dropped", self.to));
                }
                self.dropped += 1;
            }
        }
    }
}
