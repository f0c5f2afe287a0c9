"""Prints the confirmed tracks of a running chain, first those there are, then every update: HTTP and WebSocket.

    pip install requests websockets
    python3 tracks_over_http.py http://127.0.0.1:8080
"""
import json
import sys

import requests
from websockets.sync.client import connect

picture = sys.argv[1] if len(sys.argv) > 1 else "http://127.0.0.1:8080"
for site in requests.get(f"{picture}/api/v1/chain", timeout=5).json()["sites"]:
    for track in requests.get(f"{picture}/api/v1/sites/{site['name']}/tracks?confirmed=true", timeout=5).json():
        print(f"{site['name']} track {track['id']:.0f} at {track['x_m']:.0f} m east, {track['y_m']:.0f} m north")
with connect(f"ws{picture.removeprefix('http')}/api/v1/live") as live:
    live.send(json.dumps({"want": {"tracks": True}, "encoding": "json"}))
    for message in map(json.loads, live):
        for track in message.get("items", []) if message["type"] == "tracks" else []:
            print(f"{message['site']} track {track['id']:.0f} at {track['x_m']:.0f} m east, {track['y_m']:.0f} m north", flush=True)
