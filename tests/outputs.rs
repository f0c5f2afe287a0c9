//! Outputs of whole chains: read by foreign programs, and to peers that are slow, away or gone. The foreign programs are packages
//! of PyPI; without them their test says that it is left out, except where `CI` is set.

mod support;

use std::io::{BufRead, BufReader, Read, Write};
use std::net::{TcpListener, TcpStream, UdpSocket};
use std::path::Path;
use std::process::{Command, Stdio};

use serde_json::Value;
use support::{Bench, text_of};

const POSITION: &str = "site.position={ latitude_deg = 50.45, longitude_deg = 30.52, height_m = 120.0 }";

fn are_left_out() -> bool {
    let packages = "import asterix.generated, pynmea2, takproto, sapient_msg_pydantic";
    let present = Command::new("python3").args(["-c", packages]).output().is_ok_and(|output| output.status.success());
    assert!(present || std::env::var_os("CI").is_none(), "python3 cannot `{packages}`");
    if !present {
        eprintln!("left out: python3 cannot `{packages}` (pip install: see tests/judges/outputs.py)");
    }
    !present
}

#[test]
fn foreign_programs_read_every_output_and_find_the_same_tracks() {
    if are_left_out() {
        return;
    }
    let bench = Bench::new();
    let mut judge = Command::new("python3")
        .arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/judges/outputs.py"))
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("python3");
    let mut said = BufReader::new(judge.stdout.take().expect("its output"));
    let mut ports = String::new();
    said.read_line(&mut ports).expect("ports");
    let ports: Value = serde_json::from_str(&ports).expect("JSON");
    let to = |name: &str, scheme: &str| format!("outputs.{name}.to={scheme}://127.0.0.1:{}", ports[name]);
    let keys = [
        POSITION.to_string(),
        to("json", "udp"),
        to("asterix", "udp"),
        to("plots", "udp"),
        "outputs.plots.format=asterix".into(),
        "outputs.plots.send=plots".into(),
        to("cot", "udp"),
        "outputs.cot.class=drone".into(),
        to("nmea", "udp"),
        to("sapient", "tcp"),
    ];
    let arguments: Vec<&str> = keys.iter().flat_map(|key| ["--set", key]).collect();
    let ended = bench.run(&[&["--scans", "60", "--speed", "4", "--no-record"], &arguments[..]].concat());
    assert!(ended.status.success(), "{}", text_of(&ended));
    drop(judge.stdin.take());
    let mut verdict = String::new();
    said.read_to_string(&mut verdict).expect("a verdict");
    eprintln!("{verdict}");
    assert!(judge.wait().expect("the judge").success(), "{verdict}");
    let report = bench.report();
    assert_eq!((report.lost(), report.processes["outputs"].restarts), (0, 0));
}

#[test]
fn a_peer_that_is_away_and_one_that_stalls_leave_the_chain_alone() {
    let bench = Bench::new();
    let away = TcpListener::bind("127.0.0.1:0").and_then(|listener| listener.local_addr()).expect("a free port");
    let stalls = TcpListener::bind("127.0.0.1:0").expect("a port");
    let stalled = stalls.local_addr().expect("an address");
    let held = std::thread::spawn(move || stalls.accept().expect("a connection").0);
    let keys = [
        format!("outputs.json.to=tcp://{away}"),
        format!("outputs.nmea.to=tcp://{stalled}"),
        "outputs.nmea.queue_bytes=65536".into(),
        POSITION.into(),
    ];
    let arguments: Vec<&str> = keys.iter().flat_map(|key| ["--set", key]).collect();
    let ended = bench.run(&[&["--scans", "40", "--speed", "8"], &arguments[..]].concat());
    assert!(ended.status.success(), "{}", text_of(&ended));
    drop(held.join().expect("the peer"));
    let report = bench.report();
    assert_eq!(report.lost(), 0);
    let text = text_of(&ended);
    assert!(text.contains(&format!("output `json`: tcp://{away}: Connection refused")), "{text}");
    let observers = serde_json::to_value(&report.observers).expect("JSON");
    assert!(observers["tracks"]["json"].as_u64().is_some_and(|lost| lost > 0), "{observers}");
}

