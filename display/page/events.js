// The log of events, and what of it is said aloud.

import { byId, element, setText } from "./element.js";
import { clock } from "./format.js";

/** Events that are kept, and those of them that are listed. */
const MOST = 5000;
const MOST_ROWS = 500;
/** Between two things said to a screen reader, ms: news, not a flood. */
const NEWS_MS = 4000;
const WORDS = { confirmed: "confirmed", ended: "ended", restart: "restart", over_budget: "over budget", warning: "warning", command: "command" };

export class Events {
  /**
   * @param {(event: object) => void} onChoose
   * @param {(text: string) => void} onTell shows it on the picture
   */
  constructor(onChoose, onTell) {
    Object.assign(this, { onChoose, onTell });
    this.list = byId("events");
    this.news = byId("news");
    /** Kinds that are not listed. */
    this.left_out = new Set();
    byId("event-kinds").append(...Object.entries(WORDS).map(([kind, words]) => this.#choice(kind, words)));
    this.clear();
  }

  /** The events of the kinds that are listed, oldest first. */
  get shown() {
    return this.left_out.size === 0 ? this.all : this.all.filter(({ kind }) => !this.left_out.has(kind));
  }

  clear() {
    this.all = [];
    this.last = -1;
    this.said_ms = -Infinity;
    this.unsaid = [];
    this.list.replaceChildren();
  }

  /** Begins anew, with what the server remembers of the time before this page. */
  async start() {
    this.clear();
    try {
      const answer = await fetch(`/api/v1/events${location.search || "?since=0"}`);
      const before = answer.ok ? await answer.json() : [];
      const since = this.all;
      this.clear();
      for (const event of [...before, ...since]) this.add(event);
      this.unsaid = [];
    } catch (error) {
      console.info(`earlier events are not known: ${error.message}`);
    }
  }

  add(event) {
    if (event.seq <= this.last) return;
    this.last = event.seq;
    this.all.push(event);
    if (this.all.length > MOST) this.all.shift();
    if (this.left_out.has(event.kind)) return;
    this.list.prepend(this.#row(event));
    if (this.list.children.length > MOST_ROWS) this.list.lastChild.remove();
    this.unsaid.push(event);
  }

  /** Says what is new, the last of several. */
  say(now_ms) {
    if (this.unsaid.length === 0 || now_ms - this.said_ms < NEWS_MS) return;
    const { length } = this.unsaid;
    const last = this.unsaid.at(-1);
    setText(this.news, length > 1 ? `${last.text}, and ${length - 1} more events` : last.text);
    this.unsaid = [];
    this.said_ms = now_ms;
  }

  /** Says at once what has come of a command. */
  tell(text) {
    setText(this.news, text);
    this.said_ms = performance.now();
    this.list.prepend(element("li", {}, element("time", {}, clock(Date.now() / 1000, 1)), element("span", { class: "kind" }, "here"), element("span", {}, text)));
    this.onTell(text);
  }

  /** Whether a kind is listed, as a check box. */
  #choice(kind, words) {
    const box = element("input", { type: "checkbox", checked: true });
    box.addEventListener("change", () => {
      if (box.checked) this.left_out.delete(kind);
      else this.left_out.add(kind);
      this.list.replaceChildren(...this.shown.slice(-MOST_ROWS).reverse().map((event) => this.#row(event)));
    });
    return element("label", { class: "check" }, box, ` ${words}`);
  }

  #row(event) {
    const kind = element("span", { class: "kind", "data-kind": event.kind }, WORDS[event.kind] ?? event.kind);
    const parts = [element("time", {}, clock(event.time_s, 1)), kind];
    if (event.track === undefined || event.track === null) parts.push(element("span", {}, event.text));
    else parts.push(element("button", { type: "button", class: "plain", onclick: () => this.onChoose(event) }, event.text));
    return element("li", {}, ...parts);
  }
}
