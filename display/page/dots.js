// Points that fade with their age, straight from a ring of points: plots and trails.

import { PLACE, program, use } from "./gl.js";
import { POINT } from "./ring.js";

const VERTEX = `
layout(location = 0) in vec4 a_point; // x, y, z, time
uniform vec4 u_fade;                  // now, life, opacity of the youngest, size in device pixels
out float v_alpha;
${PLACE}
void main() {
  float age = (u_fade.x - a_point.w) / u_fade.y;
  v_alpha = u_fade.z * clamp(1.3 * (1.0 - age), 0.0, 1.0);
  gl_Position = vec4(v_alpha > 0.0 ? place(a_point.xyz) : vec2(9.0), 0.0, 1.0);
  gl_PointSize = u_fade.w;
}`;

const FRAGMENT = `
in float v_alpha;
uniform vec3 u_colour;
out vec4 o_colour;
void main() {
  o_colour = vec4(u_colour * v_alpha, v_alpha);
}`;

export class DotProgram {
  constructor(gl) {
    this.gl = gl;
    this.of = program(gl, VERTEX, FRAGMENT);
  }

  /** The points of a ring on the graphics card. */
  of_ring(ring) {
    const { gl } = this;
    const dots = { ring, buffer: gl.createBuffer(), vao: gl.createVertexArray() };
    gl.bindVertexArray(dots.vao);
    gl.bindBuffer(gl.ARRAY_BUFFER, dots.buffer);
    gl.bufferData(gl.ARRAY_BUFFER, ring.values.byteLength, gl.DYNAMIC_DRAW);
    gl.vertexAttribPointer(0, 4, gl.FLOAT, false, POINT * 4, 0);
    gl.enableVertexAttribArray(0);
    gl.bindVertexArray(null);
    ring.uploaded = Math.max(0, ring.added - ring.capacity);
    return dots;
  }

  draw({ ring, buffer, vao }, place, { now, life, alpha, size, rgb }) {
    if (ring.first >= ring.added) return;
    const { gl, of } = this;
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    ring.runs(ring.uploaded, ring.added, (from, count) => {
      gl.bufferSubData(gl.ARRAY_BUFFER, from * POINT * 4, ring.values, from * POINT, count * POINT);
    });
    ring.uploaded = ring.added;
    use(gl, of, place);
    gl.uniform4f(of.u_fade, now, life, alpha, Math.max(1, Math.round(size * place.pixels[2])));
    gl.uniform3fv(of.u_colour, rgb);
    gl.bindVertexArray(vao);
    ring.runs(ring.first, ring.added, (from, count) => gl.drawArrays(gl.POINTS, from, count));
  }
}
