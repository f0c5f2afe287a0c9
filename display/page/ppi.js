// The picture itself: what is drawn in which order, and when it has to be drawn again.

import { DotProgram, fadingPoints } from "./dots.js";
import { Glyphs } from "./glyphs.js";
import { Heights } from "./heights.js";
import { MapProgram } from "./maps.js";
import { MarkProgram } from "./marks.js";
import { Labels } from "./labels.js";
import { fillBeam, fillScale, writeScale } from "./scale.js";
import { StrokeProgram } from "./strokes.js";
import { Symbols } from "./symbols.js";
import { VideoProgram } from "./video.js";

/** The beam alone is drawn so often, ms; messages and the hand are followed at once. */
const BEAM_MS = 30;
/** Labels follow messages so often, ms. */
const LABELS_MS = 90;
/** More plots than this are smaller and fainter ones. */
const CROWD = 20_000;
/** Fewer plots and points of trails than this are drawn one by one. */
const FEW = 1500;
/** More device pixels than this to one of CSS cost time and show nothing. */
const MOST_RATIO = 2;
/** A picture of fewer pixels is not made coarser. */
const FEWEST_PIXELS = 2_500_000;

export class Ppi {
  /**
   * @param {object} parts elements: stage, ground, plan, heights
   * @param {object} scene picture, view, colours, layers, selection: what is drawn
   */
  constructor(parts, scene) {
    this.parts = parts;
    this.scene = scene;
    scene.heights = new Heights();
    this.labels = new Labels();
    this.drawn = { versions: "", still: "", beam_ms: -Infinity, labels_ms: -Infinity };
    this.fineness = 1;
    this.calm = matchMedia("(prefers-reduced-motion: reduce)");
    parts.ground.addEventListener("webglcontextlost", (event) => {
      event.preventDefault();
      this.gl = null;
    });
    parts.ground.addEventListener("webglcontextrestored", () => this.#start());
    this.#start();
    const observer = new ResizeObserver(() => this.#measure());
    for (const part of [parts.stage, parts.plan, parts.heights]) observer.observe(part);
    this.#measure();
  }

  /** Whether the browser can draw the picture at all. */
  get works() {
    return Boolean(this.gl);
  }

  #start() {
    const gl = this.parts.ground.getContext("webgl2", { antialias: false, alpha: false, depth: false, powerPreference: "high-performance" });
    this.gl = gl;
    if (!gl) return;
    this.video = new VideoProgram(gl);
    this.maps = new MapProgram(gl);
    this.strokes = new StrokeProgram(gl);
    this.marks = new MarkProgram(gl);
    this.dots = new DotProgram(gl);
    this.planDots = this.dots.image();
    this.heightDots = this.dots.image();
    this.fewDots = this.marks.batch();
    this.scale = this.strokes.batch();
    this.beam = this.strokes.batch();
    this.axes = this.strokes.batch();
    this.text = new Glyphs(gl);
    this.heightText = new Glyphs(gl);
    this.symbols = new Symbols(this.strokes, this.marks);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    gl.enable(gl.SCISSOR_TEST);
    Object.assign(this.drawn, { versions: "", still: "" });
    if (this.plan) this.#measure();
  }

  addVideo(message) {
    const { picture, layers } = this.scene;
    if (this.gl && layers.video) this.video.add(message, message.time_s - picture.epoch_s);
  }

  /** Forgets what was received. */
  clear() {
    this.video?.clear();
  }

  /** Half as fine, once, where a slow renderer cannot keep up with that many pixels. */
  coarsen() {
    if (this.fineness < 1 || this.parts.ground.width * this.parts.ground.height < FEWEST_PIXELS) return;
    this.fineness = 0.5;
    this.#measure();
  }

  /** Sizes. The unit of everything drawn is a pixel of CSS, larger where the text of the page is larger. */
  #measure() {
    const { stage, ground, plan, heights } = this.parts;
    const unit = parseFloat(getComputedStyle(document.documentElement).fontSize) / 16;
    const ratio = Math.min(MOST_RATIO, devicePixelRatio || 1) * this.fineness;
    const whole = stage.getBoundingClientRect();
    const of = (element) => {
      const { left, top, width, height } = element.getBoundingClientRect();
      return { left: (left - whole.left) / unit, top: (top - whole.top) / unit, width: width / unit, height: height / unit };
    };
    this.scene.unit = unit;
    this.ratio = ratio * unit;
    this.height = whole.height / unit;
    this.plan = of(plan);
    this.below = of(heights);
    ground.width = Math.round(whole.width * ratio);
    ground.height = Math.round(whole.height * ratio);
    for (const text of [this.text, this.heightText]) text?.resize(this.ratio);
    const [, , width, height] = this.scene.heights.inner(this.below.width, this.below.height);
    this.planDots?.resize(this.plan.width * this.ratio, this.plan.height * this.ratio);
    this.heightDots?.resize(width * this.ratio, height * this.ratio);
    this.scene.view.resize(this.plan.width, this.plan.height);
    Object.assign(this.drawn, { versions: "", still: "" });
  }

