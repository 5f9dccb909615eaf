/** The one time cursor of a trip, moved by mouse, keys or slider, and the window of time that the plots show. */

import { clockAt } from "../core/format.js";

const STEPS = 400;
const SHIFT = 10;
const ZOOM = 2;
const SMALLEST_WINDOW_S = 0.5;

export class Cursor {
  /** @param {number} duration Seconds of the trip. */
  constructor(duration) {
    this.duration = duration;
    this.t = 0;
    this.window = [0, duration];
    this.moved = new Set();
    this.zoomed = new Set();
  }

  /** Put the cursor at a time; beyond the ends it stays at the end. */
  set(t) {
    const clamped = Math.min(this.duration, Math.max(0, t));
    if (!Number.isFinite(clamped) || clamped === this.t) return;
    this.t = clamped;
    this.moved.forEach((listener) => listener(clamped));
  }

  /** Show a window of time; the whole trip when called without. */
  zoom(from = 0, to = this.duration) {
    const low = Math.max(0, Math.min(from, to));
    const high = Math.min(this.duration, Math.max(from, to));
    if (high - low < SMALLEST_WINDOW_S || (low === this.window[0] && high === this.window[1])) return;
    this.window = [low, high];
    this.zoomed.forEach((listener) => listener(low, high));
  }

  get whole() {
    return this.window[0] === 0 && this.window[1] === this.duration;
  }

  /** Zoom by a factor with the cursor kept where it stands in the window. */
  zoomBy(factor) {
    const [from, to] = this.window;
    const centre = this.t >= from && this.t <= to ? this.t : (from + to) / 2;
    this.zoom(centre - (centre - from) / factor, centre + (to - centre) / factor);
  }

  /** What a key does; true when it did something. */
  key(event) {
    const step = ((this.window[1] - this.window[0]) / STEPS) * (event.shiftKey ? SHIFT : 1);
    const doing = {
      ArrowRight: () => this.set(this.t + step), ArrowLeft: () => this.set(this.t - step),
      Home: () => this.set(this.window[0]), End: () => this.set(this.window[1]),
      "+": () => this.zoomBy(ZOOM), "=": () => this.zoomBy(ZOOM), "-": () => this.zoomBy(1 / ZOOM), 0: () => this.zoom(),
    }[event.key];
    if (!doing || event.ctrlKey || event.metaKey || event.altKey) return false;
    doing();
    return true;
  }
}

/** Elements that need the arrow keys for themselves. */
const OWN_KEYS = "input:not([type=range]), textarea, select, [role=tab], dialog, .table-box, summary, .log";

/** Let the slider and the keyboard move the cursor. */
export function steer(cursor, slider, startedAt) {
  slider.max = String(cursor.duration);
  const describe = () => slider.setAttribute("aria-valuetext", clockAt(startedAt, cursor.t));
  slider.addEventListener("input", () => cursor.set(Number(slider.value)));
  document.addEventListener("keydown", (event) => {
    if (!event.target.closest?.(OWN_KEYS) && cursor.key(event)) event.preventDefault();
  });
  cursor.moved.add((t) => {
    slider.value = String(t);
    describe();
  });
  describe();
}
