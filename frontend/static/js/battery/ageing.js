/** Ageing: trend and remaining life to a chosen threshold, and capacities that a laboratory measured. */

import { API, at, get, patch, post, query, remove } from "../core/api.js";
import { h, show } from "../core/dom.js";
import { Figure } from "../core/figure.js";
import { measure, when } from "../core/format.js";
import { busy, complain, guarded, problemBox, toast } from "../core/notify.js";
import { confirmed, table } from "../core/ui.js";
import { plainly, typedNumber } from "../drives/paths.js";
import { sentence } from "../drives/result.js";
import { lifeWords, trendWords } from "./life-words.js";
import { around } from "./words.js";

const FIGURE_PX = 360;
const WAIT_MS = 250;
const TESTS = 200;
const START = 0.8;
const MINUTES_A_DAY = 1440;
const MINUTE_MS = 60_000;

export class Ageing {
  constructor(panel, battery) {
    Object.assign(this, { battery, path: at("batteries", battery.id) });
    const threshold = Math.round(100 * (battery.end_of_life ?? START));
    this.slider = h("input", { type: "range", id: "threshold", min: 40, max: 95, step: 1, value: threshold, on: { input: () => this.moved() } });
    this.output = h("output", { htmlFor: "threshold" }, `${threshold}\u202f%`);
    this.keep = h("button", { class: "btn small", hidden: true, on: { click: (event) => busy(event.currentTarget, () => this.keepThreshold()) } }, "Keep");
    Object.assign(this, { words: h("div", { role: "status" }), box: h("div", { class: "figure" }), tests: h("div", { class: "section" }), outcome: h("div", { role: "status" }) });
    show(panel, h("div", { class: "drive-grid" },
      h("section", { class: "card" }, h("header", {}, h("h2", {}, "Where it is heading"), h("div", { class: "threshold" }, h("label", { htmlFor: "threshold" }, "Worn out at"), this.slider, this.output, this.keep)), this.words, this.box,
        h("p", { class: "quiet small" }, "Bands: one and two standard deviations. Diamonds: tested in a laboratory.")),
      h("section", { class: "card" }, h("h2", {}, "Laboratory tests"), h("p", { class: "quiet small" }, "A capacity measured by a full discharge. Each is laid beside what was estimated at the time."), this.tests, this.form())));
    this.figure = new Figure(this.box, { label: "State of health and where it is heading", height: FIGURE_PX, tall: true });
    this.renew();
  }

