/** What else was tried: candidates with what they burn, and why they are worse. */

import { API, at } from "../core/api.js";
import { h, show } from "../core/dom.js";
import { Figure } from "../core/figure.js";
import { NOTHING } from "../core/format.js";
import { table } from "../core/ui.js";
import { certificateMark } from "../core/verdict.js";
import { energyText, shareText, timeText } from "./words.js";

const FIGURE_PX = 240;
const column = (text, kind) => h("th", { scope: "col", class: kind }, text);
const cell = (text) => h("td", { class: "n" }, text);

function row(one, fuel) {
  return h("tr", {}, h("th", { scope: "row" }, one.name, one.words && h("div", { class: "quiet small plain" }, one.words)), cell(energyText(one.fuel_energy_j)),
    cell(fuel > 0 ? shareText(one.fuel_energy_j / fuel - 1) : NOTHING), cell(timeText(one.time_s)), h("td", {}, one.verdict ? certificateMark(one.verdict) : ""));
}

/** Fill the panel. */
export function showCompetitors(panel, drive, answer) {
  const candidates = (answer.candidates ?? []).filter((one) => Number.isFinite(one.fuel_energy_j));
  if (candidates.length === 0) {
    show(panel, h("p", { class: "quiet" }, "No other drive came near enough to be told of. How much better than every other control this one is, moment by moment, stands under “How one knows”; other methods' drives under “Methods”."));
    return;
  }
  const box = h("div", { class: "figure" });
  show(panel, h("div", { class: "stack-gap" },
    table("Competitors", h("tr", {}, column("Competitor"), column("Fuel", "n"), column("More than the answer", "n"), column("Time", "n"), column("Verdict")), candidates.map((one) => row(one, answer.fuel_energy_j))),
    h("section", { class: "card" }, h("h2", {}, "More fuel than the answer"), box)));
  new Figure(box, { label: "More fuel than the answer", height: FIGURE_PX, tall: true }).load(`${API}/${at("drives", drive.id, "/figures/competitors")}`);
}
