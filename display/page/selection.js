// The chosen track, and what is remembered of its last scans.

/** Scans whose used plots are drawn, and scans in the charts. */
const USED_SCANS = 6;
const CHART_SCANS = 120;

export class Selection {
  /** @param {(follow: object | null) => void} onChange asks the server for another track */
  constructor(picture, onChange) {
    this.picture = picture;
    this.onChange = onChange;
    this.version = 0;
    this.#forget();
  }

  #forget() {
    this.track = null;
    this.restart();
  }

  /** Forgets the last scans: time has jumped. */
  restart() {
    /** The last message of the server on this track. */
    this.said = null;
    /** Used plots by scan, oldest first, and where the track was then. */
    this.scans = [];
    /** Model probabilities by scan: `{time_s, models}`. */
    this.models = [];
    /** Errors by scan: `{time_s, position, sigma, error, id}`. */
    this.errors = [];
  }

  choose(track) {
    if (track === this.track) return;
    this.#forget();
    this.track = track;
    this.version += 1;
    // Of a system track the server knows no more than the page.
    this.onChange(track?.site ? { site: track.site, track: track.id } : null);
  }

  /** Goes to the next (1) or previous (-1) track in the order of their numbers. */
  step(by, order) {
    if (order.length === 0) return;
    const at = order.indexOf(this.track);
    const next = at < 0 ? (by > 0 ? 0 : order.length - 1) : (at + by + order.length) % order.length;
    this.choose(order[next]);
  }

  /** After a break or a jump the same track is another object, or gone. */
  refresh() {
    if (!this.track) return;
    const now = this.picture.find(this.track.key);
    if (now && now !== this.track) {
      this.track = now;
      this.version += 1;
    }
  }

  /** The server's message on the followed track. */
  hear(message) {
    const { track } = this;
    if (!track || message.site !== track.site || message.id !== track.id) return;
    const { time_s, state, models, used } = message;
    this.said = message;
    if (this.scans.at(-1)?.time_s !== time_s) {
      keep(this.scans, { time_s, used: used ?? [], x: state.x, y: state.y, z: state.z }, USED_SCANS);
      keep(this.models, { time_s, models: models ?? [] }, CHART_SCANS);
    }
    this.version += 1;
  }

  /** Notes where the track was found; its error as soon as the truth of that time is known. */
  sample() {
    const { track, picture } = this;
    if (!track) return;
    const last = this.errors.at(-1);
    if (last?.time_s !== track.time_s && track.state !== 3) {
      const position = [track.x_m, track.y_m, track.z_m];
      const sigma = [track.var_xx, track.var_yy, track.var_zz].map(Math.sqrt);
      keep(this.errors, { time_s: track.time_s, position, sigma, error: null, id: null, final: false }, CHART_SCANS);
    }
    for (const sample of this.errors.slice(-2)) {
      if (sample.final) continue;
      const found = picture.truth.errors(sample);
      if (!found) continue;
      sample.error = found.error;
      sample.id = found.id;
      sample.final = found.known_s >= sample.time_s;
    }
  }
}

function keep(list, item, most) {
  list.push(item);
  if (list.length > most) list.shift();
}
