#!/usr/bin/env python3
"""Compares `radar-chain asterix dump` with independent decoders of ASTERIX, value by value.

    python3 -m venv venv && venv/bin/pip install libasterix==0.36.3 pyasteryx==0.3.0 aviconv-asterix==0.4.0
    cargo build --release && cargo build --release -p asterix --examples
    venv/bin/python tests/judges/asterix_records.py target/release/radar-chain RECORDING…
    venv/bin/python tests/judges/asterix_records.py target/release/radar-chain --random 10000
    venv/bin/python tests/judges/asterix_records.py target/release/radar-chain --speed 20000
    venv/bin/python tests/judges/asterix_records.py - --golden 12 FILE > FILE.csv     (tables for asterix/tests/golden.rs)

libasterix knows all categories: every element is compared, its bits and its value. pyasteryx (048, 062) is compared by the
numbers of each item, aviconv-asterix (010, 034, 048, 062) by the octets of each item and of the record.
Exit code 1 if any differ.
"""

import argparse
import json
import math
import struct
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

import aviconv_asterix
import pyasteryx

from libasterix_records import blocks, elements, parse

RELATIVE = 1e-12
# What pyasteryx takes for signed, or for unsigned, other than the specification and the other decoders.
OTHER_SIGN = {("I062/340", "HEIGHT"), ("I062/380", "TCPN")}


def payloads(data):
    """UDP payloads of a pcapng capture of an Ethernet, or the file itself."""
    if data[:4] != b"\x0a\x0d\x0d\x0a":
        yield data
        return
    at = 0
    while at < len(data):
        kind, length = struct.unpack_from("<II", data, at)
        if kind == 6:
            (captured,) = struct.unpack_from("<I", data, at + 20)
            packet = data[at + 28 : at + 28 + captured]
            header = (packet[14] & 15) * 4
            if packet[12:14] == b"\x08\x00" and packet[23] == 17:
                udp = packet[14 + header :]
                yield udp[8 : int.from_bytes(udp[4:6], "big")]
        at += length


def our_elements(node, path=()):
    """The same of the dump."""
    if isinstance(node, list):
        for index, one in enumerate(node):
            yield from our_elements(one, path + (index,))
    elif "raw" in node and not isinstance(node["raw"], dict):
        yield path, node["raw"], node.get("value")
    elif "hex" in node and not isinstance(node["hex"], dict):
        yield path, node["hex"], None
    else:
        for name, part in node.items():
            if name not in ("spare", "beyond"):
                yield from our_elements(part, path + (name,))


def equal(ours, theirs):
    if ours is None or theirs is None or isinstance(ours, str):
        return ours == theirs
    return math.isclose(ours, theirs, rel_tol=RELATIVE, abs_tol=1e-300)


class Judge:
    def __init__(self):
        self.compared = Counter()
        self.differences = []
        self.refused = Counter()

    def ask(self, name, decode, block, count):
        """The records of another decoder, which may know less than the specification: it must find as many."""
        try:
            records = list(decode(block))
        except Exception as error:
            self.refused[f"{name}, category {block[0]:03}: {type(error).__name__}"] += 1
            return []
        if len(records) != count:
            self.refused[f"{name}, category {block[0]:03}: another number of records"] += 1
            return []
        return records

    def differ(self, text):
        self.differences.append(text)

    def libasterix(self, ours, category, edition, record, where):
        theirs = {}
        groups = [("items", record.items_regular.items())]
        for sequence in record.items_rfs:
            groups.append(("RFS", sequence or []))
        for group, items in groups:
            for name, item in items:
                for path, raw, value in elements(item):
                    prefix = (name,) if group == "items" else ("RFS", name)
                    theirs[prefix + path] = (raw, value)
        mine = {path: (raw, value) for path, raw, value in our_elements(ours["items"])}
        for path in mine.keys() | theirs.keys():
            left, right = mine.get(path), theirs.get(path)
            if left is None or right is None:
                self.differ(f"{where}: {path}: ours {left}, libasterix {right}")
                continue
            raw = left[0]
            if isinstance(raw, str) and isinstance(right[0], int):  # an element of more than 64 bits
                raw = int(raw, 16)
            elif isinstance(raw, str):  # an explicit item: libasterix leaves out the length
                raw = raw[2:]
            values = left[1] is not None and right[1] is not None
            if raw != right[0] or (values and not equal(left[1], right[1])):
                self.differ(f"{where}: {path}: ours {left}, libasterix {right}")
            self.compared["libasterix, bits"] += 1
            self.compared["libasterix, values"] += values

    def pyasteryx(self, ours, message, where):
        """Names differ, so the numbers of each item are compared in their order, as bits or as values."""
        for name, item in message.items.items():
            mine = list(our_elements(ours["items"].get(name[5:], {})))
            theirs = [value for value in flatten(item)]
            if len(mine) != len(theirs):
                self.compared["pyasteryx, items that it shows in another form"] += 1
                continue
            for (path, raw, value), other in zip(mine, theirs):
                if isinstance(other, (int, float)) and not isinstance(raw, str):
                    if (name, path[-1] if path else "") in OTHER_SIGN:
                        self.compared["pyasteryx, elements whose sign it takes differently"] += 1
                        continue
                    # It shows speeds in knots and some flight levels in feet.
                    forms = [raw] if value is None else [raw, value, value * 3600, value * 100]
                    if not any(math.isclose(form, other, rel_tol=1e-6, abs_tol=1e-6) for form in forms):
                        self.differ(f"{where}: {name} {path}: ours {raw} {value}, pyasteryx {other}")
                    self.compared["pyasteryx"] += 1

    def aviconv(self, ours, record, octets, where):
        names = [name[-3:].lstrip("/") for name in record.raw_items]
        if names != list(ours["items"]):
            self.differ(f"{where}: items {list(ours['items'])}, aviconv-asterix {names}")
        items = b"".join(bytes.fromhex(item) for item in record.raw_items.values())
        fspec = octets[: len(octets) - len(items)]
        if not octets.endswith(items) or fspec[-1] & 1 or any(octet & 1 == 0 for octet in fspec[:-1]):
            self.differ(f"{where}: octets {octets.hex()}, aviconv-asterix {items.hex()}")
        self.compared["aviconv-asterix, octets"] += len(items)
        for name, path in (("sac", ("010", "SAC")), ("sic", ("010", "SIC"))):
            if getattr(record, name) != ours["items"][path[0]][path[1]]["raw"]:
                self.differ(f"{where}: {name}")
            self.compared["aviconv-asterix"] += 1
        item, name = {10: ("140", "time_of_day_s"), 34: ("030", "time_of_day_s"), 48: ("140", "time_of_day_s"), 62: ("070", "time_of_track_s")}[ours["category"]]
        if item in ours["items"]:
            if not equal(ours["items"][item]["value"], getattr(record, name)):
                self.differ(f"{where}: {name}: ours {ours['items'][item]['value']}, aviconv-asterix {getattr(record, name)}")
            self.compared["aviconv-asterix"] += 1