  form() {
    const field = (id, label, unit, props, help) => h("div", { class: "field", dataset: { path: id } }, h("label", { htmlFor: `test-${id}` }, label),
      h("div", { class: "with-unit" }, h("input", { id: `test-${id}`, autocomplete: "off", ...props }), unit && h("span", { class: "unit" }, unit)), help && h("p", { class: "help" }, help), h("p", { class: "error", id: `test-${id}-error`, hidden: true }));
    const form = h("form", { noValidate: true, class: "section" }, h("div", { class: "form-grid" },
      field("at", "Tested on", "", { type: "date" }), field("capacity_ah", "Capacity of a cell", "Ah", { class: "number", inputMode: "decimal" }, "A pack’s capacity divided by its strings."),
      field("capacity_ah_sd", "± (1σ)", "Ah", { class: "number", inputMode: "decimal" }, "Optional."), field("note", "Note", "", { maxLength: 500 })), this.outcome,
    h("div", { class: "form-end" }, h("button", { class: "btn" }, "Add the test")));
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      busy(form.querySelector("button"), () => this.add(form));
    });
    return form;
  }

  async add(form) {
    const value = (id) => form.querySelector(`#test-${id}`).value.trim();
    for (const input of form.querySelectorAll("[aria-invalid]")) input.removeAttribute("aria-invalid");
    for (const error of form.querySelectorAll(".error")) error.hidden = true;
    show(this.outcome);
    const body = { at: value("at") ? `${value("at")}T12:00:00Z` : null, capacity_ah: typedNumber(value("capacity_ah")), ...(value("capacity_ah_sd") && { capacity_ah_sd: typedNumber(value("capacity_ah_sd")) }), ...(value("note") && { note: value("note") }) };
    try {
      await post(`${this.path}/tests`, body);
      form.reset();
      await this.renew();
    } catch (error) {
      this.refuse(form, error);
    }
  }

  /** Put a refusal beside its field, or under the form where it has none. */
  refuse(form, error) {
    const path = (error.path ?? error.field ?? "").replace(/^body\./, "");
    const place = form.querySelector(`[data-path="${CSS.escape(path)}"]`);
    if (!place) {
      show(this.outcome, h("div", { class: "section" }, problemBox(error)));
      return;
    }
    const [input, message] = [place.querySelector("input"), place.querySelector(".error")];
    input.setAttribute("aria-invalid", "true");
    input.setAttribute("aria-errormessage", message.id);
    message.textContent = plainly(error.detail, path);
    message.hidden = false;
    input.focus();
  }

  moved() {
    this.output.textContent = `${this.slider.value}\u202f%`;
    this.offerKeeping();
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.draw().catch(complain), WAIT_MS);
  }

  /** Write the threshold into the car's file as the battery's end of life. */
  async keepThreshold() {
    Object.assign(this.battery, await patch(this.path, { end_of_life: this.slider.value / 100 }));
    this.offerKeeping();
    toast(`It counts as worn out at ${this.slider.value}\u202f% from now on.`);
  }

  offerKeeping() {
    this.keep.hidden = Math.round(100 * (this.battery.end_of_life ?? START)) === Number(this.slider.value);
  }

  /** Words and figure for the threshold as it stands. */
  async draw() {
    const threshold = this.slider.value / 100;
    const ageing = await get(`${this.path}/ageing${query({ threshold })}`);
    if (threshold !== this.slider.value / 100) return;
    this.compared = new Map(ageing.tests.map((test) => [Math.round(test.at_days * MINUTES_A_DAY), test]));
    const trend = trendWords(ageing);
    show(this.words, trend && h("p", {}, trend), h("p", {}, lifeWords(ageing, threshold)), (ageing.warnings ?? []).map((text) => h("p", { class: "note" }, sentence(text))));
    await this.figure.load(`${API}/${this.path}/figures/ageing${query({ threshold })}`);
  }

  async list() {
    const { items } = await get(`${this.path}/tests${query({ limit: TESTS })}`);
    const th = (text, kind) => h("th", { scope: "col", class: kind }, text);
    show(this.tests, items.length === 0 ? h("p", { class: "quiet" }, "None yet.") : table("Laboratory tests", h("tr", {}, th("Tested"), th("Capacity", "n"), th("Estimated for then", "n"), th("Apart", "n"), th("Note"), th("")), items.map((test) => this.testRow(test))));
  }

  testRow(test) {
    const n = (...content) => h("td", { class: "n" }, ...content);
    const compared = this.compared?.get(Math.round(Date.parse(test.at) / MINUTE_MS));
    const away = (event) => busy(event.currentTarget, async () => {
      if (!(await confirmed("Remove this test?", "It no longer counts in the ageing.", "Remove"))) return;
      await remove(`${this.path}/tests/${test.id}`);
      await this.renew();
    });
    return h("tr", {}, h("td", {}, when(test.at)), n(around(test.capacity_ah, test.capacity_ah_sd, "Ah")), n(around(compared?.estimated_ah, compared?.estimated_ah_sd, "Ah")), n(measure(compared?.sigmas, "σ", 1)), h("td", {}, test.note), h("td", { class: "row-actions" }, h("button", { class: "btn bare small", on: { click: away } }, "Remove")));
  }

  renew() {
    return guarded(async () => {
      await this.draw();
      await this.list();
    }, this.outcome);
  }
}
