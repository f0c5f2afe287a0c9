//! Chaos: random stages are killed at random times.

mod support;

use support::{Bench, output, small_config, text_of};

#[test]
fn books_balance_whatever_is_killed() {
    let bench = Bench::new();
    let mut command = bench.command("chaos", &small_config());
    // A scan of two seconds: what is checked is that stages come back, not how quick this machine is.
    command.args(["--kills", "8", "--seed", "5", "--speed", "0.125"]);
    let output = output(&mut command);
    assert_eq!(output.status.code(), Some(0), "{}", text_of(&output));
    let report = bench.report();
    let restarts: u64 = support::STAGES.iter().map(|stage| report.processes[*stage].restarts).sum();
    assert_eq!(restarts, 8, "{}", text_of(&output));
    assert!(report.lost() > 0, "kills cost something: {}", text_of(&output));
    assert!(bench.left_behind().is_empty(), "{:?}", bench.left_behind());
}
