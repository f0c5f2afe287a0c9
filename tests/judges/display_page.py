#!/usr/bin/env python3
"""Opens the page of a running `display` in headless Chromium, uses it as a reader would, and measures it.

    python3 -m venv venv && venv/bin/pip install playwright==1.65.2 axe-playwright-python==0.1.8
    cargo run --release &
    venv/bin/python tests/judges/display_page.py http://127.0.0.1:8080 --shots shots

Checks: tracks are confirmed in time (counted from here; `confirmed_in_scan` says how long the chain has run); radar video stays for
a whole turn; a click shows the panel of a track; the numbers of the view of the chain are those of `status`; every control is
reached by Tab; where viewers may act, zones, labels and drops are answered; axe finds nothing in day and night colours; the console
is silent; nothing is asked of another host. Measures frames a second and the latency to the screen. Prints one line of JSON; exit code 1 on a failure.
"""

import argparse
import json
import shutil
import sys
import time
import urllib.request
from pathlib import Path
from urllib.parse import urlparse

from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import sync_playwright

# Software rendering, as in a virtual machine without a graphics card.
CHROMIUM = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
SIZES = {"720p": (1280, 720, 1), "2160p": (3840, 2160, 1), "zoom-200": (640, 360, 2)}
# Counts that only grow while a chain runs.
GROWING = ("messages_out", "elements_out", "restarts", "over_budget", "scan")


class Judge:
    """Failures and figures."""

    def __init__(self):
        self.failures, self.figures = [], {}

    def expect(self, holds, what):
        if not holds:
            self.failures.append(what)


def read_json(source):
    """A file or an address."""
    if urlparse(source).scheme in ("http", "https"):
        with urllib.request.urlopen(source, timeout=10) as answer:
            return json.load(answer)
    return json.loads(Path(source).read_text())


def at(tree, path):
    """The value under a dotted path, or None."""
    for key in path.split("."):
        tree = tree.get(key) if isinstance(tree, dict) else None
    return tree


def shown_number(text):
    """A number of the page: grouped by narrow spaces, a time in µs."""
    scale = {"ms": 1e3, "s": 1e6}.get(text.split("\u202f")[-1], 1)
    digits = "".join(c for c in text.replace("−", "-") if c.isdigit() or c in ".-")
    return float(digits) * scale if digits not in ("", "-") else None


def open_page(browser, url, judge, size, scheme):
    width, height, ratio = SIZES[size]
    context = browser.new_context(viewport={"width": width, "height": height}, device_scale_factor=ratio, color_scheme=scheme)
    page = context.new_page()
    host = urlparse(url).netloc
    page.on("console", lambda line: judge.expect(line.type not in ("error", "warning"), f"console: {line.text}"))
    page.on("pageerror", lambda error: judge.expect(False, f"script: {error}"))
    page.on("request", lambda request: judge.expect(urlparse(request.url).netloc == host, f"asked another host: {request.url}"))
    page.on("websocket", lambda socket: judge.expect(urlparse(socket.url).netloc == host, f"asked another host: {socket.url}"))
    page.goto(url)
    return page


def wait_until(page, expression, limit_s):
    """Polls from outside: the page's policy forbids scripts to be made inside it. Says whether it became true."""
    end = time.monotonic() + limit_s
    while not page.evaluate(expression):
        if time.monotonic() > end:
            return False
        page.wait_for_timeout(100)
    return True


def wait_for_confirmed(page, judge, wanted, limit_s):
    began = time.monotonic()
    confirmed = "radarChain.tracks.filter(t => t.state === 1).length"
    seen = wait_until(page, f"{confirmed} >= {wanted}", limit_s)
    judge.expect(seen, f"{page.evaluate(confirmed)} confirmed tracks within {limit_s} s, expected {wanted}")
    judge.figures["confirmed_after_s"] = round(time.monotonic() - began, 1)
    judge.figures["confirmed_in_scan"] = page.text_content("#fact-scan")


