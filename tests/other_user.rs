//! Somebody else looks at a running chain.

mod support;

use std::os::unix::fs::PermissionsExt;

use support::{Bench, output, scan, small_config, text_of};

#[test]
fn another_user_is_refused_and_the_chain_is_not_disturbed() {
    if !rustix::process::geteuid().is_root() {
        assert!(std::env::var_os("CI").is_none(), "checks before landing need root");
        eprintln!("only root can become another user: not tested");
        return;
    }
    let bench = Bench::new();
    let running = bench.start(&["--scans", "0", "--speed", "1"]);
    bench.wait_for("scans", |status| scan(status).filter(|&scan| scan >= 2));
    // The other user may look into the folders and run the program.
    let open = |path: &std::path::Path| {
        std::fs::set_permissions(path, std::fs::Permissions::from_mode(0o755)).expect("our own folder");
    };
    open(&bench.path(""));
    open(&bench.root());
    let program = bench.path("radar-chain");
    std::fs::copy(env!("CARGO_BIN_EXE_radar-chain"), &program).expect("a copy");
    let config = bench.path("small.toml");
    std::fs::copy(small_config(), &config).expect("a copy");
    let asked = bench.command("status", &config);
    let mut visitor = std::process::Command::new("setpriv");
    visitor.args(["--reuid=65534", "--regid=65534", "--clear-groups"]).arg(&program).args(asked.get_args());
    let visited = output(&mut visitor);
    assert_eq!(visited.status.code(), Some(2), "{}", text_of(&visited));
    assert!(text_of(&visited).contains("belongs to user 0"), "{}", text_of(&visited));
    let seen = bench.wait_for("a scan", scan);
    bench.wait_for("more scans", |status| scan(status).filter(|&now| now >= seen + 3));
    let output = running.stop();
    assert_eq!(output.status.code(), Some(0), "{}", text_of(&output));
    assert!(bench.report().processes.values().all(|used| used.slow_steps == 0), "{}", text_of(&output));
}
