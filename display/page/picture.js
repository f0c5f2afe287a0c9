// What the radar sees now: beams, plots, tracks, truth of all sites, brought up to date by messages.

import { roundStep } from "./format.js";
import { Ring } from "./ring.js";
import { TruthStore } from "./truth.js";

/** Life states by their number in messages. */
export const STATES = ["tentative", "confirmed", "coasting", "ended"];
export const ENDED = 3;

const PLOTS = 1 << 18;
const TRAIL_POINTS = 1 << 17;
/** Scans for which plots, trails and tracks without an update stay on the screen. */
const PLOT_SCANS = 1.4;
const TRAIL_SCANS = 30;
const SILENT_SCANS = 4;
const ENDED_SCANS = 1.5;
/** What is too old is looked for so often. */
const EXPIRY_SCANS = 0.1;
/** The first message need not be the oldest: times begin so long before it. */
const BEFORE_S = 1000;

export class Picture {
  constructor() {
    this.plots = new Ring(PLOTS);
    this.trail = new Ring(TRAIL_POINTS);
    this.truth = new TruthStore();
    this.start(null);
  }

  /** Begins anew with what the server has said of itself. */
  start(hello) {
    this.hello = hello;
    /** Sites by name. */
    this.sites = new Map((hello?.sites ?? []).map((of) => [of.name, new Site(of)]));
    /** Whether the coverage has grown since the view was fitted to it. */
    this.widened = false;
    /** Longest scan of all sites, s. */
    this.scan_s = Math.max(...[...this.sites.values()].map(({ of }) => of.scan_period_s || 1), 0.1);
    /** Labels of tracks by number, by site. */
    this.labels = new Map();
    this.clear();
  }

  /** Forgets what was seen, not the sites. */
  clear() {
    this.plots.clear();
    this.trail.clear();
    this.truth.clear();
    /** Living tracks and those that have just ended, by `site/id`. */
    this.tracks = new Map();
    this.system = new Map();
    /** The last map of where false plots fall, by site. */
    this.maps = new Map();
    this.mapsVersion = (this.mapsVersion ?? 0) + 1;
    /** Times are kept in s since this one: numbers of the graphics card have seven digits. */
    this.epoch_s = NaN;
    this.latest_s = 0;
    this.expired_s = NaN;
    this.version = 0;
    for (const site of this.sites.values()) site.clear();
  }

