//! An operator acts on a running chain through the display: the tracker obeys, and a replay of the recording repeats it.

#[path = "../display/tests/support/mod.rs"]
mod viewer;

mod support;

use std::collections::BTreeSet;
use std::net::SocketAddr;
use std::path::{Path, PathBuf};

use common::commands::{kind_name, outcome_name};
use common::recording::{Messages, Recorded, open, parts_from};
use common::topic::Topic;
use recorder::diff::first_difference;
use serde_json::{Value, json};
use support::{Bench, Running, number, output, signal, text_of};
use viewer::{Live, address_in, get, request};

const TRACKS: &str = "/api/v1/sites/small/tracks";
const ZONES: &str = "/api/v1/sites/small/zones";

/// The small radar with a display at any free port, through which viewers may act.
fn start(bench: &Bench, more: &[&str]) -> Running {
    let display = ["display.enabled=true", "display.listen='127.0.0.1:0'", "display.control=true"];
    let arguments: Vec<&str> = display.iter().flat_map(|set| ["--set", set]).collect();
    bench.start(&[&arguments[..], &["--scans", "0", "--speed", "2"], more].concat())
}

fn confirmed(address: SocketAddr) -> BTreeSet<u64> {
    let tracks = get(address, &format!("{TRACKS}?confirmed=true")).json();
    tracks.as_array().expect("a list").iter().filter_map(|track| track["id"].as_f64()).map(|id| id as u64).collect()
}

/// Waits until the confirmed tracks are as they should be.
fn wait_for_tracks(
    bench: &Bench,
    address: SocketAddr,
    what: &str,
    are: impl Fn(&BTreeSet<u64>) -> bool,
) -> BTreeSet<u64> {
    bench.wait_for(what, |_| Some(confirmed(address)).filter(|tracks| are(tracks)))
}

/// Waits until the tracker is `more` scans further.
fn pass_scans(bench: &Bench, more: u64) {
    let scan = |status: &Value| number(status, "tracker", "scan");
    let now = bench.wait_for("a scan", scan);
    bench.wait_for("more scans", |status| scan(status).filter(|&scan| scan >= now + more));
}

/// A zone around everything that the radar sees.
fn everywhere(kind: &str) -> Value {
    let edge = 100_000.0;
    json!({"name": "all", "kind": kind, "polygon_m": [[-edge, -edge], [edge, -edge], [edge, edge], [-edge, edge]]})
}

/// What was done, in order: kind and outcome.
fn actions(recording: &Path) -> Vec<(&'static str, &'static str)> {
    let messages = parts_from(recording).into_iter().flat_map(|part| open(&part).expect("a recording"));
    let actions = messages.filter_map(|message| match message.expect("a whole recording") {
        Recorded::Actions(_, actions) => Some(actions),
        _ => None,
    });
    actions.flatten().map(|action| (kind_name(action.kind), outcome_name(action.outcome))).collect()
}

fn compared(recording: &Path) -> Messages {
    const COMPARED: [Topic; 4] = [Topic::Plots, Topic::Tracks, Topic::Truth, Topic::Actions];
    let messages = parts_from(recording).into_iter().flat_map(|part| open(&part).expect("a recording"));
    Box::new(messages.filter(|message| message.as_ref().map_or(true, |of| COMPARED.contains(&of.by_ref().topic()))))
}

fn replay(bench: &Bench, recording: &Path, topics: &str) -> PathBuf {
    let folder = bench.path(&format!("again-{topics}"));
    let mut command = bench.bare("run");
    command.arg("--replay").arg(recording).args(["--speed", "max", "--report", "again.json", "--record"]).arg(&folder);
    command.args(["--set", "recorder.dwells=false", "--set", &format!("replay.topics=[\"{topics}\",\"truth\"]")]);
    let result = output(&mut command);
    assert!(result.status.success(), "{topics}: {}", text_of(&result));
    let entries = std::fs::read_dir(&folder).expect("a folder").map(|entry| entry.expect("an entry").path());
    entries.filter(|path| path.extension().is_some_and(|end| end == "mcap")).min().expect("a recording")
}

