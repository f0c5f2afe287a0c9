// Range rings, azimuth scale, sites and the beam.

import { angle, distance, roundStep } from "./format.js";

/** Least distance between rings, pixels. */
const RING_PX = 75;
const TICK_PX = 6;
/** Distance of numbers from the edge of the picture, pixels. */
const INSET_PX = 14;

const rad = (degrees) => (degrees * Math.PI) / 180;

/** Lines of the scale; `main` is the site that the rings are about. */
export function fillScale(lines, sites, main, view, colours) {
  lines.clear();
  const ring = colours.packed("ring");
  for (const { of } of sites) {
    const [x, y] = of.origin_m;
    const cross = 5 / view.scale;
    lines.line(x - cross, y, 0, x + cross, y, 0, 1.2, colours.packed("scale"));
    lines.line(x, y - cross, 0, x, y + cross, 0, 1.2, colours.packed("scale"));
    if (of.range_max_m === 0) continue;
    const strong = of === main;
    lines.arc(x, y, of.range_max_m, 0, 2 * Math.PI, pieces(of.range_max_m * view.scale), strong ? 1.4 : -1.2, colours.packed("scale", strong ? 0.9 : 0.5));
  }
  if (!main?.range_max_m) return;
  const [x, y] = main.origin_m;
  for (const radius of ringsOf(main, view)) {
    lines.arc(x, y, radius, 0, 2 * Math.PI, pieces(radius * view.scale), 1, ring);
  }
  const rim = main.range_max_m;
  for (let degrees = 0; degrees < 360; degrees += 10) {
    const length = (degrees % 30 === 0 ? 2 : 1) * (TICK_PX / view.scale);
    const [s, c] = [Math.sin(rad(degrees)), Math.cos(rad(degrees))];
    lines.line(x + rim * s, y + rim * c, 0, x + (rim + length) * s, y + (rim + length) * c, 0, 1.2, colours.packed("scale"));
    if (degrees % 30 === 0) lines.line(x + 0.12 * rim * s, y + 0.12 * rim * c, 0, x + rim * s, y + rim * c, 0, 1, colours.packed("ring", 0.55));
  }
}

/** Numbers of the scale: calls `write(text, px, py, type)`. */
export function writeScale(main, sites, view, write) {
  if (!main?.range_max_m) return;
  const [x, y] = main.origin_m;
  const [ax, ay] = [view.screenX(x), view.screenY(y)];
  const inside = ax > 0 && ax < view.width && ay > 0 && ay < view.height;
  const ray = inside ? rad(45) : Math.atan2(view.x - x, view.y - y);
  for (const radius of [...ringsOf(main, view), main.range_max_m]) {
    const px = ax + radius * view.scale * Math.sin(ray);
    const py = ay - radius * view.scale * Math.cos(ray);
    if (radius < main.range_max_m * 0.97 || radius === main.range_max_m) write(distance(radius), px, py, "scale");
  }
  const rim = main.range_max_m * view.scale + 2 * TICK_PX + 11;
  for (let degrees = 0; inside && degrees < 360; degrees += 30) {
    const [s, c] = [Math.sin(rad(degrees)), -Math.cos(rad(degrees))];
    const border = Math.min(edge(ax, s, view.width), edge(ay, c, view.height));
    const at = Math.min(rim, border);
    if (at > 40) write(angle(rad(degrees)), ax + at * s, ay + at * c, "scale");
  }
  if (sites.length > 1) {
    for (const { of } of sites) write(of.name, view.screenX(of.origin_m[0]), view.screenY(of.origin_m[1]) + 16, "strong");
  }
}

/** Where the beam is, and the sector it is going through. */
export function fillBeam(lines, sites, colours, now_ms, steady) {
  lines.clear();
  for (const { of, beam } of sites) {
    if (Number.isNaN(beam.azimuth_rad)) continue;
    const [x, y] = of.origin_m;
    const azimuth = beam.azimuth_rad + (steady ? 0 : beam.progress(now_ms) * beam.sector_rad);
    const [s, c] = [Math.sin(azimuth), Math.cos(azimuth)];
    lines.line(x, y, 0, x + of.range_max_m * s, y + of.range_max_m * c, 0, 1.4, colours.packed("sweep", 0.75));
    lines.arc(x, y, of.range_max_m, beam.azimuth_rad, beam.azimuth_rad + beam.sector_rad, 6, 3, colours.packed("sweep", 0.9));
  }
}

function ringsOf(main, view) {
  const step = roundStep(RING_PX / view.scale);
  const n = Math.min(200, Math.floor((main.range_max_m * 0.999) / step));
  return Array.from({ length: n }, (_, i) => (i + 1) * step);
}

const pieces = (radius_px) => Math.min(360, Math.max(48, Math.round(radius_px / 6)));

/** Steps of the direction `slope` from `at` to the border of `0..size`. */
function edge(at, slope, size) {
  if (Math.abs(slope) < 1e-9) return Infinity;
  return (slope > 0 ? size - INSET_PX - at : at - INSET_PX) / Math.abs(slope);
}