  /** Time of the newest message, s since the picture began. */
  #note(time_s) {
    if (Number.isNaN(this.epoch_s)) this.epoch_s = time_s - BEFORE_S;
    this.latest_s = Math.max(this.latest_s, time_s - this.epoch_s);
    return time_s - this.epoch_s;
  }

  sector(message, arrived_ms) {
    this.#note(message.time_s);
    const site = this.sites.get(message.site);
    if (!site) return;
    site.beam.pass(message, arrived_ms);
    if (message.sector === 0) site.lastScan();
    this.version += 1;
    if (!(this.latest_s - this.expired_s < this.scan_s * EXPIRY_SCANS)) this.#expire();
  }

  addPlots(message) {
    const time = this.#note(message.time_s);
    const { x_m, y_m, z_m, range_m, azimuth_rad, sigma_range_m, sigma_azimuth_rad, snr_db } = message.data;
    for (let i = 0; i < message.count; i += 1) {
      const across = range_m[i] * sigma_azimuth_rad[i];
      this.plots.add(x_m[i], y_m[i], z_m[i], time, sigma_range_m[i], across, azimuth_rad[i], snr_db[i]);
    }
    const site = this.sites.get(message.site);
    if (site) {
      site.plots += message.count;
      this.#reach(site, range_m);
    }
    this.version += 1;
  }

  /** A radar that does not say how far it sees has seen at least this far. */
  #reach(site, ranges_m) {
    if (!site.open) return;
    const furthest = ranges_m.reduce((most, range) => (range > most ? range : most), 0);
    if (furthest <= site.of.range_max_m) return;
    site.of.range_max_m = roundStep(furthest);
    this.widened = true;
  }

  addTracks(message) {
    this.#note(message.time_s);
    const { data, site } = message;
    const of = this.sites.get(site);
    if (of) Object.assign(of, { alive: message.alive, confirmed: message.confirmed, left_out: message.left_out });
    if (of?.open) this.#reach(of, data.x_m.map((x, i) => Math.hypot(x - of.of.origin_m[0], data.y_m[i] - of.of.origin_m[1])));
    for (let i = 0; i < message.count; i += 1) {
      const track = this.#trackOf(this.tracks, site, data.id[i]);
      track.origin = of?.of.origin_m ?? [0, 0, 0];
      copy(track, data, i);
      track.speed = Math.hypot(track.vx_mps, track.vy_mps);
      if (track.state !== ENDED) this.trail.add(track.x_m, track.y_m, track.z_m, track.at);
      if (message.stamps_us) track.stamps_us = message.stamps_us;
    }
    this.version += 1;
  }

  addSystemTracks(message) {
    this.#note(message.time_s);
    for (let i = 0; i < message.count; i += 1) {
      const track = this.#trackOf(this.system, "", message.data.id[i]);
      copy(track, message.data, i);
      track.state = track.ended ? ENDED : track.coasting ? 2 : 1;
      track.origin = [0, 0, 0];
      track.speed = Math.hypot(track.vx_mps, track.vy_mps);
      track.made_of = [...this.sites.keys()].filter((_, site) => site < 32 && (track.site_bits >>> site) & 1);
    }
    this.version += 1;
  }

  addTruth(message) {
    this.#note(message.time_s);
    this.truth.add(message);
    this.version += 1;
  }

  addMaps(message) {
    this.maps.set(message.site, message);
    this.mapsVersion += 1;
    this.version += 1;
  }

  /** The labels that operators have given the tracks of a site. */
  setLabels({ site, labels }) {
    this.labels.set(site, labels);
    for (const track of this.tracks.values()) {
      if (track.site === site) Object.assign(track, { label: labels[track.id] ?? "", short: undefined, labelled: undefined });
    }
    this.version += 1;
  }

  #trackOf(store, site, id) {
    const key = `${site}/${id}`;
    let track = store.get(key);
    if (!track) {
      track = { key, site, id, epoch_s: this.epoch_s, label: this.labels.get(site)?.[id] ?? "" };
      store.set(key, track);
    }
    return track;
  }

  #expire() {
    this.expired_s = this.latest_s;
    this.plots.expire(this.latest_s - PLOT_SCANS * this.scan_s);
    this.trail.expire(this.latest_s - TRAIL_SCANS * this.scan_s);
    this.truth.expire(this.epoch_s + this.latest_s - SILENT_SCANS * this.scan_s);
    for (const store of [this.tracks, this.system]) {
      for (const [key, track] of store) {
        const scans = (this.latest_s - track.at) / this.scan_s;
        if (scans > (track.state === ENDED ? ENDED_SCANS : SILENT_SCANS)) store.delete(key);
      }
    }
  }

  /** Scans for which plots and trails fade. */
  get lives() {
    return { plot_s: PLOT_SCANS * this.scan_s, trail_s: TRAIL_SCANS * this.scan_s };
  }

  /** A track of a site or of all of them together, by its key. */
  find(key) {
    return this.tracks.get(key) ?? this.system.get(key);
  }

  /** The track nearest to a place, within `reach` metres, of those that are shown; of equals the system track, which the centre publishes as a track too. */
  nearest(x, y, reach, layers) {
    let best = null;
    let least = reach * reach;
    for (const [on, store] of [[layers.tracks, this.tracks], [layers.system, this.system]]) {
      if (!on) continue;
      for (const track of store.values()) {
        const d2 = (track.x_m - x) ** 2 + (track.y_m - y) ** 2;
        if (store === this.system ? d2 <= least : d2 < least) [best, least] = [track, d2];
      }
    }
    return best;
  }
}

/** Copies row `i` of the columns into `track`. */
function copy(track, data, i) {
  for (const name in data) track[name] = data[name][i];
  track.at = track.time_s - track.epoch_s;
}

/** One radar: where its beam is and what its last scan has brought. */
class Site {
  constructor(of) {
    this.of = of;
    /** Whether its coverage is not known and grows with what is seen. */
    this.open = !(of.range_max_m > 0);
    if (this.open) of.range_max_m = 0;
    this.beam = new Beam(of);
    this.clear();
  }

  clear() {
    this.beam.clear();
    this.alive = 0;
    this.confirmed = 0;
    this.left_out = 0;
    this.plots = 0;
    /** Plots of the last whole scan. */
    this.scan_plots = NaN;
  }

  lastScan() {
    this.scan_plots = this.plots;
    this.plots = 0;
  }
}

/** The beam between two messages: it goes on turning as it did. */
class Beam {
  constructor(of) {
    this.sector_rad = (2 * Math.PI) / (of.sectors_per_scan || 1);
    this.sector_s = (of.scan_period_s || 1) / (of.sectors_per_scan || 1);
    this.clear();
  }

  clear() {
    this.azimuth_rad = NaN;
    this.scan = NaN;
    this.time_s = NaN;
    this.arrived_ms = 0;
    this.ms_per_sector = this.sector_s * 1000;
  }

  pass({ azimuth_rad, scan, time_s }, arrived_ms) {
    const turned_rad = Math.sin(azimuth_rad - this.azimuth_rad);
    if (turned_rad) this.sector_rad = Math.sign(turned_rad) * Math.abs(this.sector_rad);
    const ms = arrived_ms - this.arrived_ms;
    if (ms < 20 * this.ms_per_sector) this.ms_per_sector += 0.1 * (ms - this.ms_per_sector);
    Object.assign(this, { azimuth_rad, scan, time_s, arrived_ms });
  }

  /** Share of the next sector that has gone by, at most one. */
  progress(now_ms) {
    return Math.min(1, Math.max(0, (now_ms - this.arrived_ms) / this.ms_per_sector)) || 0;
  }
}
