//! Recordings in the picture: moved in time, played, drawn.

#[path = "../display/tests/support/mod.rs"]
mod viewer;

mod support;

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::io::{BufRead, BufReader};
use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

use serde_json::{Value, json};
use support::{Bench, output, text_of};
use viewer::{Live, get};

/// A recording of the small radar, at a pace that the chain keeps up with: at full speed tracks lie behind plots by as many scans as the
/// queues hold, and a picture of an early time has none.
fn recorded(bench: &Bench) -> PathBuf {
    let result = bench.run(&["--scans", "60", "--speed", "8", "--set", "recorder.chunk_kib=16"]);
    assert!(result.status.success(), "{}", text_of(&result));
    bench.recordings().remove(0)
}

fn radar_chain() -> Command {
    Command::new(env!("CARGO_BIN_EXE_radar-chain"))
}

/// `radar-chain view` while it runs.
struct Viewed {
    process: Child,
    address: SocketAddr,
}

impl Viewed {
    fn start(recordings: &[impl AsRef<OsStr>]) -> Self {
        let mut command = radar_chain();
        command.arg("view").args(recordings).args(["--listen", "127.0.0.1:0"]);
        let mut process = command.stdin(Stdio::null()).stderr(Stdio::piped()).spawn().expect("started");
        let lines = BufReader::new(process.stderr.take().expect("a pipe")).lines().map_while(Result::ok);
        let said: Vec<String> = lines.take(1).collect();
        let address = said[0].split("http://").nth(1).and_then(|rest| rest.split(',').next());
        let address = address.and_then(|address| address.parse().ok()).unwrap_or_else(|| panic!("{said:?}"));
        Self { process, address }
    }
}

impl Drop for Viewed {
    fn drop(&mut self) {
        let _ = self.process.kill().and_then(|()| self.process.wait());
    }
}

/// Asks the player to leave a time, and gives the one that it tells then.
fn ask(viewer: &mut Live, wanted: &Value, from_s: f64) -> f64 {
    viewer.send(&wanted.to_string());
    let at_s = |message: &Value| (message["type"] == "time").then(|| message["at_s"].as_f64()).flatten();
    viewer.find("another time", |message| at_s(message).filter(|at_s| (at_s - from_s).abs() > 1e-3))
}

/// What a viewer has after a jump.
struct Shown {
    /// Living tracks by number.
    tracks: BTreeMap<u64, Value>,
    /// Time of the oldest message of tracks, s UTC.
    oldest_s: f64,
    /// The last message of the track that is followed.
    followed: Option<Value>,
}

/// Asks for a jump to a time, and gathers what comes until the recording stands there.
fn picture_at(viewer: &mut Live, wanted: &Value, at_s: f64) -> Shown {
    viewer.send(&wanted.to_string());
    let mut shown = None;
    viewer.find("the time", |message| {
        let kind = message["type"].as_str();
        if kind == Some("reset") {
            shown = Some(Shown { tracks: BTreeMap::new(), oldest_s: f64::INFINITY, followed: None });
        }
        let shown = shown.as_mut()?;
        let time_s = message["time_s"].as_f64().unwrap_or(f64::INFINITY);
        match kind {
            Some("tracks") => {
                let items = message["items"].as_array().expect("a list");
                shown.tracks.extend(items.iter().map(|track| (track["id"].as_u64().expect("a number"), track.clone())));
                shown.tracks.retain(|_, track| track["state"] != 3);
                shown.oldest_s = shown.oldest_s.min(time_s);
            }
            Some("track") => shown.followed = Some(message.clone()),
            Some("time") if (message["at_s"].as_f64().expect("a time") - at_s).abs() < 1e-6 => return Some(()),
            _ => {}
        }
        None
    });
    shown.expect("what came after the jump")
}

