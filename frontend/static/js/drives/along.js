/** Panels of a drive over time or distance, its path over the map, and one cursor through both. */

import { API, at, query } from "../core/api.js";
import { CursorDot, CursorLine } from "../core/cursor-line.js";
import { byId, checked, h, show } from "../core/dom.js";
import { Figure } from "../core/figure.js";
import { NOTHING, number } from "../core/format.js";
import { valueAt } from "../trip/value-at.js";

const FIRST_PX = 560;
const PATH_PX = 520;

export class Along {
  /**
   * @param {string} driveId
   * @param {{other?: string, plane?: string, label?: string}} [options] Another drive laid over this one; which figure goes beside the panels.
   */
  constructor(driveId, { other = null, plane = "path", label = "Path over the engine’s efficiency" } = {}) {
    const places = { stack: byId("stack"), path: byId("path"), slider: byId("cursor-slider"), readout: byId("readout"), over: byId("over-switch") };
    Object.assign(this, { places, driveId, other, plane });
    this.stack = new Figure(places.stack, { label: "Along the drive", height: FIRST_PX, tall: true, adjust: ({ layout }) => { layout.hovermode = false; }, drawn: () => this.put() });
    this.path = new Figure(places.path, { label, height: PATH_PX, drawn: () => this.put() });
    this.line = new CursorLine(this.stack);
    this.dots = ["drive", "other"].map((role) => [role, new CursorDot(this.path)]);
    this.stack.plot.addEventListener("mousemove", (event) => {
      const x = this.line.under(event);
      if (x !== null) this.move(x);
    });
    places.slider.addEventListener("input", () => this.put());
    places.over.addEventListener("change", () => this.draw(true));
  }

  url(name) {
    return `${API}/${at("drives", this.driveId, `/figures/${name}`)}${query({ over: checked("over"), other: this.other })}`;
  }

  /** Draw both; with `again` only what hangs on the choice of time or distance. */
  async draw(again = false) {
    await Promise.all([this.stack.load(this.url("stack")), !again && this.path.load(this.url(this.plane))]);
    const [from, to] = this.stack.figure?.layout.xaxis?.range ?? [0, 1];
    Object.assign(this.places.slider, { min: String(from), max: String(to) });
    this.put();
  }

  move(x) {
    this.places.slider.value = String(x);
    this.put();
  }

  /** Values of the drives' lines at the cursor, by panel. */
  values() {
    const x = Number(this.places.slider.value);
    const lines = (this.stack.figure?.data ?? []).filter((trace) => trace.meta.role !== "limit");
    return Map.groupBy(lines.map((trace) => ({ ...trace.meta, value: valueAt({ t: trace.x, value: trace.y, stepped: trace.line.shape === "hv" }, x) })), (one) => one.panel);
  }

  /** Bring line, dots and words to where the slider stands. */
  put() {
    const [x, values] = [Number(this.places.slider.value), this.values()];
    this.line.put(x);
    const [across, up] = (this.plane === "path" ? ["Engine speed", "Torque"] : ["x₁", "x₂"]).map((panel) => values.get(panel) ?? []);
    for (const [role, dot] of this.dots) dot.put(...[across, up].map((lines) => lines.find((one) => one.role === role)?.value ?? null));
    const [place, unit] = /, km$/.test(this.stack.figure?.layout.xaxis?.title?.text ?? "") ? [number(x, 3), "km"] : [number(x, 2), "s"];
    this.places.slider.setAttribute("aria-valuetext", `${place} ${unit}`);
    show(this.places.readout, h("span", { class: "clock" }, `${place}\u202f`, h("span", { class: "unit" }, unit)), [...values].map(([panel, lines]) => shown(panel, lines)));
  }
}

/** One panel as the readout tells it: the value of the drive, and of the other one after it. */
function shown(panel, lines) {
  const [{ unit, decimals }] = lines;
  const text = ({ value }) => (value === null ? NOTHING : panel === "Gear" && value === 0 ? "N" : number(value, Math.min(decimals, 2)));
  return h("span", { title: panel }, lines.map((one, i) => [i > 0 && h("span", { class: "quiet" }, " | "), h("b", {}, text(one))]), " ", h("span", { class: "unit" }, unit || panel.toLowerCase()));
}
