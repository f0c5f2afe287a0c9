// The chain as boxes joined by their topics.

import { element, setText, svg } from "./element.js";
import { number, percent, quantity } from "./format.js";

/** Where lines past other boxes run, from the edge, and how round they turn. */
const RAIL_PX = 8;
const BEND_PX = 6;

/** Processes of all sites from `status`, which has one level more where there are several sites. */
export function processesOf(status) {
  const flat = Object.values(status).some((of) => of && typeof of === "object" && "pid" in of);
  const sites = flat ? [["", status]] : Object.entries(status);
  return sites.flatMap(([site, processes]) => Object.entries(processes).map(([name, of]) => ({ site, name, key: site ? `${site}.${name}` : name, of })));
}

export class Stages {
  constructor(box) {
    this.box = box;
    this.wires = svg("svg", { "aria-hidden": "true" });
    this.cards = [];
    new ResizeObserver(() => this.#join()).observe(box);
  }

  /** Lays out the stages: a column for each step from the source. */
  lay(hello) {
    this.box.replaceChildren(this.wires);
    this.cards = [];
    const columns = new Map();
    for (const stage of hello.stages) {
      const column = depth(stage, hello.stages);
      if (!columns.has(column)) columns.set(column, element("div", { class: "column" }));
      const card = new Card(stage, hello);
      card.column = column;
      this.cards.push(card);
      columns.get(column).append(card.box);
    }
    for (const column of [...columns.keys()].sort((a, b) => a - b)) this.box.append(columns.get(column));
    this.#join();
  }

  update(processes, before) {
    for (const card of this.cards) {
      const found = processes.filter(({ site, name }) => name === card.stage.name && (!site || !card.stage.site || site === card.stage.site));
      const last = found.map(({ key }) => before.get(key)).filter(Boolean);
      card.update(together(found.map(({ of }) => of)), last.length === found.length ? together(last) : undefined);
    }
  }

  /** Lines from each stage to those that read its topics. */
  #join() {
    const whole = this.box.getBoundingClientRect();
    if (whole.width === 0) return;
    const edges = [];
    for (const from of this.cards) {
      for (const to of this.cards) {
        const topics = from.stage.outputs.filter((topic) => to.stage.inputs.includes(topic));
        if (topics.length > 0 && meets(from.stage, to.stage) && from !== to) edges.push(...edge(from, to, whole, topics));
      }
    }
    this.wires.setAttribute("viewBox", `0 0 ${whole.width} ${whole.height}`);
    this.wires.replaceChildren(...edges);
  }
}

/** What a process that serves all sites says of each, as one report; a process of one site says it once. */
function together(reports) {
  const [first, ...others] = reports;
  if (others.length === 0) return first;
  const merged = (key, both) => {
    const all = {};
    for (const report of reports) {
      for (const [topic, count] of Object.entries(report[key] ?? {})) all[topic] = topic in all ? both(all[topic], count) : count;
    }
    return all;
  };
  const sum = (a, b) => a + b;
  return { ...first, received: merged("received", sum), lost: merged("lost", sum), waiting: merged("waiting", Math.max) };
}

/** Steps from the source. */
function depth(stage, all, seen = []) {
  if (stage.inputs.length === 0 || seen.includes(stage)) return 0;
  const before = all.filter(
    (other) => other !== stage && !other.observer && meets(other, stage) && other.outputs.some((topic) => stage.inputs.includes(topic)),
  );
  return before.length ? 1 + Math.max(...before.map((other) => depth(other, all, [...seen, stage]))) : 0;
}

/** Whether what one stage sends comes to another: fusion reads all other sites. */
function meets(from, to) {
  if (to.name === "fusion") return from.site !== to.site;
  return !from.site || !to.site || from.site === to.site;
}

