//! `radar-chain doctor --source`: what radars on the network say, and the configuration that fits them.

use std::io::ErrorKind;
use std::process::ExitCode;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use asterix::editions::Editions;
use common::network::{Endpoint, LARGEST_DATAGRAM};
use common::process::{BadInput, EXIT_CHECK_BROKEN, print, say, stop_requested, tell};
use plot_source::hearing::Hearing;

/// How soon a signal ends the hearing while nothing is received.
const PATIENCE: Duration = Duration::from_millis(200);

/// Listens at `source` for so long, tells what was heard, and proposes a configuration; exit code 1 if no radar was heard.
pub(crate) fn hear(source: &str, duration: Duration) -> anyhow::Result<ExitCode> {
    let endpoint: Endpoint = source.parse().map_err(|error: common::network::NetworkError| refuse(&error))?;
    let socket = endpoint.open(PATIENCE).map_err(|error| refuse(&error))?;
    tell(&format!("listening at {endpoint} for {duration:?}; Ctrl-C ends it earlier"));
    let (mut hearing, editions, began) = (Hearing::default(), Editions::default(), Instant::now());
    let mut datagram = vec![0; LARGEST_DATAGRAM];
    while began.elapsed() < duration && !stop_requested() {
        let length = match socket.recv(&mut datagram) {
            Ok(length) => length,
            Err(error)
                if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted) =>
            {
                continue;
            }
            Err(error) => return Err(anyhow::Error::from(error).context(format!("receiving at {endpoint}"))),
        };
        let since_1970 = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default().as_secs_f64();
        hearing.take(&datagram[..length], &editions, began.elapsed().as_secs_f64(), since_1970 % 86_400.0);
    }
    print(&hearing.text());
    let Some(proposal) = hearing.proposal(source) else {
        say(&format!("{endpoint}: no radar was heard: expected ASTERIX categories 001 and 002, 010, or 048 and 034"));
        return Ok(ExitCode::from(EXIT_CHECK_BROKEN));
    };
    print(&format!("\nA configuration to begin with:\n\n{proposal}"));
    Ok(ExitCode::SUCCESS)
}

fn refuse(error: &dyn std::fmt::Display) -> BadInput {
    BadInput(error.to_string())
}
