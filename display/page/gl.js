// WebGL 2: programs, and how all of them put metres on the screen.

/** Part of every vertex shader: east, north, up → the screen, as a plan or as ground range and height. */
export const PLACE = `
uniform vec4 u_view;    // centre, half of the extent in m
uniform vec3 u_heights; // foot of the height picture; 1 if it is drawn, else 0
vec2 metres(vec3 p) {
  return u_heights.z > 0.5 ? vec2(length(p.xy - u_heights.xy), p.z) : p.xy;
}
vec2 place(vec3 p) {
  vec2 at = (metres(p) - u_view.xy) / u_view.zw;
  return any(isnan(at)) ? vec2(9.0) : at; // a radar without height has nothing to show there
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

/** Vertices that are written anew for each drawing, in a buffer that grows as needed. */
export class Batch {
  /** @param {number} stride of a record in words of four bytes */
  constructor(gl, stride) {
    this.gl = gl;
    this.stride = stride;
    this.buffer = gl.createBuffer();
    this.count = 0;
    this.#room(256);
  }

  #room(records) {
    const old = this.floats;
    this.capacity = records;
    this.floats = new Float32Array(records * this.stride);
    this.words = new Uint32Array(this.floats.buffer);
    if (old) this.floats.set(old);
  }

  clear() {
    this.count = 0;
    this.changed = true;
  }

  /** Index of the first word of a new record. */
  next() {
    if (this.count === this.capacity) this.#room(2 * this.capacity);
    this.changed = true;
    return this.count++ * this.stride;
  }

  /** Binds the buffer, and sends it if it has changed. */
  bind() {
    const { gl } = this;
    gl.bindBuffer(gl.ARRAY_BUFFER, this.buffer);
    if (!this.changed) return;
    gl.bufferData(gl.ARRAY_BUFFER, this.floats.subarray(0, this.count * this.stride), gl.DYNAMIC_DRAW);
    this.changed = false;
  }
}
