//! A stage of another version meets a running chain.

mod support;

use common::dwell::DwellHeader;
use common::ipc::Station;
use common::messages::{Dwells, Message};
use common::recording::{Recorded, RecordedRef};
use common::topic::Topic;
use support::{Bench, scan, small_config, text_of};

/// The dwells of a version that never was.
struct OldDwells;

impl Message for OldDwells {
    const TOPIC: Topic = Topic::Dwells;
    const SCHEMA: &'static str = "dwell/0";
    const MOST: usize = Dwells::MOST;
    const QUEUE: usize = Dwells::QUEUE;
    const SUBSCRIBERS: usize = Dwells::SUBSCRIBERS;
    const PUBLISHERS: usize = Dwells::PUBLISHERS;
    const HISTORY: usize = Dwells::HISTORY;
    type Header = DwellHeader;
    type Element = f32;
    const SOURCE: &'static str = Dwells::SOURCE;

    fn recorded(header: DwellHeader, cells: Vec<f32>) -> Recorded {
        Dwells::recorded(header, cells)
    }

    fn borrowed<'a>(header: &'a DwellHeader, cells: &'a [f32]) -> RecordedRef<'a> {
        Dwells::borrowed(header, cells)
    }
}

#[test]
fn a_stage_of_another_version_or_mode_is_refused_and_the_chain_goes_on() {
    let bench = Bench::new();
    let running = bench.start(&["--scans", "0", "--speed", "1"]);
    bench.wait_for("scans", |status| scan(status).filter(|&scan| scan >= 2));
    let chain = common::config::load(Some(&bench.root().join("chain.toml")), &[]).expect("its configuration");
    {
        let station = Station::enter("plot-extractor", &chain).expect("a place in the domain");
        let refused = station.subscriber::<OldDwells>().err().expect("another version").to_string();
        assert!(refused.contains("(dwell/0, lossless)") && refused.contains("the service there is"), "{refused}");
        assert!(refused.contains("dwell/1"), "both versions: {refused}");
        station.subscriber::<Dwells>().expect("the same version");
    }
    let other = bench.command("stage", &small_config()).arg("tracker").args(["--set", "run.mode=real-time"]).output();
    let other = other.expect("a stage");
    assert_eq!(other.status.code(), Some(3), "{}", text_of(&other));
    assert!(text_of(&other).contains("cannot open service `radar/small/"), "{}", text_of(&other));
    let seen = bench.wait_for("a scan", scan);
    bench.wait_for("more scans", |status| scan(status).filter(|&now| now >= seen + 2));
    let output = running.stop();
    assert_eq!(output.status.code(), Some(0), "{}", text_of(&output));
}
