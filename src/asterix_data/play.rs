//! `radar-chain asterix play`: recordings onto the network, at the pace of the times of day in them.

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
use asterix::report::{Message, TimeOfDay};
use common::network::Endpoint;
use common::pace::{Pace, Speed};
use common::process::{BadInput, EXIT_CHECK_BROKEN, say, stop_requested, tell};
use common::units::seconds_between;

use super::schedule::{Said, Schedule};
use super::{bad_input, no_recording, read};

/// Largest payload of a datagram over IPv4.
const LARGEST_PAYLOAD: usize = 65_507;

/// Sends recordings, pairs of a file and an endpoint.
pub(super) fn run(plan: &[String], speed: Speed, editions: &Editions) -> anyhow::Result<ExitCode> {
    if let [.., last] = plan
        && !plan.len().is_multiple_of(2)
    {
        return Err(BadInput(format!("no endpoint after `{last}`, expected udp://ADDRESS:PORT")).into());
    }
    let (mut files, mut lines) = (Vec::new(), Vec::new());
    for pair in plan.chunks_exact(2) {
        let endpoint: Endpoint = pair[1].parse().map_err(bad_input)?;
        lines.push((endpoint.sender().map_err(bad_input)?, endpoint));
        files.push((Path::new(&pair[0]), read(Path::new(&pair[0]))?));
    }
    let (mut sendings, mut schedule, mut is_whole) = (Vec::new(), Schedule::default(), true);
    for (line, (path, bytes)) in files.iter().enumerate() {
        let recording = Recording::new(bytes, editions);
        let Datagrams { octets, said, unread_bytes } = Datagrams::of(&recording, editions);
        if octets.is_empty() {
            return Err(no_recording(path, &format!("no readable record in {} bytes", bytes.len())).into());
        }
        let times_ns = match (schedule.of(&said), speed) {
            (Some(times_ns), _) => times_ns,
            (None, Speed::Max) => vec![0; octets.len()],
            (None, Speed::Times(_)) => {
                let text = "no times of day and no times of packets, expected --speed max";
                return Err(BadInput(format!("{}: {text}", path.display())).into());
            }
        };
        if unread_bytes > 0 {
            say(&format!("{}: {unread_bytes} bytes could not be read and are not sent", path.display()));
            is_whole = false;
        }
        for (destination, datagrams) in &recording.foreign {
            say(&format!("{}: {datagrams} datagrams to {destination} are not ASTERIX, not sent", path.display()));
        }
        sendings.extend(times_ns.into_iter().zip(octets).map(|(time_ns, octets)| Sending { time_ns, line, octets }));
    }
    sendings.sort_by_key(|sending| sending.time_ns);
    let sent = send(&sendings, &lines, speed)?;
    for ((path, _), ((_, endpoint), datagrams)) in files.iter().zip(lines.iter().zip(sent)) {
        tell(&format!("{}: {datagrams} datagrams to {endpoint}", path.display()));
    }
    Ok(if is_whole { ExitCode::SUCCESS } else { ExitCode::from(EXIT_CHECK_BROKEN) })
}

/// A datagram that is to be sent.
struct Sending {
    time_ns: u64,
    /// Where, as an index.
    line: usize,
    octets: Vec<u8>,
}

/// The process has been asked to stop.
struct Stopped;

/// Sends everything in its time; says how many datagrams went to each line.
fn send(sendings: &[Sending], lines: &[(UdpSocket, Endpoint)], speed: Speed) -> anyhow::Result<Vec<u64>> {
    if let [first, .., last] = sendings {
        let lasts_s = seconds_between(first.time_ns, last.time_ns);
        let takes = match speed {
            Speed::Times(factor) => format!("{:.0} s at {speed} real time", lasts_s / factor),
            Speed::Max => "sent as fast as they can be".into(),
        };
        tell(&format!("{} datagrams of {lasts_s:.0} s: {takes}", sendings.len()));
    }
    let (mut pace, mut sent) = (Pace::new(speed), vec![0; lines.len()]);
    for sending in sendings {
        let asked = || if stop_requested() { Err(Stopped) } else { Ok(()) };
        if pace.wait_until(sending.time_ns, asked).and_then(|()| asked()).is_err() {
            break;
        }
        let (socket, endpoint) = &lines[sending.line];
        socket.send_to(&sending.octets, endpoint.address).with_context(|| format!("sending to {endpoint}"))?;
        sent[sending.line] += 1;
    }
    Ok(sent)
}

/// What of a recording is sent.
#[derive(Default)]
struct Datagrams {
    octets: Vec<Vec<u8>>,
    /// What each says of its time.
    said: Vec<Said>,
    unread_bytes: usize,
}

impl Datagrams {
    /// The datagrams of a capture as they were; of other files, one for each block.
    fn of(recording: &Recording<'_>, editions: &Editions) -> Self {
        let mut all = Self::default();
        for lost in &recording.lost {
            if let Unused::Unread { place, .. } = lost {
                all.unread_bytes += place.len();
            }
        }
        for datagram in &recording.datagrams {
            let bytes = &datagram.bytes;
            let captured_ns = datagram.time_ns;
            let mut last = None;
            for piece in Pieces::new(editions, bytes) {
                match piece {
                    Piece::Block { category, records, cut: false } => {
                        let time_of_day = time_of_day(editions.of(category), &bytes[records.clone()]);
                        last = time_of_day.or(last);
                        let block = &bytes[records.start - HEADER..records.end];
                        if recording.form == Form::Blocks && block.len() <= LARGEST_PAYLOAD {
                            all.octets.push(block.to_vec());
                            all.said.push(Said { time_of_day, captured_ns });
                        } else if recording.form == Form::Blocks {
                            all.unread_bytes += block.len();
                        }
                    }
                    Piece::Block { records: place, .. } | Piece::Lost(place) if recording.form == Form::Blocks => {
                        all.unread_bytes += place.len();
                    }
                    _ => {} // of a capture, everything is sent
                }
            }
            if recording.form != Form::Blocks {
                all.octets.push(bytes.to_vec());
                all.said.push(Said { time_of_day: last, captured_ns });
            }
        }
        all
    }
}

/// The last time of day of a block.
fn time_of_day(edition: Option<&'static Edition>, records: &[u8]) -> Option<TimeOfDay> {
    let times = Records::new(edition?, records, 0).flatten().filter_map(|record| match Message::of(&record)? {
        Message::Target(report) => report.time_of_day,
        Message::Service(message) => message.time_of_day,
    });
    times.last()
}
