/** What the report says of its figures, and what our own run says of the same. */

import { number } from "../core/format.js";

const THINNER = "Solid: three terms. Thin: the default estimator. Dotted: the truth.";

/** Number, title and how to read it, in the report's order. */
export const FIGURES = [
  ["25", "Open-circuit voltage", "The curve that model and estimators share, over 10–90 % of the charge. The report prints no coefficients; these are ours, of an iron phosphate cell."],
  ["26", "Answer to pulses", "What the virtual cell answers to pulses of current; the report compares its cell with its model in this way."],
  ["27", "A drive and its current", "FTP-72, and what a plug-in hybrid that blends fuel and battery takes from one cell."],
  ["28", "Cycling", "The drive again and again down to 20 %, then charged with 2 A up to 80 %."],
  ["30", "Parameters over ten days", "Estimators are off for the first day. Dashed: two terms. Solid: three terms. Thin: the default estimator. Dotted: the truth. Swings right after the start are cut off."],
  ["31", "Charge and voltage error", `${THINNER.replace("Dotted: the truth.", "Dotted: the noise of the voltage.")}`],
  ["32", "Degradation map", "Capacity lost for each ampere-hour that flows. The report shows its map without numbers; this one is ours."],
  ["33", "Health over a hundred days", `${THINNER} The capacity fades by the map above; estimators are off for the first ten days.`],
];

const NAMES = [["capacity_ah", "Q"], ["resistance_ohm", "R"], ["relaxation_capacitance_f", "Cᵣ"], ["relaxation_resistance_ohm", "Rᵣ"]];
const percent = (share) => `${number(100 * share, Math.abs(share) < 0.001 ? 3 : 2)}\u202f%`;
const named = (runs, terms) => runs.find((run) => run.terms === terms);
const missed = (run, names = NAMES) => names.map(([name, symbol]) => `${symbol} ${percent(run.misses[name])}`).join(", ");
const last = (run, name) => run.history[name].at(-1);

/** Rows of figure, claim and finding. */
export function claimsOf({ short, long }) {
  const [two, three, usual] = [named(short, 2), named(short, 3), named(short, null)];
  const [threeLong, usualLong] = [named(long, 3), named(long, null)];
  return [
    ["30", "With two terms Q and R are estimated quite well, Cᵣ and Rᵣ are not.", `After ten days off by ${missed(two)}.`],
    ["30", "With three terms all four parameters come into a close neighbourhood of the truth.", `After ten days off by ${missed(three)}. The default estimator: ${missed(usual)}.`],
    ["31", "The error of the charge drops suddenly, then converges to zero with the parameters.", `From ${number(100 * (three.history.soc[0] - three.history.soc_true[0]))} to ${number(100 * three.misses.soc, 3)} points at the end; the default estimator ends at ${number(100 * usual.misses.soc, 3)}.`],
    ["31", "The output error is suppressed to nearly the noise level, 2 mV.", `${number(1e3 * last(three, "voltage_rms_v"), 3)}\u202fmV rms at the end.`],
    ["33", "Capacity and resistance converge and are tracked while the capacity fades.", `After a hundred days off by ${missed(threeLong, NAMES.slice(0, 2))}, while the capacity fell from ${number(threeLong.history.capacity_ah_true[0], 3)} to ${number(last(threeLong, "capacity_ah_true"), 3)}\u202fAh. The default estimator: ${missed(usualLong, NAMES.slice(0, 2))}.`],
  ];
}