#[test]
fn a_recording_is_moved_to_any_time_and_played_to_its_end() {
    let bench = Bench::new();
    let recording = recorded(&bench);
    let viewed = Viewed::start(&[&recording]);
    let mut viewer = Live::open(viewed.address);
    let hello = viewer.next_of("hello");
    let extent = |key: &str| hello["recording"][key].as_f64().expect("a time");
    let (from_s, to_s) = (extent("from_s"), extent("to_s"));
    assert!(hello["mode"] == "recording" && to_s > from_s + 10.0, "{hello}");
    viewer.send(r#"{"want": {"tracks": true, "events": true}, "encoding": "json"}"#);

    // All that happens is known before it is played.
    let confirmed = viewer.find("a confirmation", |message| (message["kind"] == "confirmed").then(|| message.clone()));
    assert!(confirmed["time_s"].as_f64().is_some_and(|time_s| (from_s..=to_s).contains(&time_s)), "{confirmed}");

    // Forth, back, and forth again: the picture is that of the time, whatever was seen before.
    let middle_s = f64::midpoint(from_s, to_s);
    let times_s = [middle_s, from_s + 1.0, middle_s];
    let pictures = times_s.map(|at_s| picture_at(&mut viewer, &json!({ "seek": at_s }), at_s));
    assert_eq!(pictures[0].tracks, pictures[2].tracks);
    assert!(pictures[0].tracks.len() >= 2, "{:?}", pictures[0].tracks);
    assert_ne!(pictures[0].tracks, pictures[1].tracks);

    let period_s = hello["sites"][0]["scan_period_s"].as_f64().expect("a period");
    // A jump shows what has led to that time: tracks with their trails, and the followed one as it is then.
    let (id, track) = pictures[0].tracks.first_key_value().expect("a track");
    let follow = json!({"follow": {"site": hello["sites"][0]["name"], "track": id}, "seek": middle_s});
    let there = picture_at(&mut viewer, &follow, middle_s);
    let trail_s = middle_s - there.oldest_s;
    assert!((period_s * 6.0..=period_s * 14.0).contains(&trail_s), "{trail_s} s of trail");
    let followed = there.followed.expect("the followed track");
    assert_eq!((&followed["id"], &followed["time_s"]), (&track["id"], &track["time_s"]));
    let stepped_s = ask(&mut viewer, &json!({"step": "scan", "by": 2}), middle_s);
    // Plots may be recorded some sectors ahead of the tracks that end a scan.
    assert!((period_s * 0.9..=period_s * 5.1).contains(&(stepped_s - middle_s)), "{stepped_s} after {middle_s}");
    let back_s = ask(&mut viewer, &json!({"step": "scan", "by": -1}), stepped_s);
    assert!((stepped_s - back_s - period_s).abs() < 1e-3, "{back_s} before {stepped_s}");

    viewer.send(r#"{"play": 1000}"#);
    let end = viewer.find("the end", |message| {
        (message["type"] == "time" && message["playing"] == false).then(|| message["at_s"].as_f64()).flatten()
    });
    assert!((end - to_s).abs() < 1e-6, "{end}, {to_s}");
    assert_eq!(get(viewed.address, "/api/v1/chain").json()["mode"], "recording");
}

#[test]
fn what_is_no_recording_is_said_in_a_line() {
    let bench = Bench::new();
    let recording = recorded(&bench);
    let text = bench.path("notes.txt");
    std::fs::write(&text, "nothing of a radar").expect("written");
    for (file, expected) in
        [(text.as_path(), "expected a recording (MCAP)"), (Path::new("/no/such.mcap"), "cannot open")]
    {
        let result = output(radar_chain().arg("view").arg(file));
        assert_eq!(result.status.code(), Some(2), "{}", text_of(&result));
        assert!(text_of(&result).contains(expected), "{}", text_of(&result));
    }
    // Nobody beyond this machine may look without a token.
    let result = output(radar_chain().arg("view").arg(&recording).args(["--listen", "0.0.0.0:0"]));
    assert!(result.status.code() == Some(2) && text_of(&result).contains("--token-file"), "{}", text_of(&result));
    let result = output(radar_chain().arg("view").args([&recording, &recording]));
    assert!(result.status.code() == Some(2) && text_of(&result).contains("a name that no other site has"));
    // A recording that was cut is shown as far as it goes.
    let bytes = std::fs::read(&recording).expect("a recording");
    std::fs::write(bench.path("cut.mcap"), &bytes[..bytes.len() * 2 / 3]).expect("written");
    let viewed = Viewed::start(&[bench.path("cut.mcap")]);
    assert_eq!(Live::open(viewed.address).next_of("hello")["mode"], "recording");
}

#[test]
fn a_plan_shows_the_confirmed_tracks() {
    let bench = Bench::new();
    let recording = recorded(&bench);
    let draw = |plan: &Path, arguments: &[&str]| {
        output(radar_chain().arg("picture").arg(&recording).arg("--out").arg(plan).args(arguments))
    };
    let plan = bench.path("plan.svg");
    let result = draw(&plan, &[]);
    assert!(result.status.success(), "{}", text_of(&result));
    let svg = std::fs::read_to_string(&plan).expect("a plan");
    assert_eq!(svg.matches("class=\"confirmed\"").count(), 2, "two targets");
    assert!(svg.contains("class=\"trail\"") && svg.contains("class=\"truth\"") && svg.ends_with("</svg>\n"));
    let result = draw(&plan, &["--at", "1e9"]);
    assert!(result.status.code() == Some(2) && text_of(&result).contains("outside of the recording"));

    let result = draw(&bench.path("plan.png"), &["--night"]);
    assert!(result.status.success(), "{}", text_of(&result));
    let png = std::fs::read(bench.path("plan.png")).expect("a plan");
    assert_eq!((&png[..8], &png[16..24]), (&b"\x89PNG\r\n\x1a\n"[..], &[0, 0, 0x07, 0xd0, 0, 0, 0x08, 0x50][..]));
    let result = draw(&bench.path("plan.pdf"), &[]);
    assert!(result.status.code() == Some(2) && text_of(&result).contains(".svg or .png"), "{}", text_of(&result));
}

#[test]
fn the_recordings_of_several_sites_and_their_centre_are_one_picture() {
    let bench = Bench::new();
    let config = Path::new(env!("CARGO_MANIFEST_DIR")).join("config/fusion.toml");
    let result = output(bench.command("run", &config).args(["--scans", "12", "--speed", "max"]));
    assert!(result.status.success(), "{}", text_of(&result));
    let recordings = bench.recordings();
    assert_eq!(recordings.len(), 4, "{recordings:?}");
    let viewed = Viewed::start(&recordings);
    let mut viewer = Live::open(viewed.address);
    let hello = viewer.next_of("hello");
    assert_eq!(hello["sites"].as_array().map(Vec::len), Some(4));
    let to_s = &hello["recording"]["to_s"];
    viewer.send(&json!({"want": {"system_tracks": true}, "encoding": "json", "seek": to_s}).to_string());
    viewer.find("system tracks", |message| {
        let items = message["items"].as_array().filter(|_| message["type"] == "system_tracks")?;
        (items.len() >= 5).then_some(())
    });
    // The centre alone, too: as a drawing and as ways for maps.
    let centre = recordings.iter().find(|file| file.to_string_lossy().contains("centre-")).expect("the centre's");
    let plan = bench.path("plan.svg");
    let drawn = output(radar_chain().arg("picture").arg(centre).arg("--out").arg(&plan));
    assert!(drawn.status.success(), "{}", text_of(&drawn));
    assert!(std::fs::read_to_string(&plan).expect("a plan").contains("class=\"confirmed\""));
    let exported = output(
        radar_chain().args(["recorder", "export", "--format", "geojson", "--out"]).arg(bench.path("ways")).arg(centre),
    );
    assert!(exported.status.success(), "{}", text_of(&exported));
}
