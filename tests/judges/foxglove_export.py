#!/usr/bin/env python3
"""Reads an export for viewers with Foxglove's own libraries, and checks that it is what they expect.

    python3 -m venv venv && venv/bin/pip install foxglove-sdk==0.30.3 mcap==1.6.0 protobuf==7.36.2 jsonschema==4.26.0
    radar-chain recorder export RECORDING.mcap --format mcap-json --topics tracks,plots,truth,health --out viewers
    venv/bin/python tests/judges/foxglove_export.py viewers/*.mcap

Checks of every message that a viewer draws by itself: its schema has the name and only fields that the SDK knows; the message
holds what its own schema says, and nothing else; the SDK's definition takes it, field by field and type by type; the SDK's classes,
built from it, encode the same; positions, numbers and states are those of the message of tracks of the same time; text is GeoJSON.
Of all other messages: each is as its own schema says. Prints one line of JSON; exit code 1 on a failure.
"""

import collections
import json
import math
import sys

from foxglove import messages as sdk
from google.protobuf import descriptor_pb2, descriptor_pool, json_format, message_factory
from jsonschema import Draft7Validator
from mcap.reader import make_reader

DRAWN = {"foxglove.SceneUpdate": sdk.SceneUpdate, "foxglove.GeoJSON": sdk.GeoJson, "foxglove.LocationFix": sdk.LocationFix}
TIMES = ("google.protobuf.Timestamp", "google.protobuf.Duration")
# Half a unit of the last digit of a number of single precision, at most.
ROUNDED = 1e-6


class Judge:
    """Failures and figures."""

    def __init__(self):
        self.failures, self.figures = [], collections.Counter()

    def expect(self, holds, what):
        if not holds and len(self.failures) < 20:
            self.failures.append(what)


def definition(of):
    """The message as the SDK defines it."""
    files = descriptor_pb2.FileDescriptorSet.FromString(of.get_schema().data)
    pool = descriptor_pool.DescriptorPool()
    for file in files.file:
        pool.Add(file)
    return message_factory.GetMessageClass(pool.FindMessageTypeByName(of.get_schema().name))


def with_protobuf_times(value, descriptor):
    """The JSON of viewers has times as {sec, nsec}; that of Protocol Buffers as text."""
    if isinstance(value, list):
        return [with_protobuf_times(item, descriptor) for item in value]
    if descriptor is None or not isinstance(value, dict):
        return value
    if descriptor.full_name in TIMES:
        made = message_factory.GetMessageClass(descriptor)(seconds=value["sec"], nanos=value["nsec"])
        return json.loads(json_format.MessageToJson(made))
    fields = descriptor.fields_by_name
    return {name: with_protobuf_times(of, fields[name].message_type if name in fields else None) for name, of in value.items()}


def as_sdk(value, descriptor):
    """The SDK's own object of a message."""
    name = {"GeoJSON": "GeoJson"}.get(descriptor.name, descriptor.name)
    if descriptor.full_name in TIMES:
        return getattr(sdk, name)(value["sec"], value["nsec"])
    made = {}
    for key, of in value.items():
        field = descriptor.fields_by_name[key]

        def one(item):
            if field.message_type:
                return as_sdk(item, field.message_type)
            if field.enum_type:
                return enumerator(descriptor.name, field, item)
            return item

        made[key] = [one(item) for item in of] if isinstance(of, list) else one(of)
    return getattr(sdk, name)(**made)


def enumerator(owner, field, number):
    """The SDK's name of a number."""
    kind = next(getattr(sdk, name) for name in dir(sdk) if name.startswith(owner) and name.endswith(field.enum_type.name))
    return next(item for item in vars(kind).values() if isinstance(item, kind) and int(item) == number)


def closed(schema):
    """A schema that allows nothing that it does not name."""
    if isinstance(schema, list):
        return [closed(item) for item in schema]
    if not isinstance(schema, dict):
        return schema
    made = {key: closed(item) for key, item in schema.items()}
    if "properties" in made and schema.get("type") == "object":
        made.setdefault("additionalProperties", False)
    return made


