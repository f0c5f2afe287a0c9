// Tracks, truth and errors as symbols and lines, for the plan and for the picture of heights.

import { steadyPoints } from "./dots.js";
import { MARK, OF_STATE } from "./marks.js";
import { ENDED, STATES } from "./picture.js";
import { POINT, Ring } from "./ring.js";

/** Speed vectors reach to where a target will be after so many scans. */
const VECTOR_SCANS = 10;
/** A standard error times this bounds 95 % of a plane. */
const ELLIPSE_SIGMAS = Math.sqrt(5.991);
/** An ellipse or error bar shorter than this says nothing, pixels. */
const SMALLEST_PX = 3;
/** More plots in view than this show no error bars: they would cover everything else. */
const MOST_BARS = 600;
const MOST_ELLIPSES = 1500;
const MARGIN_PX = 40;
/** Symbols cover at most this share of the picture: more of them are smaller ones. */
const SHARE = 0.06;
const LARGEST_PX = 11;
/** Smaller than this a symbol has no form: it is a dot in its colour. */
const SMALLEST_FORM_PX = 6;
/** Smaller symbols than this have no speed vector: there are too many of them. */
const SMALLEST_VECTOR_PX = 8;
/** Of more than this, tracks outside the plan are dots in the picture of heights, and targets are left out. */
const MANY = 300;
const DOT_PX = 3;
/** More dots of one colour than this are not drawn. */
const MOST_DOTS = 1 << 16;

export class Symbols {
  constructor(strokes, marks) {
    this.lines = strokes.batch();
    this.heightLines = strokes.batch();
    this.marks = marks.batch();
    /** Tracks that are dots, by their colour. */
    this.dots = new Map();
  }

  /** Everything anew, for what is inside the view; dots go into the images. */
  fill({ picture, view, colours, layers, selection, hovered, zones, draft }, images, ratio) {
    Object.assign(this, { picture, view, colours, layers, images });
    this.lines.clear();
    this.heightLines.clear();
    this.marks.clear();
    for (const dots of this.dots.values()) dots.clear();
    this.ellipses = 0;
    const reach_x = (view.width / 2 + MARGIN_PX) / view.scale;
    const reach_y = (view.height / 2 + MARGIN_PX) / view.scale;
    this.sees = (x, y) => Math.abs(x - view.x) < reach_x && Math.abs(y - view.y) < reach_y;
    this.size = this.#size();
    this.dot = Math.round(DOT_PX * ratio);
    this.#zones(zones, draft);
    if (layers.errors && layers.plots) this.#bars();
    if (layers.truth && this.size >= SMALLEST_FORM_PX) this.#truth();
    this.#used(selection);
    this.#gate(selection);
    if (layers.system) {
      for (const track of picture.system.values()) this.#track(track, "system", MARK.system, this.size + 4);
    }
    if (layers.tracks) {
      for (const track of picture.tracks.values()) this.#track(track, STATES[track.state], OF_STATE[track.state], this.size);
    }
    for (const [colour, dots] of this.dots) {
      for (const image of images) steadyPoints(dots, this.dot, colours.packed(colour), image);
    }
    if (hovered) this.marks.mark(hovered.x_m, hovered.y_m, hovered.z_m, 22, MARK.chosen, colours.packed("chosen", 0.5));
    const { track } = selection;
    if (track) this.marks.mark(track.x_m, track.y_m, track.z_m, 24, MARK.chosen, colours.packed("chosen"));
  }

