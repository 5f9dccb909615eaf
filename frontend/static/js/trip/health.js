/** Does the observer agree with its sensors? The verdict with its reasons, sensor by sensor, and the innovations over time. */

import { API, at, get } from "../core/api.js";
import { h, show } from "../core/dom.js";
import { Figure } from "../core/figure.js";
import { number, percent } from "../core/format.js";
import { problemBox } from "../core/notify.js";
import { table } from "../core/ui.js";
import { verdictMark } from "../core/verdict.js";

const QUESTIONS = [
  ["nis", "Spread: NIS beside its band", "Mean normalised innovation squared; the bar is where 95 % of all right filters lie. Left of it a sensor is trusted less than it deserves, right of it more."],
  ["coverage", "Coverage: inside one and two σ", "Share of the innovations inside one and two predicted standard deviations; 68.3 % and 95.4 % are ideal, more is cautious."],
  ["whiteness", "Whiteness: correlation of neighbours", "Of a right filter with white noise it is zero. Noise that is correlated itself, like a receiver's wandering, shows here."],
  ["refusals", "Refusals over time", "When measurements lay so far off that they were refused, and where the sensor was believed in the end."],
];
const seconds = (value) => (value ? `${number(value, value < 10 ? 1 : 0)} s` : "–");

function sensorTable(rows) {
  const th = (text, kind, title) => h("th", { scope: "col", class: kind, title }, text);
  const band = (row) => (row.nis_low === null ? "" : `NIS of a right filter: ${number(row.nis_low, 2)} to ${number(row.nis_high, 2)}`);
  return table("How well each sensor agrees", h("tr", {}, th("Sensor"), th("Measurements", "n"), th("Refused", "n"), th("Longest", "n", "Longest time of refusal"),
    th("NIS", "n", "Mean normalised innovation squared; 1 is ideal"), th("Inside 1σ", "n", "68.3 % is ideal"), th("Inside 2σ", "n", "95.4 % is ideal"),
    th("Bias", "n", "Mean innovation in standard deviations; 0 is ideal"), th("Neighbours", "n", "Correlation of neighbouring innovations; 0 is ideal")),
  rows.map((row) => h("tr", {}, h("th", { scope: "row" }, row.words), h("td", { class: "n" }, number(row.count)), h("td", { class: "n" }, number(row.rejected)),
    h("td", { class: "n" }, seconds(row.longest_refusal_s)), h("td", { class: "n", title: band(row) }, number(row.nis_mean, row.nis_mean < 0.01 ? 4 : 2)), h("td", { class: "n" }, percent(row.within_one_sigma)),
    h("td", { class: "n" }, percent(row.within_two_sigma)), h("td", { class: "n" }, number(row.bias, 2)), h("td", { class: "n" }, number(row.lag1, 2)))));
}

/** Fill the panel. */
export async function showHealth(panel, trip) {
  const sensors = h("div", {}, h("p", { class: "waiting" }, "Loading the sensors…"));
  const innovations = h("div", { class: "figure" });
  const list = (items) => h("ul", { class: "reasons" }, items.map((text) => h("li", {}, text)));
  const asked = QUESTIONS.map(([name, title, help]) => ({ name, title, help, box: h("div", { class: "figure" }) }));
  show(panel, h("section", { class: "card" }, h("header", {}, h("h2", {}, "Verdict"), verdictMark(trip.verdict)),
      trip.reasons.length > 0 ? list(trip.reasons) : h("p", { class: "quiet" }, "No reason was given."),
      trip.warnings.length > 0 && [h("h3", { class: "section" }, "Warnings"), list(trip.warnings)],
      h("p", { class: "quiet small section" }, "Healthy: the measurements differ from the model's predictions by no more than their stated noise explains (NIS up to about 1, 95 % or more inside 2σ), in no lasting direction.")),
  h("section", { class: "card section" }, h("h2", {}, "Sensors"), h("div", { class: "section" }, sensors)), h("div", { class: "columns section" }, asked.map(({ title, help, box }) => h("section", { class: "card" }, h("h2", {}, title), h("p", { class: "quiet small" }, help), box))),
  h("section", { class: "card section" }, h("h2", {}, "Innovations: measured minus predicted, in standard deviations"), innovations));
  for (const { name, title, box } of asked) new Figure(box, { label: title, height: 300, tall: true }).load(`${API}/${at("trips", trip.id, `/figures/${name}`)}`);
  new Figure(innovations, { label: "Innovations", height: 420, tall: true }).load(`${API}/${at("trips", trip.id, "/figures/innovations")}`);
  try {
    const answer = await get(at("trips", trip.id, "/consistency"));
    show(sensors, sensorTable(answer.items ?? answer.sensors ?? answer));
  } catch (error) {
    show(sensors, problemBox(error));
  }
}
