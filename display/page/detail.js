// The panel in which the chosen track explains itself.

import { Chart } from "./chart.js";
import { element, setText, Table } from "./element.js";
import { angle, clock, distance, micros, number, percent, quantity, words } from "./format.js";
import { hopsOf } from "./latency.js";
import { nameOf } from "./list.js";
import { STATES } from "./picture.js";

const AXES = [["x", "East"], ["y", "North"], ["z", "Up"]];
/** Lines of the chart of models, by their order. */
const MODEL_COLOURS = ["confirmed", "coasting", "tentative", "plot", "system", "truth", "used", "ended"];
const DASHES = [[], [5, 3], [2, 2], [7, 2, 2, 2], [1, 3], [9, 3], [4, 4], [2, 5]];

export class Detail {
  constructor(section, scene, latency, onClose) {
    Object.assign(this, { section, scene, latency });
    this.title = element("h2", { id: "detail-title" });
    this.life = element("span", { class: "life" });
    const close = element("button", { type: "button", "aria-label": "Close the panel", class: "close", onclick: onClose }, "×");
    this.facts = new Facts();
    this.state = new Table("State with standard errors", ["Axis", "Position, m", "Velocity, m/s", "Accel., m/s²"]);
    this.modelNames = element("ul", { class: "key" });
    this.models = new Chart("Model probabilities over time", 56);
    this.used = new Table("Plots used by the last scans", ["Plot", "Scan", "Weight", "In gates", "Distance"]);
    this.used.table.className = "used";
    this.gate = element("p", { class: "soft" });
    this.hops = new Table("Latency hop by hop", ["Hop", "Time", "Share"]);
    this.errorTitle = element("h3", {}, "Errors against truth");
    this.errors = AXES.map(([, name]) => [element("span", { class: "axis" }), new Chart(`Error ${name.toLowerCase()}`, 40)]);
    this.errorBox = element("div", { class: "errors" }, ...this.errors.flatMap(([text, chart]) => [text, chart.canvas]));
    section.prepend(element("div", { class: "detail-head" }, this.title, this.life, close), this.facts.list);
    section.append(
      this.state.table,
      element("h3", {}, "Models"), this.models.canvas, this.modelNames,
      element("h3", {}, "Gate and plots"), this.gate, this.used.table,
      this.errorTitle, this.errorBox,
      element("h3", {}, "From the last dwell to this screen"), this.hops.table,
    );
  }

  update() {
    const { track, said } = this.scene.selection;
    this.section.hidden = !track;
    if (!track) return;
    const { sites } = this.scene.picture;
    setText(this.title, `Track ${nameOf(track, sites.size > 1)}`);
    const gone = !this.scene.picture.find(track.key);
    const state = gone ? "ended" : STATES[track.state];
    setText(this.life, state);
    this.life.dataset.state = state;
    this.#facts(track);
    this.#state(said ?? (track.site ? null : ofRow(track)));
    this.#models();
    this.#gate(said);
    this.#errors();
    this.#hops(track, said);
  }