/** A line to the next column with the names of its topics; to columns further on above the boxes, for observers below. */
function edge(from, to, whole, topics) {
  const [a, b] = [from.box.getBoundingClientRect(), to.box.getBoundingClientRect()];
  const { observer } = to.stage;
  const kind = observer ? "observer" : "";
  if (to.column - from.column === 1 && !observer) {
    const [x0, y0] = [a.right - whole.left, a.top + a.height / 2 - whole.top];
    const [x1, y1] = [b.left - whole.left, b.top + b.height / 2 - whole.top];
    const middle = (x0 + x1) / 2;
    const name = svg("text", { x: middle, y: (y0 + y1) / 2 - 5 }, topics[0]);
    return [svg("path", { d: `M${x0} ${y0}C${middle} ${y0} ${middle} ${y1} ${x1} ${y1}`, class: kind }), ...(Math.abs(y1 - y0) < 40 ? [name] : [])];
  }
  const rail = observer ? whole.height - RAIL_PX : RAIL_PX;
  const [y0, y1] = (observer ? [a.bottom, b.bottom] : [a.top, b.top]).map((y) => y - whole.top);
  const [x0, x1] = [a.left + a.width / 2 - whole.left, b.left + b.width / 2 - whole.left];
  const turn = Math.sign(y0 - rail) * BEND_PX;
  return [svg("path", { d: `M${x0} ${y0}V${rail + turn}Q${x0} ${rail} ${x0 + BEND_PX} ${rail}H${x1 - BEND_PX}Q${x1} ${rail} ${x1} ${rail + turn}V${y1}`, class: kind })];
}

/** One stage: its condition, what it reads and sends, what it has lost. */
class Card {
  constructor(stage, { sites, queues }) {
    this.stage = stage;
    this.queues = queues;
    const title = sites.length > 1 && stage.site ? `${stage.site} ${stage.name}` : stage.name;
    this.state = element("span", { class: "condition" });
    this.facts = element("dl", { class: "pairs" });
    this.box = element("article", { class: stage.observer ? "stage-card observer" : "stage-card", "aria-label": title }, element("h3", {}, title), this.state, this.facts);
    this.values = new Map();
  }

  update(of, before) {
    const text = of ? (of.ended ? "ended" : of.condition) : "no report";
    setText(this.state, text);
    this.state.dataset.condition = text;
    if (!of) return;
    for (const topic of this.stage.inputs) {
      if (of.received?.[topic] === undefined) continue;
      const rate = perSecond(of, before, (at) => at.received?.[topic]);
      const lost = of.lost?.[topic] ?? 0;
      const [waiting, room] = [of.waiting?.[topic], this.queues[topic]];
      const queue = waiting === undefined ? "" : `, queue ${number(waiting)} of ${number(room)}`;
      this.#fact(`reads ${topic}`, `${rate}${queue}${lost ? `, ${number(lost)} lost` : ""}`, lost > 0 || waiting >= room);
    }
    // What an observer counts is for viewers and other systems, whatever topics it may publish.
    const sends = this.stage.observer ? "outside" : this.stage.outputs[0];
    if (sends) this.#fact(`sends ${sends}`, perSecond(of, before, (at) => at.messages_out));
    if (of.restarts > 0) this.#fact("restarts", number(of.restarts), true);
    this.#fact("CPU", percent(of.cpu_share));
    for (const [topic, observers] of Object.entries(of.observers ?? {})) {
      for (const [name, lost] of Object.entries(observers)) this.#fact(`${name} has missed`, `${number(lost)} ${topic}`, lost > 0);
    }
  }

  #fact(name, text, bad = false) {
    let value = this.values.get(name);
    if (!value) {
      value = element("dd");
      this.values.set(name, value);
      this.facts.append(element("div", {}, element("dt", {}, name), value));
    }
    setText(value, text);
    value.className = bad ? "bad" : "";
  }
}

/** Growth of a count between two reports of one session. */
function perSecond(now, before, count) {
  if (!before || before.session !== now.session || now.heartbeat_ns <= before.heartbeat_ns) return "–";
  const s = (now.heartbeat_ns - before.heartbeat_ns) / 1e9;
  return quantity((count(now) - count(before)) / s, "/s", 0);
}
