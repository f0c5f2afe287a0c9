#!/usr/bin/env python3
"""Compares the latency of a chain with and without a display, in pairs of runs that take turns.

    cargo build --release
    python3 tests/judges/display_pairs.py target/release/radar-chain --pairs 10

Each pair is a run of the default chain at 1× with a display and one without, the second pair the other way round, and so on: what
else the machine does meets both. The ratio of p99 of `end_to_end` of each pair gives a geometric mean and its 95 % interval (Student's
t over the logarithms). `--client` has somebody look meanwhile, who wants everything (needs the package websockets). Prints one line of
JSON; exit code 1 if the interval lies above the limit, 2 if it holds the limit: then more pairs are needed, or a quieter machine.
"""

import argparse
import json
import math
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

# Quantiles 0.975 of Student's t by degrees of freedom; beyond the last, of the normal distribution and a little more.
STUDENT = [12.71, 4.30, 3.18, 2.78, 2.57, 2.45, 2.36, 2.31, 2.26, 2.23, 2.20, 2.18, 2.16, 2.14, 2.13, 2.12, 2.11, 2.10, 2.09]


def look(port, ended):
    """A client that takes everything until the run ends."""
    from display_cost import WANT
    from websockets.exceptions import ConnectionClosed
    from websockets.sync.client import connect

    while not ended.is_set():
        try:
            with connect(f"ws://127.0.0.1:{port}/api/v1/live", max_size=None) as socket:
                socket.send(json.dumps({"want": WANT}))
                for _ in socket:
                    pass
        except (OSError, ConnectionClosed):
            time.sleep(0.1)


def latencies(options, with_display):
    """p50 and p99 of `end_to_end` of one run, µs."""
    with tempfile.TemporaryDirectory() as folder:
        report = Path(folder) / "report.json"
        command = [options.program, "run", "--scans", str(options.scans), "--speed", "1", "--no-record", "--report", report]
        command += ["--ipc-prefix", options.prefix, "--set", f"display.listen=127.0.0.1:{options.port}"]
        command += [] if with_display else ["--no-display"]
        ended = threading.Event()
        if with_display and options.client:
            threading.Thread(target=look, args=(options.port, ended), daemon=True).start()
        try:
            run = subprocess.run(command, capture_output=True, text=True)
        finally:
            ended.set()
        if run.returncode:
            sys.exit(f"{options.program} ended with {run.returncode}:\n{run.stderr}")
        of = json.loads(report.read_text())["latency_us"]["end_to_end"]
        return of["p50"], of["p99"]


def interval(ratios):
    """Geometric mean and its 95 % interval."""
    logs = [math.log(ratio) for ratio in ratios]
    mean, freedom = statistics.fmean(logs), len(logs) - 1
    t = STUDENT[freedom - 1] if freedom <= len(STUDENT) else 2.05
    half = t * statistics.stdev(logs) / math.sqrt(len(logs))
    return [round(math.exp(value), 3) for value in (mean, mean - half, mean + half)]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=Path, help="radar-chain")
    parser.add_argument("--pairs", type=int, default=10)
    parser.add_argument("--scans", type=int, default=60)
    parser.add_argument("--client", action="store_true", help="somebody looks")
    parser.add_argument("--limit", type=float, default=1.1, help="ratio of p99 that is allowed (1.1)")
    parser.add_argument("--port", type=int, default=8094)
    parser.add_argument("--prefix", default="displaypairs", help="of the chain's shared memory (displaypairs)")
    options = parser.parse_args()
    if options.pairs < 2:
        parser.error("--pairs: expected at least 2")
    pairs = []
    for number in range(options.pairs):
        order = (True, False) if number % 2 == 0 else (False, True)
        of = {with_display: latencies(options, with_display) for with_display in order}
        pairs.append((of[True], of[False]))
        print(f"pair {number + 1}: p99 {of[True][1]:.0f} µs with, {of[False][1]:.0f} µs without", file=sys.stderr)
    p50, p99 = (interval([with_[of] / without[of] for with_, without in pairs]) for of in (0, 1))
    verdict = "met" if p99[2] <= options.limit else "not met" if p99[1] > options.limit else "not decided"
    medians = [round(statistics.median(pair[side][1] for pair in pairs)) for side in (0, 1)]
    print(json.dumps({"verdict": verdict, "p99_ratio": p99, "p50_ratio": p50, "median_p99_us": medians, "pairs": len(pairs)}))
    return {"met": 0, "not met": 1, "not decided": 2}[verdict]


if __name__ == "__main__":
    sys.exit(main())
