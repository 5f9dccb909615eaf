/** What is in the pack, what is left of it, and how sure one is: in words, then in numbers. */

import { byId, h, show } from "../core/dom.js";
import { measure, number, when } from "../core/format.js";
import { sentence } from "../drives/result.js";
import { PARAMETERS, around, aroundText, share, shareText, sureness } from "./words.js";

const NOISY = 1.5;

/** The rated capacity of one cell: as configured, else what was configured to begin with. */
export const ratedOf = (config) => config.rated_capacity_ah ?? config.initial?.capacity_ah;

function chargeWords(newest) {
  return h("p", { class: "big" }, `${shareText(newest.soc, newest.soc_sd)} in it`, h("span", { class: "quiet small plain" }, "  when ", newest.source, " ended, ", when(newest.ended_at)));
}

function healthWords(newest, config) {
  const rated = ratedOf(config);
  const of = Number.isFinite(rated) ? ` of the ${number(rated, 2)}\u202fAh it is rated at` : "";
  return h("p", {}, `${shareText(newest.soh, newest.soh_sd)} is left of its capacity: a cell holds ${aroundText(newest.capacity_ah, newest.capacity_ah_sd, "Ah")}${of}.`);
}

function sureWords(newest) {
  const fits = newest.voltage_noise_v > 0 && newest.voltage_rms_v > 0
    ? newest.voltage_rms_v < NOISY * newest.voltage_noise_v ? " The model fits the measured voltage down to the noise." : " The model leaves more of the voltage than noise explains." : "";
  return h("p", {}, `The charge is ${sureness(newest.soc_sd)}, the health ${sureness(newest.soh_sd)}.${fits} All ± are one standard deviation.`);
}

/** Fill the card in words. */
export function showState(newest, config) {
  show(byId("state-words"), chargeWords(newest), healthWords(newest, config), sureWords(newest));
}

/** Fill the row of numbers. */
export function showFacts(newest) {
  const fact = (value, name) => h("div", {}, h("dt", {}, name), h("dd", {}, value));
  show(byId("facts"), fact(share(newest.soc, newest.soc_sd), "state of charge"), fact(share(newest.soh, newest.soh_sd), "state of health"),
    PARAMETERS.slice(0, 2).map(([name, words, unit, factor]) => fact(around(newest[name], newest[`${name}_sd`], unit, factor), words.toLowerCase())),
    Number.isFinite(newest.current_bias_a) && newest.current_bias_a_sd > 0 && fact(around(newest.current_bias_a, newest.current_bias_a_sd, "mA", 1e3), "current sensor is off by"),
    fact(measure(1e3 * newest.voltage_rms_v, "mV", 2), "left of the voltage"));
}

/** Tell what to keep in mind. */
export function showWarnings(newest) {
  show(byId("warnings"), (newest.warnings ?? []).map((text) => h("p", { class: "note" }, sentence(text))));
}