def near(a, b):
    return math.isclose(a, b, rel_tol=ROUNDED, abs_tol=ROUNDED)


def check_scene(scene, tracks, judge):
    """What is drawn is what the tracks of the same message say."""
    of = {f"track {track['id']}": track for track in tracks}
    confirmed = {name for name, track in of.items() if track["state_code"] in (1, 2)}
    judge.expect({entity["id"] for entity in scene["entities"]} == confirmed, f"drawn {[e['id'] for e in scene['entities']]}, confirmed {confirmed}")
    for entity in scene["entities"]:
        track = of.get(entity["id"])
        if track is None:
            continue
        at = entity["spheres"][0]["pose"]["position"]
        judge.expect(all(near(at[axis], track["state"][3 * k]) for k, axis in enumerate("xyz")), f"{entity['id']} lies at {at}")
        time_ns = entity["timestamp"]["sec"] * 10**9 + entity["timestamp"]["nsec"]
        judge.expect(time_ns == track["time_ns"], f"{entity['id']} at {time_ns}, the track at {track['time_ns']}")
        judge.figures["tracks drawn"] += 1
    ended = {name for name, track in of.items() if track["state_code"] == 3}
    judge.expect({deletion["id"] for deletion in scene["deletions"]} == ended, f"deleted {scene['deletions']}, ended {ended}")


def check_map(text, judge):
    """Text is a collection of points, each with a name, in degrees."""
    collection = json.loads(text)
    judge.expect(collection["type"] == "FeatureCollection", f"{collection['type']} is no collection")
    for feature in collection["features"]:
        longitude, latitude, *height = feature["geometry"]["coordinates"]
        is_place = -180 <= longitude <= 180 and -90 <= latitude <= 90 and all(map(math.isfinite, height))
        judge.expect(feature["type"] == "Feature" and feature["geometry"]["type"] == "Point" and is_place, f"no place: {feature}")
        judge.expect("name" in feature["properties"], f"no name: {feature}")
        judge.figures["points on maps"] += 1


def main(files):
    judge = Judge()
    for file in files:
        validators, tracks_at = {}, {}
        with open(file, "rb") as stream:
            for schema, channel, message in make_reader(stream).iter_messages(log_time_order=False):
                value = json.loads(message.data)
                judge.expect((schema.encoding, channel.message_encoding) == ("jsonschema", "json"), f"{channel.topic}: {schema.encoding}")
                if schema.id not in validators:
                    validators[schema.id] = Draft7Validator(closed(json.loads(schema.data)))
                for error in list(validators[schema.id].iter_errors(value))[:2]:
                    judge.expect(False, f"{schema.name} is not as its schema says: {error.json_path}: {error.message[:200]}")
                judge.figures[schema.name] += 1
                if channel.topic == "/tracks":
                    tracks_at = {message.sequence: value["elements"]}
                of = DRAWN.get(schema.name)
                if of is None:
                    continue
                defined = definition(of)
                try:
                    parsed = json_format.ParseDict(with_protobuf_times(value, defined.DESCRIPTOR), defined())
                    built = defined.FromString(as_sdk(value, defined.DESCRIPTOR).encode())
                except (json_format.ParseError, AttributeError, KeyError, TypeError, ValueError) as error:
                    judge.expect(False, f"{schema.name} is not what the SDK takes: {error}")
                    continue
                judge.expect(parsed == built, f"{schema.name}: the SDK encodes {built}, the message says {parsed}")
                if schema.name == "foxglove.SceneUpdate":
                    check_scene(value, tracks_at.get(message.sequence, []), judge)
                elif schema.name == "foxglove.GeoJSON":
                    check_map(value["geojson"], judge)
    for name in DRAWN:
        judge.expect(judge.figures[name] > 0, f"there is no {name}")
    print(json.dumps({"ok": not judge.failures, **judge.figures, "failures": judge.failures}))
    return 1 if judge.failures else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
