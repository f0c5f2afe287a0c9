// What is asked of the server: about what the screen can show, and nothing that is not drawn.

const PAUSE_MS = 300;
const MOST_LINES = 2048;
const MOST_RANGES = 1024;
const LEAST = 64;

export class Want {
  constructor(scene, send) {
    Object.assign(this, { scene, send });
    this.asked = "";
    this.next_ms = 0;
  }

  /** Asks anew if the view or the layers have made something else of it. */
  update(now_ms, shown) {
    if (now_ms < this.next_ms) return;
    this.next_ms = now_ms + PAUSE_MS;
    const { layers } = this.scene;
    const want = {
      video: shown && layers.video ? this.#video() : null,
      plots: true,
      tracks: true,
      truth: true,
      system_tracks: true,
      maps: shown && (layers.falseAlarms || layers.clutter),
      health: true,
      events: true,
    };
    const text = JSON.stringify(want);
    if (text === this.asked) return;
    this.asked = text;
    this.send({ want, encoding: "binary" });
  }

  /** A server that has begun anew knows nothing of us. */
  forget() {
    this.asked = "";
  }

  /** Lines and ranges that the screen can tell apart, in powers of two: zooming does not ask at every step. */
  #video() {
    const { picture, view } = this.scene;
    const sites = [...picture.sites.values()].map(({ of }) => of).filter((of) => of.has_video);
    if (sites.length === 0) return null;
    const radius_px = Math.max(...sites.map((of) => of.range_max_m * view.scale)) * Math.min(2, devicePixelRatio || 1);
    const power = (least, most) => Math.min(most, Math.max(LEAST, 2 ** Math.ceil(Math.log2(least))));
    return { lines: power(2 * Math.PI * radius_px * 0.5, MOST_LINES), ranges: power(radius_px * 0.75, MOST_RANGES) };
  }
}
