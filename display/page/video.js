// Radar video: a texture of lines by ranges for each site, drawn as wedges, with afterglow.

import { PLACE, program, texture, use } from "./gl.js";

const VERTEX = `
uniform sampler2D u_times;  // one texel a wedge: its time, or a negative number
uniform vec4 u_site;        // antenna east and north, first range, last range
uniform vec3 u_glow;        // now, time constant, least that is visible
uniform vec2 u_lines;       // lines in a full circle, lines in a wedge
out vec2 v_turn;            // line times range, range: both are linear on the screen
flat out float v_glow;
${PLACE}
void main() {
  int wedge = gl_VertexID / 6, corner = gl_VertexID % 6;
  float time = texelFetch(u_times, ivec2(wedge, 0), 0).r;
  v_glow = time < 0.0 ? 0.0 : exp(-max(0.0, u_glow.x - time) / u_glow.y);
  bool far = corner == 1 || corner == 2 || corner == 4;
  float line = min(float(wedge + int(corner > 1 && corner < 5)) * u_lines.y, u_lines.x);
  float azimuth = 6.283185307 * line / u_lines.x;
  float range = far ? u_site.w : u_site.z;
  v_turn = vec2(line * range, range);
  vec2 at = u_site.xy + range * vec2(sin(azimuth), cos(azimuth));
  gl_Position = vec4(v_glow > u_glow.z ? place(vec3(at, 0.0)) : NOWHERE, 0.0, 1.0);
}`;

const FRAGMENT = `
in vec2 v_turn;
flat in float v_glow;
uniform sampler2D u_level;
uniform vec3 u_cells;       // first range, one over the step of ranges, ranges
uniform vec2 u_contrast;    // level that is black, one over the levels up to full
uniform vec3 u_weak, u_strong;
out vec4 o_colour;
void main() {
  ivec2 cell = ivec2(min((v_turn.y - u_cells.x) * u_cells.y, u_cells.z - 1.0), v_turn.x / v_turn.y);
  float level = clamp((texelFetch(u_level, cell, 0).r - u_contrast.x) * u_contrast.y, 0.0, 1.0);
  float alpha = level * v_glow;
  o_colour = vec4(mix(u_weak, u_strong, level * level) * alpha, alpha);
}`;

const MOST_LINES = 4096;
/** Wedges of a circle at most: each is two triangles, which must look round. */
const WEDGES = 128;
const AFTERGLOW_SCANS = 0.9;
/** dB over the middle of what is received at which video begins, and from there to full brightness. */
const FLOOR_DB = 3.0;
const SPAN_DB = 18.0;

export class VideoProgram {
  constructor(gl) {
    this.gl = gl;
    this.of = program(gl, VERTEX, FRAGMENT);
    /** What was received, by site. */
    this.sites = new Map();
  }

  clear() {
    for (const screen of this.sites.values()) screen.clear();
  }

  /** Takes the lines of one sector; `time` in s since the picture began. */
  add(message, time) {
    const lines = Math.min(MOST_LINES, Math.round((2 * Math.PI) / Math.abs(message.azimuth_step_rad)));
    let screen = this.sites.get(message.site);
    if (!screen?.fits(lines, message)) {
      screen?.drop();
      screen = new Screen(this.gl, lines, message);
      this.sites.set(message.site, screen);
    }
    screen.add(message, time);
  }

  /** @param {object} how now, gain_db, colours `weak` and `strong`; `steady` without afterglow */
  draw(site, place, how) {
    const screen = this.sites.get(site.name);
    if (!screen) return;
    const { gl, of } = this;
    use(gl, of, place);
    const { range_first_m, range_step_m, ranges, db_step } = screen.form;
    const first = Math.max(0, range_first_m - range_step_m / 2);
    const extent = range_step_m * ranges;
    // The innermost point has no azimuth: wedges begin a little outside it.
    gl.uniform4f(of.u_site, site.origin_m[0], site.origin_m[1], Math.max(first, 1e-4 * extent), first + extent);
    gl.uniform3f(of.u_cells, first, 1 / range_step_m, ranges);
    gl.uniform3f(of.u_glow, how.now, how.steady ? 1e9 : AFTERGLOW_SCANS * site.scan_period_s, 0.03);
    gl.uniform2f(of.u_lines, screen.lines, screen.lines_per_wedge);
    const black = screen.noise + (FLOOR_DB - how.gain_db) / db_step;
    gl.uniform2f(of.u_contrast, black / 255, (255 * db_step) / SPAN_DB);
    gl.uniform3fv(of.u_weak, how.weak);
    gl.uniform3fv(of.u_strong, how.strong);
    gl.uniform1i(of.u_level, 0);
    gl.uniform1i(of.u_times, 1);
    screen.bind();
    gl.drawArrays(gl.TRIANGLES, 0, 6 * screen.times.length);
  }
}

