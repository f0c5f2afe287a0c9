// Where the targets truly are, and how far a track is from its target.

/** A truth further away than this is not the track's, m. */
const REACH_M = 500;

const PLACE = ["x_m", "y_m", "z_m"];
const VELOCITY = ["vx_mps", "vy_mps", "vz_mps"];

export class TruthStore {
  constructor() {
    this.clear();
  }

  clear() {
    /** The last two states of each target, by number. */
    this.targets = new Map();
  }

  add({ data, count }) {
    for (let i = 0; i < count; i += 1) {
      const state = { id: data.target_id[i], time_s: data.time_s[i] };
      for (const name of [...PLACE, ...VELOCITY]) state[name] = data[name][i];
      const known = this.targets.get(state.id);
      if (!known) this.targets.set(state.id, { last: state, before: null });
      else if (state.time_s > known.last.time_s) {
        known.before = known.last;
        known.last = state;
      }
    }
  }

  expire(time_s) {
    for (const [id, { last }] of this.targets) if (last.time_s < time_s) this.targets.delete(id);
  }

  /** Errors of a position against the nearest target at its time: `{id, error: [east, north, up]}` in m, or null. */
  errors(sample) {
    let best = null;
    let least = REACH_M * REACH_M;
    for (const target of this.targets.values()) {
      const error = PLACE.map((_, axis) => sample.position[axis] - at(target, axis, sample.time_s));
      // A radar without height says nothing of the third axis.
      const d2 = error.reduce((sum, e) => sum + (Number.isNaN(e) ? 0 : e * e), 0);
      if (d2 < least) [best, least] = [{ id: target.last.id, error, known_s: target.last.time_s }, d2];
    }
    return best;
  }
}

/** A coordinate at a time: between the two last states by a cubic through both, after them by the last velocity. */
function at({ last, before }, axis, time_s) {
  const [p, v] = [PLACE[axis], VELOCITY[axis]];
  if (!before || time_s >= last.time_s) return last[p] + last[v] * (time_s - last.time_s);
  if (time_s <= before.time_s) return before[p] + before[v] * (time_s - before.time_s);
  const h = last.time_s - before.time_s;
  const s = (time_s - before.time_s) / h;
  const h00 = (1 + 2 * s) * (1 - s) ** 2;
  const h01 = s * s * (3 - 2 * s);
  return h00 * before[p] + s * (1 - s) ** 2 * h * before[v] + h01 * last[p] + s * s * (s - 1) * h * last[v];
}
