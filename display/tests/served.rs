//! The picture served on the loopback, filled by hand: what viewers get, and what those of ill will can do.

mod support;

use std::io::{Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::sync::Arc;
use std::sync::mpsc::channel;

use common::config::{ChainConfig, Sites};
use common::messages::RecordedRef;
use common::plots::{Plot, PlotsHeader};
use common::time::monotonic_ns;
use common::tracks::{CONFIRMED, Track, TracksHeader};
use display::picture::Picture;
use display::serve::{Access, Counts, Served, bind, serve};
use display::wire::hello::Extent;
use display::wire::requests::Playback;
use serde_json::json;
use support::{Live, connect, get, get_with};
use tungstenite::Message;

fn sites(clients: u32) -> Sites {
    let mut chain = ChainConfig::default();
    chain.display.clients = clients;
    Sites::one(chain)
}

fn start(served: Served) -> (SocketAddr, Arc<Served>) {
    let (listener, served) = (bind("127.0.0.1:0".parse().expect("an address")).expect("a port"), Arc::new(served));
    let address = listener.local_addr().expect("its address");
    serve(listener, Arc::clone(&served)).expect("a thread");
    (address, served)
}

fn live(clients: u32) -> (SocketAddr, Arc<Served>) {
    start(Served::live(&sites(clients), Access::default()))
}

fn take_tracks(served: &Served, seq: u64, tracks: &[Track]) {
    let header = TracksHeader { seq, scan: seq as u32, sectors_per_scan: 1, ..TracksHeader::default() };
    served.take(0, RecordedRef::Tracks(&header, tracks), monotonic_ns());
}

fn track(id: u64) -> Track {
    Track { id, state_code: CONFIRMED, known: 6, ..Track::EMPTY }
}

#[test]
fn who_comes_late_gets_the_picture_there_is_and_then_what_is_new() {
    let (address, served) = live(4);
    take_tracks(&served, 0, &[track(1), track(2)]);
    let mut viewer = Live::open(address);
    assert_eq!(viewer.next_of("hello")["sites"][0]["name"], "site1");
    viewer.send(
        r#"{"want": {"tracks": true, "events": true}, "encoding": "json", "follow": {"site": "site1", "track": 2}}"#,
    );
    let there = viewer.next_of("tracks");
    assert_eq!(there["items"].as_array().map(Vec::len), Some(2), "{there}");
    assert_eq!(viewer.next_of("event")["kind"], "confirmed");
    assert_eq!(viewer.next_of("track")["id"], 2);
    take_tracks(&served, 1, &[track(2), track(3)]);
    assert_eq!(viewer.next_of("tracks")["items"][1]["id"], 3);
    assert_eq!(viewer.next_of("track")["state_name"], "confirmed");
    // In columns, beside another viewer.
    let mut other = Live::open(address);
    other.send(r#"{"want": {"tracks": true}}"#);
    assert_eq!(other.next_of("tracks")["count"], 3);
    viewer.send(r#"{"ping": [1, "x"]}"#);
    let pong = viewer.next_of("pong");
    assert!(pong["ping"] == json!([1, "x"]) && pong["server_us"].as_f64().is_some_and(|us| us > 0.0), "{pong}");
}

#[test]
fn requests_that_make_no_sense_are_answered_in_one_line_and_harm_nobody() {
    let (address, served) = live(4);
    let mut viewer = Live::open(address);
    for wrong in [
        "",
        "[",
        "null",
        "{\"wants\": 1}",
        "{\"want\": {\"plots\": 7}}",
        "{\"follow\": {\"site\": \"x\", \"track\": 1}}",
    ] {
        viewer.send(wrong);
        let error = viewer.next_of("error")["error"].as_str().map(String::from).expect("text");
        assert!(!error.contains('\n') && !error.is_empty(), "{error}");
    }
    viewer.send(r#"{"play": 2.0}"#);
    assert!(viewer.next_of("error")["error"].as_str().is_some_and(|error| error.contains("running chain")));
    viewer.send_message(Message::binary(vec![0; 100])).expect("sent");
    viewer.next_of("error");
    // One that is too long ends the connection, of this viewer alone.
    let mut other = Live::open(address);
    let _ = viewer.send_message(Message::text("x".repeat(100_000)));
    while viewer.next().is_some() {}
    other.send(r#"{"want": {"tracks": true}, "encoding": "json"}"#);
    take_tracks(&served, 0, &[track(1)]);
    other.next_of("tracks");
}

#[test]
fn paths_queries_and_methods_that_there_are_not_are_named() {
    let (address, served) = live(4);
    take_tracks(&served, 0, &[track(7)]);
    let error = |path: &str, status: u16, text: &str| {
        let answer = get(address, path);
        let said = answer.json()["error"].as_str().map(String::from).expect("text");
        assert!(answer.status == status && said.contains(text), "{path}: {} {said}", answer.status);
    };
    error("/nowhere", 404, "/nowhere");
    error("/assets/../Cargo.toml", 404, "there is no");
    error("/assets/none.js", 404, "none.js");
    error("/api/v1/sites/x/tracks", 404, "`x`");
    error("/api/v1/sites/site1/tracks/8", 404, "`8`");
    error("/api/v1/sites/site1/tracks/abc", 404, "`abc`");
    error("/api/v1/sites/site1/tracks?confirmed=maybe", 400, "confirmed");
    error("/api/v1/events?since=yesterday", 400, "since");
    error("/api/v1/live", 400, "WebSocket");
    let mut stream = connect(address);
    stream
        .write_all(format!("DELETE /api/v1/chain HTTP/1.1\r\nhost: {address}\r\nconnection: close\r\n\r\n").as_bytes())
        .expect("sent");
    let mut answer = String::new();
    stream.read_to_string(&mut answer).expect("an answer");
    assert!(answer.starts_with("HTTP/1.1 405") && answer.contains("DELETE cannot be done here"), "{answer}");
    assert_eq!(get(address, "/api/v1/sites/site1/tracks/7").status, 200);
}

#[test]
fn the_page_loads_nothing_from_elsewhere_and_no_foreign_page_reads_anything() {
    let (address, _served) = live(4);
    let page = get(address, "/");
    assert!(page.status == 200 && page.body.starts_with("<!doctype html>"), "{}", page.head);
    for line in
        ["content-type: text/html", "content-security-policy: default-src 'none'", "x-content-type-options: nosniff"]
    {
        assert!(page.head.contains(line), "{}", page.head);
    }
    assert_eq!(get_with(address, "/", "origin: http://evil.example\r\n").status, 403);
    assert_eq!(get_with(address, "/api/v1/chain", "origin: null\r\n").status, 403);
    let refused = Live::try_open(address, "origin: http://evil.example\r\n").err().expect("refused");
    assert!(refused.starts_with("HTTP/1.1 403"), "{refused}");
    assert!(Live::try_open(address, &format!("origin: http://{address}\r\n")).is_ok());
    // A foreign name that leads here.
    let mut stream = connect(address);
    stream.write_all(b"GET /api/v1/chain HTTP/1.1\r\nhost: evil.example\r\nconnection: close\r\n\r\n").expect("sent");
    let mut answer = String::new();
    stream.read_to_string(&mut answer).expect("an answer");
    assert!(answer.starts_with("HTTP/1.1 403"), "{answer}");
}

#[test]
fn viewers_and_connections_beyond_the_limit_are_told_to_come_back_and_counted() {
    let (address, served) = live(2);
    let mut viewers = [Live::open(address), Live::open(address)];
    for viewer in &mut viewers {
        viewer.next_of("hello");
    }
    let refused = Live::try_open(address, "").err().expect("refused");
    assert!(refused.starts_with("HTTP/1.1 503"), "{refused}");
    assert_eq!(served.counts().refused, 1);
    // Connections that say nothing: those beyond the limit yield, the viewers see on, and so does whoever comes now.
    let idle: Vec<TcpStream> = (0..800).map(|_| TcpStream::connect(address).expect("a connection")).collect();
    viewers[0].send(r#"{"want": {"tracks": true}, "encoding": "json"}"#);
    take_tracks(&served, 0, &[track(1)]);
    viewers[0].next_of("tracks");
    for _ in 0..20 {
        assert_eq!(get(address, "/api/v1/chain").status, 200);
    }
    drop(idle);
    let [first, _] = viewers;
    drop(first);
    // Its place is free as soon as the server has seen that it has gone.
    let mut refusals = 0;
    while let Err(answer) = Live::try_open(address, "") {
        refusals += 1;
        assert!(refusals < 100_000, "{answer}");
    }
    assert!(served.counts().refused >= 700, "{:?}", served.counts());
}

#[test]
fn a_viewer_that_stands_still_keeps_nobody_waiting_and_its_loss_is_counted() {
    let (address, served) = live(4);
    let (mut still, mut awake) = (Live::open(address), Live::open(address));
    for viewer in [&mut still, &mut awake] {
        viewer.send(r#"{"want": {"plots": true}}"#);
        viewer.next_of("hello");
        // What was asked for has arrived when this is answered.
        viewer.send(r#"{"ping": 1}"#);
        viewer.next_of("pong");
    }
    let plots = vec![Plot::default(); 1000];
    let mut seq = 0;
    // Until its socket and its queue are full.
    while served.counts().dropped == 0 {
        let header = PlotsHeader { seq, sectors_per_scan: 4, ..PlotsHeader::default() };
        served.take(0, RecordedRef::Plots(&header, &plots), monotonic_ns());
        let seen = awake.find("plots", |message| (message["type"] == "plots").then(|| message["seq"].as_u64()));
        assert_eq!(seen, Some(seq), "the other one sees everything");
        seq += 1;
        assert!(seq < 100_000, "it never was full");
    }
    // When it looks again it learns of it, and begins anew.
    let dropped = still.next_of("dropped")["messages"].as_u64();
    assert!(dropped.is_some_and(|messages| messages > 0), "{dropped:?}");
    still.next_of("reset");
    assert_eq!(still.next_of("plots")["seq"].as_u64(), Some(seq - 4), "the last scan");
}

#[test]
fn garbage_and_half_requests_are_no_danger() {
    let (address, served) = live(4);
    for garbage in [&b"\0\0\0\0"[..], b"GET", b"GET / HTTP/9.9\r\n\r\n", b"\r\n\r\n\r\n", &vec![0xff; 70_000]] {
        let mut stream = connect(address);
        let _ = stream.write_all(garbage);
        let _ = stream.shutdown(std::net::Shutdown::Write);
        let mut answer = Vec::new();
        let _ = stream.read_to_end(&mut answer);
    }
    // Frames that are none, on a WebSocket that is one.
    let mut stream = connect(address);
    let head = format!(
        "GET /api/v1/live HTTP/1.1\r\nhost: {address}\r\nconnection: Upgrade\r\nupgrade: websocket\r\n\
         sec-websocket-version: 13\r\nsec-websocket-key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n"
    );
    stream.write_all(head.as_bytes()).expect("a request");
    let _ = stream.write_all(&[0xff; 1000]);
    let mut rest = Vec::new();
    let _ = stream.read_to_end(&mut rest);
    assert_eq!(get(address, "/api/v1/chain").status, 200);
    assert_eq!(served.counts(), Counts { sent: 0, dropped: 0, refused: 0 });
}

#[test]
fn a_recording_is_moved_by_its_viewers_and_shown_anew_after_a_jump() {
    let (sender, wanted) = channel();
    let player = Box::new(move |playback| sender.send(playback).is_ok());
    let extent = Extent { from_s: 1.0, to_s: 9.0, files: 1 };
    let (address, served) = start(Served::recording(&sites(4), Access::default(), extent, player));
    let mut viewer = Live::open(address);
    let hello = viewer.next_of("hello");
    assert_eq!((&hello["mode"], &hello["recording"]["to_s"]), (&json!("recording"), &json!(9.0)));
    viewer.send(r#"{"want": {"tracks": true}, "encoding": "json", "seek": 5.0}"#);
    assert_eq!(wanted.recv(), Ok(Playback::Seek(5.0)));
    let mut there = Picture::new(&sites(4));
    there.take(0, RecordedRef::Tracks(&TracksHeader::default(), &[track(42)]), 0);
    served.replace(there, || ());
    // Who only wants more of what there is gets the present time anew, with what has led to it.
    viewer.send(r#"{"want": {"tracks": true, "video": {"lines": 64, "ranges": 64}}}"#);
    assert_eq!(wanted.recv(), Ok(Playback::Again));
    viewer.next_of("reset");
    let tracks = viewer.next_of("tracks");
    assert_eq!((&tracks["items"][0]["id"], &tracks["stamps_us"]["display_in"]), (&json!(42), &json!(null)));
}
