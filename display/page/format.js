// Numbers and times as text: plain figures, the unit behind a narrow space.

const GAP = "\u202f";
const dash = "–";

/** The smallest of 1, 2, 5 times a power of ten that is not below `least`. */
export function roundStep(least) {
  const power = 10 ** Math.floor(Math.log10(least));
  return power * [1, 2, 5, 10].find((factor) => factor * power >= least * 0.999);
}

export function number(value, digits = 0) {
  if (!Number.isFinite(value)) return dash;
  const text = Math.abs(value).toFixed(digits);
  const [whole, part] = text.split(".");
  const grouped = whole.length > 4 ? whole.replace(/\B(?=(\d{3})+$)/g, GAP) : whole;
  const sign = value < 0 && Number(text) !== 0 ? "−" : "";
  return sign + grouped + (part ? `.${part}` : "");
}

/** As `number`, with a unit. */
export function quantity(value, unit, digits = 0) {
  return Number.isFinite(value) ? `${number(value, digits)}${GAP}${unit}` : dash;
}

export function distance(metres) {
  if (!Number.isFinite(metres)) return dash;
  if (Math.abs(metres) < 1000) return quantity(metres, "m");
  const km = metres / 1000;
  return quantity(km, "km", Number.isInteger(km) ? 0 : Math.abs(km) < 100 ? 1 : 0);
}

/** Three digits, as azimuths are said. */
export function angle(radians) {
  if (!Number.isFinite(radians)) return dash;
  const degrees = Math.round((((radians * 180) / Math.PI) % 360 + 360) % 360) % 360;
  return `${String(degrees).padStart(3, "0")}°`;
}

/** A duration in the unit that suits it. */
export function micros(us) {
  if (!Number.isFinite(us)) return dash;
  if (us < 9999.5) return quantity(us, "µs");
  return us < 999_500 ? quantity(us / 1000, "ms", us < 99_950 ? 1 : 0) : quantity(us / 1e6, "s", 1);
}

export function bytes(n) {
  return quantity(n / 2 ** 20, "MiB", 1);
}

export function percent(share, digits = 0) {
  return Number.isFinite(share) ? `${number(100 * share, digits)}${GAP}%` : dash;
}

/** Time of day, UTC. */
export function clock(time_s, digits = 0) {
  if (!Number.isFinite(time_s)) return dash;
  const unit = 10 ** digits;
  const text = new Date((Math.floor(time_s * unit) / unit) * 1000 + 0.01).toISOString();
  return text.slice(11, digits ? 20 + digits : 19);
}

/** Hours, minutes and seconds since a beginning. */
export function elapsed(s) {
  if (!Number.isFinite(s)) return dash;
  const whole = Math.floor(Math.max(0, s));
  const two = (n) => String(n).padStart(2, "0");
  return `${Math.floor(whole / 3600)}:${two(Math.floor(whole / 60) % 60)}:${two(whole % 60)}`;
}

/** A name of the program as words. */
export function words(name) {
  return String(name).replaceAll("_", " ");
}
