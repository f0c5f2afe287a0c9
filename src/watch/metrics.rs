//! Counters, states and latencies of the chain for Prometheus, over HTTP.
//!
//! The page is written once a second; a scrape reads it and never waits for the chain. The text form is that of
//! the Prometheus exposition format 0.0.4.

use std::fmt::Write as _;
use std::io::{Read, Write};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use common::config::MetricsConfig;
use common::health::{Condition, Health, LatencySummary, RealtimeSetting};
use common::latency::LATENCY_NAMES;
use common::process::BadInput;
use common::time::monotonic_ns;
use common::topology::{LINK_IN, LINK_OUT};
use common::units::NS_PER_S;

use super::board::{Board, SiteBoard};
use crate::stages::name::LAUNCHER;

/// A slower scraper is disconnected.
const TIMEOUT: Duration = Duration::from_secs(2);
/// Scrapers that are answered at the same time; more are disconnected.
const SCRAPERS: usize = 16;
/// A process that has said nothing for so long is not up, s.
const SILENT_S: f64 = 10.0;
/// Longest request that is read, bytes.
const REQUEST: usize = 8192;

/// The page and where it is served.
#[derive(Debug)]
pub(crate) struct Metrics {
    page: Arc<Mutex<String>>,
    address: Option<SocketAddr>,
}

impl Metrics {
    /// Begins to serve, if the configuration says where.
    pub(crate) fn serve(config: &MetricsConfig) -> anyhow::Result<Self> {
        let page = Arc::new(Mutex::new(String::new()));
        let Some(wanted) = config.address() else { return Ok(Self { page, address: None }) };
        let refused = |error: std::io::Error| BadInput(format!("cannot serve metrics on {wanted}: {error}"));
        let listener = TcpListener::bind(wanted).map_err(refused)?;
        let address = listener.local_addr().map_err(refused)?;
        let shown = Arc::clone(&page);
        let named = |name: &str| std::thread::Builder::new().name(name.into());
        named("metrics").spawn(move || {
            // Each in a thread of its own: one that is slow keeps nobody waiting.
            let served = Arc::new(());
            for stream in listener.incoming().flatten() {
                if Arc::strong_count(&served) > SCRAPERS {
                    continue;
                }
                let text = shown.lock().unwrap_or_else(PoisonError::into_inner).clone();
                let place = Arc::clone(&served);
                let _ = named("scraper").spawn(move || {
                    let _ = answer(stream, &text); // a scraper that has gone away is no loss
                    drop(place);
                });
            }
        })?;
        if !wanted.ip().is_loopback() {
            common::process::say(&format!("metrics.listen = {wanted}: whoever reaches this address reads the metrics"));
        }
        common::process::say(&format!("metrics on http://{address}/metrics"));
        Ok(Self { page, address: Some(address) })
    }

    /// Writes the page anew.
    pub(crate) fn publish(&self, board: &Board) {
        if self.address.is_some() {
            let text = page(board);
            *self.page.lock().unwrap_or_else(PoisonError::into_inner) = text;
        }
    }
}

/// Answers one request.
fn answer(mut stream: TcpStream, page: &str) -> std::io::Result<()> {
    let until = Instant::now() + TIMEOUT;
    stream.set_write_timeout(Some(TIMEOUT))?;
    let (mut request, mut length) = ([0; REQUEST], 0);
    while length < REQUEST && !request[..length].windows(4).any(|end| end == b"\r\n\r\n") {
        // For the whole request: a byte now and then is no reason to wait on.
        let left = until.saturating_duration_since(Instant::now()).max(Duration::from_millis(1));
        stream.set_read_timeout(Some(left))?;
        match stream.read(&mut request[length..])? {
            0 => break,
            more => length += more,
        }
    }
    let path = request.strip_prefix(b"GET ").and_then(|rest| rest.split(|&byte| byte == b' ' || byte == b'?').next());
    let found = path.is_some_and(|path| path == b"/" || path == b"/metrics");
    let (status, body) = if found { ("200 OK", page) } else { ("404 Not Found", "see /metrics\n") };
    write!(
        stream,
        "HTTP/1.1 {status}\r\nContent-Type: text/plain; version=0.0.4; charset=utf-8\r\nContent-Length: {}\r\nConnection: close\r\n\r\n{body}",
        body.len()
    )
}

