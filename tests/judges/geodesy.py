#!/usr/bin/env python3
"""Compares changes of frame (F1), (F2) and of datum with PROJ, place by place.

    python3 -m venv venv && venv/bin/pip install pyproj==3.7.2
    cargo build --release -p common --example frames
    venv/bin/python tests/judges/geodesy.py target/release/examples/frames [--places 10000] [--seed 1]

Places all over the earth, poles and the 180th meridian among them, up to 30 km high, each seen from two sites up to 500 km away. Positions
are to agree to 1e-6 m, and so are latitude and longitude as arcs. Exit code 1 if one does not.
"""

import argparse
import json
import math
import random
import subprocess
import sys

from pyproj import Transformer

WITHIN_M = 1e-6
EARTH_M = 6_378_137.0


def pipeline(steps):
    return Transformer.from_pipeline("+proj=pipeline " + " ".join(f"+step {step}" for step in steps))


def geocentric(ellipsoid, place):
    latitude, longitude, height = place
    return pipeline([f"+proj=cart +ellps={ellipsoid}"]).transform(longitude, latitude, height)


def questions(count, seed):
    draw = random.Random(seed)
    for index in range(count):
        latitude = [90.0, -90.0, 0.0][index % 3] if index < 9 else math.degrees(math.asin(draw.uniform(-1, 1)))
        longitude = [180.0, -180.0, 0.0][index // 3] if index < 9 else draw.uniform(-180, 180)
        place = [latitude, longitude, draw.uniform(-100, 30_000)]

        def site():
            return [
                max(-90.0, min(90.0, latitude + draw.uniform(-4.5, 4.5))),
                longitude + draw.uniform(-4.5, 4.5),
                draw.uniform(0, 3000),
            ]

        yield {
            "place": place,
            "sites": [site(), site()],
            "shift_m": [draw.uniform(-150, 150) for _ in range(3)],
            "rotation_arcsec": [draw.uniform(-2, 2) for _ in range(3)],
            "scale_ppm": draw.uniform(-5, 5),
        }


def expected(question):
    place = question["place"]
    wgs84, krasovsky = geocentric("WGS84", place), geocentric("krass", place)
    (x, y, z), (rx, ry, rz) = question["shift_m"], question["rotation_arcsec"]
    # To first order in the rotation, as published parameters are meant.
    helmert = pipeline([f"+proj=helmert +convention=position_vector +x={x!r} +y={y!r} +z={z!r} "
                        f"+rx={rx!r} +ry={ry!r} +rz={rz!r} +s={question['scale_ppm']!r}"])

    def seen_from(site):
        latitude, longitude, height = site
        of = f"+proj=topocentric +ellps=WGS84 +lat_0={latitude!r} +lon_0={longitude!r} +h_0={height!r}"
        return pipeline([of]).transform(*wgs84)

    return {
        "wgs84": wgs84,
        "krasovsky": krasovsky,
        "shifted": helmert.transform(*krasovsky),
        "of_first": seen_from(question["sites"][0]),
        "of_second": seen_from(question["sites"][1]),
    }


def arc_m(found, place):
    """How far a latitude, longitude and height are from those of a place."""
    latitude, longitude, height = (a - b for a, b in zip(found, place))
    longitude = (longitude + 180.0) % 360.0 - 180.0
    east = math.radians(longitude) * math.cos(math.radians(place[0]))
    return max(abs(EARTH_M * math.radians(latitude)), abs(EARTH_M * east), abs(height))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--places", type=int, default=10_000)
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    asked = list(questions(arguments.places, arguments.seed))
    lines = "".join(json.dumps(question) + "\n" for question in asked)
    answers = subprocess.run([arguments.program], input=lines, capture_output=True, text=True, check=True).stdout
    worst, values = {}, 0
    for question, line in zip(asked, answers.splitlines(), strict=True):
        answer = json.loads(line)
        differences = {
            key: max(abs(a - b) for a, b in zip(answer[key], value)) for key, value in expected(question).items()
        }
        differences |= {key: arc_m(answer[key], question["place"]) for key in answer if key.startswith("back")}
        values += 3 * len(differences)
        for key, difference in differences.items():
            if key not in worst or not difference <= worst[key][0]:
                worst[key] = (difference, question)
    wrong = False
    for key, (difference, question) in worst.items():
        wrong |= not difference <= WITHIN_M
        print(f"{key:15} {difference:.1e} m at most" + ("" if difference <= WITHIN_M else f": {json.dumps(question)}"))
    print(f"{len(asked)} places, {values} values")
    sys.exit(wrong)


if __name__ == "__main__":
    main()
