/** The line under the plots: what every signal is at the cursor. Near values at once, exact ones when the cursor rests. */

import { at, get, query } from "../core/api.js";
import { h, show } from "../core/dom.js";
import { NOTHING, clockAt, elapsed, number } from "../core/format.js";
import { signal } from "./signals.js";
import { valueAt } from "./value-at.js";

const REST_MS = 90;
const LEAST_DIGITS = 4;

export class Readout {
  /**
   * @param {HTMLElement} box
   * @param {object} trip
   * @param {import("./cursor.js").Cursor} cursor
   * @param {import("./stack.js").Stack} stack
   * @param {import("./track.js").Track} track
   */
  constructor(box, trip, cursor, stack, track) {
    Object.assign(this, { trip, cursor, stack, track, places: new Map() });
    this.clock = h("span", { class: "clock" });
    this.values = h("span", { class: "readout" });
    show(box, this.clock, this.values);
    cursor.moved.add(() => this.move());
  }

  /** Show these signals. */
  use(names) {
    this.places = new Map(names.map((name) => [name, h("b", { style: `min-width: ${LEAST_DIGITS + signal(name).decimals}ch` })]));
    show(this.values, names.map((name) => h("span", { title: signal(name).label }, this.places.get(name), " ",
      h("span", { class: "unit" }, signal(name).unit || signal(name).label.toLowerCase()))));
    this.move();
  }

  /** The cursor has moved: near values now, exact ones when it rests. */
  move() {
    const { t } = this.cursor;
    this.write(t, (name) => valueAt(this.stack.curve(name), t));
    this.track.put(this.track.spotAt(t));
    clearTimeout(this.resting);
    this.resting = setTimeout(() => this.settle(t), REST_MS);
  }

  async settle(t) {
    const row = await get(at("trips", this.trip.id, `/at${query({ t_s: t })}`)).catch(() => null);
    if (!row || this.cursor.t !== t) return;
    this.write(t, (name) => (Number.isFinite(row[name]) ? row[name] * signal(name).factor : null));
    this.track.put(this.track.columns.map((name) => row[name]));
  }

  write(t, value) {
    this.clock.textContent = clockAt(this.trip.started_at, t);
    this.clock.title = `${elapsed(t)} after the start`;
    for (const [name, place] of this.places) {
      const shown = value(name);
      place.textContent = shown === null ? NOTHING : number(shown, signal(name).decimals);
    }
  }
}
