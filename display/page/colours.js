// Colours of the style sheet for the graphics card, and which scheme is on.

const NAMES = [
  "ground", "ring", "scale", "sweep", "video", "video-strong", "plot", "truth", "tentative", "confirmed",
  "coasting", "ended", "system", "chosen", "used", "text", "soft", "false-alarm", "clutter",
];
const CHOICES = ["auto", "night", "day"];

export class Colours {
  /** @param {() => void} onChange when the scheme has changed */
  constructor(choice, onChange) {
    this.onChange = onChange;
    this.system = matchMedia("(prefers-color-scheme: light)");
    this.system.addEventListener("change", () => this.set(this.choice));
    this.set(choice);
  }

  set(choice) {
    this.choice = CHOICES.includes(choice) ? choice : "auto";
    const day = this.choice === "day" || (this.choice === "auto" && this.system.matches);
    document.documentElement.dataset.scheme = day ? "day" : "night";
    const style = getComputedStyle(document.documentElement);
    /** `#rrggbb` by name. */
    this.text = Object.fromEntries(NAMES.map((name) => [name, style.getPropertyValue(`--${name}`).trim()]));
    /** Red, green, blue from 0 to 1, by name. */
    this.rgb = Object.fromEntries(NAMES.map((name) => [name, rgb(this.text[name])]));
    this.onChange?.();
  }

  next() {
    this.set(CHOICES[(CHOICES.indexOf(this.choice) + 1) % CHOICES.length]);
    return this.choice;
  }

  /** Four bytes for a vertex: a colour and how opaque it is. */
  packed(name, alpha = 1) {
    const [r, g, b] = this.rgb[name];
    return ((Math.round(alpha * 255) << 24) | (byte(b) << 16) | (byte(g) << 8) | byte(r)) >>> 0;
  }
}

const byte = (share) => Math.round(share * 255);

function rgb(hex) {
  return [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16) / 255);
}
