// Numbers of tracks, placed so that none covers another.

import { quantity } from "./format.js";

const LINE_PX = 13;
/** With more tracks than this in view labels keep a distance from each other, and have one place only. */
const CROWD = 300;
const DISTANCE_PX = 18;
/** Side of a cell of the grid in which labels claim their place, pixels. */
const CELL_PX = 6;
/** With fewer tracks than this in view each label also says speed and height. */
const FEW = 40;
const OFFSETS = [[12, -9], [12, 15], [-12, -9], [-12, 15]];

export class Labels {
  constructor() {
    this.taken = new Uint8Array(0);
    /** What was placed: `{track, px, py, lines}`. */
    this.placed = [];
  }

  /** Forgets all places. */
  begin(view) {
    this.columns = Math.ceil(view.width / CELL_PX) + 1;
    this.rows = Math.ceil(view.height / CELL_PX) + 1;
    if (this.taken.length < this.columns * this.rows) this.taken = new Uint8Array(this.columns * this.rows);
    else this.taken.fill(0);
    this.placed.length = 0;
  }

  /** Takes the place of another text with this middle. */
  reserve(px, py, width) {
    this.#claim(px - width / 2, py - LINE_PX / 2, width, LINE_PX);
  }

  /** Places labels: the chosen track first, then confirmed ones, then the others. */
  place({ picture, view, layers, selection, hovered }, glyphs) {
    if (!layers.labels) return;
    const inView = [];
    for (const [on, store] of [[layers.tracks, picture.tracks], [layers.system, picture.system]]) {
      if (!on) continue;
      for (const track of store.values()) {
        const [px, py] = [view.screenX(track.x_m), view.screenY(track.y_m)];
        if (px < 0 || py < 0 || px > view.width || py > view.height) continue;
        track.px = px;
        track.py = py;
        inView.push(track);
      }
    }
    const few = inView.length <= FEW;
    this.crowd = inView.length > CROWD;
    // A symbol keeps its place free, as long as there is room for labels at all.
    if (!this.crowd) for (const { px, py } of inView) this.#claim(px - 5, py - 5, 10, 10);
    const measure = (text) => glyphs.width(text, "label");
    for (const first of new Set([selection.track, hovered])) if (first && inView.includes(first)) this.#put(first, true, measure);
    for (const wanted of [1, 2, 0]) {
      for (const track of inView) {
        if (track.state === wanted && track !== selection.track && track !== hovered) this.#put(track, few, measure);
      }
    }
  }

  /** Writes what was placed. */
  write(glyphs, { colours, selection }) {
    const [chosen, text, soft] = ["chosen", "text", "soft"].map((name) => colours.packed(name));
    for (const { track, px, py, lines } of this.placed) {
      lines.forEach((line, i) => {
        const colour = i > 0 ? soft : track === selection.track ? chosen : text;
        glyphs.write(line, px, py + LINE_PX * (i + 0.5), "label", "left", colour);
      });
    }
  }

  #put(track, full, measure) {
    const first = OFFSETS[track.corner ?? 0];
    if (this.crowd && !this.#free(track.px + first[0], track.py + first[1], 1, 1)) return;
    const away = this.crowd ? DISTANCE_PX : 0;
    const tries = this.crowd ? [first] : [first, ...OFFSETS];
    for (const lines of full ? [textOf(track, true), textOf(track, false)] : [textOf(track, false)]) {
      const width = Math.max(...lines.map(measure));
      const height = LINE_PX * lines.length;
      for (const offset of tries) {
        const [dx, dy] = offset;
        const left = dx > 0 ? track.px + dx : track.px + dx - width;
        const top = dy < 0 ? track.py + dy - height + LINE_PX / 2 : track.py + dy - LINE_PX / 2;
        if (!this.#free(left, top, width, height)) continue;
        this.#claim(left - away, top - away, width + 2 * away, height + 2 * away);
        track.corner = OFFSETS.indexOf(offset);
        this.placed.push({ track, px: left, py: top, lines });
        return;
      }
    }
  }

  #free(left, top, width, height) {
    return !this.#cells(left, top, width, height, (at) => this.taken[at] === 1);
  }

  #claim(left, top, width, height) {
    this.#cells(left, top, width, height, (at) => {
      this.taken[at] = 1;
      return false;
    });
  }

  /** Whether `stop` says so of a cell of the rectangle. */
  #cells(left, top, width, height, stop) {
    const from = Math.max(0, Math.floor(left / CELL_PX));
    const to = Math.min(this.columns - 1, Math.floor((left + width) / CELL_PX));
    const last = Math.min(this.rows - 1, Math.floor((top + height) / CELL_PX));
    for (let row = Math.max(0, Math.floor(top / CELL_PX)); row <= last; row += 1) {
      for (let column = from; column <= to; column += 1) if (stop(row * this.columns + column)) return true;
    }
    return false;
  }
}

/** Number, and below it speed and height where there is room; made anew when the track has moved. */
function textOf(track, full) {
  track.short ??= [track.site === "" ? `S${track.id}` : track.label || String(track.id)];
  if (!full) return track.short;
  if (track.labelled !== track.time_s) {
    track.labelled = track.time_s;
    const height = Number.isFinite(track.z_m) ? `  ${quantity(track.z_m, "m")}` : "";
    track.full = [track.short[0], `${quantity(Math.hypot(track.vx_mps, track.vy_mps), "m/s")}${height}`];
  }
  return track.full;
}
