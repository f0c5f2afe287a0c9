// The view of the chain: what `radar-chain status` says, and how it went in the last minutes.

import { Chart } from "./chart.js";
import { byId, Table } from "./element.js";
import { bytes, micros, number, percent, words } from "./format.js";
import { processesOf, Stages } from "./stages.js";

/** Reports that the history holds: ten minutes of one a second. */
const HISTORY = 600;

/** Latencies in the order of the way through the chain. */
const ORDER = ["hop_dwells", "extract", "hop_plots", "track", "end_to_end", "scan", "record"];
const HEADS = ["Process", "Condition", "CPU", "Memory", "Sent", "Elements", "Lost", "Rejected", "Restarts", "Tracks", "Confirmed", "Scan"];

export class ChainView {
  constructor(scene) {
    this.scene = scene;
    this.stages = new Stages(byId("stages"));
    this.latency = new Table("Latency against budget", ["Latency", "p50", "p99", "Budget", "Scans over budget", "p99 over time"]);
    this.processes = new Table("Processes", HEADS);
    byId("latency").append(this.latency.table);
    byId("processes").append(this.processes.table);
    this.start(null);
  }

  start(hello) {
    this.hello = hello;
    /** p99 by process and latency: `{points, chart}`. */
    this.history = new Map();
    this.before = new Map();
    this.latest = [];
    this.fresh = false;
    if (hello) this.stages.lay(hello);
  }

  hear({ status, time_s }) {
    this.latest = processesOf(status ?? {});
    this.status = status;
    for (const { key, of } of this.latest) {
      for (const [name, { p99 }] of Object.entries(of.latency_us ?? {})) {
        const id = `${key}.${name}`;
        if (!this.history.has(id)) this.history.set(id, { points: [], chart: new Chart(`${words(name)}, p99 over time`, 22) });
        const { points } = this.history.get(id);
        points.push([time_s, p99]);
        if (points.length > HISTORY) points.shift();
      }
    }
    this.fresh = true;
  }

  /** Draws the last report, if the view is shown. */
  update(shown) {
    if (!shown || !this.fresh) return;
    this.fresh = false;
    /** The report that is on the screen. */
    this.shown = this.status;
    this.stages.update(this.latest, this.before);
    this.before = new Map(this.latest.map(({ key, of }) => [key, of]));
    this.#latencies();
    this.processes.update(this.latest.map((process) => [process.key, rowOf(process)]));
  }

  #latencies() {
    const rows = [];
    for (const { key, site, of } of this.latest) {
      const budgets = (this.hello.sites.find(({ name }) => name === (site || of.site)) ?? this.hello.sites[0])?.budgets_us ?? {};
      const latencies = Object.entries(of.latency_us ?? {}).sort(([a], [b]) => ORDER.indexOf(a) - ORDER.indexOf(b));
      for (const [name, { p50, p99, over_budget }] of latencies) {
        const id = `${key}.${name}`;
        const { chart } = this.history.get(id);
        const budget = budgets[name];
        const kind = budget && p99 > budget ? "bad" : "";
        const path = `${key}.latency_us.${name}`;
        rows.push([
          id,
          [
            this.latest.length && site ? `${site} ${words(name)}` : words(name),
            { text: micros(p50), data: `${path}.p50` },
            { text: micros(p99), data: `${path}.p99`, kind },
            budget ? micros(budget) : "–",
            { text: number(over_budget), data: `${path}.over_budget`, kind: over_budget > 0 ? "bad" : "" },
            chart.canvas,
          ],
        ]);
      }
    }
    this.latency.update(rows);
    for (const [, cells] of rows) this.#draw(cells.at(-1));
  }

  #draw(canvas) {
    for (const [id, { points, chart }] of this.history) {
      if (chart.canvas !== canvas) continue;
      const [name, , site] = id.split(".").reverse(); // site, process, latency: the first where there are several
      const { sites } = this.hello;
      const budget = (sites.find((of) => of.name === site) ?? sites[0])?.budgets_us?.[name];
      const most = Math.max(...points.map(([, p99]) => p99), budget ?? 0);
      chart.begin(this.scene.colours, points[0][0], Math.max(points.at(-1)[0], points[0][0] + 10), 0, most);
      if (budget) chart.level(budget, "coasting");
      chart.line(points, "confirmed");
    }
  }
}

/** The row of a process; counts as they are in `status --json`, named by their path in it. */
function rowOf({ key, name, site, of }) {
  const sum = (counts) => Object.values(counts ?? {}).reduce((a, b) => a + b, 0);
  const count = (field) => ({ text: number(of[field]), data: `${key}.${field}` });
  const lost = sum(of.lost);
  const condition = of.ended ? "ended" : of.condition;
  return [
    site ? `${site} ${name}` : name,
    { text: condition, kind: condition === "fine" || condition === "ended" ? "" : "bad" },
    percent(of.cpu_share),
    bytes(of.rss_bytes),
    count("messages_out"),
    count("elements_out"),
    { text: number(lost), kind: lost ? "bad" : "" },
    number(sum(of.rejected)),
    count("restarts"),
    count("tracks"),
    count("confirmed"),
    count("scan"),
  ];
}