#[test]
fn whoever_connects_hears_the_tracks() {
    let bench = Bench::new();
    let at = TcpListener::bind("127.0.0.1:0").and_then(|listener| listener.local_addr()).expect("a free port");
    let to = format!("outputs.json.to=tcp-listen://{at}");
    let running = bench.start(&["--scans", "0", "--speed", "8", "--set", &to]);
    bench.wait_for("tracks", |status| support::number(status, "tracker", "confirmed").filter(|&tracks| tracks == 2));
    let stream = TcpStream::connect(at).expect("a connection");
    let lines = BufReader::new(stream).lines().take(20);
    for line in lines {
        let line: Value = serde_json::from_str(&line.expect("a line")).expect("JSON");
        assert!(line["site"] == "small" && line["east_m"].is_f64() && line.get("latitude_deg").is_none(), "{line}");
    }
    let ended = running.stop();
    assert!(ended.status.success(), "{}", text_of(&ended));
}

#[test]
fn what_cannot_be_used_is_one_line() {
    let bench = Bench::new();
    let taken = TcpListener::bind("127.0.0.1:0").expect("a port");
    let busy = taken.local_addr().expect("an address");
    for (keys, expected) in [
        (vec![format!("outputs.json.to=tcp-listen://{busy}")], "Address already in use".to_string()),
        (vec!["outputs.json.to=here".into()], "expected udp://ADDRESS:PORT".into()),
        (vec!["outputs.cot.to=udp://127.0.0.1:9".into()], "expected a position: output `cot`".into()),
        (
            vec![POSITION.into(), "outputs.sapient.to=tcp://127.0.0.1:9".into(), "outputs.sapient.node_id=x".into()],
            "key `outputs.sapient.node_id` is x, expected a UUID".into(),
        ),
    ] {
        let arguments: Vec<&str> = keys.iter().flat_map(|key| ["--set", key]).collect();
        let ended = bench.run(&[&["--scans", "1", "--no-record"], &arguments[..]].concat());
        let lines = String::from_utf8_lossy(&ended.stderr).lines().filter(|line| line.contains(&expected)).count();
        assert_eq!(lines, 1, "{}", text_of(&ended));
    }
}

/// Plots that have gone out as ASTERIX and come back as those of a radar give the tracks of the direct path.
#[test]
fn plots_that_go_out_come_back_as_those_of_a_radar() {
    let (sender, receiver) = (Bench::new(), Bench::new());
    let port = UdpSocket::bind("127.0.0.1:0").and_then(|socket| socket.local_addr()).expect("a free port").port();
    let config = receiver.path("listen.toml");
    let text = format!(
        "[site]\nname = \"radar\"\nsac = 0\nsic = 1\n[run]\nsource = \"plot-source\"\nmode = \"real-time\"\nscans = 20\n\
         [plot_source]\nlisten = [\"udp://239.255.86.70:{port}?interface=lo\"]\nscan_period_s = 0.5\nuse_simulated = true\n\
         sigma_range_m = 20.0\n"
    );
    std::fs::File::create(&config).and_then(|mut file| file.write_all(text.as_bytes())).expect("a configuration");
    let listening = receiver.start_config(&config, &["--no-record"]);
    let to = format!("outputs.asterix.to=udp://239.255.86.70:{port}");
    let set = ["--set", &to, "--set", "outputs.asterix.send=plots", "--set", "outputs.asterix.shift_time=true"];
    let running = sender.start(&[&["--scans", "0", "--speed", "1", "--no-record"], &set[..]].concat());
    let heard = listening.end();
    assert!(heard.status.success(), "{}", text_of(&heard));
    let sent = running.stop();
    assert!(sent.status.success(), "{}", text_of(&sent));
    let tracking = serde_json::to_value(&receiver.report().tracking).expect("JSON");
    assert_eq!(tracking["tracks"]["alive"].as_u64(), Some(2), "{tracking}");
}
