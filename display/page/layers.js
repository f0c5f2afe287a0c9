// The list of layers over the plan.

import { byId, element } from "./element.js";
import { LAYERS } from "./settings.js";

export class Layers {
  constructor(settings) {
    this.settings = settings;
    this.form = byId("layers");
    this.button = byId("layers-button");
    this.boxes = new Map();
    for (const [name, [title]] of Object.entries(LAYERS)) {
      const box = element("input", { type: "checkbox", name, onchange: () => settings.toggle(name) });
      this.boxes.set(name, box);
      this.form.append(element("label", { class: "check" }, box, ` ${title}`));
    }
    this.gain = element("input", { type: "range", min: -12, max: 12, step: 1, "aria-label": "Brightness of radar video, dB" });
    this.gain.addEventListener("input", () => settings.set({ gain_db: Number(this.gain.value) }));
    this.form.append(element("label", { class: "gain" }, "Brightness", this.gain));
    this.form.addEventListener("submit", (event) => event.preventDefault());
    this.form.addEventListener("keydown", (event) => {
      if (event.key !== "Escape") return;
      event.stopPropagation();
      this.open(false);
      this.button.focus();
    });
    this.button.addEventListener("click", () => this.open(this.form.hidden));
    this.show();
  }

  open(open) {
    this.form.hidden = !open;
    this.button.setAttribute("aria-expanded", String(open));
  }

  /** Boxes as the settings are, also where a key has changed them. */
  show() {
    for (const [name, box] of this.boxes) box.checked = this.settings.layers[name];
    this.gain.value = this.settings.gain_db;
  }

  /** Hides what a chain does not have. */
  start({ sites, hasSystem }) {
    const maps = sites.some((of) => of.maps.length > 0);
    const has = { falseAlarms: maps, clutter: maps, video: sites.some((of) => of.has_video), truth: sites.some((of) => of.has_truth), system: hasSystem };
    for (const [name, there] of Object.entries(has)) this.boxes.get(name).parentElement.hidden = !there;
  }
}
