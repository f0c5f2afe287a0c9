// Many small points: written into an image here, drawn by the graphics card in one piece.
//
// A point costs a software renderer 1 µs as a point and 10 ns as a pixel; a hundred thousand of them are nothing special.

import { program, texture } from "./gl.js";
import { POINT } from "./ring.js";

const VERTEX = `
uniform vec4 u_box;   // left, bottom, right, top of the image on the screen, -1 to 1
uniform vec2 u_low;   // the same corner in the image, pixels
uniform vec2 u_high;
out vec2 v_at;
void main() {
  vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1);
  gl_Position = vec4(mix(u_box.xy, u_box.zw, corner), 0.0, 1.0);
  v_at = mix(u_low, u_high, corner);
}`;

const FRAGMENT = `
in vec2 v_at;
uniform sampler2D u_image;
out vec4 o_colour;
void main() {
  vec4 colour = texelFetch(u_image, ivec2(v_at), 0);
  o_colour = vec4(colour.rgb * colour.a, colour.a);
}`;

/** Steps in which a point fades. */
export const SHADES = 32;

export class DotProgram {
  constructor(gl) {
    this.gl = gl;
    this.of = program(gl, VERTEX, FRAGMENT);
  }

  image() {
    return new Dots(this.gl);
  }

  draw(dots) {
    const { width, height, low, high } = dots;
    if (high[0] <= low[0]) return;
    const { gl, of } = this;
    gl.useProgram(of.program);
    dots.bind();
    gl.uniform1i(of.u_image, 0);
    gl.uniform2f(of.u_low, low[0], low[1]);
    gl.uniform2f(of.u_high, high[0], high[1]);
    gl.uniform4f(of.u_box, (2 * low[0]) / width - 1, (2 * low[1]) / height - 1, (2 * high[0]) / width - 1, (2 * high[1]) / height - 1);
    gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
  }
}

/** The image of one part of the screen, the lower left pixel first. */
class Dots {
  constructor(gl) {
    this.gl = gl;
    this.resize(1, 1);
  }

  /** In device pixels. */
  resize(width, height) {
    const { gl } = this;
    this.width = Math.max(1, Math.round(width));
    this.height = Math.max(1, Math.round(height));
    this.pixels = new Uint32Array(this.width * this.height);
    this.bytes = new Uint8Array(this.pixels.buffer);
    gl.deleteTexture(this.texture ?? null);
    this.texture = texture(gl, gl.RGBA8, this.width, this.height);
    this.low = [this.width, this.height];
    this.high = [0, 0];
  }

  /** An empty image that is filled for this place. */
  begin(place) {
    const { low, high, width } = this;
    if (high[1] > low[1]) this.pixels.fill(0, low[1] * width, high[1] * width);
    [low[0], low[1], high[0], high[1]] = [this.width, this.height, 0, 0];
    const { view, heights } = place;
    this.foot = heights[2] ? heights : null;
    this.scale_u = this.width / 2 / view[2];
    this.scale_v = this.height / 2 / view[3];
    this.left = this.width / 2 - view[0] * this.scale_u - 1;
    this.bottom = this.height / 2 - view[1] * this.scale_v - 1;
    this.changed = true;
  }

  /** Points of a ring from one place in it to another. This is the inner loop: plain numbers only, and no calls. */
  points(values, from, to, { now, life, size, shades }) {
    const { width, pixels, low, high, scale_u, scale_v, left: left_of, bottom: bottom_of } = this;
    const sideways = this.foot !== null;
    const east_of = sideways ? this.foot[0] : 0;
    const north_of = sideways ? this.foot[1] : 0;
    const most_left = width - size;
    const most_bottom = this.height - size;
    let low_u = low[0];
    let low_v = low[1];
    let high_u = high[0] - size;
    let high_v = high[1] - size;
    for (let at = from * POINT; at < to * POINT; at += POINT) {
      const young = 1 - (now - values[at + 3]) / life;
      let u = values[at];
      let v = values[at + 1];
      if (sideways) {
        u -= east_of;
        v -= north_of;
        u = Math.sqrt(u * u + v * v);
        v = values[at + 2];
      }
      const left = Math.floor(u * scale_u + left_of);
      const bottom = Math.floor(v * scale_v + bottom_of);
      // False also for what is not a number: a radar without height has nothing to show there.
      if (!(young > 0 && left >= 0 && bottom >= 0 && left <= most_left && bottom <= most_bottom)) continue;
      const colour = shades[young < 1 ? Math.ceil(young * SHADES) : SHADES];
      const first = bottom * width + left;
      if (size === 1) {
        pixels[first] = colour;
      } else {
        for (let row = 0; row < size; row += 1) {
          for (let column = 0; column < size; column += 1) pixels[first + row * width + column] = colour;
        }
      }
      if (left < low_u) low_u = left;
      if (bottom < low_v) low_v = bottom;
      if (left > high_u) high_u = left;
      if (bottom > high_v) high_v = bottom;
    }
    [low[0], low[1], high[0], high[1]] = [low_u, low_v, high_u + size, high_v + size];
  }

  /** Binds the texture to unit 0, and sends the rows that hold anything. */
  bind() {
    const { gl, low, high, width } = this;
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, this.texture);
    if (!this.changed) return;
    this.changed = false;
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 4);
    gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, low[1], width, high[1] - low[1], gl.RGBA, gl.UNSIGNED_BYTE, this.bytes, low[1] * width * 4);
  }
}

const shades = new Uint32Array(SHADES + 1);

/** The points of a ring in one colour, which has red in its lowest byte. */
export function steadyPoints(ring, size, colour, target) {
  const how = { now: 0, life: Infinity, size, shades: shades.fill(colour) };
  ring.runs(ring.first, ring.added, (from, count) => target.points(ring.values, from, from + count, how));
}

/**
 * The points of a ring, which fade to nothing in `life` seconds, by calls of `target.points`.
 * @param {{now: number, life: number, alpha: number, size: number, rgb: number[]}} how `alpha` of the youngest
 */
export function fadingPoints(ring, { now, life, alpha, size, rgb }, target) {
  const [r, g, b] = rgb.map((share) => Math.round(255 * share));
  for (let i = 0; i <= SHADES; i += 1) {
    const opacity = Math.round(255 * alpha * Math.min(1, (1.3 * i) / SHADES));
    shades[i] = ((opacity << 24) | (b << 16) | (g << 8) | r) >>> 0;
  }
  const how = { now, life, size, shades };
  ring.runs(ring.since(now - life), ring.added, (from, count) => target.points(ring.values, from, from + count, how));
}
