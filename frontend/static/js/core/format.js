/** Numbers, times and sizes as people read them, with units. */

import { h } from "./dom.js";

const NNBSP = "\u202f";
const MONTH = new Intl.DateTimeFormat("en-GB", { day: "numeric", month: "short", year: "numeric" });
const CLOCK = new Intl.DateTimeFormat("en-GB", { hour: "2-digit", minute: "2-digit" });
const CLOCK_S = new Intl.DateTimeFormat("en-GB", { hour: "2-digit", minute: "2-digit", second: "2-digit" });
export const NOTHING = "–";

const known = (value) => typeof value === "number" && Number.isFinite(value);

/** A number with a fixed number of decimals and thin spaces between thousands; a dash when it is not known. */
export function number(value, digits = 0) {
  if (!known(value)) return NOTHING;
  const [whole, part] = Math.abs(value).toFixed(digits).split(".");
  const grouped = whole.replace(/\B(?=(\d{3})+$)/g, NNBSP);
  const sign = value < 0 && /[1-9]/.test(whole + (part ?? "")) ? "−" : "";
  return sign + grouped + (part ? `.${part}` : "");
}

/** A number and its unit, the unit in quiet. */
export function measure(value, unit, digits = 0) {
  if (!known(value)) return h("span", { class: "quiet" }, NOTHING);
  return h("span", { class: "nowrap" }, number(value, digits), unit && [NNBSP, h("span", { class: "unit" }, unit)]);
}

/** The same as plain text. */
export const measureText = (value, unit, digits = 0) => number(value, digits) + (known(value) && unit ? NNBSP + unit : "");

export const km = (metres) => measure(known(metres) ? metres / 1000 : null, "km", metres >= 1e6 ? 0 : 1);
export const litres = (value) => measure(value, "L", 2);
export const per100 = (fuelL, distanceM) => measure(fuelL > 0 && distanceM > 100 ? (1e5 * fuelL) / distanceM : null, "L/100 km", 1);
export const percent = (fraction, digits = 1) => measure(known(fraction) ? 100 * fraction : null, "%", digits);

/** Seconds as `58 min`, `1 h 04 min` or `12.3 s`. */
export function duration(seconds) {
  if (!known(seconds)) return NOTHING;
  if (seconds < 0.05) return `< 0.1${NNBSP}s`;
  if (seconds < 60) return `${number(seconds, seconds < 10 ? 1 : 0)}${NNBSP}s`;
  const minutes = Math.round(seconds / 60);
  if (minutes < 60) return `${minutes}${NNBSP}min`;
  return `${Math.floor(minutes / 60)}${NNBSP}h ${String(minutes % 60).padStart(2, "0")}${NNBSP}min`;
}

/** Seconds since the start as `0:58:03`. */
export function elapsed(seconds) {
  if (!known(seconds)) return NOTHING;
  const s = Math.max(0, Math.floor(seconds));
  const two = (n) => String(n).padStart(2, "0");
  return `${Math.floor(s / 3600)}:${two(Math.floor(s / 60) % 60)}:${two(s % 60)}`;
}

/** Time of an API timestamp (ISO text), or null. */
export function instant(text) {
  const date = text ? new Date(text) : null;
  return date && !Number.isNaN(date.getTime()) ? date : null;
}

/** `27 Oct 2009, 07:41` in the reader's own time zone, with UTC as a tooltip. */
export function when(text) {
  const date = instant(text);
  if (!date) return h("span", { class: "quiet" }, NOTHING);
  return h("time", { dateTime: date.toISOString(), title: date.toISOString().replace("T", " ").slice(0, 19) + " UTC", class: "nowrap" },
    `${MONTH.format(date)}, ${CLOCK.format(date)}`);
}

/** `27 Oct 2009, 07:41–08:39`. */
export function span(text, seconds) {
  const start = instant(text);
  if (!start) return "";
  const head = `${MONTH.format(start)}, ${CLOCK.format(start)}`;
  return known(seconds) ? `${head}–${CLOCK.format(new Date(start.getTime() + 1000 * seconds))}` : head;
}

/** Time of day at a moment of a trip; the elapsed time when the trip has no date. */
export function clockAt(startText, seconds) {
  const start = instant(startText);
  return start ? CLOCK_S.format(new Date(start.getTime() + 1000 * seconds)) : elapsed(seconds);
}

/** Bytes as `12.4 MB`. */
export function bytes(count) {
  if (!known(count)) return NOTHING;
  const units = ["B", "kB", "MB", "GB"];
  let power = 0;
  for (; count >= 1000 && power < 3; power += 1) count /= 1000;
  return `${number(count, power && count < 100 ? 1 : 0)}${NNBSP}${units[power]}`;
}

/** `3 trips`, `1 trip`. */
export const plural = (count, one, many = `${one}s`) => `${number(count)}${NNBSP}${count === 1 ? one : many}`;
