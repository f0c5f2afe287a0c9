#!/usr/bin/env python3
"""Measures what the display of a running chain costs: processor time without and with a client, and its memory over time.

    python3 -m venv venv && venv/bin/pip install websockets==15.0.1
    cargo build --release
    venv/bin/python tests/judges/display_cost.py target/release/radar-chain --hours 1

Starts an endless chain (default configuration, 1×, no recording) under a prefix of its own, measures the display alone for a
minute, then with one client that wants everything, and ends the chain. Memory is flat when the line through the samples after the first
ten minutes (a sixth, in shorter runs) rises by no more than `--most-growth-mib` from one end to the other. Prints one line of JSON; exit code 1 on a failure.
"""

import argparse
import json
import os
import signal
import subprocess
import sys
import threading
import time
import urllib.request
from pathlib import Path

from websockets.sync.client import connect

WANT = {
    "video": {"lines": 1024, "ranges": 512},
    "plots": True,
    "tracks": True,
    "truth": True,
    "maps": True,
    "health": True,
    "events": True,
}
TICKS_PER_S = os.sysconf("SC_CLK_TCK")


def processor_s(pid):
    """User and system time of a process."""
    fields = Path(f"/proc/{pid}/stat").read_text().rsplit(") ", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / TICKS_PER_S


def resident_mib(pid):
    """Resident memory in all, and of it what is no shared memory of the chain."""
    lines = dict(line.split(":", 1) for line in Path(f"/proc/{pid}/status").read_text().splitlines())
    whole, shared = (int(lines[key].split()[0]) / 1024 for key in ("VmRSS", "RssShmem"))
    return whole, whole - shared


def share_percent(pid, seconds):
    """Of one core."""
    before, began = processor_s(pid), time.monotonic()
    time.sleep(seconds)
    return 100 * (processor_s(pid) - before) / (time.monotonic() - began)


def watch(url, client, stop):
    """Takes everything, as fast as it comes, and counts it."""
    with connect(url, max_size=None) as socket:
        socket.send(json.dumps({"want": WANT}))
        while not stop.is_set():
            message = socket.recv(timeout=30)
            client["messages"] += 1
            client["bytes"] += len(message)
            if isinstance(message, str) and '"dropped"' in message[:40]:
                client["dropped"] = json.loads(message)


def line_through(samples):
    """Slope of the least-squares line."""
    n = len(samples)
    mean_t, mean_y = sum(t for t, _ in samples) / n, sum(y for _, y in samples) / n
    spread = sum((t - mean_t) ** 2 for t, _ in samples)
    return sum((t - mean_t) * (y - mean_y) for t, y in samples) / spread


def display_of(address, deadline_s=60):
    """Process number of the display, as it says itself."""
    end = time.monotonic() + deadline_s
    while time.monotonic() < end:
        try:
            with urllib.request.urlopen(f"{address}/api/v1/status", timeout=5) as answer:
                return json.load(answer)["display"]["pid"]
        except (OSError, KeyError):
            pass
        time.sleep(0.5)
    sys.exit(f"no display at {address} within {deadline_s} s")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=Path, help="radar-chain")
    parser.add_argument("--hours", type=float, default=1, help="how long with the client (1)")
    parser.add_argument("--port", type=int, default=8093)
    parser.add_argument("--prefix", default="displaycost", help="of the chain's shared memory (displaycost)")
    parser.add_argument("--most-growth-mib", type=float, default=1, help="what still counts as flat (1)")
    parser.add_argument("--samples", type=Path, help="CSV of all samples")
    options = parser.parse_args()
    command = [options.program, "run", "--scans", "0", "--no-record", "--ipc-prefix", options.prefix]
    command += ["--set", f"display.listen=127.0.0.1:{options.port}"]
    with subprocess.Popen(command, stdout=subprocess.DEVNULL) as chain:
        try:
            figures = measure(options)
        finally:
            chain.send_signal(signal.SIGINT)
    failures = []
    if figures["share_percent_alone"] > 15 or figures["share_percent_client"] > 40:
        failures.append("processor share: at most 15 % alone, 40 % with a client")
    if abs(figures["growth_mib"]) > options.most_growth_mib:
        failures.append(f"memory: at most {options.most_growth_mib} MiB from end to end")
    print(json.dumps({"ok": not failures, **figures, "failures": failures}))
    return 1 if failures else 0


def measure(options):
    pid = display_of(f"http://127.0.0.1:{options.port}")
    time.sleep(15)
    alone = share_percent(pid, 60)
    client, stop = {"messages": 0, "bytes": 0, "dropped": None}, threading.Event()
    watcher = threading.Thread(target=watch, args=(f"ws://127.0.0.1:{options.port}/api/v1/live", client, stop), daemon=True)
    watcher.start()
    began, before, samples = time.monotonic(), processor_s(pid), []
    while time.monotonic() - began < 3600 * options.hours:
        samples.append((time.monotonic() - began, *resident_mib(pid)))
        time.sleep(min(10, 360 * options.hours))
    share = 100 * (processor_s(pid) - before) / (time.monotonic() - began)
    if not watcher.is_alive():
        sys.exit("the client lost its connection")
    stop.set()
    if options.samples:
        options.samples.write_text("s,resident_mib,own_mib\n" + "".join("{:.0f},{:.2f},{:.2f}\n".format(*sample) for sample in samples))
    settled = [sample for sample in samples if sample[0] >= 600 * min(options.hours, 1)]
    length = settled[-1][0] - settled[0][0]
    whole, own = ([(t, values[i]) for t, *values in settled] for i in (0, 1))
    return {
        "share_percent_alone": round(alone, 2),
        "share_percent_client": round(share, 2),
        "samples": len(settled),
        "resident_mib": [round(pick(y for _, y in whole), 2) for pick in (min, max)],
        "own_mib": [round(pick(y for _, y in own), 2) for pick in (min, max)],
        "growth_mib": round(line_through(own) * length, 3),
        "growth_resident_mib": round(line_through(whole) * length, 3),
        "client": client,
    }


if __name__ == "__main__":
    sys.exit(main())
