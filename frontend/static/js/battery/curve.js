/** The open-circuit curve: edited row by row with its figure beside it, or fitted from a slow charge and discharge. */

import { API, at, get, post, put, query } from "../core/api.js";
import { h, show } from "../core/dom.js";
import { Figure } from "../core/figure.js";
import { announce, busy, problemBox, toast } from "../core/notify.js";
import { plotly } from "../core/plotly.js";
import { currentTheme, onTheme } from "../core/theme.js";
import { sentence } from "../drives/result.js";
import { plainly, typedNumber } from "../drives/paths.js";
import { droppable } from "../upload/drop.js";
import { CurveRows, rowsOf } from "./curve-rows.js";
import { sendFile } from "./data.js";
import { aroundText } from "./words.js";

const WAIT_MS = 300;
const FIGURE_PX = 340;

const curveOf = ({ ocv, ocv_soc_range }) => ({ ocv, ...(ocv_soc_range && { ocv_soc_range }) });

export class CurveEditor {
  /** @param {HTMLElement} panel @param {object} battery @param {{follow: (job: object) => void, saved: () => Promise<void>}} hooks */
  constructor(panel, battery, hooks) {
    Object.assign(this, { battery, hooks, path: at("batteries", battery.id), fitted: null });
    const places = { figure: h("div", { class: "figure" }), rows: h("div", { class: "section" }), origin: h("p", { class: "quiet small" }), outcome: h("div", { role: "status" }), proposal: h("div", {}) };
    Object.assign(this, { places });
    this.saveButton = h("button", { class: "btn primary", on: { click: (event) => busy(event.currentTarget, () => this.save()) } }, "Save the curve");
    show(panel, h("div", { class: "drive-grid" },
      h("section", { class: "card" }, h("h2", {}, "Open-circuit voltage over state of charge"), h("p", { class: "quiet small" }, "The voltage of a cell at rest. It decides what a voltage means, so everything else is as good as this curve."), places.figure, places.outcome),
      h("div", { class: "drive-side" },
        h("section", { class: "card" }, h("h2", {}, "Rows"), places.origin, places.rows,
          h("div", { class: "form-end" }, this.saveButton, h("button", { class: "btn", on: { click: () => this.begin() } }, "Undo all"))),
        h("section", { class: "card" }, h("h2", {}, "Fit it from data"), h("p", { class: "quiet small" }, "From a slow charge and discharge between empty and full, a twentieth of the capacity an hour or slower, or from pulses with long rests."), this.dropzone(), places.proposal))));
    this.figure = new Figure(places.figure, { label: "Open-circuit curve", height: FIGURE_PX, tall: true });
    this.rows = new CurveRows(places.rows, () => this.soon());
    onTheme(() => !this.figure.url && this.draw());
    this.begin();
  }

  dropzone() {
    const input = h("input", { class: "visually-hidden", type: "file", id: "curve-file", accept: ".csv,.gz,.parquet,.zip,.txt" });
    const zone = h("div", { class: "dropzone compact section" }, h("label", { class: "btn", htmlFor: "curve-file" }, "Choose a file…"), input, h("p", { class: "quiet small" }, "or drop it here"));
    droppable(zone, input, ([file]) => this.send(file));
    const help = "curve-capacity-help";
    this.capacity = h("input", { id: "curve-capacity", class: "number", inputMode: "decimal", autocomplete: "off", "aria-describedby": help });
    return [h("div", { class: "field section" }, h("label", { htmlFor: "curve-capacity" }, "Capacity of a cell"), h("div", { class: "with-unit" }, this.capacity, h("span", { class: "unit" }, "Ah")),
      h("p", { class: "help", id: help }, "Only needed where the data hold no full charge or discharge.")), zone];
  }

  /** Start from the configuration as it is. */
  begin() {
    this.fitted = null;
    show(this.places.proposal);
    this.rows.show(rowsOf(this.battery.config));
    const { ocv } = this.battery.config;
    show(this.places.outcome);
    show(this.places.origin, ocv?.length && !Array.isArray(ocv[0]) && `The curve is a polynomial with ${ocv.length} coefficients; these rows lie on it. Saving them makes it a table.`);
    this.turn = (this.turn ?? 0) + 1; // a drawing that is still under way is of what was edited
    if (ocv?.length) this.figure.load(`${API}/${this.path}/figures/curve`);
    else this.draw();
  }

  soon() {
    this.fitted = null; // what is edited by hand is no longer what was fitted
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.draw(), WAIT_MS);
  }

  /** Draw the rows as they are; a row that can't be is marked, and the figure stays as it was. */
  async draw() {
    this.figure.url = null; // what is drawn is not kept anywhere
    const mine = (this.turn = (this.turn ?? 0) + 1);
    const measured = this.fitted ? { soc: this.fitted.soc, volts: this.fitted.volts, spread_v: this.fitted.spread_v } : {};
    try {
      const [library, figure] = await Promise.all([plotly(), post(`batteries/curves/figure${query({ theme: currentTheme() })}`, { ocv: this.rows.rows, ...measured, ...(this.battery.config.ocv && { present: curveOf(this.battery.config) }) })]);
      if (mine !== this.turn) return;
      this.rows.clear();
      show(this.places.outcome);
      await this.figure.draw(library, figure);
    } catch (error) {
      if (mine === this.turn) this.refuse(error);
    }
  }

  refuse(error) {
    const path = error.path ?? error.field ?? "";
    const marked = this.rows.mark(path);
    const row = Number(/\d+/.exec(path)?.[0]) + 1;
    show(this.places.outcome, marked ? h("p", { class: "problem section" }, `Row ${row}: ${plainly(error.detail, path)}`) : problemBox(error));
  }

  async save() {
    try {
      const { ocv_soc_range: dropped, ...config } = await get(`${this.path}/config`);
      await put(`${this.path}/config`, { ...config, ocv: this.rows.rows });
      toast("The curve is in the car’s file. Estimates made before keep the curve they were made with.");
      await this.hooks.saved();
      this.begin();
    } catch (error) {
      this.refuse(error);
    }
  }

  async send(file) {
    show(this.places.proposal, h("p", { class: "quiet section" }, `Sending ${file.name}…`));
    try {
      const capacity = this.capacity.value.trim();
      const answer = await sendFile(`${this.path}/curve`, file, { capacity_ah: capacity && typedNumber(capacity) });
      show(this.places.proposal, h("p", { class: "quiet section" }, "A curve is being laid through it…"));
      if (answer.job) this.hooks.follow(answer.job);
    } catch (error) {
      show(this.places.proposal, h("div", { class: "section" }, problemBox(error)));
    }
  }

  /** Nothing could be fitted: its job tells why. */
  failed(job) {
    show(this.places.proposal, job.problem && h("div", { class: "section" }, problemBox(job.problem)));
  }

  /** A fit is there: show it over the present curve, and offer to take it. */
  propose(fitted) {
    this.fitted = fitted;
    show(this.places.origin);
    this.rows.show(rowsOf(fitted));
    show(this.places.proposal, h("div", { class: "section" }, h("p", {}, h("strong", {}, "A fitted curve is shown. "), Number.isFinite(fitted.capacity_ah) && `Between empty and full a cell held ${aroundText(fitted.capacity_ah, null, "Ah")}. `, "It takes the place of the present one when you save it."),
      (fitted.warnings ?? []).map((text) => h("p", { class: "note" }, sentence(text)))));
    announce("A fitted curve is shown.");
    this.draw();
  }
}
