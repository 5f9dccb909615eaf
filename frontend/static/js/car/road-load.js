/** Road load from driving: mass, drag and rolling resistance, and what they make of the engine's efficiency. */

import { h } from "../core/dom.js";
import { number, percent, plural } from "../core/format.js";
import { table } from "../core/ui.js";

const SOURCES = { prior: "the car file", coasting: "coasting", gravity: "slopes", acceleration: "accelerating", cruising: "cruising" };
const QUANTITIES = [["mass_kg", "Mass with driver and things, kg", 0], ["cd_area_m2", "Drag area C_d·A, m²", 3], ["crr", "Rolling resistance C_rr", 4]];
const LEAST_SHARE = 0.005;

const cell = (...content) => h("td", { class: "n" }, content);
const column = (text, kind) => h("th", { scope: "col", class: kind }, text);

function quantityRow(found, [name, label, digits]) {
  const one = found[name];
  const rests = one.shares.filter(({ share }) => share >= LEAST_SHARE).map(({ source, share }) => `${SOURCES[source]} ${number(100 * share)}\u202f%`);
  return h("tr", {}, h("th", { scope: "row" }, label), cell(number(one.file, digits)),
    cell(h("strong", {}, number(one.value, digits)), h("span", { class: "quiet" }, ` ±\u202f${number(one.sd, digits)}`)), h("td", {}, rests.join(", ")));
}

function levelRow(label, { before, after }) {
  return h("tr", {}, h("th", { scope: "row" }, label), cell(percent(before)), cell(h("strong", {}, percent(after))), cell(`${after < before ? "−" : "+"}${number(100 * Math.abs(after - before), 1)}`));
}

/** The engine's efficiency with the file's road load and with the one from driving. */
function levelsView({ best, by_load: loads, ...all }) {
  const rows = [levelRow("All driving", all)];
  if (best) rows.push(levelRow(`Best point, ${number(best.rpm, 0)} rpm and ${number(best.nm_before, 0)} Nm`, best));
  rows.push(...loads.map((one) => levelRow(`At ${number(one.fuel_power_w / 1000, 0)} kW of fuel`, one)));
  const head = h("tr", {}, column("Efficiency of the engine"), column("Car file", "n"), column("Road load from driving", "n"), column("Points", "n"));
  return table("Efficiency before and after", head, rows);
}

/** What the trips tell of the road load, or nothing where none of them tells. */
export function roadLoadView(found) {
  if (!found) return null;
  const head = h("tr", {}, column("Value"), column("Car file", "n"), column("From driving, ±1σ", "n"), column("Rests on"));
  const counted = `${number(found.hours, 1)} h of steady driving in ${plural(found.trips, "trip")}, ${plural(found.coasting_windows, "stretch", "stretches")} of coasting.`;
  return h("div", { class: "card section" }, h("header", {}, h("h2", {}, "Road load and efficiency")),
    h("p", { class: "quiet" }, `${counted} Efficiencies stay as they are until the proposal is applied.`),
    table("Road load", head, QUANTITIES.map((one) => quantityRow(found, one))), found.levels && levelsView(found.levels),
    h("ul", { class: "reasons" }, [...found.reasons, ...found.warnings].map((text) => h("li", {}, text))));
}
