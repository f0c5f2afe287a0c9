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
const SHADES = 32;

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

  /** One point; a colour has red in its lowest byte. This is the inner loop: plain numbers only. */
  point(x, y, z, size, colour) {
    const { width, pixels, low, high } = this;
    let u = x;
    let v = y;
    if (this.foot) {
      const east = x - this.foot[0];
      const north = y - this.foot[1];
      u = Math.sqrt(east * east + north * north);
      v = z;
    }
    const left = Math.floor(u * this.scale_u + this.left);
    const bottom = Math.floor(v * this.scale_v + this.bottom);
    // False also for what is not a number: a radar without height has nothing to show there.
    if (!(left >= 0 && bottom >= 0 && left + size <= width && bottom + size <= this.height)) return;
    const first = bottom * width + left;
    for (let row = 0; row < size; row += 1) {
      for (let column = 0; column < size; column += 1) pixels[first + row * width + column] = colour;
    }
    if (left < low[0]) low[0] = left;
    if (bottom < low[1]) low[1] = bottom;
    if (left + size > high[0]) high[0] = left + size;
    if (bottom + size > high[1]) high[1] = bottom + size;
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

/**
 * The points of a ring, which fade to nothing in `life` seconds, by calls of `target.point`.
 * @param {{now: number, life: number, alpha: number, size: number, rgb: number[]}} how `alpha` of the youngest
 */
export function fadingPoints(ring, { now, life, alpha, size, rgb }, target) {
  const [r, g, b] = rgb.map((share) => Math.round(255 * share));
  for (let i = 0; i <= SHADES; i += 1) {
    const opacity = Math.round(255 * alpha * Math.min(1, (1.3 * i) / SHADES));
    shades[i] = ((opacity << 24) | (b << 16) | (g << 8) | r) >>> 0;
  }
  const { values } = ring;
  ring.runs(ring.first, ring.added, (from, count) => {
    for (let at = from * POINT; at < (from + count) * POINT; at += POINT) {
      const left = 1 - (now - values[at + 3]) / life;
      if (left > 0) target.point(values[at], values[at + 1], values[at + 2], size, shades[left < 1 ? Math.ceil(left * SHADES) : SHADES]);
    }
  });
}
