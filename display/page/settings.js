// What the reader has chosen to see; kept in the browser.

const KEY = "radar-chain";

/** Layers by name: title, and whether it is on at first. */
export const LAYERS = {
  video: ["Radar video", true],
  falseAlarms: ["False alarms", false],
  clutter: ["Clutter expected", false],
  plots: ["Plots", true],
  errors: ["Plot errors (1σ)", true],
  tracks: ["Tracks", true],
  labels: ["Numbers", true],
  trails: ["Trails", true],
  vectors: ["Speed vectors (10 scans)", true],
  ellipses: ["Uncertainty (95 %)", true],
  used: ["Used plots of the chosen track", true],
  gate: ["Gate of the chosen track", false],
  truth: ["Truth", true],
  system: ["System tracks", true],
  rings: ["Rings and azimuths", true],
  heights: ["Range and height", true],
};

export class Settings {
  constructor() {
    const kept = read();
    this.layers = Object.fromEntries(Object.entries(LAYERS).map(([name, [, on]]) => [name, kept.layers?.[name] ?? on]));
    this.scheme = kept.scheme ?? "auto";
    /** Added to the brightness of video, dB. */
    this.gain_db = Number.isFinite(kept.gain_db) ? kept.gain_db : 0;
    /** Whether single letters are commands. */
    this.letters = kept.letters ?? true;
    this.version = 0;
  }

  /** Changes values, keeps them. */
  set(changes) {
    Object.assign(this, changes);
    this.version += 1;
    const { layers, scheme, gain_db, letters } = this;
    try {
      localStorage.setItem(KEY, JSON.stringify({ layers, scheme, gain_db, letters }));
    } catch {
      // A browser that keeps nothing begins anew each time.
    }
  }

  toggle(layer) {
    this.layers[layer] = !this.layers[layer];
    this.set({});
  }
}

function read() {
  try {
    return JSON.parse(localStorage.getItem(KEY)) ?? {};
  } catch {
    return {};
  }
}
