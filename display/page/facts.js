// The line at the top: what is going on, in a few numbers.

import { byId, setText } from "./element.js";
import { clock, number } from "./format.js";

export class Facts {
  constructor(picture, latency) {
    Object.assign(this, { picture, latency });
    this.of = Object.fromEntries(["time", "scan", "confirmed", "alive", "plots", "latency"].map((name) => [name, byId(`fact-${name}`)]));
  }

  start(hello) {
    byId("fact-latency-box").hidden = hello.mode === "recording";
  }

  update() {
    const { picture, of } = this;
    const sites = [...picture.sites.values()];
    const sum = (value) => sites.reduce((total, site) => total + value(site), 0);
    const scans = sites.filter(({ beam }) => Number.isFinite(beam.scan)).map(({ beam }) => number(beam.scan + 1));
    setText(of.time, Number.isNaN(picture.epoch_s) ? "–" : `${clock(picture.epoch_s + picture.latest_s)} UTC`);
    setText(of.scan, scans.join(" · ") || "–");
    setText(of.confirmed, number(sum(({ confirmed }) => confirmed)));
    setText(of.alive, number(sum(({ alive }) => alive)));
    setText(of.plots, number(sum(({ scan_plots }) => scan_plots)));
    const { p50_ms, p95_ms, n } = this.latency.summary();
    setText(of.latency, n ? `p50 ${number(p50_ms)}, p95 ${number(p95_ms)}\u202fms` : "–");
  }
}