def click_a_track(page, judge):
    """Chooses the confirmed track that is furthest from all others, by a click on the plan."""
    chosen = page.evaluate("""() => {
      const all = radarChain.tracks, gap = t => Math.min(...all.filter(o => o !== t).map(o => Math.hypot(o.x_m - t.x_m, o.y_m - t.y_m)));
      return all.filter(t => t.state === 1).sort((a, b) => gap(b) - gap(a))[0] ?? null }""")
    if chosen is None:
        return judge.expect(False, "no track to click")
    place = page.evaluate("t => radarChain.where(t.site, t.id)", chosen)
    page.mouse.click(place["x"], place["y"])
    page.wait_for_timeout(3000)
    title = page.text_content("#detail-title") or ""
    judge.expect(title.endswith(f" {chosen['id']}"), f"a click on track {chosen['id']} shows the panel `{title}`")
    for fact in ("Range", "Azimuth", "Speed", "Existence", "Hits"):
        value = page.text_content(f"#detail [data-fact='{fact}']")
        judge.expect(value not in (None, "", "–"), f"the panel says nothing of {fact}")
    hops = page.locator("#detail table").last.locator("tbody tr").count()
    judge.expect(hops >= 5, f"the panel shows {hops} hops of the latency, expected at least 5")
    return None


def compare_status(page, judge, source):
    """What the page shows is what it was sent, and that is what `status` says before and after."""
    before = read_json(source)
    page.keyboard.press("2")
    judge.expect(wait_until(page, "radarChain.status !== undefined", 10), "no report of the chain within 10 s")
    page.wait_for_timeout(1500)
    shown, cells = page.evaluate(
        "[radarChain.status, [...document.querySelectorAll('[data-status]')].map(c => [c.dataset.status, c.textContent])]"
    )
    after = read_json(source)
    judge.figures["numbers_compared"] = len(cells)
    judge.expect(len(cells) >= 10, f"the view of the chain shows {len(cells)} numbers")
    for path, text in cells:
        sent, number = at(shown, path), shown_number(text)
        close = sent is not None and number is not None and abs(number - sent) <= max(0.5, 0.006 * abs(sent))
        judge.expect(close, f"{path}: the page shows `{text}`, it was sent {sent}")
        if path.split(".")[-1] in GROWING and sent is not None:
            low, high = at(before, path), at(after, path)
            judge.expect(low is not None and low <= sent <= max(high, low), f"{path}: {sent} on the page, status says {low} before and {high} after")
    page.keyboard.press("1")


def reach_by_keyboard(page, judge):
    """Goes through the page by Tab, and compares with what can be used."""
    for view in ("2", "1"):
        page.keyboard.press(view)
        page.wait_for_timeout(500)
        page.evaluate("document.activeElement.blur()")
        wanted = set(page.evaluate("""[...document.querySelectorAll('button, input, select, a[href], [tabindex="0"]')]
          .filter(e => e.checkVisibility() && !e.disabled).map((e, i) => e.dataset.reach = String(i))"""))
        reached = set()
        for _ in range(len(wanted) + 5):
            page.keyboard.press("Tab")
            reached.add(page.evaluate("document.activeElement.dataset.reach ?? ''"))
        missed = [page.evaluate("i => document.querySelector(`[data-reach='${i}']`)?.outerHTML.slice(0, 80) ?? ''", i) for i in wanted - reached]
        judge.expect(not [m for m in missed if m], f"not reached by Tab: {missed}")
        page.evaluate("document.querySelectorAll('[data-reach]').forEach(e => delete e.dataset.reach)")
    page.keyboard.press("Escape")
    page.keyboard.press("n")
    page.wait_for_timeout(500)
    judge.expect(page.is_visible("#detail"), "the key n chooses a track")
    page.keyboard.press("?")
    judge.expect(page.is_visible("#help"), "the key ? opens the help")
    page.keyboard.press("Escape")
    judge.expect(not page.is_visible("#help"), "Escape closes the help")


def switch_heights(page, judge):
    """Without the heights the plan takes their room, at once, and with them it is what it was."""
    places = []
    for _ in range(2):
        places.append(page.evaluate("[document.getElementById('plan').clientHeight, radarChain.height]"))
        page.keyboard.press("h")
        page.wait_for_timeout(500)
    places.append(page.evaluate("[document.getElementById('plan').clientHeight, radarChain.height]"))
    drawn = [abs(height - view) < 2 for height, view in places]
    judge.expect(all(drawn) and places[1][0] > places[0][0] and places[2] == places[0], f"heights off and on: plan and view {places}")


def check_access(page, judge, what):
    for found in Axe().run(page).response["violations"]:
        judge.expect(False, f"axe, {what}: {found['id']} at {[node['target'] for node in found['nodes']][:3]}")


