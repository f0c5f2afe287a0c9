#!/usr/bin/env python3
"""Receives every output of a chain, has foreign programs read it, and compares it with the JSON lines, track by track.

    python3 -m venv venv && venv/bin/pip install libasterix==0.36.3 pynmea2==1.19.0 takproto==3.0.1 sapient-pydantic==0.1.0
    venv/bin/python tests/judges/outputs.py

The first line on standard output names the ports, as JSON. At the end of standard input it judges: one line for each format with
the number of reports and of values compared. Exit code 1 if anything is refused or differs by more than half a unit of the format.
"""

import json
import math
import select
import socket
import struct
import sys
import warnings
from collections import Counter
from datetime import datetime

import pynmea2
import takproto
from sapient_msg.bsi_flex_335_v2_0 import sapient_message_pb2 as sapient
from sapient_msg_pydantic.bsi_flex_335_v2_0.sapient_message import SapientMessage

from libasterix_records import blocks, elements, parse

warnings.simplefilter("error")
warnings.simplefilter("ignore", ResourceWarning)
EDITIONS = {62: "1.21", 65: "1.6", 48: "1.32", 34: "1.29"}
DATAGRAMS = ("json", "asterix", "plots", "cot", "nmea")
NM_M = 1852.0
TASK = "01ARZ3NDEKTSV4RRFFQ69G5FAV"


class FusionNode:
    """What a SAPIENT node connects to: it accepts the registration and sets a task."""

    def __init__(self):
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.connection, self.octets, self.messages = None, b"", []

    def sockets(self):
        return [self.listener] + ([self.connection] if self.connection else [])

    def read(self, ready):
        if ready is self.listener:
            self.connection, _ = self.listener.accept()
            return
        octets = self.connection.recv(65536)
        if not octets:
            self.connection = None
            return
        self.octets += octets
        while len(self.octets) >= 4 and len(self.octets) >= 4 + struct.unpack("<I", self.octets[:4])[0]:
            length = struct.unpack("<I", self.octets[:4])[0]
            self.take(sapient.SapientMessage.FromString(self.octets[4 : 4 + length]))
            self.octets = self.octets[4 + length :]

    def take(self, message):
        self.messages.append(message)
        if message.HasField("registration"):
            answer = sapient.SapientMessage(node_id=message.node_id)
            answer.timestamp.GetCurrentTime()
            answer.registration_ack.acceptance = True
            self.say(answer)
            task = sapient.SapientMessage(node_id=message.node_id)
            task.timestamp.GetCurrentTime()
            task.task.task_id = TASK
            task.task.control = 1
            task.task.command.mode_change = "Default"
            self.say(task)

    def say(self, message):
        octets = message.SerializeToString()
        self.connection.sendall(struct.pack("<I", len(octets)) + octets)


class Verdict:
    def __init__(self):
        self.reports, self.compared, self.differences = Counter(), Counter(), []

    def require(self, condition, text):
        if not condition:
            self.differences.append(text)

    def compare(self, name, what, ours, theirs, half_unit):
        self.compared[name] += 1
        if not math.isclose(ours, theirs, rel_tol=1e-12, abs_tol=half_unit * (1 + 1e-6)):
            self.differences.append(f"{name}: {what}: ours {ours}, theirs {theirs}, half a unit {half_unit}")


def milliseconds(text):
    return round(datetime.fromisoformat(text).timestamp() * 1000)


def asterix_values(datagrams):
    """Category and values by path of every record."""
    for datagram in datagrams:
        for block in blocks(datagram):
            for record in parse(block, block[0], EDITIONS[block[0]], None):
                values = {}
                for name, item in record.items_regular.items():
                    for path, raw, value in elements(item):
                        values["/".join((name,) + tuple(map(str, path)))] = raw if value is None else value
                yield block[0], values