  /** Draws if anything has changed, and says whether it has. */
  frame(now_ms) {
    const { scene, drawn, gl } = this;
    if (!gl || this.plan.width < 2) return false;
    const { picture, view, selection, settings } = scene;
    const still = `${view.version}/${selection.version}/${settings.version}`;
    const versions = `${still}/${picture.version}`;
    const beams = !this.calm.matches && now_ms - drawn.beam_ms >= BEAM_MS && this.#turning(now_ms);
    if (versions === drawn.versions && !beams) return false;
    if (versions !== drawn.versions) this.#fill();
    if (still !== drawn.still || (versions !== drawn.labelled && now_ms - drawn.labels_ms > LABELS_MS)) {
      this.#write(still !== drawn.still);
      Object.assign(drawn, { labelled: versions, labels_ms: now_ms });
    }
    Object.assign(drawn, { versions, still, beam_ms: now_ms });
    this.#draw(now_ms);
    return true;
  }

  #turning(now_ms) {
    for (const { beam } of this.scene.sites) if (beam.progress(now_ms) < 1) return true;
    return false;
  }

  /** Lines and symbols anew. */
  #fill() {
    const { scene } = this;
    const { picture, selection, layers } = scene;
    scene.sites = [...picture.sites.values()];
    const main = (picture.sites.get(selection.track?.site) ?? scene.sites[0])?.of;
    if (main !== scene.main) this.drawn.still = "";
    scene.main = main;
    if (layers.heights && scene.heights.fit(main, picture)) this.drawn.still = "";
    this.#place();
    this.planDots.begin(this.planPlace);
    this.heightDots.begin(this.sidePlace);
    this.fewDots.clear();
    this.maps.fill(scene);
    this.#fillDots();
    this.symbols.fill(scene, this.#images(), this.ratio);
  }

  /** Where dots are written. */
  #images() {
    return this.scene.layers.heights ? [this.planDots, this.heightDots] : [this.planDots];
  }

  /** Where metres are on the screen, in both parts of the picture. */
  #place() {
    const { plan, below, ratio, scene: { view, heights } } = this;
    this.planPlace = {
      view: [view.x, view.y, view.width / 2 / view.scale, view.height / 2 / view.scale],
      heights: [0, 0, 0],
      pixels: [plan.width * ratio, plan.height * ratio, ratio],
    };
    this.sideArea = heights.inner(below.width, below.height);
    this.sidePlace = heights.place(this.sideArea[2], this.sideArea[3], ratio);
  }

  /** Plots and trails: a few as symbols, many as images, for an image costs as much with one dot as with all. */
  #fillDots() {
    const { picture, colours, layers } = this.scene;
    const { plots, trail, lives, latest_s: now } = picture;
    const count = (ring) => ring.added - ring.first;
    const crowd = count(plots) > CROWD;
    const few = count(plots) + count(trail) < FEW;
    const unit = few ? 1 : this.ratio;
    const size = (px) => Math.max(1, Math.round(px * unit));
    for (const target of few ? [this.fewDots] : this.#images()) {
      if (layers.trails) {
        const life = crowd ? lives.trail_s / 4 : lives.trail_s;
        fadingPoints(trail, { now, life, alpha: crowd ? 0.4 : 0.75, size: size(crowd ? 1 : 2), rgb: colours.rgb.confirmed }, target);
      }
      if (layers.plots) fadingPoints(plots, { now, life: lives.plot_s, alpha: crowd ? 0.55 : 0.9, size: size(crowd ? 1 : 3), rgb: colours.rgb.plot }, target);
    }
  }

  /** Text anew; with `scale`, also rings and axes, which only the hand moves. */
  #write(scale) {
    const { scene, text, heightText, below } = this;
    const { view, colours, layers, main, sites, heights } = scene;
    const soft = colours.packed("soft");
    if (scale) {
      this.scale.clear();
      if (layers.rings) fillScale(this.scale, sites, main, view, colours);
      this.axes.clear();
      heightText.clear();
      heights.fillAxes(this.axes, below.width, below.height, colours, (words, x, y, align) => heightText.write(words, x, y, "scale", align, soft));
    }
    text.clear();
    this.labels.begin(view);
    if (layers.rings) {
      writeScale(main, sites, view, (words, x, y, type) => {
        text.write(words, x, y, type, "center", type === "strong" ? colours.packed("text") : soft);
        this.labels.reserve(x, y, text.width(words, type));
      });
    }
    this.labels.place(scene, text);
    this.labels.write(text, scene);
  }

  #draw(now_ms) {
    const { gl, ratio, plan, below, scene } = this;
    const { colours, layers } = scene;
    const [r, g, b] = colours.rgb.ground;
    gl.clearColor(r, g, b, 1);
    this.#area(plan.left, plan.top, plan.width, plan.height);
    this.#drawPlan(this.planPlace, now_ms);
    if (!layers.heights || below.height <= 0) return;
    this.#area(below.left, below.top, below.width, below.height);
    gl.clear(gl.COLOR_BUFFER_BIT);
    this.heightText.draw({ pixels: [below.width * ratio, below.height * ratio] }, colours.rgb.ground);
    const [left, top, width, height] = this.sideArea;
    this.#area(below.left + left, below.top + top, width, height);
    this.strokes.draw(this.axes, this.sidePlace);
    this.dots.draw(this.heightDots);
    this.marks.draw(this.fewDots, this.sidePlace);
    if (layers.tracks) this.strokes.draw(this.symbols.heightLines, this.sidePlace);
    this.marks.draw(this.symbols.marks, this.sidePlace);
  }

  #drawPlan(place, now_ms) {
    const { gl, symbols, scene } = this;
    const { picture, colours, layers, settings, sites } = scene;
    gl.clear(gl.COLOR_BUFFER_BIT);
    if (layers.video) {
      const how = {
        now: picture.latest_s, gain_db: settings.gain_db, weak: colours.rgb.video,
        strong: colours.rgb["video-strong"], steady: this.calm.matches,
      };
      for (const { of } of sites) this.video.draw(of, place, how);
    }
    this.maps.draw(place);
    this.strokes.draw(this.scale, place);
    this.dots.draw(this.planDots);
    this.marks.draw(this.fewDots, place);
    if (layers.rings) {
      fillBeam(this.beam, sites, colours, now_ms, this.calm.matches);
      this.strokes.draw(this.beam, place);
    }
    this.strokes.draw(symbols.lines, place);
    this.marks.draw(symbols.marks, place);
    this.text.draw(place, colours.rgb.ground);
  }

  /** Draws into this part of the picture from now on; from the upper left. */
  #area(left, top, width, height) {
    const { gl, ratio } = this;
    const at = [left, this.height - top - height, width, height].map((px) => Math.round(px * ratio));
    gl.viewport(...at);
    gl.scissor(...at);
  }
}
