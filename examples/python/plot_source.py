"""Puts plots of a program of your own into the chain: two targets on circles, seen by a 2-D radar.

    pip install iceoryx2==0.10.0
    cargo run --release -- run --config examples/plot_source.toml     # a chain without a source, in one terminal
    python3 examples/python/plot_source.py                            # its source, in another

The contract of a plot source is in `examples/plot_source.rs`; this is the same in Python.
"""

import argparse
import math
import time

from messages import TOPICS, Plot, PlotsHeader
from radar_chain import Chain

END_OF_SCAN, END_OF_STREAM = 1, 4
SOURCE_ID = 1 << 8 | 2  # SAC and SIC, as in the configuration

parser = argparse.ArgumentParser(description="Publish plots of two targets on circles")
parser.add_argument("--site", default="mine", help="name of the site")
parser.add_argument("--prefix", default="radar", help="ipc.prefix of the chain")
parser.add_argument("--root", default="/tmp", help="ipc.root of the chain")
parser.add_argument("--scans", type=int, default=30)
parser.add_argument("--sectors", type=int, default=16, help="sectors per scan")
parser.add_argument("--period", type=float, default=1.0, help="scan period, s")
parser.add_argument("--speed", type=float, default=4.0, help="times real time; 0 for as fast as the chain goes")
args = parser.parse_args()

chain = Chain("python-radar", args.site, args.prefix, args.root)
plots = chain.publisher("plots", TOPICS["plots"].most, ["tracker", "recorder"])
session = time.time_ns()
began = time.monotonic()
for seq in range(args.scans * args.sectors):
    scan, sector = divmod(seq, args.sectors)
    start_s = scan * args.period
    turned = sector / args.sectors, (sector + 1) / args.sectors
    at = lambda turn: 1_700_000_000_000_000_000 + int((start_s + turn * args.period) * 1e9)
    elements = []
    for radius, speed in [(2000.0, 25.0), (3500.0, -40.0)]:
        azimuth = (0.5 + start_s * speed / radius) % math.tau
        if turned[0] <= azimuth / math.tau < turned[1]:
            plot = Plot(time_ns=at(azimuth / math.tau), range_m=radius, azimuth_rad=azimuth, cell_count=1)
            plot.sigma_range_m, plot.sigma_azimuth_rad = 3.0, math.radians(0.1)
            plot.source_id = SOURCE_ID
            elements.append(plot)
    header = PlotsHeader(
        seq=seq,
        session=session,
        time_ns=at(turned[1]),
        covered_from_rad=math.tau * turned[0],
        covered_to_rad=math.tau * turned[1],
        scan_period_s=args.period,
        cell_range_m=12.0,
        cell_azimuth_rad=math.radians(0.4),
        scan=scan,
        sector=sector,
        sectors_per_scan=args.sectors,
        source_id=SOURCE_ID,
    )
    header.lineage.published_before = seq
    header.flags = (END_OF_SCAN if sector + 1 == args.sectors else 0) | (
        END_OF_STREAM if seq + 1 == args.scans * args.sectors else 0
    )
    if args.speed > 0:
        time.sleep(max(0.0, began + (start_s + turned[1] * args.period) / args.speed - time.monotonic()))
    header.stamps.source_out_ns = header.stamps.plots_out_ns = time.clock_gettime_ns(time.CLOCK_MONOTONIC)
    plots.publish(header, elements)
time.sleep(1.0)  # its last messages are read from its memory