/** The video of one site, here and on the graphics card. */
class Screen {
  constructor(gl, lines, { ranges, range_first_m, range_step_m, db_first, db_step }) {
    this.gl = gl;
    this.lines = lines;
    this.lines_per_wedge = Math.ceil(lines / WEDGES);
    this.form = { ranges, range_first_m, range_step_m, db_first, db_step };
    this.levels = new Uint8Array(lines * ranges);
    this.times = new Float32Array(Math.ceil(lines / this.lines_per_wedge));
    this.levelTexture = texture(gl, gl.R8, ranges, lines);
    this.timeTexture = texture(gl, gl.R32F, this.times.length, 1);
    this.counts = new Uint32Array(256);
    /** Level in the middle of what is received: noise, for most of what a radar sees is that. */
    this.noise = NaN;
    this.clear();
  }

  fits(lines, message) {
    return lines === this.lines && Object.keys(this.form).every((key) => this.form[key] === message[key]);
  }

  /** Share of the circle of which anything has come. */
  get share() {
    return this.times.filter((time) => time >= 0).length / this.times.length;
  }

  clear() {
    this.times.fill(-1);
    this.levels.fill(0);
    /** The line that came last, and of which scan. */
    this.last = {};
    /** Lines that the graphics card does not have yet. */
    this.fresh = [0, this.lines];
  }

  drop() {
    this.gl.deleteTexture(this.levelTexture);
    this.gl.deleteTexture(this.timeTexture);
  }

  add({ scan, azimuth_first_rad, azimuth_step_rad, lines, data: { level } }, time) {
    const { ranges } = this.form;
    const turns = azimuth_first_rad / (2 * Math.PI);
    const first = Math.floor((turns - Math.floor(turns)) * this.lines + 1e-6);
    const step = azimuth_step_rad > 0 ? 1 : -1;
    for (let line = 0; line < lines; line += 1) {
      const at = (((first + step * line) % this.lines) + this.lines) % this.lines;
      const strongest = level.subarray(line * ranges, (line + 1) * ranges);
      // A line that two sectors share comes with both.
      if (line === 0 && at === this.last.at && scan === this.last.scan) this.#keepStronger(strongest, at);
      this.levels.set(strongest, at * ranges);
      this.last = { at, scan };
      this.times[Math.floor(at / this.lines_per_wedge)] = time;
      this.fresh = [Math.min(this.fresh[0], at), Math.max(this.fresh[1], at + 1)];
    }
    this.#measureNoise(level);
  }

  /** Binds both textures, and sends what is new in one piece: each piece costs more than its bytes. */
  bind() {
    const { gl, fresh: [from, to], form: { ranges } } = this;
    gl.activeTexture(gl.TEXTURE1);
    gl.bindTexture(gl.TEXTURE_2D, this.timeTexture);
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, this.levelTexture);
    if (from >= to) return;
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, from, ranges, to - from, gl.RED, gl.UNSIGNED_BYTE, this.levels, from * ranges);
    gl.activeTexture(gl.TEXTURE1);
    gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, this.times.length, 1, gl.RED, gl.FLOAT, this.times);
    gl.activeTexture(gl.TEXTURE0);
    this.fresh = [this.lines, 0];
  }

  /** Raises levels to those that the line has already. */
  #keepStronger(level, at) {
    const before = at * level.length;
    for (let i = 0; i < level.length; i += 1) level[i] = Math.max(level[i], this.levels[before + i]);
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
