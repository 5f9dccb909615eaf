/** How well the model fits what was measured: residuals of the voltage beside its noise, current and voltage. */

import { API } from "../core/api.js";
import { h, show } from "../core/dom.js";
import { Figure } from "../core/figure.js";
import { measureText } from "../core/format.js";

function words(newest) {
  const [rms, noise] = [newest.voltage_rms_v, newest.voltage_noise_v];
  if (!(rms >= 0)) return "The residuals of this estimate are not known.";
  const level = noise > 0 ? `, with the voltage’s noise at ${measureText(1e3 * noise, "mV", 2)}` : "";
  return `Once it had settled, the model was off by ${measureText(1e3 * rms, "mV", 2)} (rms of a cell, one row ahead)${level}.`;
}

/** Fill the panel. */
export function showFit(panel, battery, url) {
  const [residual, current] = [h("div", { class: "figure" }), h("div", { class: "figure" })];
  show(panel, h("section", { class: "card" }, h("h2", {}, "Measured less predicted voltage"), h("p", { class: "quiet small" }, `${words(battery.shown)} Dashed: twice the noise. Right: how often, beside what noise alone would be.`), residual),
    h("section", { class: "card section" }, h("h2", {}, "Current and voltage"), current));
  new Figure(residual, { label: "Measured less predicted voltage", height: 300, tall: true }).load(`${API}/${url("residual")}`);
  new Figure(current, { label: "Current and voltage", height: 400, tall: true }).load(`${API}/${url("current")}`);
}
