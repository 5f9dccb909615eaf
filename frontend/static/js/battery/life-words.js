/** Trend and remaining life in sentences. */

import { number } from "../core/format.js";
import { aroundText } from "./words.js";

const YEAR_DAYS = 365.25;
const MONTH_DAYS = YEAR_DAYS / 12;
const LEAST_SIGMAS = 2;
const LEAST_CYCLES = 30; // from fewer, nothing is said of a hundred

/** Days as weeks, months or years, whatever is short. */
export function longText(days) {
  if (days < 14) return `${number(days)}\u202fdays`;
  if (days < 3 * MONTH_DAYS) return `${number(days / 7)}\u202fweeks`;
  return days < 2 * YEAR_DAYS ? `${number(days / MONTH_DAYS)}\u202fmonths` : `${number(days / YEAR_DAYS, 1)}\u202fyears`;
}

const between = (low, high) => (longText(low) === longText(high) ? longText(low) : `${longText(low)} to ${longText(high)}`);

function changes(value, sd, down, up) {
  const sure = Math.abs(value) > LEAST_SIGMAS * sd;
  return sure ? `${value < 0 ? down : up} ${aroundText(Math.abs(value), sd, "%", 100)}` : null;
}

/** How fast capacity and resistance change. */
export function trendWords({ capacity, resistance, equivalent_full_cycles: cycles }) {
  const trend = capacity.trend;
  if (!trend) return ""; // the warnings tell what it needs
  const a_year = changes(trend.slope_share_per_year, trend.slope_share_per_year_sd, "loses", "gains");
  const words = [a_year ? `It ${a_year} of its rated capacity a year` : "No loss of capacity can be told from the noise yet"];
  const per_cycle = capacity.slope_share_per_100_cycles;
  if (a_year && per_cycle < 0 && cycles > LEAST_CYCLES) words.push(`, ${aroundText(-per_cycle, capacity.slope_share_per_100_cycles_sd, "%", 100)} in a hundred full cycles`);
  words.push(". ");
  const growth = resistance.trend && changes(resistance.trend.slope_share_per_year, resistance.trend.slope_share_per_year_sd, "falls", "grows");
  if (growth) words.push(`Its resistance ${growth.replace(" ", " by ")} a year. `);
  if (cycles > 0) words.push(`${number(cycles, cycles < 10 ? 1 : 0)} full cycles were seen.`);
  return words.join("");
}

const VERDICTS = {
  reached: () => "It is there already.",
  expected: (left) => `It gets there in about ${longText(left.remaining_days)}; with 95\u202f% certainty in ${between(left.remaining_low_days, left.remaining_high_days)}.`,
  "at the earliest": (left) => `It gets there in ${longText(left.remaining_low_days)} at the earliest; how late can’t be told yet.`,
  "not in sight": (left) => `It doesn’t get there within the next ${longText(left.horizon_days)}; further nothing is said.`,
  unknown: () => "When it gets there can’t be told yet: the history is too short or too uncertain.",
};

/** How long until a share of the rated capacity is reached. */
export function lifeWords({ capacity }, threshold) {
  const worn = `Worn out means ${number(100 * threshold)}\u202f% of the rated capacity. `;
  return worn + (capacity.remaining ? VERDICTS[capacity.remaining.verdict](capacity.remaining) : "More trips or files over more days are needed to tell when it gets there.");
}