  #facts(track) {
    const [x, y, z] = [track.x_m - track.origin[0], track.y_m - track.origin[1], track.z_m - track.origin[2]];
    this.facts.update({
      Range: distance(Math.hypot(x, y, Number.isFinite(z) ? z : 0)),
      Azimuth: angle(Math.atan2(x, y)),
      Height: quantity(track.z_m, "m"),
      Speed: quantity(track.speed, "m/s", 1),
      Course: angle(Math.atan2(track.vx_mps, track.vy_mps)),
      Existence: percent(track.existence, 2),
      SNR: quantity(track.snr_db, "dB", 1),
      Hits: number(track.hits),
      "Missed in a row": number(track.misses),
      Age: quantity(track.age_scans, "scans"),
      Updated: clock(track.time_s, 2),
      [track.site ? "Site" : "Sites"]: track.site || `${track.made_of.join(", ") || "none now"} (${track.sites === 1 ? "1 track" : `${track.sites} tracks`})`,
    });
  }

  /** After a jump nothing is said yet: what was said of another time goes. */
  #state(said) {
    const { state, sigma } = said ?? {};
    const cell = (key, digits) => {
      const value = state?.[key];
      if (!Number.isFinite(value)) return "–";
      return `${number(value, digits)} ± ${number(sigma?.[key], digits)}`;
    };
    this.state.update(
      AXES.map(([axis, name]) => [axis, [name, cell(axis, 1), cell(`v${axis}`, 1), cell(`a${axis}`, 2)]]),
    );
  }

  #models() {
    const { models: scans } = this.scene.selection;
    const latest = scans.at(-1)?.models ?? [];
    const { models } = this;
    models.canvas.hidden = scans.length === 0;
    if (scans.length > 0) {
      models.begin(this.scene.colours, scans[0].time_s, Math.max(scans.at(-1).time_s, scans[0].time_s + 1), 0, 1);
      latest.forEach((_, i) => {
        const points = scans.map((scan) => [scan.time_s, scan.models[i]?.probability ?? NaN]);
        models.line(points, MODEL_COLOURS[i % MODEL_COLOURS.length], DASHES[i % DASHES.length]);
      });
      models.describe(`Model probabilities over ${scans.length} scans`);
    }
    while (this.modelNames.children.length < latest.length) {
      const i = this.modelNames.children.length;
      this.modelNames.append(element("li", { "data-line": i % DASHES.length }, element("span"), " ", element("b")));
    }
    [...this.modelNames.children].forEach((item, i) => {
      item.hidden = !latest[i];
      if (!latest[i]) return;
      setText(item.children[0], words(latest[i].name));
      setText(item.children[1], percent(latest[i].probability));
    });
  }

  #gate(said) {
    if (!Number.isFinite(said?.gate?.in_gate)) {
      setText(this.gate, "");
      this.used.update([]);
      return;
    }
    const { gate, weight_none } = said;
    const kind = gate.kind ? `Gate: ${words(gate.kind)}` : "No gate";
    setText(this.gate, `${kind}, ${number(gate.in_gate)} plots in it. No plot is the track's: ${percent(weight_none, 1)}.`);
    const { scans, models } = this.scene.selection;
    const rows = [];
    [...scans].reverse().forEach((scan, ago) => {
      for (const plot of scan.used) {
        const known = plot.x_m !== null && plot.y_m !== null;
        const away = known ? Math.hypot(plot.x_m - scan.x, plot.y_m - scan.y) : NaN;
        const name = `${plot.seq}/${plot.index}`;
        const when = ago === 0 ? "last" : number(-ago);
        rows.push([rows.length, [name, when, percent(plot.weight, 1), gatesOf(plot.gates, models.at(-1)?.models), distance(away)]]);
      }
    });
    this.used.update(rows);
  }

  #errors() {
    const { selection, colours, picture } = this.scene;
    const site = picture.sites.get(selection.track.site)?.of;
    const samples = selection.errors.filter(({ error }) => error);
    const shown = samples.length > 0 || Boolean(site?.has_truth);
    this.errorTitle.hidden = this.errorBox.hidden = !shown;
    if (!shown) return;
    const last = samples.at(-1);
    setText(this.errorTitle, last ? `Errors against truth ${last.id}, with ±2σ` : "Errors against truth: no target near this track");
    AXES.forEach(([, name], axis) => {
      const [text, chart] = this.errors[axis];
      setText(text, last ? `${name} ${quantity(last.error[axis], "m", 1)}` : name);
      if (samples.length === 0) return;
      const most = Math.max(1, ...samples.map(({ error, sigma }) => Math.max(Math.abs(error[axis]) || 0, 2 * sigma[axis] || 0)));
      chart.begin(colours, samples[0].time_s, Math.max(last.time_s, samples[0].time_s + 1), -most, most);
      chart.band(samples.map(({ time_s, sigma }) => [time_s, -2 * sigma[axis], 2 * sigma[axis]]), "confirmed");
      chart.level(0, "soft");
      chart.line(samples.map(({ time_s, error }) => [time_s, error[axis]]), "coasting");
      chart.describe(`Error ${name.toLowerCase()}: ${number(last.error[axis], 1)} m, two standard errors ${number(2 * last.sigma[axis], 1)} m`);
    });
  }

  #hops(track, said) {
    const shown = this.latency.shown.get(track.stamps_us);
    // Of an update that is not yet on the screen, the way is not known to its end: that of the one before stays.
    if (shown || this.way?.key !== track.key) this.way = { key: track.key, hops: hopsOf(track.stamps_us, shown) };
    let { hops } = this.way;
    if (hops.length === 0) hops = Object.entries(said?.latency_us ?? {}).map(([name, us]) => [words(name), us]).filter(([, us]) => Number.isFinite(us));
    const total = hops.reduce((sum, [, us]) => sum + us, 0);
    const row = ([name, us]) => [name, [name, micros(us), bar(us / total)]];
    this.hops.update([...hops.map(row), ["all", ["all", micros(total), ""]]]);
  }
}

/** What its row says of the state of a system track. */
function ofRow({ x_m, y_m, z_m, vx_mps, vy_mps, vz_mps, var_xx, var_yy, var_zz }) {
  const sigma = { x: Math.sqrt(var_xx), y: Math.sqrt(var_yy), z: Math.sqrt(var_zz) };
  return { state: { x: x_m, y: y_m, z: z_m, vx: vx_mps, vy: vy_mps, vz: vz_mps }, sigma };
}

/** Names of the models in whose gates a plot lay. */
function gatesOf(bits, models) {
  if (bits === undefined) return "–";
  const names = [];
  for (let j = 0; j < 8; j += 1) if (bits & (1 << j)) names.push(words(models?.[j]?.name ?? `model ${j + 1}`));
  return names.length ? names.join(", ") : "none";
}

/** A share of the whole as a bar of text, which needs no style of its own. */
function bar(share) {
  return "▬".repeat(Math.max(0, Math.min(10, Math.round(10 * share))));
}

/** Short facts as pairs of a name and a value. */
class Facts {
  constructor() {
    this.list = element("dl", { class: "pairs" });
    this.values = new Map();
  }

  update(facts) {
    for (const [name, value] of this.values) value.parentElement.hidden = !(name in facts);
    for (const [name, text] of Object.entries(facts)) {
      let value = this.values.get(name);
      if (!value) {
        value = element("dd", { "data-fact": name });
        this.values.set(name, value);
        this.list.append(element("div", {}, element("dt", {}, name), value));
      }
      setText(value, text);
    }
  }
}