/// One figure of a process: its name, type, meaning and value.
type Figure = (&'static str, &'static str, &'static str, fn(&Health) -> f64);

const FIGURES: [Figure; 18] = [
    ("radar_up", "gauge", "1 while the last health report is younger than 10 s and not of the end", |health| {
        let age_s = monotonic_ns().saturating_sub(health.heartbeat_ns) as f64 / NS_PER_S;
        f64::from(health.ended == 0 && age_s < SILENT_S)
    }),
    ("radar_scan", "gauge", "Scan being worked on", |health| f64::from(health.scan)),
    ("radar_heartbeat_seconds", "gauge", "CLOCK_MONOTONIC of the last health report", |health| {
        health.heartbeat_ns as f64 / NS_PER_S
    }),
    ("radar_messages_published_total", "counter", "Messages published in this session", |health| {
        health.messages_out as f64
    }),
    ("radar_elements_published_total", "counter", "Cells, plots or tracks published in this session", |health| {
        health.elements_out as f64
    }),
    ("radar_cpu_seconds_total", "counter", "Processor time", |health| health.cpu_ns as f64 / NS_PER_S),
    ("radar_resident_memory_bytes", "gauge", "Resident memory", |health| health.rss_bytes as f64),
    ("radar_open_files", "gauge", "Open file descriptors", |health| f64::from(health.files)),
    ("radar_plots", "gauge", "Plots of the last whole scan", |health| f64::from(health.plots)),
    ("radar_tracks", "gauge", "Tracks alive", |health| f64::from(health.tracks)),
    ("radar_tracks_confirmed", "gauge", "Tracks confirmed", |health| f64::from(health.confirmed)),
    (
        "radar_restarts_total",
        "counter",
        "Restarts of stages by the launcher; under systemd radar_starts_total counts",
        |health| f64::from(health.restarts),
    ),
    ("radar_upstream_silences_total", "counter", "Times the input fell silent", |health| f64::from(health.silences)),
    ("radar_slow_steps_total", "counter", "Steps that took too long", |health| f64::from(health.slow_steps)),
    ("radar_realtime_settings_refused", "gauge", "Real-time settings that the system has refused", |health| {
        RealtimeSetting::names(health.refused).len() as f64
    }),
    ("radar_false_alarm_probability", "gauge", "False alarms per cell, measured; 0 while unknown", |health| {
        f64::from(health.false_alarms.measured)
    }),
    ("radar_false_alarm_probability_set", "gauge", "False alarms per cell, as set; 0 while unknown", |health| {
        f64::from(health.false_alarms.set)
    }),
    ("radar_clock_uncertainty_seconds", "gauge", "Clock of another host; 0 while unknown", |health| {
        f64::from(health.clock_uncertainty_us) * 1e-6
    }),
];

/// Whether a figure says something of a process: only a tracker has tracks, only who makes or takes plots has those.
fn applies(figure: &str, process: &str) -> bool {
    let is = |names: &[&str]| names.contains(&process);
    match figure {
        "radar_plots" => is(&[plot_extractor::process::NAME, tracker::process::NAME]),
        "radar_tracks"
        | "radar_tracks_confirmed"
        | "radar_false_alarm_probability"
        | "radar_false_alarm_probability_set" => is(&[tracker::process::NAME]),
        "radar_clock_uncertainty_seconds" => is(&[LINK_IN, LINK_OUT]),
        "radar_restarts_total" => is(&[LAUNCHER]),
        _ => true,
    }
}

/// The whole page.
fn page(board: &Board) -> String {
    let mut text = String::new();
    let (version, git) = (env!("CARGO_PKG_VERSION"), option_env!("RADAR_CHAIN_GIT").unwrap_or("unknown"));
    let _ = writeln!(text, "# HELP radar_build_info Version of the program\n# TYPE radar_build_info gauge");
    let _ = writeln!(text, "radar_build_info{{version=\"{version}\",git=\"{git}\"}} 1");
    let head = |text: &mut String, name: &str, kind: &str, help: &str| {
        let _ = writeln!(text, "# HELP {name} {help}\n# TYPE {name} {kind}");
    };
    for (name, kind, help, value) in FIGURES {
        head(&mut text, name, kind, help);
        for_each_process(board, |labels, health| {
            if applies(name, health.process.as_str()) {
                let _ = writeln!(text, "{name}{{{labels}}} {}", value(health));
            }
        });
    }
    head(&mut text, "radar_starts_total", "counter", "Starts of the process, whoever started it");
    for (site, of_site) in board.sites() {
        for (process, starts) in of_site.starts() {
            let _ = writeln!(text, "radar_starts_total{{{}}} {starts}", labels(site, process));
        }
    }
    head(&mut text, "radar_condition", "gauge", "1 for the condition that the watchdog of the process reports");
    for_each_process(board, |labels, health| {
        for condition in [Condition::Fine, Condition::UpstreamSilent, Condition::Slow] {
            let is = u32::from(condition as u32 == health.condition);
            let _ = writeln!(text, "radar_condition{{{labels},condition=\"{}\"}} {is}", condition.text());
        }
    });
    for (name, help, count) in [
        (
            "radar_messages_received_total",
            "Messages received",
            (|intake| intake.received) as fn(&common::health::Intake) -> u64,
        ),
        ("radar_messages_lost_total", "Messages missing, from gaps of the sequence numbers", |intake| intake.lost),
    ] {
        head(&mut text, name, "counter", help);
        for_each_process(board, |labels, health| {
            for (topic, intake) in health.inputs().filter(|(_, intake)| intake.received > 0) {
                let _ = writeln!(text, "{name}{{{labels},topic=\"{topic}\"}} {}", count(intake));
            }
        });
    }
    head(&mut text, "radar_rejected_total", "counter", "Input that could not be used, by reason");
    for_each_process(board, |labels, health| {
        for (reason, count) in health.rejected() {
            let _ = writeln!(text, "radar_rejected_total{{{labels},reason=\"{reason}\"}} {count}");
        }
    });
    head(
        &mut text,
        "radar_observer_lost_total",
        "counter",
        "Messages that the full queue of an observer has discarded",
    );
    for_each_process(board, |labels, health| {
        for of in health.observers() {
            let (topic, observer) = (of.topic, escaped(of.observer.as_str()));
            let labels = format!("{labels},topic=\"{topic}\",observer=\"{observer}\"");
            let _ = writeln!(text, "radar_observer_lost_total{{{labels}}} {}", of.lost);
        }
    });
    head(&mut text, "radar_latency_seconds", "summary", "Latencies of the whole run so far");
    for_each_latency(board, |labels, latency| {
        for (quantile, us) in [("0.5", latency.p50_us), ("0.99", latency.p99_us)] {
            let seconds = f64::from(us) * 1e-6;
            let _ = writeln!(text, "radar_latency_seconds{{{labels},quantile=\"{quantile}\"}} {seconds:e}");
        }
        let _ = writeln!(text, "radar_latency_seconds_count{{{labels}}} {}", latency.n);
    });
    head(&mut text, "radar_budget_misses_total", "counter", "Scans with a latency above its limit");
    for_each_latency(board, |labels, latency| {
        let _ = writeln!(text, "radar_budget_misses_total{{{labels}}} {}", latency.misses);
    });
    text
}

fn labels(site: &str, process: &str) -> String {
    format!("site=\"{site}\",process=\"{}\"", escaped(process))
}

/// A value of a label, as the exposition format wants it.
fn escaped(value: &str) -> String {
    value.replace('\\', "\\\\").replace('"', "\\\"").replace('\n', "\\n")
}

/// Calls `write` with the labels and the health of every process.
fn for_each_process(board: &Board, mut write: impl FnMut(&str, &Health)) {
    for (site, of_site) in board.sites() {
        for (process, health, _) in of_site.all() {
            write(&labels(site, process), health);
        }
    }
}

/// Calls `write` with the labels and the summary of every latency that has values.
fn for_each_latency(board: &Board, mut write: impl FnMut(&str, &LatencySummary)) {
    let recorder = |of_site: &SiteBoard| of_site.of(recorder::process::NAME).copied();
    for (site, health) in board.sites().filter_map(|(site, of_site)| Some((site, recorder(of_site)?))) {
        for (name, latency) in LATENCY_NAMES.iter().zip(&health.latency).filter(|(_, latency)| latency.n > 0) {
            write(&format!("site=\"{site}\",latency=\"{name}\""), latency);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::config::{ChainConfig, Sites};

    #[test]
    fn a_process_that_has_fallen_silent_is_not_up() {
        for (age_s, ended, up) in [(1, 0, 1), (11, 0, 0), (1, 1, 0)] {
            let heartbeat_ns = monotonic_ns().saturating_sub(age_s * 1_000_000_000);
            let mut health = Health { heartbeat_ns, ended, ..Health::default() };
            health.process = "tracker".into();
            let mut board = Board::new(&Sites::one(ChainConfig::default()));
            board.note(&health);
            let text = page(&board);
            health.session += 1;
            board.note(&health);
            assert!(page(&board).contains("radar_starts_total{site=\"site1\",process=\"tracker\"} 2\n"));
            assert!(text.contains(&format!("radar_up{{site=\"site1\",process=\"tracker\"}} {up}\n")), "{text}");
        }
    }
}
