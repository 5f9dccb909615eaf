/** The signals stacked over one time axis: zoom asks for finer traces, the cursor's line lies above the drawing. */

import { API, at, query } from "../core/api.js";
import { CursorLine } from "../core/cursor-line.js";
import { h } from "../core/dom.js";
import { Figure, figureAhead } from "../core/figure.js";
import { chosenSignals } from "./signals.js";
import { timeTicks } from "./time-ticks.js";

const POINTS = 4000;
const PANEL_PX = 112;
const FRAME_PX = 70;
const TICK_PX = 80;
const SETTLE_MS = 40;

const figurePath = (tripId, names, from = null, to = null) =>
  `${API}/${at("trips", tripId, "/figures/stack")}${query({ signals: names, from_s: from, to_s: to, points: POINTS })}`;

/** Ask now for the plots of the whole trip. */
export const stackAhead = (tripId) => figureAhead(figurePath(tripId, chosenSignals()));

export class Stack {
  /** @param {HTMLElement} box @param {object} trip @param {import("./cursor.js").Cursor} cursor @param {...Node} tools Buttons under the plots. */
  constructor(box, trip, cursor, ...tools) {
    Object.assign(this, { trip, cursor, names: [] });
    this.figure = new Figure(box, {
      label: "Signals over time", height: this.heightOf(chosenSignals()), adjust: (figure) => this.adjust(figure), drawn: (plot) => this.drawn(plot),
    });
    this.line = new CursorLine(this.figure);
    this.back = h("button", { class: "btn bare small", hidden: true, on: { click: () => cursor.zoom() } }, "Whole trip");
    this.figure.badge.title = "Of every bundle of samples the lowest and the highest are drawn, so that no spike is lost. Zoom in to see every sample.";
    this.figure.under.append(" ", this.back);
    this.figure.footer.insertBefore(h("span", {}, tools), this.figure.tableButton);
    cursor.moved.add(() => this.place());
    cursor.zoomed.add(() => this.load());
    this.figure.plot.addEventListener("mousemove", (event) => this.follow(event));
  }

  /** Height of so many panels, in pixels. */
  heightOf(names) {
    return names.length * PANEL_PX + FRAME_PX;
  }

  /** Show these signals. */
  use(names) {
    this.names = names;
    this.figure.options.height = this.heightOf(names);
    return this.load();
  }

  async load() {
    const [from, to] = this.cursor.whole ? [null, null] : this.cursor.window;
    const began = performance.now();
    const drawn = await this.figure.load(figurePath(this.trip.id, this.names, from, to));
    if (drawn) performance.measure("ponthy-stack", { start: began });
  }

  /** The window of time comes from the cursor, whatever the figure says. */
  adjust({ layout }) {
    const ticks = timeTicks(this.trip.started_at, this.cursor.window, this.figure.plot.clientWidth / TICK_PX);
    for (const key of Object.keys(layout)) {
      if (/^xaxis\d*$/.test(key)) layout[key] = { ...layout[key], ...ticks, range: [...this.cursor.window], autorange: false };
    }
    layout.meta = { ...layout.meta, column: "Time since the start, s" }; // the table keeps to seconds
    if (layout.xaxis?.title) layout.xaxis.title.text = this.trip.started_at ? "Time of day" : "Time since the start";
    layout.uirevision = this.cursor.window.join();
    layout.dragmode = "zoom";
    layout.hovermode = false; // the cursor and its readout say more
  }

  drawn(plot) {
    if (!this.listening) {
      this.listening = true;
      plot.on("plotly_relayout", (change) => this.relayout(plot, change));
      plot.on("plotly_doubleclick", () => this.cursor.zoom());
    }
    this.back.hidden = this.cursor.whole;
    this.place();
  }

  /** The drawn curve of a signal, in the unit it is shown in; nothing while it is not drawn. */
  curve(name) {
    const { data = [], layout } = this.figure.figure ?? {};
    const curves = data.filter((trace) => trace.hoverinfo !== "skip");
    const drawn = curves[layout?.meta?.signals?.indexOf(name) ?? -1];
    return drawn && { t: drawn.x, value: drawn.y };
  }

  /** The reader has dragged a window in the plots. */
  relayout(plot, change) {
    if (!Object.keys(change).some((key) => /^xaxis\d*\.(range|autorange)/.test(key))) return;
    const [from, to] = plot._fullLayout.xaxis.range;
    clearTimeout(this.settling);
    this.settling = setTimeout(() => this.cursor.zoom(from, to), SETTLE_MS);
  }

  follow(event) {
    const t = this.line.under(event);
    if (t !== null) this.cursor.set(t);
  }

  /** Put the line where the cursor is. */
  place() {
    this.line.put(this.cursor.t);
  }
}