def asterix(verdict, datagrams, lines):
    by_place = {(line["id"] & 0x7FFF, int(milliseconds(line["time"]) * 128 // 1000)): line for line in lines}
    fresh = measured = 0
    for category, values in asterix_values(datagrams):
        if category == 65:
            verdict.reports["asterix 065"] += 1
            continue
        verdict.reports["asterix 062"] += 1
        steps = round(values["070"] * 128)
        # The text of a time ends with the millisecond.
        day = 86_400 * 128
        near = [line for (number, at), line in by_place.items() if number == values["040"] and min((at - steps) % day, (steps - at) % day) <= 1]
        verdict.require(len(near) == 1, f"asterix: {len(near)} lines of track {values['040']} at {steps}")
        for line in near[:1]:
            for path, key, half in (
                ("105/LAT", "latitude_deg", 90 / 2**25),
                ("105/LON", "longitude_deg", 90 / 2**25),
                ("100/X", "east_m", 0.25),
                ("100/Y", "north_m", 0.25),
                ("185/VX", "east_mps", 0.125),
                ("185/VY", "north_mps", 0.125),
            ):
                verdict.compare("asterix 062", path, line[key], values[path], half)
            fresh += line["since_plot_s"] == 0
            if line["since_plot_s"] == 0 and "340/POS/RHO" in values:
                measured += 1
                range_m, azimuth_deg = values["340/POS/RHO"] * NM_M, values["340/POS/THETA"]
                track_m = math.hypot(line["east_m"], line["north_m"], line.get("up_m", 0))
                verdict.require(abs(range_m - track_m) < 300, f"asterix: plot at {range_m} m of a track at {track_m} m")
                beside_deg = azimuth_deg - math.degrees(math.atan2(line["east_m"], line["north_m"]))
                verdict.require(abs((beside_deg + 180) % 360 - 180) < 3, f"asterix: plot {beside_deg}° beside its track")
    verdict.require(0 < fresh <= measured * 1.02, f"asterix: {measured} of {fresh} tracks just seen have their plot")


def plots(verdict, datagrams):
    categories = Counter(category for category, _ in asterix_values(datagrams))
    verdict.reports["asterix 048"], verdict.reports["asterix 034"] = categories[48], categories[34]
    verdict.require(categories[48] > 0 and categories[34] > 0, f"plots: records by category {dict(categories)}")


def line_of(lines, number, at, tolerance, time_of):
    """The line of a track at a time, which other programs may round otherwise."""
    near = [line for line in lines if line["id"] == number and abs(time_of(line) - at) <= tolerance]
    return near[0] if len(near) == 1 else None


def cot(verdict, datagrams, lines):
    for datagram in datagrams:
        event = takproto.parse_proto(bytearray(datagram)).cotEvent
        verdict.reports["cot"] += 1
        line = line_of(lines, int(event.uid.rsplit(".", 1)[1]), event.sendTime, 1, lambda line: milliseconds(line["time"]))
        verdict.require(line is not None, f"cot: no line for {event.uid} at {event.sendTime}")
        verdict.require(event.type == "a-u-A-M-H-Q" and event.how == "m-r", f"cot: {event.type} {event.how}")
        verdict.require((event.staleTime == event.sendTime) == (line is not None and line["state"] == "ended"), "cot: stale")
        if line:
            verdict.compare("cot", "latitude", line["latitude_deg"], event.lat, 0.5e-7)
            verdict.compare("cot", "longitude", line["longitude_deg"], event.lon, 0.5e-7)
            verdict.compare("cot", "speed", line["speed_mps"], event.detail.track.speed, 0.005)
            verdict.compare("cot", "course", line["course_deg"], event.detail.track.course, 0.005)


def nmea(verdict, datagrams, lines):
    for datagram in datagrams:
        text = datagram.decode("ascii")
        sentence = pynmea2.parse(text, check=True)
        verdict.require(text.endswith("\r\n") and len(text) <= 82, f"nmea: {text!r}")
        verdict.reports["nmea " + sentence.sentence_type] += 1
        fields = sentence.data
        number, at = (int(fields[10]), fields[13]) if sentence.sentence_type == "TTM" else (int(fields[5]), fields[6])
        day_s = int(at[:2]) * 3600 + int(at[2:4]) * 60 + float(at[4:])
        line = line_of(lines, number, day_s, 0.0111, lambda line: milliseconds(line["time"]) / 1000 % 86_400)
        verdict.require(line is not None, f"nmea: no line for {text!r}")
        if line and sentence.sentence_type == "TTM":
            east, north = line["east_m"], line["north_m"]
            verdict.compare("nmea TTM", "distance", math.hypot(east, north) / NM_M, float(fields[1]), 0.5e-3)
            verdict.compare("nmea TTM", "bearing", math.degrees(math.atan2(east, north)) % 360, float(fields[2]), 0.005)
            verdict.compare("nmea TTM", "speed", line["speed_mps"] * 3600 / NM_M, float(fields[4]), 0.05)
        elif line:
            for text, side, key, digits in ((fields[1], fields[2], "latitude_deg", 2), (fields[3], fields[4], "longitude_deg", 3)):
                value = (int(text[:digits]) + float(text[digits:]) / 60) * (-1 if side in "SW" else 1)
                verdict.compare("nmea TLL", key, line[key], value, 0.5e-4 / 60)


def judge_sapient(verdict, messages, lines):
    by_place = {(line["id"], milliseconds(line["time"])): line for line in lines}
    for message in messages:
        SapientMessage.from_pb2(message)  # raises where the interface is violated
        verdict.reports["sapient " + message.WhichOneof("content")] += 1
    kinds = [message.WhichOneof("content") for message in messages]
    verdict.require(kinds[:1] == ["registration"] and kinds[-1:] == ["status_report"], f"sapient: {kinds[:3]} … {kinds[-3:]}")
    latency = [message.registration.mode_definition[0].maximum_latency for message in messages[:1]]
    verdict.require(latency and latency[0].value > 0, "sapient: no latency")
    acknowledged = [message.task_ack for message in messages if message.HasField("task_ack")]
    verdict.require([(ack.task_id, ack.task_status) for ack in acknowledged] == [(TASK, 3)], f"sapient: {acknowledged}")
    goodbye = messages[-1].status_report.system if messages else None
    verdict.require(goodbye == 5, f"sapient: the last status is {goodbye}")
    objects = {}
    for message in messages:
        if not message.HasField("detection_report"):
            continue
        report = message.detection_report
        at = message.timestamp.seconds * 1000 + message.timestamp.nanos // 1_000_000
        near = [line for (_, time), line in by_place.items() if abs(time - at) <= 1 and abs(line["latitude_deg"] - report.location.y) < 1e-9]
        verdict.require(len(near) == 1, f"sapient: {len(near)} lines for {report.object_id} at {at}")
        for line in near[:1]:
            verdict.require(objects.setdefault(line["id"], report.object_id) == report.object_id, "sapient: identity")
            verdict.compare("sapient detection_report", "latitude", line["latitude_deg"], report.location.y, 0)
            verdict.compare("sapient detection_report", "longitude", line["longitude_deg"], report.location.x, 0)
            verdict.compare("sapient detection_report", "east rate", line["east_mps"], report.enu_velocity.east_rate, 0)
            verdict.require((line["state"] == "ended") == (report.state == "lost"), "sapient: lost")
    verdict.require(len(set(objects.values())) == len(objects), "sapient: identities of several tracks")


def main():
    receivers, node = {}, FusionNode()
    for name in DATAGRAMS:
        receivers[name] = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        receivers[name].setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 8 << 20)
        receivers[name].bind(("127.0.0.1", 0))
    ports = {name: receiver.getsockname()[1] for name, receiver in receivers.items()}
    print(json.dumps(ports | {"sapient": node.listener.getsockname()[1]}), flush=True)
    received = {name: [] for name in DATAGRAMS}
    told_to_judge = False
    while True:
        sockets = list(receivers.values()) + node.sockets() + ([] if told_to_judge else [sys.stdin])
        ready, _, _ = select.select(sockets, [], [], 0.2)
        if told_to_judge and not ready:
            break
        for one in ready:
            if one is sys.stdin:
                told_to_judge = not sys.stdin.buffer.read(1)
            elif one in node.sockets():
                node.read(one)
            else:
                name = next(name for name, receiver in receivers.items() if receiver is one)
                received[name].append(one.recv(65536))
    verdict = Verdict()
    lines = [json.loads(line) for line in received["json"]]
    verdict.reports["json"] = len(lines)
    asterix(verdict, received["asterix"], lines)
    plots(verdict, received["plots"])
    cot(verdict, received["cot"], lines)
    nmea(verdict, received["nmea"], lines)
    judge_sapient(verdict, node.messages, lines)
    for name in ("asterix 062", "cot", "nmea TTM", "nmea TLL"):
        verdict.require(verdict.reports[name] == len(lines), f"{name}: {verdict.reports[name]} reports, {len(lines)} lines")
    verdict.require(len(lines) > 0 and verdict.reports["sapient detection_report"] > 0, f"{dict(verdict.reports)}")
    for name, count in sorted(verdict.reports.items()):
        print(f"{name}: {count} reports, {verdict.compared[name]} values")
    for difference in verdict.differences[:10]:
        print(f"DIFFERENCE {difference}")
    print(f"{len(verdict.differences)} differences")
    sys.exit(bool(verdict.differences))


if __name__ == "__main__":
    main()
