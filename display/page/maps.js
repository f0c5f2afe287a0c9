// Where false plots fall: cells of a polar grid, the more opaque the more there are.

import { PLACE, program, Records, RECORDS, use } from "./gl.js";

// A record: antenna east and north, azimuth from and to, range from and to, colour.
const VERTEX = `
out vec4 v_colour;
${PLACE}
${RECORDS}
void main() {
  int corner = gl_VertexID % 6;
  uvec4 first = word4(gl_VertexID / 6, 0), second = word4(gl_VertexID / 6, 1);
  bool far = corner == 1 || corner == 2 || corner == 4;
  bool on = corner > 1 && corner < 5;
  float azimuth = uintBitsToFloat(on ? first.w : first.z);
  float range = uintBitsToFloat(far ? second.y : second.x);
  vec2 at = uintBitsToFloat(first.xy) + range * vec2(sin(azimuth), cos(azimuth));
  gl_Position = vec4(place(vec3(at, 0.0)), 0.0, 1.0);
  v_colour = colour_of(second.z);
}`;

const FRAGMENT = `
in vec4 v_colour;
out vec4 o_colour;
void main() { o_colour = vec4(v_colour.rgb * v_colour.a, v_colour.a); }`;

const MOST_OPAQUE = 0.8;
/** Less than this is not drawn. */
const FAINTEST = 0.03;

/** The maps by the name of their layer: colour, what it says, and its scale from nothing to most opaque. */
export const MAPS = {
  clutter: {
    colour: "clutter",
    title: () => "Clutter expected, times none",
    scale: () => ["×1", "×10", "×100", "×1000", "×10⁴"],
    share: ({ least_expected }, found, promised, expected) => Math.log10(expected / least_expected) / 4,
  },
  falseAlarms: {
    colour: "false-alarm",
    title: ({ promised }) => (promised ? "False plots, times promised" : "False plots in a cell and scan"),
    scale: ({ promised }) => (promised ? ["×1", "×3", "×10", "×30", "×100"] : ["0.01", "0.1", "1", "10"]),
    /** A plot that would have come anyway is not taken for clutter: both counts begin with one. */
    share({ scans }, found, promised) {
      if (Number.isNaN(promised)) return (Math.log10(found) + 2) / 3;
      return Math.log10((found * scans + 1) / (promised * scans + 1)) / 2;
    },
  },
};

export class MapProgram {
  constructor(gl) {
    this.gl = gl;
    this.of = program(gl, VERTEX, FRAGMENT);
    this.records = new Records(gl);
    this.filled = "";
  }

  /** The cells of the maps that are switched on, anew if anything has changed. */
  fill({ picture, layers, colours, settings }) {
    const version = `${picture.mapsVersion}/${settings.version}`;
    if (version === this.filled) return;
    this.filled = version;
    this.records.clear();
    for (const [name, map] of Object.entries(MAPS)) {
      if (!layers[name]) continue;
      for (const message of picture.maps.values()) this.#add(message, picture.sites.get(message.site), map, colours);
    }
  }

  #add(message, site, { colour, share }, colours) {
    const { azimuth_rad, range_m, found_per_scan, promised_per_scan, expected_per_cell } = message.data;
    const [half_rad, half_m] = [message.azimuth_step_rad / 2, message.range_step_m / 2];
    for (let i = 0; i < message.count; i += 1) {
      const opacity = Math.min(1, share(message, found_per_scan[i], promised_per_scan[i], expected_per_cell[i]));
      if (!(opacity > FAINTEST)) continue;
      const at = this.records.next();
      const { floats, words } = this.records;
      floats[at] = site.of.origin_m[0];
      floats[at + 1] = site.of.origin_m[1];
      floats[at + 2] = azimuth_rad[i] - half_rad;
      floats[at + 3] = azimuth_rad[i] + half_rad;
      floats[at + 4] = range_m[i] - half_m;
      floats[at + 5] = range_m[i] + half_m;
      words[at + 6] = colours.packed(colour, MOST_OPAQUE * opacity);
    }
  }

  draw(place) {
    if (this.records.count === 0) return;
    const { gl, of } = this;
    use(gl, of, place);
    this.records.bind(of);
    gl.drawArrays(gl.TRIANGLES, 0, 6 * this.records.count);
  }
}
