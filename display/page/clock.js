// The server's clock as the page sees it, and how late what it shows is.

/** Answers to pings that are remembered: the quickest of them sets the clock. */
const PINGS = 30;

/** Offset of the server's monotonic clock from the page's, from the ping with the shortest way there and back. */
export class ServerClock {
  constructor() {
    this.pings = [];
    this.offset_us = NaN;
    this.uncertain_us = NaN;
  }

  /** Notes an answer: sent and received on the page's clock in ms, the server's time between them in µs. */
  note(sent_ms, received_ms, server_us) {
    this.pings.push({ way_us: (received_ms - sent_ms) * 1000, offset_us: server_us - (sent_ms + received_ms) * 500 });
    if (this.pings.length > PINGS) this.pings.shift();
    const best = this.pings.reduce((a, b) => (b.way_us < a.way_us ? b : a));
    this.offset_us = best.offset_us;
    this.uncertain_us = best.way_us / 2;
  }

  /** The server's time in µs at this time of the page in ms; NaN before the first answer. */
  server_us(page_ms) {
    return page_ms * 1000 + this.offset_us;
  }

  forget() {
    this.pings.length = 0;
    this.offset_us = NaN;
  }
}

/** The latest values of a quantity, and their percentiles. */
export class Latest {
  constructor(capacity) {
    this.values = new Float64Array(capacity);
    this.sorted = new Float64Array(capacity);
    this.n = 0;
  }

  add(value) {
    this.values[this.n++ % this.values.length] = value;
  }

  clear() {
    this.n = 0;
  }

  /** Nearest-rank percentile, 0 to 100; NaN of nothing. */
  percentile(p) {
    const n = Math.min(this.n, this.values.length);
    if (n === 0) return NaN;
    const sorted = this.sorted.subarray(0, n);
    sorted.set(this.values.subarray(0, n));
    sorted.sort();
    return sorted[Math.max(0, Math.ceil((p / 100) * n) - 1)];
  }
}