def act(page, judge, shoot):
    """Where the page offers it: draws a zone, labels the chosen track and drops it, and looks whether the page says what came of it."""
    if page.get_by_role("button", name="Acquire", exact=True).is_hidden():
        return

    def says(text):
        judge.expect(wait_until(page, f"document.getElementById('toast').textContent.includes({json.dumps(text)})", 8), f"not said: {text}")

    page.keyboard.press("1")
    plan = page.locator("#plan").bounding_box()
    x, y = plan["x"] + plan["width"] / 4, plan["y"] + plan["height"] / 3
    page.get_by_role("button", name="Zone", exact=True).click()
    for dx, dy in ((0, 0), (90, 0), (90, 90)):
        page.mouse.click(x + dx, y + dy)
        page.wait_for_timeout(200)
    page.get_by_label("Name of the zone").fill("hill")
    page.get_by_role("button", name="Finish").click()
    says("Zone hill set.")
    page.keyboard.press("n")
    page.get_by_label("Label of the track").fill("blue one")
    page.get_by_role("button", name="Label", exact=True).click()
    says("blue one")
    judge.expect(wait_until(page, "document.getElementById('detail').textContent.includes('Track blue one')", 8), "no label")
    shoot(page, "acting")
    check_access(page, judge, "acting")
    page.get_by_role("button", name="Drop", exact=True).click()
    says(" dropped.")
    page.get_by_role("button", name="Remove zone hill").click()
    says("Zone hill removed.")
    judge.figures["acted"] = True


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("url")
    parser.add_argument("--status", help="output of `radar-chain status --json`: a file or an address; default: the server's own")
    parser.add_argument("--shots", type=Path, help="folder for screenshots")
    parser.add_argument("--tracks", type=int, default=8, help="confirmed tracks to wait for (8)")
    parser.add_argument("--within", type=float, default=30, help="seconds to wait for them (30)")
    parser.add_argument("--measure", type=float, default=10, help="seconds of measurement (10)")
    parser.add_argument("--least-frames", type=float, default=0, help="frames a second that must be reached")
    parser.add_argument("--most-latency-ms", type=float, default=float("inf"), help="median latency to the screen that must be reached")
    parser.add_argument("--chromium", default=shutil.which("chromium"), help="the program (chromium)")
    options = parser.parse_args()
    judge = Judge()
    status = options.status or options.url.rstrip("/") + "/api/v1/status"

    def shoot(page, name):
        if options.shots:
            options.shots.mkdir(parents=True, exist_ok=True)
            page.screenshot(path=options.shots / f"{name}.png")

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=options.chromium, args=CHROMIUM)
        page = open_page(browser, options.url, judge, "720p", "dark")
        wait_for_confirmed(page, judge, options.tracks, options.within)
        page.wait_for_timeout(options.measure * 1000)
        frames, latency = page.evaluate("[radarChain.frames, radarChain.latency]")
        measured = latency["n"] > 0  # a recording has none
        for site, share in page.evaluate("radarChain.video").items():
            judge.expect(share > 0.9, f"video of {site} on {100 * share:.0f} % of the circle")
        judge.figures["frames_per_s"] = round(frames["drawn_per_s"] or 0, 1)
        judge.figures.update({f"latency_{key}": round(latency[key], 1) for key in ("p50_ms", "p95_ms", "n") if measured})
        judge.expect(judge.figures["frames_per_s"] >= options.least_frames, f"{frames['drawn_per_s']} frames a second")
        judge.expect(not measured or latency["p50_ms"] <= options.most_latency_ms, f"median latency {latency['p50_ms']} ms")
        click_a_track(page, judge)
        shoot(page, "track-night")
        check_access(page, judge, "picture, night")
        compare_status(page, judge, status)
        reach_by_keyboard(page, judge)
        switch_heights(page, judge)
        act(page, judge, shoot)
        page.keyboard.press("2")
        page.wait_for_timeout(1500)
        shoot(page, "chain-night")
        check_access(page, judge, "chain, night")
        page.context.close()
        for size in SIZES:
            for scheme in ("light", "dark"):
                page = open_page(browser, options.url, judge, size, scheme)
                page.wait_for_timeout(4000)
                shoot(page, f"{size}-{scheme}")
                check_access(page, judge, f"{size}, {scheme}")
                judge.expect(page.evaluate("radarChain.badMessages") == 0, "messages that could not be read")
                page.context.close()
        browser.close()
    print(json.dumps({"ok": not judge.failures, **judge.figures, "failures": judge.failures}))
    return 1 if judge.failures else 0


if __name__ == "__main__":
    sys.exit(main())
