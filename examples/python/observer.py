"""Prints the confirmed tracks of a running chain.

    pip install iceoryx2==0.10.0
    cargo run --release -- run --scans 0          # a chain, in one terminal
    python3 examples/python/observer.py uav       # its site, in another
"""

import argparse
import math

from radar_chain import Chain

CONFIRMED, COASTING = 1, 2

parser = argparse.ArgumentParser(description="Print the confirmed tracks of a running chain")
parser.add_argument("site", help="name of the site")
parser.add_argument("--prefix", default="radar", help="ipc.prefix of the chain")
parser.add_argument("--root", default="/tmp", help="ipc.root of the chain")
parser.add_argument("--seconds", type=float, default=5.0, help="end when nothing has come for so long")
args = parser.parse_args()

tracks = Chain("python-observer", args.site, args.prefix, args.root).subscriber("tracks")
for header, elements in tracks.messages(args.seconds):
    for track in elements:
        if track.state_code in (CONFIRMED, COASTING):
            # East, north, up and their rates; the third of each three is the acceleration.
            east, vx, _, north, vy, _, up, _, _ = track.state
            course = math.degrees(math.atan2(vx, vy)) % 360.0
            speed = math.hypot(vx, vy)
            print(f"{header.scan:6} {track.id:4} {east:9.1f} {north:9.1f} {up:7.1f} m {course:4.0f}° {speed:5.1f} m/s")
if tracks.missed:
    print(f"missed {tracks.missed} messages")
