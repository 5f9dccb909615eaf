/** Ageing: trend and remaining life to a chosen threshold, and capacities that a laboratory measured. */

import { API, at, get, post, query, remove } from "../core/api.js";
import { h, show } from "../core/dom.js";
import { Figure } from "../core/figure.js";
import { when } from "../core/format.js";
import { busy, complain, guarded, problemBox } from "../core/notify.js";
import { confirmed, table } from "../core/ui.js";
import { plainly, typedNumber } from "../drives/paths.js";
import { sentence } from "../drives/result.js";
import { lifeWords, trendWords } from "./life-words.js";
import { around } from "./words.js";

const FIGURE_PX = 360;
const WAIT_MS = 250;
const TESTS = 200;
const START = 0.8;

export class Ageing {
  constructor(panel, battery) {
    Object.assign(this, { battery, path: at("batteries", battery.id) });
    const threshold = Math.round(100 * (battery.end_of_life ?? START));
    this.slider = h("input", { type: "range", id: "threshold", min: 40, max: 95, step: 1, value: threshold, on: { input: () => this.moved() } });
    this.output = h("output", { htmlFor: "threshold" }, `${threshold}\u202f%`);
    Object.assign(this, { words: h("div", { role: "status" }), box: h("div", { class: "figure" }), tests: h("div", { class: "section" }), outcome: h("div", { role: "status" }) });
    show(panel, h("div", { class: "drive-grid" },
      h("section", { class: "card" }, h("header", {}, h("h2", {}, "Where it is heading"), h("div", { class: "threshold" }, h("label", { htmlFor: "threshold" }, "Worn out at"), this.slider, this.output)), this.words, this.box,
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
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.draw().catch(complain), WAIT_MS);
  }

  /** Words and figure for the threshold as it stands. */
  async draw() {
    const threshold = this.slider.value / 100;
    const ageing = await get(`${this.path}/ageing${query({ threshold })}`);
    if (threshold !== this.slider.value / 100) return;
    const trend = trendWords(ageing);
    show(this.words, trend && h("p", {}, trend), h("p", {}, lifeWords(ageing, threshold)), (ageing.warnings ?? []).map((text) => h("p", { class: "note" }, sentence(text))));
    await this.figure.load(`${API}/${this.path}/figures/ageing${query({ threshold })}`);
  }

  async list() {
    const { items } = await get(`${this.path}/tests${query({ limit: TESTS })}`);
    const th = (text, kind) => h("th", { scope: "col", class: kind }, text);
    show(this.tests, items.length === 0 ? h("p", { class: "quiet" }, "None yet.") : table("Laboratory tests", h("tr", {}, th("Tested"), th("Capacity", "n"), th("Note"), th("")), items.map((test) => this.testRow(test))));
  }

  testRow(test) {
    const away = (event) => busy(event.currentTarget, async () => {
      if (!(await confirmed("Remove this test?", "It no longer counts in the ageing.", "Remove"))) return;
      await remove(`${this.path}/tests/${test.id}`);
      await this.renew();
    });
    return h("tr", {}, h("td", {}, when(test.at)), h("td", { class: "n" }, around(test.capacity_ah, test.capacity_ah_sd, "Ah")), h("td", {}, test.note), h("td", { class: "row-actions" }, h("button", { class: "btn bare small", on: { click: away } }, "Remove")));
  }

  renew() {
    return guarded(() => Promise.all([this.draw(), this.list()]), this.outcome);
  }
}
