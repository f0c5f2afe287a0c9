// What an operator may do where the chain allows it: acquire, drop and label tracks, draw zones.

import { byId, element } from "./element.js";

const KINDS = { exclusion: "no tracks begin here", acquisition: "two plots make a track here" };
/** What a zone has room for, as the server says. */
const MOST_CORNERS = 16;

export class Control {
  /** @param {(text: string) => void} say tells the operator what has happened */
  constructor(scene, say) {
    Object.assign(this, { scene, say });
    /** What a click on the plan does now: nothing special, `acquire` or `zone`. */
    this.mode = null;
    scene.zones = [];
    /** Zones by site, as the server tells of them. */
    this.zones = new Map();
    scene.draft = [];
    const button = (text, act, more = {}) => element("button", { type: "button", onclick: act, ...more }, text);
    this.acquire = button("Acquire", () => this.#enter("acquire"), { "aria-pressed": "false" });
    this.zone = button("Zone", () => this.#enter("zone"), { "aria-pressed": "false" });
    this.name = element("input", { "aria-label": "Name of the zone", placeholder: "name", size: 8, maxlength: 32 });
    this.kind = element("select", { "aria-label": "Kind of zone" }, ...Object.keys(KINDS).map((kind) => element("option", { value: kind }, kind)));
    this.finish = button("Finish", () => this.#finishZone());
    this.zoneForm = element("span", { class: "zone-form", hidden: true }, this.name, this.kind, this.finish);
    this.zoneList = element("ul", { class: "zones", "aria-label": "Zones" });
    this.hint = element("p", { class: "hint", role: "status", hidden: true });
    this.label = element("input", { "aria-label": "Label of the track", placeholder: "label", size: 8, maxlength: 32 });
    this.ofTrack = element("form", { class: "of-track", hidden: true }, this.label, element("button", {}, "Label"), button("Drop", () => this.#drop()));
    this.ofTrack.addEventListener("submit", (event) => {
      event.preventDefault();
      this.#labelTrack();
    });
    byId("tools").append(this.acquire, this.zone, this.zoneForm);
    byId("stage").append(this.hint, this.zoneList);
    byId("track-control").append(this.ofTrack);
  }

  start(hello) {
    const tracks = ({ name }) => hello.stages.some((stage) => stage.name === "tracker" && stage.site === name);
    /** Sites whose tracker can be asked. */
    this.acting = hello.sites.filter(tracks);
    this.allowed = hello.control === true && hello.mode === "live" && this.acting.length > 0;
    for (const of of [this.acquire, this.zone]) of.hidden = !this.allowed;
    this.update();
    this.leave();
    this.zones.clear();
    this.#showZones();
  }

  /** Of a track that is fused of others', nobody can be asked. */
  update() {
    const { track } = this.scene.selection;
    this.ofTrack.hidden = !this.allowed || !track || !this.acting.some(({ name }) => name === track.site);
  }

  /** What operators have done at a site: everybody sees it. */
  hear({ site, zones }) {
    this.zones.set(site, zones);
    this.#showZones();
  }

  /** A click or Enter on the plan; says whether it was for us. */
  point(x, y) {
    if (this.mode === null) return false;
    if (this.mode === "acquire") {
      this.leave();
      this.#post(this.#path("tracks", this.#siteAt([x, y])), { x_m: x, y_m: y }, "A track may begin there now, within five turns");
    } else if (this.scene.draft.length < MOST_CORNERS) {
      this.scene.draft.push([x, y]);
      this.#changed();
      this.#tell();
    }
    return true;
  }

  /** Ends what was begun; says whether there was anything. */
  leave() {
    const was = this.mode !== null;
    this.mode = null;
    this.scene.draft = [];
    this.#changed();
    this.#show();
    return was;
  }

  #enter(mode) {
    const again = this.mode === mode;
    this.leave();
    if (!again) this.mode = mode;
    this.#show();
    if (!again) byId("plan").focus();
  }

  #show() {
    this.acquire.setAttribute("aria-pressed", String(this.mode === "acquire"));
    this.zone.setAttribute("aria-pressed", String(this.mode === "zone"));
    this.zoneForm.hidden = this.mode !== "zone";
    this.hint.hidden = this.mode === null;
    byId("plan").classList.toggle("aiming", this.mode !== null);
    this.#tell();
  }

  #tell() {
    const { length } = this.scene.draft;
    const corners = length === 1 ? "1 corner" : `${length} corners`;
    this.hint.textContent =
      this.mode === "acquire"
        ? "Click where the track is, or press Enter to take the centre. Escape ends."
        : `Click the corners, or press Enter to take the centre: ${corners}. Then give a name and finish. Escape ends.`;
  }

  #finishZone() {
    const polygon_m = this.scene.draft;
    const name = this.name.value.trim();
    if (polygon_m.length < 3) return this.say(`A zone has at least 3 corners; this one has ${polygon_m.length}.`);
    if (name === "") {
      this.say("The zone has no name yet.");
      return this.name.focus();
    }
    const zone = { kind: this.kind.value, name, polygon_m };
    return this.#post(this.#path("zones", this.#siteAt(polygon_m[0])), zone, `Zone ${name} set`).then((done) => {
      if (!done) return; // the drawing is still there
      this.leave();
      this.name.value = "";
    });
  }

  #drop() {
    const { track } = this.scene.selection;
    if (track) this.#send("DELETE", this.#path(`tracks/${track.id}`, track.site), undefined, `Track ${track.id} dropped`);
  }

  #labelTrack() {
    const { track } = this.scene.selection;
    if (!track) return;
    const label = this.label.value.trim();
    this.#post(this.#path(`tracks/${track.id}/label`, track.site), { label }, `Track ${track.id} is now ${label || "without a label"}`);
  }

  #showZones() {
    this.scene.zones = [...this.zones].flatMap(([site, zones]) => zones.map((zone) => ({ ...zone, site })));
    const remove = ({ site, name }) =>
      element("button", { type: "button", "aria-label": `Remove zone ${name}`, onclick: () => this.#removeZone(site, name) }, "×");
    this.zoneList.replaceChildren(
      ...this.scene.zones.map((zone) =>
        element("li", { title: KINDS[zone.kind] }, `${zone.name}, ${zone.kind} `, ...(this.allowed ? [remove(zone)] : [])),
      ),
    );
    this.zoneList.hidden = this.scene.zones.length === 0;
    this.#changed();
  }

  #removeZone(site, name) {
    return this.#send("DELETE", this.#path(`zones/${encodeURIComponent(name)}`, site), undefined, `Zone ${name} removed`);
  }

  /** The site that a command for a place goes to: that of the nearest antenna. */
  #siteAt([x, y]) {
    const away = ({ origin_m: [east, north] }) => Math.hypot(x - east, y - north);
    return this.acting.reduce((best, site) => (away(site) < away(best) ? site : best)).name;
  }

  #path(rest, site) {
    return `/api/v1/sites/${encodeURIComponent(site)}/${rest}`;
  }

  #post(path, body, done) {
    return this.#send("POST", path, body, done);
  }

  /** Sends a command and says what came of it. */
  async #send(method, path, body, done) {
    try {
      const headers = body ? { "content-type": "application/json" } : {};
      const answer = await fetch(path, { method, headers, body: body && JSON.stringify(body) });
      const content = await answer.json();
      if (!answer.ok) throw new Error(content.error ?? `the server answered ${answer.status}`);
      this.say(content.outcome === "accepted" ? `${done}.` : "Asked for: the tracker has not answered yet.");
      return true;
    } catch (error) {
      this.say(`Not done: ${error.message}`);
      return false;
    }
  }

  #changed() {
    this.scene.view.version += 1;
  }
}
