// How long it takes from the antenna to this screen, measured here.

import { Latest } from "./clock.js";

/** Stamps of a tracks message in their order, and what lies between two of them. */
const HOPS = [
  ["source_out", "extractor_in", "dwell to extractor"],
  ["extractor_in", "plots_out", "plots extracted"],
  ["plots_out", "tracker_in", "plots to tracker"],
  ["tracker_in", "tracks_out", "tracks updated"],
  ["tracks_out", "display_in", "tracks to display"],
  ["display_in", "display_out", "packed for the page"],
];
const REMEMBERED = 1024;

export class ScreenLatency {
  constructor(clock) {
    this.clock = clock;
    this.all = new Latest(REMEMBERED);
    /** Waiting to be drawn, and drawn but not yet on the screen. */
    this.waiting = [];
    this.drawn = [];
    /** When messages reached the screen, by their stamps, which their tracks have too. */
    this.shown = new WeakMap();
  }

  /** A message with tracks has arrived. */
  arrived(message, arrived_ms) {
    if (message.count === 0 || !message.stamps_us || this.waiting.length > 256) return;
    this.waiting.push({ stamps_us: message.stamps_us, arrived_ms });
  }

  /** Called at the start of each animation frame: what the frame before has drawn is now on the screen. */
  frame(now_ms) {
    const now_us = this.clock.server_us(now_ms);
    for (const { stamps_us, arrived_ms } of this.drawn) {
      const from = stamps_us.source_out || stamps_us.plots_out;
      if (Number.isNaN(now_us) || !from) continue;
      this.all.add(now_us - from);
      this.shown.set(stamps_us, { arrived_us: this.clock.server_us(arrived_ms), shown_us: now_us });
    }
    this.drawn.length = 0;
  }

  /** The picture has been drawn. */
  afterDrawing() {
    [this.waiting, this.drawn] = [this.drawn, this.waiting];
  }

  /** A hidden page draws nothing: what came meanwhile is not measured. */
  forget() {
    this.waiting.length = 0;
    this.drawn.length = 0;
  }

  /** Median and 95th percentile in ms, and how many they are of. */
  summary() {
    const { all } = this;
    return { p50_ms: all.percentile(50) / 1000, p95_ms: all.percentile(95) / 1000, n: all.n };
  }
}

/** Hops of one message as `[name, µs]`; a stamp of 0 has not been there. `shown` adds the way to the screen. */
export function hopsOf(stamps_us, shown) {
  const hops = [];
  for (const [from, to, name] of HOPS) {
    if (stamps_us?.[from] && stamps_us[to]) hops.push([name, stamps_us[to] - stamps_us[from]]);
  }
  if (shown && stamps_us?.display_out) {
    hops.push(["to the browser", Math.max(0, shown.arrived_us - stamps_us.display_out)]);
    hops.push(["drawn", shown.shown_us - shown.arrived_us]);
  }
  return hops;
}
