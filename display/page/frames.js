// Frames that were drawn, and how many a second.

const WINDOW_MS = 3000;
/** Fewer frames a second than this for two windows are too few. */
const SLOW_PER_S = 12;

export class Frames {
  constructor() {
    /** Drawn since the page was opened. */
    this.total = 0;
    this.drawn = 0;
    this.called = 0;
    this.from_ms = NaN;
    this.slow = this.wasSlow = false;
    this.last = { drawn_per_s: NaN, called_per_s: NaN };
  }

  /** One animation frame, drawn or found unchanged; says whether there is a new summary. */
  note(now_ms, drawn) {
    if (Number.isNaN(this.from_ms)) this.from_ms = now_ms;
    this.called += 1;
    if (drawn) {
      this.drawn += 1;
      this.total += 1;
    }
    const ms = now_ms - this.from_ms;
    if (ms < WINDOW_MS) return false;
    this.last = { drawn_per_s: (1000 * this.drawn) / ms, called_per_s: (1000 * this.called) / ms };
    const slow = this.last.called_per_s < SLOW_PER_S;
    /** Whether the browser does not keep up. */
    this.slow = slow && this.wasSlow;
    this.wasSlow = slow;
    this.drawn = this.called = 0;
    this.from_ms = now_ms;
    return true;
  }

  summary() {
    return { ...this.last, total: this.total };
  }
}
