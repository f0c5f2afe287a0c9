// What tests, and the curious, can ask the page: `window.radarChain`.

export class Probe {
  #of;

  constructor(of) {
    this.#of = of;
  }

  /** Latency to the screen: `{p50_ms, p95_ms, n}`. */
  get latency() {
    return this.#of.latency.summary();
  }

  /** Frames: `{drawn_per_s, called_per_s, total}`. */
  get frames() {
    return this.#of.frames.summary();
  }

  get tracks() {
    const { picture } = this.#of.scene;
    return [...picture.tracks.values()].map(({ site, id, state, x_m, y_m, z_m, time_s }) => ({ site, id, state, x_m, y_m, z_m, time_s }));
  }

  get systemTracks() {
    const { picture } = this.#of.scene;
    return [...picture.system.values()].map(({ id, state, made_of }) => ({ id, state, made_of }));
  }

  /** The report that the view of the chain shows, as it came. */
  get status() {
    return this.#of.chain.shown;
  }

  /** Messages that the server has not sent because this page was slow, and those that could not be read. */
  get dropped() {
    return this.#of.dropped();
  }

  get badMessages() {
    return this.#of.link.bad;
  }

  /** Share of the circle on which radar video is kept, by site. */
  get video() {
    const { ppi } = this.#of;
    return Object.fromEntries([...(ppi.video?.sites ?? [])].map(([site, screen]) => [site, screen.share]));
  }

  /** How high what the plan draws is, pixels. */
  get height() {
    const { view, unit } = this.#of.scene;
    return unit * view.height;
  }

  /** Where a track is in the window, pixels. */
  where(site, id) {
    const { picture, view, unit } = this.#of.scene;
    const track = picture.find(`${site}/${id}`);
    const { left, top } = this.#of.plan.getBoundingClientRect();
    return track && { x: left + unit * view.screenX(track.x_m), y: top + unit * view.screenY(track.y_m) };
  }
}
