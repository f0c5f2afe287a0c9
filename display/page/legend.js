// What the colours of the maps mean, over the plan while a map is shown.

import { byId, element, setText } from "./element.js";
import { MAPS } from "./maps.js";

export class Legend {
  constructor() {
    this.box = byId("legend");
    this.entries = new Map();
    for (const name of Object.keys(MAPS)) {
      const title = element("span", {});
      const scale = element("span", { class: "scale" });
      const entry = element("div", { class: "map", "data-map": name, hidden: true }, title, element("span", { class: "ramp", "aria-hidden": "true" }), scale);
      this.entries.set(name, { entry, title, scale });
      this.box.append(entry);
    }
  }

  /** Shows the maps that are switched on; a map of which nothing is known yet says so. */
  update({ picture, layers }) {
    const messages = [...picture.maps.values()];
    const learnt = (picture.hello?.sites ?? []).some((of) => of.maps.length > 0);
    const promised = messages.some(({ data }) => data.promised_per_scan.some((share) => share > 0));
    for (const [name, { entry, title, scale }] of this.entries) {
      const known = messages.length > 0;
      entry.hidden = !layers[name] || !learnt;
      setText(title, known ? MAPS[name].title({ promised }) : "No map yet: the tracker learns it from the ninth scan on");
      const marks = known ? MAPS[name].scale({ promised }) : [];
      if (scale.children.length !== marks.length) scale.replaceChildren(...marks.map(() => element("span")));
      marks.forEach((mark, i) => setText(scale.children[i], mark));
      entry.classList.toggle("empty", !known);
    }
    this.box.hidden = ![...this.entries.values()].some(({ entry }) => !entry.hidden);
  }
}
