//! `radar-chain asterix play`: recordings onto the network, at the pace of the times of day in them.

use std::collections::BTreeMap;
use std::convert::Infallible;
use std::net::UdpSocket;
use std::path::Path;
use std::process::ExitCode;

use anyhow::Context;
use asterix::block::HEADER;
use asterix::definition::Edition;
use asterix::editions::Editions;
use asterix::record::Records;
use asterix::recording::{Form, Recording};
use asterix::recovery::{Piece, Pieces, Unused};
use asterix::report::Message;
use common::pace::{Pace, Speed};
use common::process::{BadInput, EXIT_CHECK_BROKEN, say, stop_requested, tell};
use common::units::{DAY_NS, seconds_between};
use plot_source::clock::DayClock;
use plot_source::network::Endpoint;

use super::{bad_input, no_recording, read};

/// Sends recordings, pairs of a file and an endpoint.
pub(super) fn run(plan: &[String], speed: Speed, editions: &Editions) -> anyhow::Result<ExitCode> {
    let [pairs @ .., last] = plan else { unreachable!("the command line asks for two at least") };
    if pairs.len().is_multiple_of(2) {
        return Err(BadInput(format!("no endpoint after `{last}`, expected udp://ADDRESS:PORT")).into());
    }
    let (mut files, mut lines) = (Vec::new(), Vec::new());
    for pair in plan.chunks_exact(2) {
        let endpoint: Endpoint = pair[1].parse().map_err(bad_input)?;
        lines.push((endpoint.sender().map_err(bad_input)?, endpoint));
        files.push((Path::new(&pair[0]), read(Path::new(&pair[0]))?));
    }
    let mut sendings = Vec::new();
    let mut code = ExitCode::SUCCESS;
    for (line, (path, bytes)) in files.iter().enumerate() {
        let recording = Recording::new(bytes, editions);
        let played = Played::of(&recording, editions);
        if played.datagrams.is_empty() {
            return Err(no_recording(path, &format!("no readable record in {} bytes", bytes.len())).into());
        }
        if !played.is_timed && speed != Speed::Max {
            let text = "no times of day and no times of packets, expected --speed max";
            return Err(BadInput(format!("{}: {text}", path.display())).into());
        }
        if played.unread_bytes > 0 {
            say(&format!("{}: {} bytes could not be read and are not sent", path.display(), played.unread_bytes));
            code = ExitCode::from(EXIT_CHECK_BROKEN);
        }
        sendings.extend(played.datagrams.into_iter().map(|(time_ns, octets)| Sending { time_ns, line, octets }));
    }
    sendings.sort_by_key(|sending| sending.time_ns);
    let sent = send(&sendings, &lines, speed)?;
    for (line, (path, _)) in files.iter().enumerate() {
        let datagrams = sent.get(&line).copied().unwrap_or(0);
        tell(&format!("{}: {datagrams} datagrams to {}", path.display(), lines[line].1));
    }
    Ok(code)
}

/// A datagram that is to be sent.
struct Sending {
    time_ns: u64,
    /// Where, as an index.
    line: usize,
    octets: Vec<u8>,
}

/// Sends everything in its time; says how many datagrams went to each line.
fn send(sendings: &[Sending], lines: &[(UdpSocket, Endpoint)], speed: Speed) -> anyhow::Result<BTreeMap<usize, u64>> {
    if let [first, .., last] = sendings {
        let lasts_s = seconds_between(first.time_ns, last.time_ns);
        let takes = match speed {
            Speed::Times(factor) => format!("{:.0} s at {speed} real time", lasts_s / factor),
            Speed::Max => "sent as fast as they can be".into(),
        };
        tell(&format!("{} datagrams of {lasts_s:.0} s: {takes}", sendings.len()));
    }
    let (mut pace, mut sent) = (Pace::new(speed), BTreeMap::new());
    for sending in sendings {
        let Ok(()) = pace.wait_until(sending.time_ns, || Ok::<(), Infallible>(()));
        if stop_requested() {
            break;
        }
        let (socket, endpoint) = &lines[sending.line];
        socket.send_to(&sending.octets, endpoint.address).with_context(|| format!("sending to {endpoint}"))?;
        *sent.entry(sending.line).or_default() += 1;
    }
    Ok(sent)
}

/// What of a recording is sent.
#[derive(Default)]
struct Played {
    /// Octets, and when they are sent: ns from the midnight before the day on which the recording began.
    datagrams: Vec<(u64, Vec<u8>)>,
    unread_bytes: usize,
    /// Datagrams before the first time that is known go out with that one; without any, all at once.
    is_timed: bool,
}

impl Played {
    fn of(recording: &Recording<'_>, editions: &Editions) -> Self {
        let mut played = Self::default();
        for lost in &recording.lost {
            if let Unused::Unread { place, .. } = lost {
                played.unread_bytes += place.len();
            }
        }
        let mut clock = Clock { of_day: DayClock::new(DAY_NS), latest_ns: None };
        for datagram in &recording.datagrams {
            let bytes = &datagram.bytes;
            for piece in Pieces::new(editions, bytes) {
                match piece {
                    Piece::Block { category, records, cut: false } => {
                        let block = &bytes[records.start - HEADER..records.end];
                        clock.read(editions.of(category), &block[HEADER..]);
                        if recording.form == Form::Blocks {
                            played.datagrams.push((clock.latest_ns.unwrap_or(0), block.to_vec()));
                        }
                    }
                    Piece::Block { records: place, .. } | Piece::Lost(place) if recording.form == Form::Blocks => {
                        played.unread_bytes += place.len();
                    }
                    _ => {} // of a capture, everything is sent
                }
            }
            if recording.form != Form::Blocks {
                let captured_ns = datagram.time_ns.map(|time_ns| time_ns % DAY_NS + DAY_NS);
                let time_ns = clock.latest_ns.or(captured_ns);
                played.datagrams.push((time_ns.unwrap_or(0), bytes.to_vec()));
            }
        }
        played.is_timed = played.datagrams.iter().any(|&(time_ns, _)| time_ns > 0);
        let first_ns = played.datagrams.iter().map(|&(time_ns, _)| time_ns).find(|&time_ns| time_ns > 0).unwrap_or(0);
        played.datagrams.iter_mut().for_each(|(time_ns, _)| *time_ns = first_ns.max(*time_ns));
        played
    }
}

/// The latest time of day: what is late in a recording was late on the line.
struct Clock {
    of_day: DayClock,
    latest_ns: Option<u64>,
}

impl Clock {
    /// Reads the last time of day of a block.
    fn read(&mut self, edition: Option<&'static Edition>, records: &[u8]) {
        let Some(edition) = edition else { return };
        let times = Records::new(edition, records, 0).flatten().filter_map(|record| match Message::of(&record)? {
            Message::Target(report) => report.time_of_day,
            Message::Service(message) => message.time_of_day,
        });
        if let Some(time) = times.last() {
            self.latest_ns = self.latest_ns.max(Some(self.of_day.time_ns(time).max(0) as u64));
        }
    }
}
