// Text on the picture: letters from a texture, each with a rim in the colour of the ground.
//
// A canvas of its own for text would cost a software renderer 10 ms a frame at 1280 × 720; this costs one.

import { program, Records, RECORDS, texture } from "./gl.js";

// A record: left and top on the screen, left and top in the texture, width and height; device pixels; colour, rim.
const VERTEX = `
uniform vec2 u_size; // width and height of the part of the screen, device pixels
out vec2 v_at;
flat out vec4 v_colour;
${RECORDS}
const vec2 CORNERS[6] = vec2[6](vec2(0, 0), vec2(1, 0), vec2(0, 1), vec2(0, 1), vec2(1, 0), vec2(1, 1));
void main() {
  uvec4 first = word4(gl_VertexID / 6, 0), second = word4(gl_VertexID / 6, 1);
  vec2 corner = CORNERS[gl_VertexID % 6] * vec2(second.xy);
  vec2 at = uintBitsToFloat(first.xy) + corner;
  v_at = vec2(first.zw) + corner;
  v_colour = colour_of(second.z);
  gl_Position = vec4(at / u_size * vec2(2.0, -2.0) + vec2(-1.0, 1.0), 0.0, 1.0);
}`;

const FRAGMENT = `
in vec2 v_at;
flat in vec4 v_colour;
uniform sampler2D u_letters; // red: letter, green: letter with its rim
uniform vec3 u_rim;
out vec4 o_colour;
void main() {
  vec2 cover = texelFetch(u_letters, ivec2(v_at), 0).rg;
  float rim = max(cover.g, cover.r) * 0.85;
  float alpha = max(cover.r, rim);
  o_colour = vec4(mix(u_rim * alpha, v_colour.rgb, cover.r), alpha);
}`;

const FONT = "system-ui, sans-serif";
const SIDE = 512;
const RIM_PX = 2;

/** Sizes and weights by name. */
const TYPE = { label: "12px", strong: "600 12px", scale: "11px" };

export class Glyphs {
  constructor(gl) {
    this.gl = gl;
    this.of = program(gl, VERTEX, FRAGMENT);
    this.records = new Records(gl);
    const canvas = document.createElement("canvas");
    canvas.width = canvas.height = SIDE;
    this.context = canvas.getContext("2d", { willReadFrequently: true });
    this.texture = texture(gl, gl.RG8, SIDE, SIDE);
    this.resize(1);
  }

  /** Letters are drawn anew for another number of device pixels to one of CSS. */
  resize(ratio) {
    this.ratio = ratio;
    this.letters = new Map(Object.keys(TYPE).map((type) => [type, new Map()]));
    this.x = this.y = this.row = 0;
    this.context.clearRect(0, 0, SIDE, SIDE);
  }

  clear() {
    this.records.clear();
  }

  /** Width of a text in pixels of CSS. */
  width(text, type) {
    let width = 0;
    for (const letter of text) width += this.#letter(letter, type).advance;
    return width;
  }

  /** Writes a text; `y` is its middle, `align` one of left, center, right; pixels of CSS. */
  write(text, x, y, type, align, colour) {
    const { ratio, records } = this;
    let left = x;
    if (align !== "left") left -= this.width(text, type) * (align === "center" ? 0.5 : 1);
    for (const letter of text) {
      const of = this.#letter(letter, type);
      if (letter.trim() !== "") {
        const at = records.next();
        const { floats, words } = records;
        floats[at] = Math.round(left * ratio) - of.pad;
        floats[at + 1] = Math.round(y * ratio - of.height / 2);
        words[at + 2] = of.x;
        words[at + 3] = of.y;
        words[at + 4] = of.width;
        words[at + 5] = of.height;
        words[at + 6] = colour;
      }
      left += of.advance;
    }
  }

  draw({ pixels }, rim) {
    if (this.records.count === 0) return;
    const { gl, of } = this;
    gl.useProgram(of.program);
    gl.uniform2f(of.u_size, pixels[0], pixels[1]);
    gl.uniform3fv(of.u_rim, rim);
    gl.uniform1i(of.u_letters, 1);
    gl.activeTexture(gl.TEXTURE1);
    gl.bindTexture(gl.TEXTURE_2D, this.texture);
    if (this.fresh) this.#send();
    this.records.bind(of);
    gl.drawArrays(gl.TRIANGLES, 0, 6 * this.records.count);
  }

  #letter(letter, type) {
    const known = this.letters.get(type);
    return known.get(letter) ?? this.#add(letter, type, known);
  }

  #add(letter, type, known) {
    const { context, ratio } = this;
    context.font = `${TYPE[type].replace(/[\d]+px/, (size) => `${parseInt(size, 10) * ratio}px`)} ${FONT}`;
    const { width: advance } = context.measureText(letter);
    const pad = Math.ceil(RIM_PX * ratio);
    const width = Math.ceil(advance) + 2 * pad;
    const height = Math.ceil(17 * ratio);
    if (this.x + width > SIDE) {
      this.x = 0;
      this.y += height;
    }
    // A texture full of letters begins anew; what was written before comes out wrong for one drawing.
    if (this.y + height > SIDE) this.resize(ratio);
    context.textBaseline = "middle";
    context.lineJoin = "round";
    context.globalCompositeOperation = "lighter";
    const [x, y] = [this.x + pad, this.y + height / 2];
    context.lineWidth = 2 * RIM_PX * 0.8 * ratio;
    context.strokeStyle = "#00ff00";
    context.strokeText(letter, x, y);
    context.fillStyle = "#ff0000";
    context.fillText(letter, x, y);
    const of = { x: this.x, y: this.y, width, height, pad, advance: advance / ratio };
    this.x += width;
    known.set(letter, of);
    this.fresh = true;
    return of;
  }

  #send() {
    const { gl } = this;
    const { data } = this.context.getImageData(0, 0, SIDE, SIDE);
    const both = new Uint8Array(SIDE * SIDE * 2);
    for (let i = 0; i < SIDE * SIDE; i += 1) {
      both[2 * i] = data[4 * i];
      both[2 * i + 1] = data[4 * i + 1];
    }
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, SIDE, SIDE, gl.RG, gl.UNSIGNED_BYTE, both);
    this.fresh = false;
  }
}
