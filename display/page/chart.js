// Small charts on a canvas: lines over time, bands round them, a limit.

const PAD_PX = 3;

export class Chart {
  /** @param {string} label says to everybody what the chart shows */
  constructor(label, height = 44) {
    this.canvas = document.createElement("canvas");
    this.canvas.className = "chart";
    this.canvas.setAttribute("role", "img");
    this.canvas.setAttribute("aria-label", label);
    this.canvas.height = height;
    this.height = height;
  }

  /** A clean canvas, and the scales: seconds `from..to`, values `low..high`. */
  begin(colours, from, to, low, high) {
    const { canvas } = this;
    const ratio = Math.min(2, devicePixelRatio || 1);
    const width = canvas.clientWidth || 200;
    if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(this.height * ratio)) {
      canvas.width = Math.round(width * ratio);
      canvas.height = Math.round(this.height * ratio);
    }
    const context = canvas.getContext("2d");
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, width, this.height);
    context.lineWidth = 1.3;
    context.lineJoin = "round";
    this.context = context;
    this.colours = colours;
    this.from = from;
    this.to = to;
    const span = Math.max(1e-9, to - from);
    const rise = Math.max(1e-12, high - low);
    this.x = (t) => PAD_PX + ((t - from) / span) * (width - 2 * PAD_PX);
    this.y = (v) => this.height - PAD_PX - ((v - low) / rise) * (this.height - 2 * PAD_PX);
  }

  /** `points` of `[time, value]`; a gap where a value is not finite. */
  line(points, colour, dash = []) {
    const { context } = this;
    context.strokeStyle = this.colours.text[colour];
    context.setLineDash(dash);
    context.beginPath();
    let pen = false;
    for (const [t, v] of points) {
      if (!Number.isFinite(v)) {
        pen = false;
        continue;
      }
      if (pen) context.lineTo(this.x(t), this.y(v));
      else context.moveTo(this.x(t), this.y(v));
      pen = true;
    }
    context.stroke();
    context.setLineDash([]);
  }

  /** From one value to another over time: `[time, low, high]`. */
  band(points, colour) {
    const whole = points.filter(([, low, high]) => Number.isFinite(low) && Number.isFinite(high));
    if (whole.length < 2) return;
    const { context } = this;
    context.fillStyle = this.colours.text[colour];
    context.globalAlpha = 0.22;
    context.beginPath();
    for (const [t, , high] of whole) context.lineTo(this.x(t), this.y(high));
    for (const [t, low] of whole.reverse()) context.lineTo(this.x(t), this.y(low));
    context.fill();
    context.globalAlpha = 1;
  }

  /** A value that holds all the time. */
  level(value, colour) {
    this.line([[this.from, value], [this.to, value]], colour, [2, 3]);
  }

  describe(text) {
    this.canvas.setAttribute("aria-label", text);
  }
}
