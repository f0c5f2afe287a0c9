// The pointer on the plan: pan, zoom, choose.

/** A press that moves less than this chooses, pixels. */
const CLICK_PX = 4;
/** A track this near to the pointer is meant, pixels. */
const REACH_PX = 16;

export class Hand {
  /** @param {(x: number, y: number, track: object | null) => void} onClick with the place and the track under it */
  constructor(plan, scene, onClick) {
    Object.assign(this, { plan, scene, onClick });
    /** Where the pressed pointers are. */
    this.down = new Map();
    this.moved = 0;
    plan.addEventListener("pointerdown", (event) => this.#press(event));
    plan.addEventListener("pointermove", (event) => this.#move(event));
    for (const kind of ["pointerup", "pointercancel"]) plan.addEventListener(kind, (event) => this.#release(event));
    plan.addEventListener("pointerleave", () => this.#hover(null));
    plan.addEventListener("wheel", (event) => this.#wheel(event), { passive: false });
    plan.addEventListener("dblclick", (event) => scene.view.zoom(2, ...this.#at(event)));
  }

  #press(event) {
    if (event.button !== 0) return;
    this.plan.setPointerCapture(event.pointerId);
    this.down.set(event.pointerId, this.#at(event));
    if (this.down.size === 1) this.moved = 0;
  }

  #move(event) {
    const [px, py] = this.#at(event);
    const before = this.down.get(event.pointerId);
    if (!before) {
      if (this.down.size === 0) this.#hover(this.#under(px, py));
      return;
    }
    const [dx, dy] = [px - before[0], py - before[1]];
    this.moved += Math.hypot(dx, dy);
    if (this.down.size === 2) {
      const other = [...this.down].find(([id]) => id !== event.pointerId)[1];
      const gap = (a) => Math.max(1, Math.hypot(a[0] - other[0], a[1] - other[1]));
      this.scene.view.zoom(gap([px, py]) / gap(before), (px + other[0]) / 2, (py + other[1]) / 2);
    } else if (this.moved > CLICK_PX) {
      this.scene.following = false;
      this.scene.view.pan(dx, dy);
    }
    this.down.set(event.pointerId, [px, py]);
  }

  #release(event) {
    if (this.down.delete(event.pointerId) && event.type === "pointerup" && this.moved <= CLICK_PX) {
      const [px, py] = this.#at(event);
      const { view } = this.scene;
      this.onClick(view.metreX(px), view.metreY(py), this.#under(px, py));
    }
  }

  #wheel(event) {
    event.preventDefault();
    const lines = event.deltaMode === WheelEvent.DOM_DELTA_LINE ? 30 : 1;
    this.scene.view.zoom(Math.exp(-0.0015 * lines * event.deltaY), ...this.#at(event));
  }

  #under(px, py) {
    const { view, picture, layers } = this.scene;
    return picture.nearest(view.metreX(px), view.metreY(py), REACH_PX / view.scale, layers);
  }

  #hover(track) {
    if (track === this.scene.hovered) return;
    this.scene.hovered = track;
    this.scene.view.version += 1;
    this.plan.classList.toggle("over", Boolean(track));
  }

  /** Where the pointer is, in the units of the view. */
  #at({ offsetX, offsetY }) {
    return [offsetX / this.scene.unit, offsetY / this.scene.unit];
  }
}
