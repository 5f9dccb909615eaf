/** Any JSON report as definitions and tables: for what has more detail than a page should know by name. */

import { h } from "../core/dom.js";
import { NOTHING, number, when } from "../core/format.js";
import { table } from "../core/ui.js";

const UNITS = [["_mps2", "m/s²"], ["_mps", "m/s"], ["_ms", "ms"], ["_us", "µs"], ["_hz", "Hz"], ["_deg", "°"], ["_kg", "kg"], ["energy_j", "J"],
  ["_s", "s"], ["_m", "m"], ["_l", "l"], ["_w", "W"]];
const ACRONYMS = /\b(nis|nmea|gps|vss|utc|sha256|id)\b/gi;
const MOST_ROWS = 200;
const LONG = 16;

/** `bad_checksums` → `Bad checksums`; a unit at the end goes to the value. */
function words(key) {
  const [suffix, unit] = UNITS.find(([end]) => key.endsWith(end)) ?? ["", ""];
  const text = (unit ? key.slice(0, key.length - suffix.length + suffix.lastIndexOf("_")) : key).replaceAll("_", " ");
  const said = text === "t" ? "time" : text.replace(ACRONYMS, (word) => word.toUpperCase());
  return { text: said.charAt(0).toUpperCase() + said.slice(1), unit };
}

/** A number with about four significant digits; very small and very large ones as powers of ten. */
function short(value) {
  const size = Math.abs(value);
  if (size !== 0 && (size < 1e-3 || size >= 1e9)) return value.toExponential(2).replace("-", "−");
  return number(value, Number.isInteger(value) ? 0 : size >= 100 ? 1 : size >= 1 ? 2 : 4);
}

function scalar(key, value) {
  const { unit } = words(key);
  if (value === null || value === undefined || value === "") return NOTHING;
  if (typeof value === "boolean") return value ? "yes" : "no";
  if (typeof value !== "number") return String(value);
  if (key.endsWith("utc_s")) return when(new Date(1000 * value).toISOString());
  return unit ? [short(value), "\u202f", h("span", { class: "unit" }, unit)] : short(value);
}

const isObject = (value) => value !== null && typeof value === "object" && !Array.isArray(value);
const isFlat = (value) => value === null || typeof value !== "object";
const isEmpty = (value) => value === null || (typeof value === "object" && Object.keys(value).length === 0);
const isRow = (value) => isObject(value) && Object.values(value).every(isFlat);

/** Rows of a table, when a value is one: a list of objects, or several objects of plain values by name. */
function rowsOf(value) {
  if (Array.isArray(value)) return value.length > 0 && value.every(isObject) ? value : null;
  const entries = Object.entries(value);
  return entries.length > 1 && entries.every(([, row]) => isRow(row)) ? entries.map(([name, row]) => ({ name, ...row })) : null;
}

function rowsTable(caption, rows) {
  const keys = [...new Set(rows.flatMap((row) => Object.keys(row)))].filter((key) => rows.some((row) => isFlat(row[key])));
  const numeric = (key) => rows.every((row) => typeof row[key] === "number" || row[key] === null || row[key] === undefined);
  const kind = (key) => (numeric(key) ? "n" : "");
  return [table(caption, h("tr", {}, keys.map((key) => h("th", { scope: "col", class: kind(key) }, words(key).text))),
    rows.slice(0, MOST_ROWS).map((row) => h("tr", {}, keys.map((key) => h("td", { class: kind(key) }, scalar(key, row[key]))))), "tall"),
  rows.length > MOST_ROWS && h("p", { class: "quiet small" }, `The first ${number(MOST_ROWS)} of ${number(rows.length)}.`)];
}

function content(key, value, depth) {
  const rows = rowsOf(value);
  if (rows) return rowsTable(words(key).text, rows);
  if (!Array.isArray(value)) return report(value, depth + 1);
  return h("ul", { class: "reasons" }, value.slice(0, MOST_ROWS).map((item) => h("li", {}, isFlat(item) ? scalar(key, item) : JSON.stringify(item))));
}

/** A part of its own; a long list inside another part is folded. */
function block(key, value, depth) {
  const { text } = words(key);
  if (depth === 0) return h("section", { class: "card" }, h("h2", {}, text), content(key, value, depth));
  if (isRow(value) && Object.keys(value).length > LONG) return h("details", { class: "section" }, h("summary", {}, text), content(key, value, depth));
  return h("section", { class: "section" }, h("h3", {}, text), content(key, value, depth));
}

/** Draw an object: its plain values as pairs, everything else below; what is empty is left out. */
export function report(object, depth = 0) {
  const entries = Object.entries(object).filter(([, value]) => !isEmpty(value));
  const plain = entries.filter(([, value]) => isFlat(value));
  const rich = entries.filter(([, value]) => !isFlat(value));
  const pairs = plain.length > 0 && h("dl", { class: "pairs" }, plain.map(([key, value]) => [h("dt", {}, words(key).text), h("dd", {}, scalar(key, value))]));
  if (depth > 0) return [pairs, rich.map(([key, value]) => block(key, value, depth))];
  return h("div", { class: "report" }, pairs && h("section", { class: "card" }, pairs), rich.map(([key, value]) => block(key, value, depth)));
}
