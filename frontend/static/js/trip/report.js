/** Any JSON report as definitions and tables: for what has more detail than a page should know by name. */

import { h } from "../core/dom.js";
import { NOTHING, number } from "../core/format.js";
import { table } from "../core/ui.js";

const UNITS = [["_mps2", "m/s²"], ["_mps", "m/s"], ["_ms", "ms"], ["_us", "µs"], ["_hz", "Hz"], ["_deg", "°"], ["_kg", "kg"], ["_s", "s"], ["_m", "m"], ["_l", "l"], ["_j", "J"], ["_w", "W"]];
const ACRONYMS = /\b(nis|nmea|gps|vss|utc|sha256|id)\b/gi;
const MOST_ROWS = 200;

/** `bad_checksums` → `Bad checksums`; a unit at the end goes to the value. */
export function words(key) {
  const unit = UNITS.find(([suffix]) => key.endsWith(suffix));
  const text = (unit ? key.slice(0, -unit[0].length) : key).replaceAll("_", " ");
  const said = text === "t" ? "time" : text.replace(ACRONYMS, (word) => word.toUpperCase());
  return { text: said.charAt(0).toUpperCase() + said.slice(1), unit: unit?.[1] ?? "" };
}

function scalar(value, unit) {
  if (value === null || value === undefined || value === "") return NOTHING;
  if (typeof value === "boolean") return value ? "yes" : "no";
  if (typeof value !== "number") return String(value);
  const size = Math.abs(value);
  const text = number(value, Number.isInteger(value) ? 0 : size >= 100 ? 1 : size >= 1 ? 2 : 4);
  return unit ? [text, "\u202f", h("span", { class: "unit" }, unit)] : text;
}

const isTable = (value) => Array.isArray(value) && value.length > 0 && value.every((row) => row && typeof row === "object" && !Array.isArray(row));
const isFlat = (value) => value === null || typeof value !== "object";

function rowsTable(caption, rows) {
  const keys = [...new Set(rows.flatMap((row) => Object.keys(row)))].filter((key) => rows.some((row) => isFlat(row[key])));
  const numeric = (key) => rows.every((row) => typeof row[key] === "number" || row[key] === null || row[key] === undefined);
  const kind = (key) => (numeric(key) ? "n" : "");
  return [table(caption, h("tr", {}, keys.map((key) => h("th", { scope: "col", class: kind(key) }, words(key).text))),
    rows.slice(0, MOST_ROWS).map((row) => h("tr", {}, keys.map((key) => h("td", { class: kind(key) }, scalar(row[key], words(key).unit))))), "tall"),
  rows.length > MOST_ROWS && h("p", { class: "quiet small" }, `The first ${number(MOST_ROWS)} of ${number(rows.length)}.`)];
}

function block(key, value, depth) {
  const title = h(depth ? "h3" : "h2", {}, words(key).text);
  if (isTable(value)) return h("section", { class: depth ? "section" : "card" }, title, rowsTable(words(key).text, value));
  if (Array.isArray(value)) return h("section", { class: depth ? "section" : "card" }, title, h("ul", { class: "reasons" }, value.slice(0, MOST_ROWS).map((item) => h("li", {}, isFlat(item) ? scalar(item, words(key).unit) : JSON.stringify(item)))));
  return h("section", { class: depth ? "section" : "card" }, title, report(value, depth + 1));
}

const isEmpty = (value) => value === null || (typeof value === "object" && Object.keys(value).length === 0);

/** Draw an object: its plain values as pairs, everything else below; what is empty is left out. */
export function report(object, depth = 0) {
  const entries = Object.entries(object).filter(([, value]) => !isEmpty(value));
  const plain = entries.filter(([, value]) => isFlat(value));
  const rich = entries.filter(([, value]) => !isFlat(value));
  const pairs = plain.length > 0 && h("dl", { class: "pairs" }, plain.map(([key, value]) => {
    const { text, unit } = words(key);
    return [h("dt", {}, text), h("dd", {}, scalar(value, unit))];
  }));
  if (depth > 0) return [pairs, rich.map(([key, value]) => block(key, value, depth))];
  return h("div", { class: "report" }, pairs && h("section", { class: "card" }, pairs), rich.map(([key, value]) => block(key, value, depth)));
}
