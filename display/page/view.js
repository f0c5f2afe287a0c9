// Which part of the plane is on the screen: pixels are those of CSS, metres east and north.

const NEAREST_M = 5;

export class View {
  constructor() {
    this.width = 1;
    this.height = 1;
    this.x = 0;
    this.y = 0;
    /** Pixels per metre. */
    this.scale = 0.1;
    /** What `fit` shows: centre and half of its extent. */
    this.whole = { x: 0, y: 0, half: 5000 };
    /** Grows with every change. */
    this.version = 0;
    this.fitted = true;
  }

  resize(width, height) {
    if (width === this.width && height === this.height) return;
    this.width = Math.max(1, width);
    this.height = Math.max(1, height);
    if (this.fitted) this.fit();
    this.version += 1;
  }

  /** Takes this circle for everything there is. */
  cover(x, y, half) {
    this.whole = { x, y, half };
    if (this.fitted) this.fit();
  }

  fit() {
    const { x, y, half } = this.whole;
    this.x = x;
    this.y = y;
    this.scale = Math.min(this.width, this.height) / 2 / (half * 1.13);
    this.fitted = true;
    this.version += 1;
  }

  pan(dx_px, dy_px) {
    this.centre(this.x - dx_px / this.scale, this.y + dy_px / this.scale);
  }

  centre(x, y) {
    this.x = x;
    this.y = y;
    this.fitted = false;
    this.version += 1;
  }

  /** Zooms and keeps what is under this pixel where it is. */
  zoom(factor, px = this.width / 2, py = this.height / 2) {
    const [x, y] = [this.metreX(px), this.metreY(py)];
    const least = Math.min(this.width, this.height) / (8 * this.whole.half);
    const most = Math.min(this.width, this.height) / (2 * NEAREST_M);
    this.scale = Math.min(most, Math.max(least, this.scale * factor));
    this.centre(x - (px - this.width / 2) / this.scale, y + (py - this.height / 2) / this.scale);
  }

  screenX(x) {
    return this.width / 2 + (x - this.x) * this.scale;
  }

  screenY(y) {
    return this.height / 2 - (y - this.y) * this.scale;
  }

  metreX(px) {
    return this.x + (px - this.width / 2) / this.scale;
  }

  metreY(py) {
    return this.y - (py - this.height / 2) / this.scale;
  }
}
