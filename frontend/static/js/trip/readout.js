/** The line under the plots: what every signal is at the cursor. Near values at once, exact ones when the cursor rests. */

import { at, get, query } from "../core/api.js";
import { h, show } from "../core/dom.js";
import { NOTHING, clockAt, elapsed, number } from "../core/format.js";
import { signal } from "./signals.js";

const POINTS = 1500;
const REST_MS = 90;

/** Value of a trace at a time, between its two neighbours; null outside, and next to a gap. */
export function valueAt(trace, t) {
  const { t_s: times, value } = trace ?? {};
  if (!times?.length || t < times[0] || t > times[times.length - 1]) return null;
  let [low, high] = [0, times.length - 1];
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (times[middle] <= t) low = middle;
    else high = middle;
  }
  if (value[low] === null || value[high] === null) return null;
  const share = times[high] === times[low] ? 0 : (t - times[low]) / (times[high] - times[low]);
  return value[low] + share * (value[high] - value[low]);
}

export class Readout {
  /** @param {HTMLElement} box @param {object} trip @param {import("./cursor.js").Cursor} cursor @param {import("./track.js").Track} track */
  constructor(box, trip, cursor, track) {
    Object.assign(this, { trip, cursor, track, names: [], traces: {} });
    this.clock = h("span", { class: "clock" });
    this.values = h("span", { class: "readout" });
    show(box, this.clock, this.values);
    cursor.moved.add(() => this.move());
    cursor.zoomed.add(() => this.fetch());
  }

  /** Show these signals. */
  async use(names) {
    this.names = names;
    const width = (name) => Math.max(4, signal(name).decimals + 4);
    this.places = new Map(names.map((name) => [name, h("b", { style: `min-width: ${width(name)}ch` })]));
    show(this.values, names.map((name) => h("span", { title: signal(name).label }, this.places.get(name), " ", h("span", { class: "unit" }, signal(name).unit || signal(name).label.toLowerCase()))));
    await this.fetch();
  }

  async fetch() {
    this.fetching?.abort();
    const mine = (this.fetching = new AbortController());
    const [from, to] = this.cursor.window;
    const signals = [...new Set([...this.names, ...this.track.columns])];
    try {
      const answer = await get(at("trips", this.trip.id, `/traces${query({ signals, from_s: from, to_s: to, points: POINTS })}`), { signal: mine.signal });
      this.traces = answer.signals;
      this.move();
    } catch (error) {
      if (error.name !== "AbortError") throw error;
    }
  }

  /** The cursor has moved: near values now, exact ones when it rests. */
  move() {
    const { t } = this.cursor;
    this.write(t, (name) => valueAt(this.traces[name], t));
    clearTimeout(this.resting);
    this.resting = setTimeout(() => this.settle(t), REST_MS);
  }

  async settle(t) {
    const row = await get(at("trips", this.trip.id, `/at${query({ t_s: t })}`)).catch(() => null);
    if (!row || this.cursor.t !== t) return;
    const values = row.values ?? row;
    this.write(t, (name) => values[name] ?? null);
  }

  write(t, value) {
    this.clock.textContent = clockAt(this.trip.started_at, t);
    this.clock.title = `${elapsed(t)} after the start`;
    for (const [name, place] of this.places ?? []) {
      const { factor, decimals } = signal(name);
      const raw = value(name);
      place.textContent = raw === null || raw === undefined ? NOTHING : number(raw * factor, decimals);
    }
    this.track.put(...this.track.columns.map(value));
  }
}
