// Points with their times, the oldest overwritten: plots and trails.

/** Columns of a point: x, y, z in m, time in s since the picture began, then what its layer needs. */
export const POINT = 8;

export class Ring {
  /** @param {number} capacity of points */
  constructor(capacity) {
    this.capacity = capacity;
    this.values = new Float32Array(capacity * POINT);
    this.clear();
  }

  clear() {
    /** Points ever added; the last `capacity` of them are held. */
    this.added = 0;
    /** The first that is still young enough to be shown. */
    this.first = 0;
  }

  add(x, y, z, time, a = 0, b = 0, c = 0, d = 0) {
    const at = (this.added % this.capacity) * POINT;
    const { values } = this;
    values[at] = x;
    values[at + 1] = y;
    values[at + 2] = z;
    values[at + 3] = time;
    values[at + 4] = a;
    values[at + 5] = b;
    values[at + 6] = c;
    values[at + 7] = d;
    this.added += 1;
  }

  /** Leaves out what is older than `time`; times of points do not decrease by much. */
  expire(time) {
    this.first = Math.max(this.first, this.added - this.capacity);
    while (this.first < this.added && this.values[(this.first % this.capacity) * POINT + 3] < time) this.first += 1;
  }

  /** The first point that is not older than `time`, but for a few. */
  since(time) {
    let [from, to] = [Math.max(this.first, this.added - this.capacity), this.added];
    while (from < to) {
      const middle = Math.floor((from + to) / 2);
      if (this.values[(middle % this.capacity) * POINT + 3] < time) from = middle + 1;
      else to = middle;
    }
    return from;
  }

  /** Calls `each(from, count)` with the places of points `from..to` of all that were added: at most two runs. */
  runs(from, to, each) {
    from = Math.max(from, this.added - this.capacity);
    if (from >= to) return;
    const start = from % this.capacity;
    const head = Math.min(to - from, this.capacity - start);
    each(start, head);
    if (head < to - from) each(0, to - from - head);
  }
}
