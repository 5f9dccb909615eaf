/** Panels of a drive over time or distance, its path over the map, and one cursor through both. */

import { API, at, query } from "../core/api.js";
import { CursorDot, CursorLine } from "../core/cursor-line.js";
import { checked, h, show } from "../core/dom.js";
import { Figure } from "../core/figure.js";
import { NOTHING, number } from "../core/format.js";
import { valueAt } from "../trip/value-at.js";

const FIRST_PX = 560;
const PATH_PX = 520;

export class Along {
  /**
   * @param {{stack: HTMLElement, path: HTMLElement, slider: HTMLInputElement, readout: HTMLElement, over: HTMLElement}} places
   * @param {string} driveId
   * @param {{other?: string, plane?: string, label?: string}} [options] Another drive laid over this one; which figure goes beside the panels.
   */
  constructor(places, driveId, { other = null, plane = "path", label = "Path over the engine’s efficiency" } = {}) {
    Object.assign(this, { places, driveId, other, plane });
    this.stack = new Figure(places.stack, { label: "Along the drive", height: FIRST_PX, tall: true, adjust: ({ layout }) => { layout.hovermode = false; }, drawn: () => this.put() });
    this.path = new Figure(places.path, { label, height: PATH_PX, drawn: () => this.put() });
    [this.line, this.dot] = [new CursorLine(this.stack), new CursorDot(this.path)];
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

  /** Values of the drawn lines at the cursor. */
  values() {
    const x = Number(this.places.slider.value);
    return (this.stack.figure?.data ?? []).map((trace) => ({
      name: trace.name, dash: trace.line.dash, decimals: Number(/%\{y:\.(\d+)f\}/.exec(trace.hovertemplate)?.[1] ?? 1),
      value: valueAt({ t: trace.x, value: trace.y, stepped: trace.line.shape === "hv" }, x),
    }));
  }

  /** Bring line, dot and words to where the slider stands. */
  put() {
    const [x, values] = [Number(this.places.slider.value), this.values()];
    this.line.put(x);
    const of = (name) => values.find((one) => one.name === name)?.value;
    if (this.plane === "path") this.dot.put(of("Engine speed, rpm"), of("Torque, Nm"));
    else this.dot.put(of("x₁"), of("x₂"));
    const [place, unit] = /, km$/.test(this.stack.figure?.layout.xaxis?.title?.text ?? "") ? [number(x, 3), "km"] : [number(x, 2), "s"];
    this.places.slider.setAttribute("aria-valuetext", `${place} ${unit}`);
    show(this.places.readout, h("span", { class: "clock" }, `${place}\u202f`, h("span", { class: "unit" }, unit)), values.filter((one) => one.dash !== "dot").map(shown));
  }
}

/** One value as the readout tells it. */
function shown({ name, value, decimals }) {
  const cut = name.lastIndexOf(", ");
  const [label, unit] = cut < 0 ? [name, ""] : [name.slice(0, cut), name.slice(cut + 2)];
  const digits = Math.min(decimals, 2);
  const text = value === null ? NOTHING : label === "Gear" && value === 0 ? "N" : number(value, digits);
  return h("span", { title: label }, h("b", {}, text), " ", h("span", { class: "unit" }, unit || label.toLowerCase()));
}