  /** Size of a symbol such that all of them leave something to be seen. */
  #size() {
    const { picture: { tracks }, view } = this;
    let n = 0;
    for (const { x_m, y_m } of tracks.values()) if (this.sees(x_m, y_m)) n += 1;
    return Math.min(LARGEST_PX, Math.sqrt((SHARE * view.width * view.height) / Math.max(1, n)));
  }

  #track(track, colour, form, size) {
    const { lines, heightLines, layers, picture, view } = this;
    const { x_m: x, y_m: y, z_m: z } = track;
    if (size < SMALLEST_FORM_PX || (picture.tracks.size > MANY && !this.sees(x, y))) {
      let dots = this.dots.get(colour);
      if (!dots) this.dots.set(colour, (dots = new Ring(MOST_DOTS)));
      dots.add(x, y, z, 0);
      return;
    }
    const packed = this.colours.packed(colour, track.state === 0 ? 0.8 : 1);
    this.marks.mark(x, y, z, size, form, packed);
    if (track.state === ENDED) return;
    if (layers.vectors && size >= SMALLEST_VECTOR_PX) {
      const ahead = VECTOR_SCANS * picture.scan_s;
      const { vx_mps: vx, vy_mps: vy, vz_mps: vz } = track;
      lines.line(x, y, 0, x + ahead * vx, y + ahead * vy, 0, 1.3, packed);
      heightLines.line(x, y, z, x + ahead * vx, y + ahead * vy, z + ahead * vz, 1.3, packed);
    }
    if (layers.ellipses && this.ellipses < MOST_ELLIPSES && this.sees(x, y)) {
      const widest_px = ELLIPSE_SIGMAS * Math.sqrt(Math.max(track.var_xx, track.var_yy)) * view.scale;
      if (widest_px > SMALLEST_PX + size / 2) {
        const dash = track.state === 2 ? -1.2 : 1.2;
        lines.ellipse(x, y, track.var_xx, track.var_xy, track.var_yy, ELLIPSE_SIGMAS, dash, this.colours.packed(colour, 0.65));
        this.ellipses += 1;
      }
      const dz = 2 * Math.sqrt(track.var_zz);
      if (dz > 0) heightLines.line(x, y, z - dz, x, y, z + dz, 1.3, this.colours.packed(colour, 0.55));
    }
  }

  /** One standard error to each side, along and across the line of sight. */
  #bars() {
    const { picture: { plots }, lines, view, colours } = this;
    const { values } = plots;
    const colour = colours.packed("plot", 0.7);
    const inView = [];
    for (let n = plots.first; n < plots.added; n += 1) {
      const at = (n % plots.capacity) * POINT;
      if (Math.max(values[at + 4], values[at + 5]) * view.scale < SMALLEST_PX || !this.sees(values[at], values[at + 1])) continue;
      if (inView.length === MOST_BARS) return;
      inView.push(at);
    }
    for (const at of inView) {
      const [x, y, along, across] = [values[at], values[at + 1], values[at + 4], values[at + 5]];
      const [s, c] = [Math.sin(values[at + 6]), Math.cos(values[at + 6])];
      lines.line(x - along * s, y - along * c, 0, x + along * s, y + along * c, 0, 1, colour);
      lines.line(x - across * c, y + across * s, 0, x + across * c, y - across * s, 0, 1, colour);
    }
  }

  /** Zones of the operator, and the one that is being drawn. */
  #zones(zones, draft) {
    const { lines, colours } = this;
    const outline = (corners, closed, width, colour) => {
      corners.forEach(([x, y], i) => {
        const next = corners[i + 1] ?? (closed ? corners[0] : null);
        if (next) lines.line(x, y, 0, next[0], next[1], 0, width, colour);
      });
    };
    for (const { kind, polygon_m } of zones) {
      const exclusion = kind === "exclusion";
      outline(polygon_m, true, exclusion ? 1.6 : -1.6, colours.packed(exclusion ? "coasting" : "confirmed"));
    }
    outline(draft, false, 1.6, colours.packed("chosen"));
    for (const [x, y] of draft) this.marks.mark(x, y, NaN, 8, MARK.used, colours.packed("chosen"));
  }

  #truth() {
    const colour = this.colours.packed("truth");
    const { targets } = this.picture.truth;
    for (const { last } of targets.values()) {
      if (targets.size > MANY && !this.sees(last.x_m, last.y_m)) continue;
      this.marks.mark(last.x_m, last.y_m, last.z_m, 13, MARK.truth, colour);
    }
  }

  /** The plots that have moved the chosen track in its last scans. */
  #used({ track, scans }) {
    if (!track || !this.layers.used) return;
    const { marks, lines, heightLines, colours } = this;
    scans.forEach((scan, i) => {
      const fresh = (i + 1) / scans.length;
      for (const { x_m, y_m, z_m, weight } of scan.used) {
        if (x_m === null || y_m === null) continue;
        const colour = colours.packed("used", 0.2 + 0.6 * fresh * fresh);
        const z = z_m ?? NaN;
        marks.mark(x_m, y_m, z, 6 + 7 * weight, MARK.used, colour);
        const thick = 0.5 + 1.5 * weight;
        lines.line(x_m, y_m, 0, scan.x, scan.y, 0, thick, colour);
        heightLines.line(x_m, y_m, z, scan.x, scan.y, scan.z, thick, colour);
      }
    });
  }

  /** Where plots of the chosen track were looked for by its last update. */
  #gate({ track, said }) {
    const region = track && said?.gate.region;
    if (!region || !this.layers.gate) return;
    const { lines, colours, picture } = this;
    const [x, y] = picture.sites.get(track.site).of.origin_m;
    const ground = Math.cos(region.elevation_rad);
    const [near, far] = [region.range_from_m * ground, region.range_to_m * ground];
    const [from, to] = [region.azimuth_from_rad, region.azimuth_to_rad];
    const colour = colours.packed("used");
    for (const range of [near, far]) lines.arc(x, y, range, from, to, 12, 1.4, colour);
    for (const azimuth of [from, to]) {
      const [s, c] = [Math.sin(azimuth), Math.cos(azimuth)];
      lines.line(x + near * s, y + near * c, 0, x + far * s, y + far * c, 0, 1.4, colour);
    }
  }
}
