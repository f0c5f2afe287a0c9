// The canvas over the picture that holds all text: scale, labels, axes.

import { Labels } from "./labels.js";
import { writeScale } from "./scale.js";

const FONT = "system-ui, sans-serif";
const LINE_PX = 13;

export class Writing {
  constructor(canvas) {
    this.canvas = canvas;
    this.context = canvas.getContext("2d");
    this.labels = new Labels();
    this.widths = new Map();
  }

  resize(width, height, ratio) {
    this.canvas.width = Math.round(width * ratio);
    this.canvas.height = Math.round(height * ratio);
    this.ratio = ratio;
    this.widths.clear();
  }

  /** Writes everything anew. `plan` and `below` are the two parts of the picture: left, top, width, height. */
  draw(scene, plan, below) {
    const { context, canvas } = this;
    const { colours, view, layers } = scene;
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, canvas.width, canvas.height);
    context.textBaseline = "middle";
    context.lineJoin = "round";
    context.lineWidth = 3;
    // A rim in the colour of the ground keeps text readable over video.
    context.strokeStyle = colours.text.ground;
    this.#part(plan, () => {
      if (layers.rings) this.#scale(scene);
      this.#labels(scene);
    });
    if (below.height > 0) this.#part(below, () => this.#axes(scene, below, view));
  }

  #part({ left, top, width, height }, draw) {
    const { context, ratio } = this;
    context.save();
    context.setTransform(ratio, 0, 0, ratio, left * ratio, top * ratio);
    context.beginPath();
    context.rect(0, 0, width, height);
    context.clip();
    draw();
    context.restore();
  }

  #scale({ main, sites, view, colours }) {
    const { context } = this;
    writeScale(main, sites, view, (text, px, py, align, weight) => {
      context.font = `${weight ? "600 12px" : "11px"} ${FONT}`;
      context.fillStyle = weight ? colours.text.text : colours.text.soft;
      this.#rimmed(text, px, py, align);
    });
  }

  #rimmed(text, px, py, align) {
    this.context.textAlign = align;
    this.context.strokeText(text, px, py);
    this.context.fillText(text, px, py);
  }

  #labels(scene) {
    const { context, labels } = this;
    const { colours, selection } = scene;
    context.font = `12px ${FONT}`;
    labels.place(scene, (text) => this.#width(text));
    for (const { track, px, py, lines } of labels.placed) {
      lines.forEach((line, i) => {
        const strong = i === 0;
        context.fillStyle = track === selection.track ? colours.text.chosen : strong ? colours.text.text : colours.text.soft;
        this.#rimmed(line, px, py + LINE_PX * (i + 0.5), "left");
      });
    }
  }

  #width(text) {
    let width = this.widths.get(text);
    if (width === undefined) {
      if (this.widths.size > 5000) this.widths.clear();
      width = this.context.measureText(text).width;
      this.widths.set(text, width);
    }
    return width;
  }

  #axes({ heights, colours }, { width, height }) {
    const { context } = this;
    context.font = `11px ${FONT}`;
    context.fillStyle = colours.text.soft;
    const lines = new Path2D();
    const texts = [];
    heights.axes(
      width,
      height,
      (x0, y0, x1, y1) => {
        lines.moveTo(Math.round(x0) + 0.5, Math.round(y0) + 0.5);
        lines.lineTo(Math.round(x1) + 0.5, Math.round(y1) + 0.5);
      },
      (...text) => texts.push(text),
    );
    context.save();
    context.globalAlpha = 0.6;
    context.lineWidth = 1;
    context.strokeStyle = colours.text.ring;
    context.stroke(lines);
    context.restore();
    for (const [text, px, py, align] of texts) this.#rimmed(text, px, py, align);
  }
}
