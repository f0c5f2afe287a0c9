// The keyboard: every command, and the page of help that lists them.

import { byId, element } from "./element.js";

/** Share of the picture that an arrow key pans. */
const STEP = 0.12;

/** Commands: keys, what they do in words, and the name of the action. `plan`: only while the plan has the focus. */
const COMMANDS = [
  { keys: ["?"], words: "this help", act: "help" },
  { keys: ["1"], words: "picture", act: "showPicture" },
  { keys: ["2"], words: "chain", act: "showChain" },
  { keys: ["n"], words: "next track", act: "nextTrack" },
  { keys: ["p"], words: "track before", act: "previousTrack" },
  { keys: ["Escape"], words: "choose no track", act: "chooseNone" },
  { keys: ["/"], words: "find a track by its number", act: "find" },
  { keys: ["+", "="], shown: "+", words: "zoom in", act: "zoomIn" },
  { keys: ["-"], words: "zoom out", act: "zoomOut" },
  { keys: ["0"], words: "show everything", act: "zoomAll" },
  { keys: ["c"], words: "keep the chosen track in the centre", act: "centre" },
  { keys: ["ArrowLeft", "ArrowRight", "ArrowUp", "ArrowDown"], shown: "arrows", words: "pan, with the focus on the plan", act: "pan", plan: true },
  { keys: ["Enter"], words: "acquire or corner of a zone in the centre of the plan", act: "point", plan: true },
  { keys: ["l"], words: "layers", act: "layers" },
  { keys: ["v"], words: "radar video on or off", act: "toggle", layer: "video" },
  { keys: ["o"], words: "plots on or off", act: "toggle", layer: "plots" },
  { keys: ["f"], words: "false alarms on or off", act: "toggle", layer: "falseAlarms" },
  { keys: ["u"], words: "clutter expected on or off", act: "toggle", layer: "clutter" },
  { keys: ["g"], words: "gate of the chosen track on or off", act: "toggle", layer: "gate" },
  { keys: ["t"], words: "truth on or off", act: "toggle", layer: "truth" },
  { keys: ["h"], words: "range and height on or off", act: "toggle", layer: "heights" },
  { keys: ["d"], words: "day, night or as the system", act: "scheme" },
  { keys: ["k"], words: "recording: play or pause", act: "play" },
  { keys: [",", "."], shown: ", .", words: "recording: a sector back or on", act: "sector" },
  { keys: ["<", ">"], shown: "< >", words: "recording: a scan back or on", act: "scan" },
  { keys: ["[", "]"], shown: "[ ]", words: "recording: event before, next event", act: "event" },
];

const FORMS = [
  ["confirmed", "confirmed track: disc"],
  ["coasting", "coasting track, its gate was empty lately: square"],
  ["tentative", "tentative track: diamond"],
  ["ended", "ended track: cross"],
  ["system", "system track: hexagon"],
  ["truth", "truth: plus"],
];

export class Keys {
  /** @param {Record<string, (key: string, command: object) => void>} actions by name */
  constructor(settings, actions) {
    this.settings = settings;
    this.actions = actions;
    this.help = byId("help");
    this.#fillHelp();
    document.addEventListener("keydown", (event) => this.#press(event));
  }

  #press(event) {
    if (event.ctrlKey || event.altKey || event.metaKey || this.help.open) return;
    const { target } = event;
    const onPlan = target.id === "plan";
    const types = target.matches("input:not([type=range], [type=checkbox]), textarea");
    if (types && event.key !== "Escape") return;
    const command = COMMANDS.find(({ keys }) => keys.includes(event.key));
    if (!command || (command.plan && !onPlan)) return;
    // Single characters are commands everywhere only as long as the reader wants them to be.
    if (event.key.length === 1 && !this.settings.letters && !onPlan && event.key !== "?") return;
    event.preventDefault();
    this.actions[command.act](event.key, command);
  }

  openHelp() {
    if (!this.help.open) this.help.showModal();
  }

  #fillHelp() {
    const letters = element("input", { type: "checkbox", checked: this.settings.letters });
    letters.addEventListener("change", () => this.settings.set({ letters: letters.checked }));
    const keys = element("dl", { class: "keys" });
    for (const { keys: of, shown, words } of COMMANDS) {
      const names = (shown ?? of[0]).split(" ");
      keys.append(element("div", {}, element("dt", {}, ...names.flatMap((name) => [element("kbd", {}, name), " "])), element("dd", {}, words)));
    }
    const forms = element("ul", { class: "forms" }, ...FORMS.map(([form, words]) => element("li", {}, element("span", { class: `form ${form}`, "aria-hidden": "true" }), words)));
    this.help.append(
      element("h2", { id: "help-title" }, "Help"),
      element("p", {}, "Drag pans, the wheel zooms, a click chooses a track. The thick arc at the rim is the sector being scanned."),
      element("h3", {}, "Forms"),
      forms,
      element("p", {}, "Line: where the target will be in ten scans. Ellipse: holds the target with 95 %. Small circles at the chosen track: plots of its last scans, the larger the heavier."),
      element("h3", {}, "Keys"),
      keys,
      element("label", { class: "check" }, letters, " single letters are commands everywhere, not only on the plan"),
      element("form", { method: "dialog" }, element("button", { autofocus: true }, "Close")),
    );
  }
}

/** How far an arrow key pans the view, pixels. */
export function panOf(key, view) {
  const step = STEP * Math.min(view.width, view.height);
  return { ArrowLeft: [step, 0], ArrowRight: [-step, 0], ArrowUp: [0, step], ArrowDown: [0, -step] }[key];
}