#[test]
fn what_an_operator_does_is_done_and_a_replay_repeats_it() {
    let bench = Bench::new();
    let running = start(&bench, &["--set", "recorder.dwells=true"]);
    let address = address_in(&bench.root());
    let both = wait_for_tracks(&bench, address, "two tracks", |tracks| tracks.len() == 2);
    let [kept, dropped] = [0, 1].map(|nth| both.iter().copied().nth(nth).expect("two tracks"));
    let act = |method: &str, path: &str, content: &Value| request(address, method, path, content).status;

    let mut viewer = Live::open(address);
    viewer.send(r#"{"want": {"events": true}}"#);
    assert_eq!(act("POST", &format!("{TRACKS}/{kept}/label"), &json!({"label": "blue one"})), 200);
    viewer.find("the label", |message| {
        let labels = &message["labels"];
        (message["type"] == "operator" && labels[kept.to_string()] == "blue one").then_some(())
    });
    viewer.find("the event", |message| {
        (message["kind"] == "command" && message["text"] == format!("operator: label track {kept} blue one: accepted"))
            .then_some(())
    });
    // A target whose track is dropped is seen again, unless no track may begin.
    assert_eq!(act("POST", ZONES, &everywhere("exclusion")), 200);
    assert_eq!(get(address, ZONES).json(), json!([everywhere("exclusion")]));
    assert_eq!(act("DELETE", &format!("{TRACKS}/{dropped}"), &Value::Null), 200);
    pass_scans(&bench, 12);
    assert_eq!(confirmed(address), BTreeSet::from([kept]));
    assert_eq!(act("DELETE", &format!("{TRACKS}/{dropped}"), &Value::Null), 404);
    assert_eq!(act("DELETE", &format!("{ZONES}/none"), &Value::Null), 404);
    assert_eq!(act("DELETE", &format!("{ZONES}/all"), &Value::Null), 200);
    assert_eq!(get(address, ZONES).json(), json!([]));
    wait_for_tracks(&bench, address, "a new track", |tracks| tracks.len() == 2 && !tracks.contains(&dropped));
    // Where nothing is, no track can begin.
    assert_eq!(act("POST", TRACKS, &json!({"x_m": 900.0, "y_m": 900.0, "radius_m": 1.0})), 200);
    viewer.find("the end of it", |message| {
        (message["kind"] == "command" && message["text"] == "operator: acquire a track: none could begin there")
            .then_some(())
    });
    drop(viewer);
    assert_eq!(act("POST", ZONES, &everywhere("acquisition")), 200);
    pass_scans(&bench, 4);
    let result = running.stop();
    assert!(result.status.success(), "{}", text_of(&result));

    let recording = bench.recordings().remove(0);
    let done = [
        ("label", "accepted"),
        ("exclusion", "accepted"),
        ("drop", "accepted"),
        ("drop", "no_such_track"),
        ("remove_zone", "no_such_zone"),
        ("remove_zone", "accepted"),
        ("acquire", "accepted"),
        ("acquire", "expired"),
        ("acquisition", "accepted"),
    ];
    assert_eq!(actions(&recording), done);
    // What was refused is not asked for again.
    let repeated: Vec<_> = done.into_iter().filter(|(_, outcome)| !outcome.starts_with("no_such")).collect();
    for topics in ["dwells", "plots"] {
        let again = replay(&bench, &recording, topics);
        assert_eq!(actions(&again), repeated, "{topics}");
        let without =
            |recording: &Path| compared(recording).filter(|message| !matches!(message, Ok(Recorded::Actions(..))));
        assert_eq!(first_difference(without(&recording), without(&again)).expect("whole"), None, "{topics}");
    }
    // Without a tracker they are shown as they were.
    assert_eq!(actions(&replay(&bench, &recording, "tracks")), done);
    let tracks = bench.path("tracks.jsonl");
    let mut batch = std::process::Command::new(beside("tracker"));
    batch.args(["replay", "--config"]).arg(support::small_config()).arg("--plots").arg(&recording);
    let result = output(batch.arg("--tracks").arg(&tracks));
    assert!(result.status.success(), "{}", text_of(&result));
    assert_eq!(ids(&tracks), ids(&recording), "in one process");
}

/// A program of another package, built beside this test.
fn beside(name: &str) -> PathBuf {
    Path::new(env!("CARGO_BIN_EXE_radar-chain")).with_file_name(name)
}

/// The tracks of each message.
fn ids(recording: &Path) -> Vec<Vec<(u64, u32)>> {
    let messages = parts_from(recording).into_iter().flat_map(|part| open(&part).expect("a recording"));
    let tracks = messages.filter_map(|message| match message.expect("a whole recording") {
        Recorded::Tracks(_, tracks) => Some(tracks),
        _ => None,
    });
    tracks.map(|tracks| tracks.iter().map(|track| (track.id, track.state_code)).collect()).collect()
}

#[test]
fn a_tracker_that_is_started_again_keeps_the_zones_and_a_recorder_records_them_once() {
    let bench = Bench::new();
    let running = start(&bench, &[]);
    let address = address_in(&bench.root());
    wait_for_tracks(&bench, address, "two tracks", |tracks| tracks.len() == 2);
    assert_eq!(request(address, "POST", ZONES, &everywhere("exclusion")).status, 200);
    let killed = bench.wait_for("a tracker", |status| number(status, "tracker", "pid"));
    signal(killed as u32, "KILL");
    bench.wait_for("another one", |status| number(status, "tracker", "pid").filter(|&pid| pid != killed));
    pass_scans(&bench, 4);
    let recorder = bench.wait_for("a recorder", |status| number(status, "recorder", "pid"));
    signal(recorder as u32, "KILL");
    bench.wait_for("another recorder", |status| number(status, "recorder", "pid").filter(|&pid| pid != recorder));
    pass_scans(&bench, 8);
    // The tracks from before the zone live on; no other begins, also when they are dropped.
    for track in confirmed(address) {
        assert!(track < 1_000_000, "{track}: {}", get(address, "/api/v1/events").body);
        assert_eq!(
            request(address, "DELETE", &format!("/api/v1/sites/small/tracks/{track}"), &Value::Null).status,
            200
        );
    }
    pass_scans(&bench, 8);
    assert_eq!(confirmed(address), BTreeSet::new(), "{}", get(address, "/api/v1/events").body);
    assert_eq!(request(address, "DELETE", &format!("{ZONES}/all"), &Value::Null).status, 200);
    wait_for_tracks(&bench, address, "two tracks", |tracks| tracks.len() == 2);
    running.stop();
    let zones: Vec<_> = actions(&bench.recordings().remove(0)).into_iter().map(|(kind, _)| kind).collect();
    assert_eq!(zones, ["exclusion", "exclusion", "drop", "drop", "remove_zone"]);
}

#[test]
fn what_makes_no_sense_is_refused_and_nobody_acts_where_that_is_not_allowed() {
    let bench = Bench::new();
    let running = start(&bench, &[]);
    let address = address_in(&bench.root());
    let refused = |method: &str, path: &str, content: &Value, status: u16, words: &str| {
        let answer = request(address, method, path, content);
        let error = answer.json()["error"].as_str().unwrap_or_default().to_string();
        assert!(
            answer.status == status && error.contains(words),
            "{method} {path} {content}: {} {error}",
            answer.status
        );
    };
    let corners = |count: u32| -> Vec<[f64; 2]> { (0..count).map(|i| [f64::from(i), f64::from(i * i)]).collect() };
    let zone = |name: &str, count: u32| json!({"name": name, "kind": "exclusion", "polygon_m": corners(count)});
    refused("POST", ZONES, &zone("a", 2), 400, "2 corners found, expected 3 to 16");
    refused("POST", ZONES, &zone("a", 17), 400, "17 corners found, expected 3 to 16");
    refused("POST", ZONES, &zone("", 3), 400, "name `` found");
    refused("POST", ZONES, &zone("..", 3), 400, "name `..` found");
    refused("DELETE", &format!("{ZONES}/{}", "n".repeat(33)), &Value::Null, 400, "33 bytes");
    refused("POST", ZONES, &zone(&"n".repeat(33), 3), 400, "33 bytes");
    refused("POST", ZONES, &json!({"name": "a", "kind": "mined", "polygon_m": corners(3)}), 400, "mined");
    refused("POST", TRACKS, &json!({"x_m": 1.0}), 400, "y_m");
    refused("POST", TRACKS, &json!({"x_m": 1.0, "y_m": 1.0, "radius_m": -1.0}), 400, "radius_m");
    refused("POST", &format!("{TRACKS}/seven/label"), &json!({"label": "a"}), 400, "expected a number");
    refused("POST", &format!("{TRACKS}/999999/label"), &json!({"label": "a"}), 404, "no track 999999");
    refused("POST", "/api/v1/sites/none/tracks", &json!({"x_m": 1.0, "y_m": 1.0}), 404, "none");
    refused("PUT", ZONES, &zone("a", 3), 405, "PUT");
    refused("POST", ZONES, &json!({"name": "x".repeat(20_000)}), 400, "at most 16384 bytes");
    running.stop();

    let bench = Bench::new();
    let running = start(&bench, &["--set", "display.control=false"]);
    let address = address_in(&bench.root());
    let answer = request(address, "POST", ZONES, &everywhere("exclusion"));
    assert!(answer.status == 403 && answer.body.contains("display.control = true"), "{}", answer.body);
    running.stop();
}
