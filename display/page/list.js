// The list of tracks: everything that the picture shows, for keyboard and screen reader.

import { angle, distance, quantity } from "./format.js";
import { byId, element, setText } from "./element.js";
import { ENDED, STATES } from "./picture.js";

/** Rows that are shown; a search by number finds the others. */
const MOST_ROWS = 200;
/** A list of more tracks than this is sorted anew once a second. */
const MANY = 1000;
const MANY_MS = 1000;
/** Order by life state: confirmed, coasting, tentative. */
const RANK = [2, 0, 1, 3];

export class TrackList {
  constructor({ picture, selection }, onChoose) {
    Object.assign(this, { picture, selection, onChoose });
    this.box = byId("list");
    this.find = byId("find");
    this.note = byId("list-note");
    this.rows = [];
    this.shown = [];
    this.box.addEventListener("click", (event) => {
      const row = event.target.closest("[role=option]");
      if (row) onChoose(this.shown[this.rows.indexOf(row)]);
    });
    this.box.addEventListener("keydown", (event) => this.#key(event));
    this.find.addEventListener("input", () => this.update());
    this.find.addEventListener("keydown", (event) => {
      if (event.key === "Enter" && this.shown[0]) onChoose(this.shown[0]);
    });
  }

  /** Living tracks in the order of the list. */
  order() {
    const wanted = this.find.value.trim();
    const { tracks, system } = this.picture;
    // A track without hits is fused: the system track beside it says the same and more.
    const once = (track) => track.site === "" || system.size === 0 || !Number.isNaN(track.hits);
    const fits = (track) => [String(track.id), nameOf(track, false), track.label].some((name) => name.startsWith(wanted));
    const living = [...tracks.values(), ...system.values()].filter((track) => track.state !== ENDED && once(track) && fits(track));
    return living.sort((a, b) => RANK[a.state] - RANK[b.state] || (a.site < b.site ? -1 : a.site > b.site ? 1 : a.id - b.id));
  }

  /** The list anew; `soon` says that once a second will do. */
  update(soon = false) {
    const now_ms = performance.now();
    if (soon && this.picture.tracks.size > MANY && now_ms - this.updated_ms < MANY_MS) return;
    this.updated_ms = now_ms;
    const order = this.order();
    this.shown = order.slice(0, MOST_ROWS);
    const several = this.picture.sites.size > 1;
    while (this.rows.length < this.shown.length) this.#addRow();
    let active = "";
    this.rows.forEach((row, i) => {
      const track = this.shown[i];
      row.hidden = !track;
      if (!track) return;
      const chosen = track.key === this.selection.track?.key;
      if (chosen) active = row.id;
      const [x, y] = [track.x_m - track.origin[0], track.y_m - track.origin[1]];
      const cells = [
        nameOf(track, several),
        STATES[track.state],
        distance(Math.hypot(x, y)),
        angle(Math.atan2(x, y)),
        quantity(track.speed, "m/s"),
      ];
      cells.forEach((text, cell) => setText(row.children[cell], text));
      if (row.dataset.state !== STATES[track.state]) row.dataset.state = STATES[track.state];
      const selected = String(chosen);
      if (row.getAttribute("aria-selected") !== selected) row.setAttribute("aria-selected", selected);
    });
    if (active) this.box.setAttribute("aria-activedescendant", active);
    else this.box.removeAttribute("aria-activedescendant");
    setText(this.note, this.#words(order.length));
  }

  #words(n) {
    if (n > MOST_ROWS) return `${MOST_ROWS} of ${n} shown; type a number to find another.`;
    if (n > 0) return "";
    return this.find.value ? "No living track has this number." : "No tracks yet.";
  }

  #addRow() {
    const row = element("div", { role: "option", id: `row-${this.rows.length}`, "aria-selected": "false" });
    for (const name of ["name", "state", "range", "azimuth", "speed"]) row.append(element("span", { class: name }));
    this.rows.push(row);
    this.box.append(row);
  }

  #key(event) {
    const by = { ArrowDown: 1, ArrowUp: -1 }[event.key];
    const to = { Home: 0, End: this.shown.length - 1 }[event.key];
    if (by) this.selection.step(by, this.shown);
    else if (to !== undefined) this.onChoose(this.shown[to] ?? null);
    else return;
    event.preventDefault();
    this.update();
    this.rows[this.shown.indexOf(this.selection.track)]?.scrollIntoView({ block: "nearest" });
  }
}

/** What a track is called where there are several sites, or one. */
export function nameOf(track, several) {
  if (track.site === "") return `S${track.id}`;
  return `${several ? `${track.site} ` : ""}${track.label || track.id}`;
}
