// The second view: ground range against height, from the antenna of one site.

import { distance, roundStep } from "./format.js";

const LEFT_PX = 48;
const BOTTOM_PX = 20;
const TOP_PX = 8;
const RIGHT_PX = 14;
const LEAST_TOP_M = 100;

export class Heights {
  constructor() {
    this.top_m = LEAST_TOP_M;
    this.range_m = 1000;
    this.foot = [0, 0];
  }

  /** Room for everything that flies, given back only when half of it is empty; says whether the axes have changed. */
  fit(site, picture) {
    if (!site) return false;
    const before = `${this.foot}/${this.range_m}/${this.top_m}`;
    this.foot = site.origin_m;
    this.range_m = site.range_max_m || 1000;
    let highest = LEAST_TOP_M / 1.2;
    for (const { z_m } of picture.tracks.values()) if (z_m > highest) highest = z_m;
    const top = roundStep(highest * 1.2);
    if (top > this.top_m || top < this.top_m / 2 || highest * 1.05 > this.top_m) this.top_m = top;
    return before !== `${this.foot}/${this.range_m}/${this.top_m}`;
  }

  /** The picture without its margins, pixels: left, top, width, height. */
  inner(width, height) {
    return [LEFT_PX, TOP_PX, Math.max(1, width - LEFT_PX - RIGHT_PX), Math.max(1, height - TOP_PX - BOTTOM_PX)];
  }

  place(width, height, ratio) {
    const [half_range, half_top] = [this.range_m / 2, this.top_m / 2];
    return {
      view: [half_range, half_top, half_range, half_top],
      heights: [this.foot[0], this.foot[1], 1],
      pixels: [width * ratio, height * ratio, ratio],
    };
  }

  /** Lines and numbers of the axes. */
  fillAxes(lines, width, height, colours, write) {
    const [left, top, w, h] = this.inner(width, height);
    const [x, y] = this.foot;
    const grid = colours.packed("ring");
    const up = roundStep((this.top_m * 32) / h);
    for (let z = 0; z <= this.top_m * 1.001; z += up) {
      lines.line(x, y, z, x, y + this.range_m, z, 1, grid);
      write(distance(z), left - 6, top + h - (z / this.top_m) * h, "right");
    }
    const along = roundStep((this.range_m * 90) / w);
    for (let r = along; r <= this.range_m * 1.001; r += along) {
      lines.line(x, y + r, 0, x, y + r, this.top_m, 1, grid);
      write(distance(r), left + (r / this.range_m) * w, top + h + 11, r > this.range_m * 0.97 ? "right" : "center");
    }
  }
}