def flatten(node):
    if isinstance(node, dict):
        for value in node.values():
            yield from flatten(value)
    elif isinstance(node, list):
        for value in node:
            yield from flatten(value)
    else:
        yield node


def compare(judge, program, file):
    data = file.read_bytes()
    dump = subprocess.run([program, "asterix", "dump", file], stdout=subprocess.PIPE, check=True)
    lines = iter(dump.stdout.splitlines())
    second = pyasteryx.Decoder()
    counts = Counter()
    for payload in payloads(data):
        for block in blocks(payload):
            category = block[0]
            ours = [json.loads(next(lines))]
            theirs = parse(block, category, ours[0]["edition"], ours[0].get("profile"))
            ours += [json.loads(next(lines)) for _ in theirs[1:]]
            counts[category] += len(theirs)
            messages = judge.ask("pyasteryx", second.decode, block, len(theirs)) if category in (48, 62) else []
            records = judge.ask("aviconv-asterix", aviconv_asterix.iter_records, block, len(theirs)) if category in (10, 34, 48, 62) else []
            for index, (mine, record) in enumerate(zip(ours, theirs)):
                where = f"{file.name} byte {mine['offset']} category {category:03}"
                if mine["category"] != category:
                    judge.differ(f"{where}: category {mine['category']}")
                judge.libasterix(mine, category, mine["edition"], record, where)
                if messages:
                    judge.pyasteryx(mine, messages[index], where)
                if records:
                    judge.aviconv(mine, records[index], record.unparse().to_bytes(), where)
    left = len(list(lines))
    if left:
        judge.differ(f"{file.name}: {left} records that libasterix does not have")
    print(f"{file.name}: records by category {dict(counts)}")


def speed(program, count):
    """Records of category 048 a second: this decoder to SI units, in its benchmark's words, beside libasterix."""
    with tempfile.TemporaryDirectory() as folder:
        generator = program.parent / "examples" / "random_records"
        subprocess.run([generator, folder, str(count)], check=True)
        file = next(Path(folder).glob("cat048-*.ast"))
        every = list(blocks(file.read_bytes()))
        begin = time.perf_counter()
        for block in every:
            parse(block, 48, "1.32", None)
        theirs = count / (time.perf_counter() - begin)
        fast = program.parent / "examples" / "decode_speed"
        ours = float(subprocess.run([fast, file], stdout=subprocess.PIPE, check=True).stdout)
    print(f"category 048, records a second: ours {ours:.0f}, libasterix {theirs:.0f}, {ours / theirs:.0f} times as many")


def golden(file, count):
    """Bits of the elements of the first records by libasterix, as a table."""
    editions = {10: "1.1", 34: "1.29", 48: "1.32"}
    records = (
        (block[0], record)
        for payload in payloads(file.read_bytes())
        for block in blocks(payload)
        for record in parse(block, block[0], editions[block[0]], None)
    )
    for index, (category, record) in zip(range(count), records):
        for name, item in record.items_regular.items():
            for path, bits, _ in elements(item):
                print(f"{index},{category},{'/'.join(map(str, (name, *path)))},{bits}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=Path, help="radar-chain; the crate's examples lie in the folder beside it")
    parser.add_argument("recordings", type=Path, nargs="*")
    parser.add_argument("--random", type=int, metavar="N", help="N random records of each category, encoded by the crate")
    parser.add_argument("--golden", type=int, metavar="N", help="print the elements of the first N records of a recording instead")
    parser.add_argument("--speed", type=int, metavar="N", help="decode N random records of category 048 with both")
    arguments = parser.parse_intermixed_args()
    if arguments.speed:
        return speed(arguments.program, arguments.speed)
    if arguments.golden:
        return golden(arguments.recordings[0], arguments.golden)
    judge = Judge()
    for recording in arguments.recordings:
        compare(judge, arguments.program, recording)
    if arguments.random:
        with tempfile.TemporaryDirectory() as folder:
            generator = arguments.program.parent / "examples" / "random_records"
            subprocess.run([generator, folder, str(arguments.random)], check=True)
            for file in sorted(Path(folder).iterdir()):
                compare(judge, arguments.program, file)
    for name, count in judge.compared.items():
        print(f"{name}: {count} compared")
    for name, count in judge.refused.items():
        print(f"{name}: {count} blocks that it cannot read")
    for difference in judge.differences[:20]:
        print(difference)
    print(f"{len(judge.differences)} differences")
    sys.exit(1 if judge.differences else 0)


main()
