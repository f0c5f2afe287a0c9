// Lines between points in space, with a width in pixels and soft edges.

import { PLACE, program, Records, RECORDS, use } from "./gl.js";

// A record: from (3), to (3), width, colour.
const VERTEX = `
uniform vec3 u_pixels; // width and height of the part of the screen, device pixels; device pixels to one of CSS
out vec4 v_colour;
out vec3 v_line;       // across, half of the width, along; device pixels
${PLACE}
${RECORDS}
const int CORNERS[6] = int[6](0, 1, 2, 2, 1, 3);
void main() {
  int corner = CORNERS[gl_VertexID % 6];
  uvec4 first = word4(gl_VertexID / 6, 0), second = word4(gl_VertexID / 6, 1);
  vec2 half_size = 0.5 * u_pixels.xy;
  vec2 from = place(uintBitsToFloat(first.xyz)), to = place(uintBitsToFloat(uvec3(first.w, second.xy)));
  if (from == NOWHERE || to == NOWHERE) {
    gl_Position = vec4(NOWHERE, 0.0, 1.0);
    return;
  }
  from *= half_size;
  to *= half_size;
  float width = uintBitsToFloat(second.z); // negative: dashed
  float length_px = max(distance(from, to), 1e-3);
  vec2 along = (to - from) / length_px;
  float half_width = 0.5 * abs(width) * u_pixels.z;
  float reach = half_width + 1.0;
  bool far = corner > 1;
  float side = (corner & 1) == 0 ? -reach : reach;
  vec2 at = (far ? to : from) + side * vec2(-along.y, along.x);
  gl_Position = vec4(at / half_size, 0.0, 1.0);
  v_colour = colour_of(second.w);
  v_line = vec3(side, half_width, width < 0.0 ? (far ? length_px : 0.0) / u_pixels.z : -1.0);
}`;

const FRAGMENT = `
in vec4 v_colour;
in vec3 v_line;
out vec4 o_colour;
void main() {
  float cover = clamp(v_line.y - abs(v_line.x) + 0.5, 0.0, 1.0);
  if (v_line.z >= 0.0 && mod(v_line.z, 8.0) > 4.5) cover = 0.0;
  float alpha = v_colour.a * cover;
  o_colour = vec4(v_colour.rgb * alpha, alpha);
}`;

export class StrokeProgram {
  constructor(gl) {
    this.gl = gl;
    this.of = program(gl, VERTEX, FRAGMENT);
  }

  batch() {
    return new Strokes(this.gl);
  }

  draw({ records }, place) {
    if (records.count === 0) return;
    const { gl, of } = this;
    use(gl, of, place);
    gl.uniform3fv(of.u_pixels, place.pixels);
    records.bind(of);
    gl.drawArrays(gl.TRIANGLES, 0, 6 * records.count);
  }
}

/** A set of lines that is filled and drawn together. */
class Strokes {
  constructor(gl) {
    this.records = new Records(gl);
  }

  clear() {
    this.records.clear();
  }

  /** From one point to another; `width` in pixels of CSS, negative for a dashed line. */
  line(ax, ay, az, bx, by, bz, width, colour) {
    const at = this.records.next();
    const { floats, words } = this.records;
    floats[at] = ax;
    floats[at + 1] = ay;
    floats[at + 2] = az;
    floats[at + 3] = bx;
    floats[at + 4] = by;
    floats[at + 5] = bz;
    floats[at + 6] = width;
    words[at + 7] = colour;
  }

  /** Part of a circle about a point on the ground, azimuths clockwise from north. */
  arc(x, y, radius, from_rad, to_rad, pieces, width, colour) {
    let [ax, ay] = [x + radius * Math.sin(from_rad), y + radius * Math.cos(from_rad)];
    for (let i = 1; i <= pieces; i += 1) {
      const azimuth = from_rad + ((to_rad - from_rad) * i) / pieces;
      const [bx, by] = [x + radius * Math.sin(azimuth), y + radius * Math.cos(azimuth)];
      this.line(ax, ay, 0, bx, by, 0, width, colour);
      [ax, ay] = [bx, by];
    }
  }

  /** Where `k` standard errors end, for these variances and covariance. */
  ellipse(x, y, var_xx, var_xy, var_yy, k, width, colour) {
    // Any square root of the covariance maps a circle to the ellipse: the lower triangular one is the shortest.
    const l11 = Math.sqrt(var_xx);
    const l21 = var_xy / l11;
    const l22 = Math.sqrt(Math.max(0, var_yy - l21 * l21));
    const pieces = 32;
    let [ax, ay] = [x + k * l11, y + k * l21];
    for (let i = 1; i <= pieces; i += 1) {
      const [c, s] = [Math.cos((2 * Math.PI * i) / pieces), Math.sin((2 * Math.PI * i) / pieces)];
      const [bx, by] = [x + k * l11 * c, y + k * (l21 * c + l22 * s)];
      this.line(ax, ay, 0, bx, by, 0, width, colour);
      [ax, ay] = [bx, by];
    }
  }
}
