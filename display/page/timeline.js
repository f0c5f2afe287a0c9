// The time line of a recording: play, pause, speed, steps, jumps.

import { drawing, element, setText } from "./element.js";
import { clock, elapsed, quantity } from "./format.js";

const RATES = [0.25, 0.5, 1, 2, 4, 8, 16, 32];
/** Drawings of the buttons, in a square of 16. */
const ICONS = {
  play: "M4 2v12l10-6z",
  pause: "M3 2h4v12H3zM9 2h4v12H9z",
  eventBefore: "M2 2h2v12H2zM14 2v12L5 8z",
  nextEvent: "M12 2h2v12h-2zM2 2v12l9-6z",
  scanBack: "M8 3v10L1 8zM15 3v10L8 8z",
  scanOn: "M1 3v10l7-5zM8 3v10l7-5z",
  sectorBack: "M11 3v10L4 8z",
  sectorOn: "M5 3v10l7-5z",
};
/** While the hand drags, the server is asked for another time at most this often, ms. */
const SEEK_MS = 120;

export class Timeline {
  constructor(section, send, events) {
    Object.assign(this, { section, send, events });
    this.now = { at_s: NaN, playing: false, rate: 1 };
    const button = (label, icon, act) => element("button", { type: "button", "aria-label": label, title: label, onclick: act }, drawing(ICONS[icon]));
    this.play = button("Play", "play", () => this.toggle());
    this.slider = element("input", { type: "range", min: 0, max: 1, step: 0.01, value: 0, "aria-label": "Time in the recording" });
    this.slider.addEventListener("input", () => this.#drag());
    this.ticks = element("canvas", { class: "ticks", "aria-hidden": "true" });
    this.rate = element("select", { "aria-label": "Speed" }, ...RATES.map((rate) => element("option", { value: rate }, `${rate}×`)));
    this.rate.value = "1";
    this.rate.addEventListener("change", () => this.now.playing && this.send({ play: Number(this.rate.value) }));
    this.clock = element("output", { class: "clock" });
    section.append(
      button("Event before", "eventBefore", () => this.jump(-1)),
      button("Scan back", "scanBack", () => this.step("scan", -1)),
      button("Sector back", "sectorBack", () => this.step("sector", -1)),
      this.play,
      button("Sector on", "sectorOn", () => this.step("sector", 1)),
      button("Scan on", "scanOn", () => this.step("scan", 1)),
      button("Next event", "nextEvent", () => this.jump(1)),
      this.rate,
      element("div", { class: "track" }, this.ticks, this.slider),
      this.clock,
    );
  }

  start(hello) {
    this.recording = hello.mode === "recording" ? hello.recording : null;
    this.section.hidden = !this.recording;
    if (!this.recording) return;
    const { from_s, to_s } = this.recording;
    this.slider.max = Math.max(0.01, to_s - from_s);
  }

  hear(message) {
    this.now = message;
    const label = message.playing ? "Pause" : "Play";
    if (this.play.title !== label) {
      this.play.title = label;
      this.play.setAttribute("aria-label", label);
      this.play.replaceChildren(drawing(ICONS[message.playing ? "pause" : "play"]));
    }
    const rate = String(message.rate);
    if (message.playing && document.activeElement !== this.rate && RATES.includes(message.rate)) this.rate.value = rate;
    this.#show(message.at_s);
  }

  #show(at_s) {
    const { from_s, to_s } = this.recording ?? { from_s: 0, to_s: 0 };
    const gone = at_s - from_s;
    if (!this.dragging) this.slider.value = gone;
    const text = `${elapsed(gone)} of ${elapsed(to_s - from_s)}`;
    if (this.slider.getAttribute("aria-valuetext") !== text) this.slider.setAttribute("aria-valuetext", text);
    setText(this.clock, `${clock(at_s, 1)}   ${text}`);
  }

  toggle() {
    if (!this.recording) return;
    this.send(this.now.playing ? { pause: true } : { play: Number(this.rate.value) });
  }

  step(step, by) {
    if (this.recording) this.send({ step, by });
  }

  seek(at_s) {
    if (!this.recording) return;
    const seek = Math.min(this.recording.to_s, Math.max(this.recording.from_s, at_s));
    this.now = { ...this.now, at_s: seek };
    this.send({ seek });
  }

  /** To the next event (1) or the one before (-1), of the kinds that are listed. */
  jump(by) {
    const times = this.events.shown.map(({ time_s }) => time_s).sort((a, b) => a - b);
    const { at_s, playing } = this.now;
    // What plays has left the event that it was sent to.
    const before_s = at_s - (playing ? 0.5 : 0.001);
    const to = by > 0 ? times.find((time_s) => time_s > at_s + 0.001) : times.findLast((time_s) => time_s < before_s);
    if (to !== undefined) this.seek(to);
  }

  #drag() {
    const at_s = this.recording.from_s + Number(this.slider.value);
    this.#show(at_s);
    if (this.dragging) return;
    // The last place of the hand within the pause is the one that counts.
    this.dragging = setTimeout(() => {
      this.dragging = null;
      this.seek(this.recording.from_s + Number(this.slider.value));
    }, SEEK_MS);
  }

  /** Marks of the events above the slider. */
  drawTicks(colours) {
    const { ticks, events: { shown } } = this;
    const drawn = [shown.length, ticks.clientWidth, colours.text.coasting].join();
    if (!this.recording || this.drawn === drawn) return;
    ticks.width = ticks.clientWidth;
    ticks.height = 8;
    const { from_s, to_s } = this.recording;
    const context = ticks.getContext("2d");
    for (const { time_s, kind } of shown) {
      context.fillStyle = colours.text[{ confirmed: "confirmed", ended: "ended" }[kind] ?? "coasting"];
      context.fillRect(((time_s - from_s) / (to_s - from_s)) * ticks.width, 1, 2, 6);
    }
    this.ticks.title = quantity(shown.length, "events");
    this.drawn = drawn;
  }
}
