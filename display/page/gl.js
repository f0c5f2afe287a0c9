// WebGL 2: programs, and how all of them put metres on the screen.

/** Part of every vertex shader: east, north, up → the screen, as a plan or as ground range and height. */
export const PLACE = `
uniform vec4 u_view;    // centre, half of the extent in m
uniform vec3 u_heights; // foot of the height picture; 1 if it is drawn, else 0
vec2 metres(vec3 p) {
  return u_heights.z > 0.5 ? vec2(length(p.xy - u_heights.xy), p.z) : p.xy;
}
const vec2 NOWHERE = vec2(9.0);
vec2 place(vec3 p) {
  vec2 at = (metres(p) - u_view.xy) / u_view.zw;
  return any(isnan(at)) ? NOWHERE : at; // a radar without height has nothing to show there
}
`;

/** Compiles and links; attributes are bound by their `layout`. */
export function program(gl, vertex, fragment) {
  const made = gl.createProgram();
  for (const [kind, source] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, `#version 300 es\nprecision highp float;\nprecision highp int;\n${source}`);
    gl.compileShader(shader);
    gl.attachShader(made, shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS) && !gl.isContextLost()) {
      throw new Error(`shader: ${gl.getShaderInfoLog(shader)}`);
    }
  }
  gl.linkProgram(made);
  const uniforms = {};
  for (let i = 0; i < (gl.getProgramParameter(made, gl.ACTIVE_UNIFORMS) ?? 0); i += 1) {
    const { name } = gl.getActiveUniform(made, i);
    uniforms[name] = gl.getUniformLocation(made, name);
  }
  return { program: made, ...uniforms };
}

/** Makes the program current and tells it where metres are. */
export function use(gl, of, place) {
  gl.useProgram(of.program);
  gl.uniform4fv(of.u_view, place.view);
  gl.uniform3fv(of.u_heights, place.heights);
}

/** Words of four bytes in a record, and records in a row of the texture that holds them. */
const RECORD = 8;
const IN_ROW = 512;

/** Part of a vertex shader: record `n` as two times four words. */
export const RECORDS = `
uniform highp usampler2D u_records;
uvec4 word4(int n, int half_of) {
  return texelFetch(u_records, ivec2((n % ${IN_ROW}) * 2 + half_of, n / ${IN_ROW}), 0);
}
vec4 colour_of(uint packed) {
  return vec4(packed & 255u, (packed >> 8) & 255u, (packed >> 16) & 255u, packed >> 24) / 255.0;
}
`;

/**
 * Things to draw, eight words each, which a vertex shader fetches by its vertex number.
 *
 * A texture and not attributes of instances: a software renderer draws each instance by itself, which takes 30 µs.
 */
export class Records {
  constructor(gl) {
    this.gl = gl;
    this.count = 0;
    this.#room(IN_ROW);
  }

  #room(records) {
    const { gl, floats: old } = this;
    this.capacity = records;
    this.floats = new Float32Array(records * RECORD);
    this.words = new Uint32Array(this.floats.buffer);
    if (old) this.words.set(new Uint32Array(old.buffer));
    gl.deleteTexture(this.texture ?? null);
    this.texture = texture(gl, gl.RGBA32UI, (IN_ROW * RECORD) / 4, records / IN_ROW);
  }

  clear() {
    this.count = 0;
    this.changed = true;
  }

  /** Index of the first word of a new record. */
  next() {
    if (this.count === this.capacity) this.#room(2 * this.capacity);
    this.changed = true;
    return this.count++ * RECORD;
  }

  /** Binds the texture to unit 0, and sends it if it has changed. */
  bind(of) {
    const { gl } = this;
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, this.texture);
    gl.uniform1i(of.u_records, 0);
    if (!this.changed) return;
    this.changed = false;
    const rows = Math.ceil(this.count / IN_ROW);
    gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, (IN_ROW * RECORD) / 4, rows, gl.RGBA_INTEGER, gl.UNSIGNED_INT, this.words);
  }
}

/** A texture without filters. */
export function texture(gl, format, width, height) {
  const made = gl.createTexture();
  gl.bindTexture(gl.TEXTURE_2D, made);
  gl.texStorage2D(gl.TEXTURE_2D, 1, format, width, height);
  for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, filter, gl.NEAREST);
  for (const wrap of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, wrap, gl.CLAMP_TO_EDGE);
  return made;
}
