/** Formulas as tables: beside each other, and one with its coefficients. */

import { h } from "../core/dom.js";
import { measureText, number } from "../core/format.js";
import { table } from "../core/ui.js";

const RAISED = [..."⁰¹²³⁴⁵⁶⁷⁸⁹"];
const column = (text, kind) => h("th", { scope: "col", class: kind }, text);
const cell = (...content) => h("td", { class: "n" }, content);
const points = (share, digits = 2) => number(100 * share, digits);

/** A number with so many significant digits, as `3.7201 × 10⁻⁶` where it is very small or large. */
export function significant(value, digits) {
  if (!Number.isFinite(value)) return "–";
  if (value === 0) return "0";
  const power = Math.floor(Math.log10(Math.abs(value)));
  if (power >= -3 && power < 6) return number(value, Math.max(0, digits - 1 - power));
  const raised = [...String(Math.abs(power))].map((digit) => RAISED[Number(digit)]).join("");
  return `${number(value / 10 ** power, digits - 1)}\u202f×\u202f10${power < 0 ? "⁻" : ""}${raised}`;
}

/** The coefficients of one formula with their deviations and units. */
export function coefficientTable(one) {
  const rows = one.coefficients.map((value, i) => h("tr", {}, h("th", { scope: "row" }, one.words[i]), cell(significant(value, 5)),
    cell(one.sd[i] === 0 && value === 0 ? h("span", { class: "quiet" }, "held at 0") : significant(one.sd[i], 2)), h("td", { class: "nowrap" }, one.units[i])));
  return table(`Coefficients of ${one.name}`, h("tr", {}, column("Term"), column("Coefficient", "n"), column("±1σ", "n"), column("Unit")), rows);
}

/** All formulas beside each other. */
export function comparison({ fits, target, idle_rpm: idleRpm }) {
  const power = target === "p_in";
  const head = h("tr", {}, column("Formula"), column("Terms", "n"), column("R²", "n"), column("Left out, points ±1σ", "n"), column(power ? "RMS error, kW" : "RMS error", "n"),
    column("Best η, %", "n"), column("at", "n"), power && column(`No load at ${number(idleRpm)}\u202frpm, kW`, "n"), column("Concave in torque", "n"));
  const rows = fits.map((one) => h("tr", {}, h("th", { scope: "row" }, one.proposed && h("span", { ariaHidden: "true" }, "● "), one.name, one.proposed && h("span", { class: "quiet" }, ", proposed")),
    cell(number(one.terms.length)), cell(number(one.r_squared, 4)), cell(points(one.cross_validated_eta), h("span", { class: "quiet" }, ` ±\u202f${points(one.cross_validated_eta_sd)}`)),
    cell(power ? number(one.rmse / 1000, 3) : number(one.rmse, target === "eta" ? 4 : 3)),
    cell(one.peak ? [points(one.peak.efficiency, 1), h("span", { class: "quiet" }, ` ±\u202f${points(one.peak.sd, 1)}`)] : "–"),
    cell(one.peak ? `${number(one.peak.rpm)}\u202frpm, ${measureText(one.peak.nm, "Nm")}` : "–"),
    power && cell(number(one.idle_fuel_power_w / 1000, 2), h("span", { class: "quiet" }, ` ±\u202f${number(one.idle_fuel_power_sd_w / 1000, 2)}`)),
    cell(one.fuel.concave > 0 ? `${points(one.fuel.concave, 0)}\u202f%` : "nowhere")));
  return table("Formulas beside each other", head, rows);
}
