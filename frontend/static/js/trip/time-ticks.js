/** Ticks of the time axis at round times of day, as a clock shows them. */

import { clockAt, elapsed, instant } from "../core/format.js";

const STEPS_S = [0.1, 0.2, 0.5, 1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 900, 1800, 3600, 7200, 14400, 28800, 86400];
const SECONDS = /:\d\d$/;

/**
 * Axis settings for a window of a trip.
 * @param {string|null} startedAt Start of the trip; without one the time since the start is shown.
 * @param {[number, number]} window Seconds.
 * @param {number} most Ticks there is room for.
 */
export function timeTicks(startedAt, [from, to], most) {
  const step = STEPS_S.find((one) => (to - from) / one <= most) ?? STEPS_S.at(-1);
  const start = instant(startedAt);
  const shift = start ? (start.getTime() / 1000 - 60 * start.getTimezoneOffset()) % 86400 : 0;
  const tickvals = [];
  for (let k = Math.ceil((from + shift) / step); k * step - shift <= to; k += 1) tickvals.push(k * step - shift);
  const text = (t) => {
    const clock = start ? clockAt(startedAt, t + 1e-3) : elapsed(t + 1e-3);
    if (step >= 60) return clock.replace(SECONDS, "");
    return step < 1 ? `${clock}.${Math.floor((((t + shift + 1e-3) % 1) + 1) % 1 * 10)}` : clock;
  };
  return { tickmode: "array", tickvals, ticktext: tickvals.map(text) };
}
