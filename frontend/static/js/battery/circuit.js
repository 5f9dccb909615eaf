/** The circuit's parameters: over time with their bands, and as a table. */

import { API } from "../core/api.js";
import { h, show } from "../core/dom.js";
import { Figure } from "../core/figure.js";
import { table } from "../core/ui.js";
import { PARAMETERS, around } from "./words.js";

const FIGURE_PX = 600;

/** Relaxation's time constant; its deviation is not told, as the two go together. */
const seconds = (values) => values.relaxation_capacitance_f * values.relaxation_resistance_ohm;

function valuesTable(newest, initial) {
  const n = (...content) => h("td", { class: "n" }, ...content);
  const rows = PARAMETERS.map(([name, words, unit, factor]) => h("tr", {}, h("th", { scope: "row" }, words),
    n(around(newest[name], newest[`${name}_sd`], unit, factor)), n(around(initial[name], null, unit, factor))));
  rows.push(h("tr", {}, h("th", { scope: "row" }, "Time constant of the relaxation"), n(around(seconds(newest), null, "s")), n(around(seconds(initial), null, "s"))));
  const th = (text, kind) => h("th", { scope: "col", class: kind }, text);
  return table("Parameters of the circuit", h("tr", {}, th("Of one cell"), th("Now", "n"), th("To begin with", "n")), rows);
}

/** Fill the panel. */
export function showCircuit(panel, battery, url) {
  const box = h("div", { class: "figure" });
  show(panel, h("div", { class: "drive-grid" },
    h("section", { class: "card" }, h("h2", {}, "Parameters over the record"), h("p", { class: "quiet small" }, "Bands: one and two standard deviations. Dotted: what the configuration begins with."), box),
    h("section", { class: "card" }, h("h2", {}, "In numbers"), h("div", { class: "section" }, valuesTable(battery.shown, battery.config.initial ?? {})),
      h("p", { class: "quiet small section" }, "The cell’s voltage is its open-circuit voltage, the drop over the series resistance, and the drop over a resistance and a capacitance side by side, which relaxes after every change of current."))));
  new Figure(box, { label: "Parameters over the record", height: FIGURE_PX, tall: true }).load(`${API}/${url("parameters")}`);
}
