/** How batteries are told: values with what they may be off by, and how sure one is. */

import { h } from "../core/dom.js";
import { NOTHING, number } from "../core/format.js";

/** The circuit's parameters: name in the answer, words, unit, factor to it. */
export const PARAMETERS = [
  ["capacity_ah", "Capacity of a cell", "Ah", 1], ["resistance_ohm", "Series resistance", "mΩ", 1e3],
  ["relaxation_capacitance_f", "Relaxation capacitance", "F", 1], ["relaxation_resistance_ohm", "Relaxation resistance", "mΩ", 1e3],
];
export const ESTIMATORS = { ekf_bias: "Kalman filter with the current sensor’s error", ekf: "Kalman filter", ukf: "Unscented Kalman filter", gpc: "The report’s polynomial chaos", rls: "Recursive least squares" };

const MOST_DIGITS = 5;
const known = (value) => typeof value === "number" && Number.isFinite(value);

/** Decimals that show two digits of a deviation, of per cent no more than two; three digits of the value where none is known. */
function digitsFor(value, sd, unit) {
  const size = sd > 0 ? sd / 10 : Math.abs(value) / 100;
  return size > 0 ? Math.min(unit?.startsWith("%") ? 2 : MOST_DIGITS, Math.max(0, -Math.floor(Math.log10(size)))) : 2;
}

/** A value and its standard deviation as plain text, `92.4 ± 0.8 %`. */
export function aroundText(value, sd, unit, factor = 1) {
  if (!known(value)) return NOTHING;
  const [shown, off] = [factor * value, known(sd) ? factor * sd : null];
  const digits = digitsFor(shown, off, unit);
  return `${number(shown, digits)}${off === null ? "" : `\u202f±\u202f${number(off, digits)}`}${unit ? `\u202f${unit}` : ""}`;
}

/** The same with the deviation and the unit in quiet. */
export function around(value, sd, unit, factor = 1) {
  if (!known(value)) return h("span", { class: "quiet" }, NOTHING);
  const [shown, off] = [factor * value, known(sd) ? factor * sd : null];
  const digits = digitsFor(shown, off, unit);
  return h("span", { class: "nowrap" }, number(shown, digits), off !== null && h("span", { class: "quiet plain" }, `\u202f±\u202f${number(off, digits)}`), unit && ["\u202f", h("span", { class: "unit" }, unit)]);
}

/** A share as per cent with its deviation. */
export const share = (value, sd) => around(value, sd, "%", 100);
export const shareText = (value, sd) => aroundText(value, sd, "%", 100);

const SURE = [[0.01, "sure"], [0.03, "fairly sure"], [0.1, "rough"]];

/** How sure a share is, in words. */
export const sureness = (sd) => (known(sd) ? SURE.find(([most]) => sd <= most)?.[1] ?? "hardly known" : "of unknown certainty");
