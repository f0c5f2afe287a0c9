// Symbols of a size in pixels: the form says what a thing is, also without colour.

import { SHADES } from "./dots.js";
import { PLACE, program, Records, RECORDS, use } from "./gl.js";
import { POINT } from "./ring.js";

/** Forms by their number in the shader. */
export const MARK = { tentative: 0, confirmed: 1, coasting: 2, ended: 3, truth: 4, system: 5, used: 6, chosen: 7, dot: 8 };
/** Form of a track by the number of its life state. */
export const OF_STATE = [MARK.tentative, MARK.confirmed, MARK.coasting, MARK.ended];

// A record: place (3), size, form, colour.
const VERTEX = `
uniform float u_ratio; // device pixels to one of CSS
out vec4 v_colour;
flat out float v_size;
flat out int v_form;
${PLACE}
${RECORDS}
void main() {
  uvec4 first = word4(gl_VertexID, 0), second = word4(gl_VertexID, 1);
  gl_Position = vec4(place(uintBitsToFloat(first.xyz)), 0.0, 1.0);
  v_size = uintBitsToFloat(first.w) * u_ratio;
  gl_PointSize = v_size;
  v_form = int(second.x);
  v_colour = colour_of(second.y);
}`;

// Each form is a distance in pixels from a line of the drawing, and half of the width of that line.
const FRAGMENT = `
in vec4 v_colour;
flat in float v_size;
flat in int v_form;
uniform float u_ratio;
out vec4 o_colour;
void main() {
  vec2 p = (gl_PointCoord - 0.5) * v_size;
  vec2 q = abs(p);
  float r = 0.5 * v_size - 1.5 * u_ratio;
  float pen = 0.75 * u_ratio;
  float d;
  if (v_form == 0) d = abs((q.x + q.y - r) * 0.7071);                        // diamond
  else if (v_form == 1) d = max(length(p) - 0.85 * r, 0.0);                  // disc
  else if (v_form == 2) d = abs(max(q.x, q.y) - 0.75 * r);                   // square
  else if (v_form == 3) d = max(abs(q.x - q.y) * 0.7071, max(q.x, q.y) - 0.8 * r); // cross
  else if (v_form == 4) d = max(min(q.x, q.y), max(q.x, q.y) - r);           // plus
  else if (v_form == 5) d = abs(max(q.x * 0.866 + q.y * 0.5, q.y) - 0.86 * r); // hexagon
  else if (v_form == 6) d = abs(length(p) - r);                              // circle
  else if (v_form == 7) d = max(abs(max(q.x, q.y) - r), 0.55 * r - min(q.x, q.y)); // corners
  else d = 0.0;                                                              // dot
  float cover = clamp(pen - d + 0.5, 0.0, 1.0);
  float alpha = v_colour.a * cover;
  o_colour = vec4(v_colour.rgb * alpha, alpha);
}`;

export class MarkProgram {
  constructor(gl) {
    this.gl = gl;
    this.of = program(gl, VERTEX, FRAGMENT);
  }

  batch() {
    return new Marks(this.gl);
  }

  draw({ records }, place) {
    if (records.count === 0) return;
    const { gl, of } = this;
    use(gl, of, place);
    gl.uniform1f(of.u_ratio, place.pixels[2]);
    records.bind(of);
    gl.drawArrays(gl.POINTS, 0, records.count);
  }
}

/** A set of symbols that is filled and drawn together. */
class Marks {
  constructor(gl) {
    this.records = new Records(gl);
  }

  clear() {
    this.records.clear();
  }

  /** A form at a point; `size` in pixels of CSS. */
  mark(x, y, z, size, form, colour) {
    const at = this.records.next();
    const { floats, words } = this.records;
    floats[at] = x;
    floats[at + 1] = y;
    floats[at + 2] = z;
    floats[at + 3] = size;
    words[at + 4] = form;
    words[at + 5] = colour;
  }

  /** Points of a ring as square dots. */
  points(values, from, to, { now, life, size, shades }) {
    for (let at = from * POINT; at < to * POINT; at += POINT) {
      const young = Math.min(1, 1 - (now - values[at + 3]) / life);
      if (young > 0) this.mark(values[at], values[at + 1], values[at + 2], size, MARK.dot, shades[Math.ceil(young * SHADES)]);
    }
  }
}
