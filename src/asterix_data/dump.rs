//! `radar-chain asterix dump`: ASTERIX records as JSON lines, from a file or from the network.

use std::collections::BTreeMap;
use std::io::{self, BufWriter, ErrorKind, Write};
use std::net::SocketAddr;
use std::path::Path;
use std::process::ExitCode;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use asterix::editions::Editions;
use asterix::record::Record;
use asterix::recording::Recording;
use asterix::recovery::{Unused, records};
use asterix::value::RecordValues;
use common::network::{Endpoint, LARGEST_DATAGRAM};
use common::process::{EXIT_CHECK_BROKEN, say, stop_requested};

use super::{bad_input, no_recording, read};

/// How soon a signal ends the command while nothing is received.
const PATIENCE: Duration = Duration::from_millis(200);
/// Damaged places that are described; the others are counted.
const MOST_DESCRIBED: usize = 5;

/// Prints the records of a file or a place on the network.
pub(super) fn run(source: &str, editions: &Editions) -> anyhow::Result<ExitCode> {
    let mut dump = Dump { out: BufWriter::new(io::stdout().lock()), tally: Tally::default() };
    let printed = if source.starts_with("udp://") {
        let endpoint: Endpoint = source.parse().map_err(bad_input)?;
        dump.network(&endpoint, editions)
    } else {
        dump.file(Path::new(source), editions)
    };
    let printed = printed.and_then(|()| Ok(dump.out.flush()?));
    match printed {
        Err(error) if error.downcast_ref().is_some_and(|it: &io::Error| it.kind() == ErrorKind::BrokenPipe) => {
            Ok(ExitCode::SUCCESS) // whoever reads them has seen enough
        }
        Err(error) => Err(error),
        Ok(()) => Ok(dump.tally.conclude(source)),
    }
}

struct Dump<W> {
    out: W,
    tally: Tally,
}

impl<W: Write> Dump<W> {
    fn file(&mut self, path: &Path, editions: &Editions) -> anyhow::Result<()> {
        let bytes = read(path)?;
        let recording = Recording::new(&bytes, editions);
        for received in recording.records(editions) {
            match received {
                Ok(it) => self.record(&it.record, it.time_ns, it.destination)?,
                Err(unused) => self.tally.count(unused),
            }
        }
        self.tally.foreign.clone_from(&recording.foreign);
        if self.tally.records == 0 && self.tally.categories.is_empty() {
            return Err(no_recording(path, &format!("no readable record in {} bytes", bytes.len())).into());
        }
        Ok(())
    }

    fn network(&mut self, endpoint: &Endpoint, editions: &Editions) -> anyhow::Result<()> {
        let socket = endpoint.open(PATIENCE).map_err(bad_input)?;
        let mut datagram = vec![0; LARGEST_DATAGRAM];
        while !stop_requested() {
            let bytes = match socket.recv(&mut datagram) {
                Ok(length) => &datagram[..length],
                Err(error)
                    if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted) =>
                {
                    continue;
                }
                Err(error) => return Err(anyhow::Error::from(error).context(format!("receiving at {endpoint}"))),
            };
            let now_ns = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_nanos() as u64);
            for record in records(editions, bytes, 0) {
                match record {
                    Ok(record) => self.record(&record, Some(now_ns), Some(endpoint.address))?,
                    Err(unused) => self.tally.count(unused),
                }
            }
            self.out.flush()?;
        }
        Ok(())
    }

    fn record(&mut self, record: &Record<'_>, time_ns: Option<u64>, to: Option<SocketAddr>) -> io::Result<()> {
        self.tally.records += 1;
        let (category, edition) = (record.edition.category, record.edition.number);
        write!(self.out, "{{\"offset\":{},\"category\":{category},\"edition\":\"{edition}\"", record.offset)?;
        if !record.profile.name.is_empty() {
            write!(self.out, ",\"profile\":\"{}\"", record.profile.name)?;
        }
        if let Some(time_ns) = time_ns {
            write!(self.out, ",\"received_ns\":{time_ns}")?;
        }
        if let Some(to) = to {
            write!(self.out, ",\"to\":\"{to}\"")?;
        }
        writeln!(self.out, ",\"items\":{}}}", RecordValues::of(record))
    }
}

/// What was printed, and what was not.
#[derive(Default)]
struct Tally {
    records: u64,
    /// Blocks by category.
    categories: BTreeMap<u8, u64>,
    foreign: BTreeMap<SocketAddr, u64>,
    unread_bytes: usize,
    unread_places: usize,
    described: Vec<String>,
}

impl Tally {
    fn count(&mut self, unused: Unused) {
        match unused {
            Unused::Category { category, .. } => *self.categories.entry(category).or_default() += 1,
            Unused::Unread { place, cause } => {
                self.unread_bytes += place.len();
                self.unread_places += 1;
                if self.described.len() < MOST_DESCRIBED {
                    self.described.push(format!("byte {}: {cause}", place.start));
                }
            }
        }
    }

    /// Says what the user should know.
    fn conclude(&self, source: &str) -> ExitCode {
        for (category, blocks) in &self.categories {
            say(&format!("{source}: category {category:03}: {blocks} blocks not read, the category is not known"));
        }
        for (destination, datagrams) in &self.foreign {
            say(&format!("{source}: {datagrams} datagrams to {destination} are not ASTERIX"));
        }
        if self.unread_places == 0 {
            return ExitCode::SUCCESS;
        }
        let (bytes, places) = (self.unread_bytes, self.unread_places);
        say(&format!("{source}: {bytes} bytes could not be read, in {places} places: {}", self.described.join("; ")));
        ExitCode::from(EXIT_CHECK_BROKEN)
    }
}
