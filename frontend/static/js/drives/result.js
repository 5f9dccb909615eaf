/** The answer in words and numbers: advice first, then what it takes. */

import { query } from "../core/api.js";
import { byId, h, show } from "../core/dom.js";
import { measure, number, plural } from "../core/format.js";
import { KMH, energy, substance, timeText, tiny, way } from "./words.js";

const MOST_SHIFTS = 8;
const FEW_PHASES = 14;
const SHIFT = /^shift up at/;

const FEW_STEPS = 3;
const MOST_STEPS = 6;
const MOST_PER_MINUTE = 6;

/** What science says, as a sentence with true minus signs. */
export const sentence = (text) => `${text.charAt(0).toUpperCase()}${text.slice(1)}${/[.!?]$/.test(text) ? "" : "."}`.replace(/(^|[\s(])-(?=\d)/g, "$1−");

const steps = (lines) => h("ol", { class: "advice-steps" }, lines.map((line) => h("li", {}, sentence(line))));

/** What the driver is told: a short drive in one sentence, else where to shift and the steps in driving order. */
export function showAdvice(answer) {
  const advice = answer.advice ?? [];
  byId("advice-card").hidden = advice.length === 0;
  const shift = advice.find((line) => SHIFT.test(line));
  const others = advice.filter((line) => line !== shift);
  const short = !shift && others.length <= FEW_STEPS;
  const [first, rest] = short ? [others.join(", then "), []] : [shift, others];
  show(byId("advice"), first && h("p", { class: "big" }, sentence(first)), rest.length > 0 && steps(rest.slice(0, MOST_STEPS)),
    rest.length > MOST_STEPS && h("details", {}, h("summary", { class: "quiet small" }, `${plural(rest.length - MOST_STEPS, "more step")}`), steps(rest.slice(MOST_STEPS))));
  byId("advice").querySelector("details ol")?.setAttribute("start", String(MOST_STEPS + 1));
}

/** Gears in their order; long drives by how many changes they have. */
function gearsOf({ gears }) {
  if (!gears?.length) return null;
  if (gears.length > FEW_PHASES) return [plural(gears.length - 1, "change"), "of gear"];
  return [gears.map((gear) => (gear === 0 ? "N" : gear)).join("\u2009–\u2009"), "gears"];
}

function shiftsOf({ switch_speeds_mps: speeds }) {
  if (!speeds?.length || speeds.length > MOST_SHIFTS) return null;
  return [h("span", {}, speeds.map((speed) => number(KMH * speed, 1)).join("\u2002"), "\u202f", h("span", { class: "unit" }, "km/h")), "changes at"];
}

function priceOf({ multiplier_w: price }) {
  if (!Number.isFinite(price)) return null;
  return [price === 0 ? "nothing" : measure(price / 1000, "kW", Math.abs(price) < 1e4 ? 2 : 1), "a second is worth"];
}

/** The numbers of an answer. */
export function showFacts(answer) {
  const fuel = answer.fuel_energy_j;
  const emissions = Object.entries(answer.emissions_g ?? {}).map(([name, grams]) => [[tiny(grams, 3), "\u202f", h("span", { class: "unit" }, "g")], substance(name)]);
  const facts = [
    Number.isFinite(fuel) && [energy(fuel), "fuel"], [timeText(answer.time_s), "time"], Number.isFinite(answer.distance_m) && [way(answer.distance_m), "distance"],
    fuel > 0 && answer.distance_m > 0 && [measure(fuel / answer.distance_m, "kJ/km", 0), "fuel per kilometre"], ...emissions,
    answer.first && [{ u_min: "lowest", u_max: "highest", none: "nothing to do" }[answer.first], "control first"], Number.isFinite(answer.switch_time_s) && [timeText(answer.switch_time_s), "control changes at"],
    gearsOf(answer), shiftsOf(answer), priceOf(answer),
  ].filter(Boolean);
  show(byId("facts"), facts.map(([value, name]) => h("div", {}, h("dt", {}, name), h("dd", {}, value))));
}

/** Whether gears change more often than anybody would, because changing them costs nothing. */
function restless(drive, { gears, time_s: seconds }) {
  const free = !(drive.problem.transmission?.shift_cost_j > 0);
  return free && gears?.length > FEW_PHASES && gears.length > (MOST_PER_MINUTE * seconds) / 60;
}

/** What to keep in mind about the answer. */
export function showWarnings(drive, answer) {
  const again = `/drives/new${query({ from: drive.id, field: "transmission.shift_cost_j" })}`;
  show(byId("warnings"), (answer.warnings ?? []).map((text) => h("p", { class: "note" }, sentence(text))),
    restless(drive, answer) && h("p", { class: "note" }, "The gears change more often than anybody would: with nothing charged for a shift, the least gain is worth one. ", h("a", { href: again }, "Charge something for a shift"), " and solve it again."));
}
