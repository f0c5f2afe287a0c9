//! Metrics as a scraper sees them, read by a parser that is not ours.

mod support;

use std::io::{Read, Write};
use std::net::TcpStream;
use std::time::Duration;

use prometheus_parse::{Scrape, Value};
use support::{Bench, scan, text_of};

/// A port that was free a moment ago.
fn free_port() -> u16 {
    let listener = std::net::TcpListener::bind("127.0.0.1:0").expect("a port");
    listener.local_addr().expect("an address").port()
}

fn request(port: u16, request: &str) -> String {
    let mut stream = TcpStream::connect(("127.0.0.1", port)).expect("metrics are served");
    stream.set_read_timeout(Some(Duration::from_secs(30))).expect("a timeout");
    stream.write_all(request.as_bytes()).expect("asking");
    let mut answer = String::new();
    stream.read_to_string(&mut answer).expect("an answer");
    answer
}

#[test]
fn metrics_are_read_by_an_independent_parser() {
    let bench = Bench::new();
    let port = free_port();
    let listen = format!("metrics.listen='127.0.0.1:{port}'");
    let running = bench.start(&["--scans", "0", "--speed", "1", "--set", &listen]);
    bench.wait_for("scans", |status| scan(status).filter(|&scan| scan >= 12));
    let answer = request(port, "GET /metrics HTTP/1.1\r\nHost: x\r\n\r\n");
    let (head, body) = answer.split_once("\r\n\r\n").expect("a head and a body");
    assert!(head.starts_with("HTTP/1.1 200 OK"), "{head}");
    assert!(head.contains(&format!("Content-Length: {}", body.len())), "{head}");
    let scrape = Scrape::parse(body.lines().map(|line| Ok(line.to_string()))).expect("the exposition format");

    let value = |metric: &str, label: &str, of: &str| {
        let sample =
            scrape.samples.iter().find(|sample| sample.metric == metric && sample.labels.get(label) == Some(of));
        match &sample.unwrap_or_else(|| panic!("{metric} of {of} in {body}")).value {
            Value::Counter(value) | Value::Gauge(value) | Value::Untyped(value) => *value,
            other => panic!("{metric}: {other:?}"),
        }
    };
    for process in support::STAGES {
        assert!(value("radar_resident_memory_bytes", "process", process) > 1e6);
        assert!(value("radar_open_files", "process", process) > 3.0);
        assert!((value("radar_up", "process", process) - 1.0).abs() < 1e-9);
    }
    assert!((value("radar_build_info", "version", env!("CARGO_PKG_VERSION")) - 1.0).abs() < 1e-9);
    let confirmed = scrape.samples.iter().filter(|sample| sample.metric == "radar_tracks_confirmed");
    let processes: Vec<_> = confirmed.filter_map(|sample| sample.labels.get("process")).collect();
    assert_eq!(processes, ["tracker"], "others have none");
    assert!(value("radar_messages_received_total", "topic", "plots") > 50.0);
    assert!(value("radar_messages_lost_total", "topic", "plots").abs() < 1e-9);
    assert!(value("radar_messages_published_total", "process", "radar-sim") > 500.0);
    let latency = scrape
        .samples
        .iter()
        .find(|sample| sample.metric == "radar_latency_seconds" && sample.labels.get("latency") == Some("end_to_end"));
    let Value::Summary(quantiles) = &latency.expect("latencies").value else { panic!("a summary") };
    assert!(quantiles.iter().any(|part| (part.quantile - 0.5).abs() < 1e-9 && part.count > 0.0 && part.count < 10.0));

    // Others get their answers while slow scrapers say nothing.
    let slow: Vec<TcpStream> =
        (0..8).map(|_| TcpStream::connect(("127.0.0.1", port)).expect("metrics are served")).collect();
    let asked = std::time::Instant::now();
    assert!(request(port, "GET /metrics?name=x HTTP/1.1\r\n\r\n").starts_with("HTTP/1.1 200 OK"));
    let waited_for_all = Duration::from_secs(2) * slow.len() as u32;
    assert!(asked.elapsed() < waited_for_all, "slow scrapers are not waited for one after the other");
    drop(slow);
    assert!(request(port, "GET /else HTTP/1.1\r\n\r\n").starts_with("HTTP/1.1 404"));
    let again = Bench::new().run(&["--set", &listen]);
    assert_eq!(again.status.code(), Some(2), "{}", text_of(&again));
    assert!(text_of(&again).contains("cannot serve metrics on 127.0.0.1"), "{}", text_of(&again));
    let output = running.stop();
    assert_eq!(output.status.code(), Some(0), "{}", text_of(&output));
}
