// Radar video: a texture of lines by ranges for each site, drawn as wedges, with afterglow.

import { PLACE, program, use } from "./gl.js";

const VERTEX = `
uniform sampler2D u_lines;  // one texel a line: its time, or a negative number
uniform vec4 u_site;        // antenna east and north, first range, last range
uniform vec3 u_glow;        // now, time constant, shortest visible part
uniform float u_count;      // lines in a full circle
out float v_range;          // 0 to 1
flat out float v_line;
flat out float v_glow;
${PLACE}
void main() {
  float time = texelFetch(u_lines, ivec2(0, gl_InstanceID), 0).r;
  v_glow = time < 0.0 ? 0.0 : exp(-max(0.0, u_glow.x - time) / u_glow.y);
  v_line = (float(gl_InstanceID) + 0.5) / u_count;
  v_range = float(gl_VertexID >> 1);
  float azimuth = 6.283185307 * (float(gl_InstanceID) + float(gl_VertexID & 1)) / u_count;
  float range = mix(u_site.z, u_site.w, v_range);
  vec2 at = u_site.xy + range * vec2(sin(azimuth), cos(azimuth));
  gl_Position = vec4(v_glow > u_glow.z ? place(vec3(at, 0.0)) : vec2(9.0), 0.0, 1.0);
}`;

const FRAGMENT = `
in float v_range;
flat in float v_line;
flat in float v_glow;
uniform sampler2D u_level;
uniform vec2 u_contrast;    // level that is black, one over the levels up to full
uniform vec3 u_weak, u_strong;
out vec4 o_colour;
void main() {
  float level = clamp((texture(u_level, vec2(v_range, v_line)).r - u_contrast.x) * u_contrast.y, 0.0, 1.0);
  float alpha = level * v_glow;
  o_colour = vec4(mix(u_weak, u_strong, level * level) * alpha, alpha);
}`;

/** Lines of a scan whose step is not known better than this many. */
const MOST_LINES = 4096;
const AFTERGLOW_SCANS = 0.9;
/** dB over the middle of what is received at which video begins, and from there to full brightness. */
const FLOOR_DB = 3.0;
const SPAN_DB = 18.0;

export class VideoProgram {
  constructor(gl) {
    this.gl = gl;
    this.of = program(gl, VERTEX, FRAGMENT);
    this.vao = gl.createVertexArray();
    /** Textures by site. */
    this.sites = new Map();
  }

  clear() {
    for (const screen of this.sites.values()) screen.clear();
  }

  /** Takes the lines of one sector; `time` in s since the picture began. */
  add(message, time) {
    const { gl } = this;
    let screen = this.sites.get(message.site);
    const lines = Math.min(MOST_LINES, Math.round((2 * Math.PI) / Math.abs(message.azimuth_step_rad)));
    if (!screen?.fits(lines, message)) {
      screen?.drop();
      screen = new Screen(gl, lines, message);
      this.sites.set(message.site, screen);
    }
    screen.add(message, time);
  }

  /** @param {object} how now, scan_s, gain_db, colours, `steady` without afterglow */
  draw(site, place, how) {
    const screen = this.sites.get(site.name);
    if (!screen) return;
    const { gl, of } = this;
    use(gl, of, place);
    const [x, y] = site.origin_m;
    const { range_first_m, range_step_m, ranges, db_step } = screen.form;
    const first = Math.max(0, range_first_m - range_step_m / 2);
    gl.uniform4f(of.u_site, x, y, first, first + range_step_m * ranges);
    const glow_s = how.steady ? 1e9 : AFTERGLOW_SCANS * site.scan_period_s;
    gl.uniform3f(of.u_glow, how.now, glow_s, 0.03);
    gl.uniform1f(of.u_count, screen.lines);
    const black = screen.noise + (FLOOR_DB - how.gain_db) / db_step;
    gl.uniform2f(of.u_contrast, black / 255, (255 * db_step) / SPAN_DB);
    gl.uniform3fv(of.u_weak, how.weak);
    gl.uniform3fv(of.u_strong, how.strong);
    gl.uniform1i(of.u_level, 0);
    gl.uniform1i(of.u_lines, 1);
    gl.activeTexture(gl.TEXTURE1);
    gl.bindTexture(gl.TEXTURE_2D, screen.times);
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, screen.levels);
    gl.bindVertexArray(this.vao);
    gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, screen.lines);
  }
}

/** The video of one site. */
class Screen {
  constructor(gl, lines, { ranges, range_first_m, range_step_m, db_first, db_step }) {
    this.gl = gl;
    this.lines = lines;
    this.form = { ranges, range_first_m, range_step_m, db_first, db_step };
    this.levels = texture(gl, gl.R8, ranges, lines);
    this.times = texture(gl, gl.R32F, 1, lines);
    this.time = new Float32Array(lines);
    this.counts = new Uint32Array(256);
    /** Level in the middle of what is received: noise, for most of what a radar sees is that. */
    this.noise = NaN;
    this.clear();
  }

  fits(lines, message) {
    return lines === this.lines && Object.keys(this.form).every((key) => this.form[key] === message[key]);
  }

  clear() {
    this.time.fill(-1);
    this.#sendTimes(0, this.lines);
  }

  drop() {
    this.gl.deleteTexture(this.levels);
    this.gl.deleteTexture(this.times);
  }

  add({ azimuth_first_rad, azimuth_step_rad, lines, data: { level } }, time) {
    const { gl, form: { ranges } } = this;
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    gl.bindTexture(gl.TEXTURE_2D, this.levels);
    const turns = azimuth_first_rad / (2 * Math.PI);
    const first = Math.floor((turns - Math.floor(turns)) * this.lines + 1e-6);
    const up = azimuth_step_rad > 0;
    for (let line = 0; line < lines; ) {
      // Runs of neighbouring lines go in one piece; those of a radar that turns the other way one by one.
      const at = (((up ? first + line : first - line) % this.lines) + this.lines) % this.lines;
      const run = up ? Math.min(lines - line, this.lines - at) : 1;
      gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, at, ranges, run, gl.RED, gl.UNSIGNED_BYTE, level, line * ranges);
      this.time.fill(time, at, at + run);
      this.#sendTimes(at, run);
      gl.bindTexture(gl.TEXTURE_2D, this.levels);
      line += run;
    }
    this.#measureNoise(level);
  }

  #sendTimes(at, count) {
    const { gl } = this;
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 4);
    gl.bindTexture(gl.TEXTURE_2D, this.times);
    gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, at, 1, count, gl.RED, gl.FLOAT, this.time, at);
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
  }

  #measureNoise(level) {
    this.counts.fill(0);
    const step = Math.max(1, Math.floor(level.length / 1024));
    let n = 0;
    for (let i = 0; i < level.length; i += step, n += 1) this.counts[level[i]] += 1;
    let middle = 0;
    for (let below = this.counts[0]; below < n / 2; ) below += this.counts[++middle];
    this.noise = Number.isNaN(this.noise) ? middle : this.noise + 0.05 * (middle - this.noise);
  }
}

function texture(gl, format, width, height) {
  const made = gl.createTexture();
  gl.bindTexture(gl.TEXTURE_2D, made);
  gl.texStorage2D(gl.TEXTURE_2D, 1, format, width, height);
  for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, filter, gl.NEAREST);
  for (const wrap of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, wrap, gl.CLAMP_TO_EDGE);
  return made;
}
