//! The wall clock is stepped under a running chain: nothing but names and times in logs may notice.

mod support;

use std::process::Command;

use support::{Bench, output, scan, text_of};

/// CLOCK_REALTIME and what is read from it, moved by the seconds that stand in the file `$CLOCK_STEP`.
const SHIM: &str = r#"
#define _GNU_SOURCE
#include <stdio.h>
#include <stdlib.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

static long step(void) {
    const char *path = getenv("CLOCK_STEP");
    FILE *file = path ? fopen(path, "r") : NULL;
    long seconds = 0;
    if (file) {
        if (fscanf(file, "%ld", &seconds) != 1) seconds = 0;
        fclose(file);
    }
    return seconds;
}

int clock_gettime(clockid_t clock, struct timespec *now) {
    int result = syscall(SYS_clock_gettime, clock, now);
    if (result == 0 && clock == CLOCK_REALTIME) now->tv_sec += step();
    return result;
}
"#;

#[test]
fn a_step_of_the_wall_clock_changes_nothing() {
    let bench = Bench::new();
    let (source, shim, step) = (bench.path("shim.c"), bench.path("shim.so"), bench.path("step"));
    std::fs::write(&source, SHIM).expect("a file");
    let built = output(Command::new("cc").args(["-shared", "-fPIC", "-o"]).args([&shim, &source]));
    assert!(built.status.success(), "a C compiler is needed anyway: {}", text_of(&built));
    std::fs::write(&step, "0").expect("a file");

    // That the shim works at all.
    let year = |seconds: &str| {
        std::fs::write(&step, seconds).expect("a file");
        let said = output(Command::new("date").arg("+%Y").env("LD_PRELOAD", &shim).env("CLOCK_STEP", &step));
        String::from_utf8_lossy(&said.stdout).trim().parse::<u32>().expect("a year")
    };
    assert_eq!(year("0") + 10, year("315576000"));
    std::fs::write(&step, "0").expect("a file");

    let running = bench.start_with(&["--scans", "0", "--speed", "1"], |command| {
        command.env("LD_PRELOAD", &shim).env("CLOCK_STEP", &step)
    });
    for seconds in ["7200", "-86400", "0"] {
        let seen = bench.wait_for("a scan", scan);
        std::fs::write(&step, seconds).expect("a file");
        bench.wait_for("more scans", |status| scan(status).filter(|&now| now >= seen + 4));
    }
    let output = running.stop();
    assert_eq!(output.status.code(), Some(0), "{}", text_of(&output));
    let report = bench.report();
    assert!(report.lost() == 0 && report.comparable && report.wall_s < 1000.0, "{}", text_of(&output));
    assert!(report.processes.values().all(|used| used.silences == 0 && used.restarts == 0));
}
