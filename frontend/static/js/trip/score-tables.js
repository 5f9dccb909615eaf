/** The tables of a trip's score: its Table 4.2, every acceleration, every stretch between two stops. */

import { h } from "../core/dom.js";
import { elapsed, km, number } from "../core/format.js";
import { table } from "../core/ui.js";

const KMH = 3.6;
const th = (text, kind, title) => h("th", { scope: "col", class: kind, title }, text);
const n = (...content) => h("td", { class: "n" }, ...content);
const signed = (value, digits = 1) => (value > 0 ? "+" : "") + number(value, digits);
const known = (value) => value !== null && value !== undefined;
const share = (value) => (known(value) ? `${signed(value)}\u202f%` : "–");
const kilojoules = (joules) => (known(joules) ? number(joules / 1000, 1) : "–");
const shifts = (rpm) => (rpm.length > 0 ? rpm.map((one) => number(one)).join(", ") : "–");

/** Driving styles and what they take (Sebesta 2010, Table 4.2). */
export const styleTable = (rows) => table("Driving styles, what they take and the difference",
  h("tr", {}, th("Driving style"), th("Energy used, kJ", "n"), th("Difference, %", "n")),
  rows.map((row) => h("tr", {}, h("th", { scope: "row" }, row.style), n(number(row.energy_kj)), n(known(row.percent) ? signed(row.percent) : "–"))));

/** Every acceleration: how it was driven, what it took, and what the best drives to the same speed take. */
export const accelerationTable = (accelerations) => table("Every acceleration beside the best drives to the same speed",
  h("tr", {}, th("At"), th("From", "n"), th("To, km/h", "n"), th("Seconds", "n"), th("How"), th("Shifted at, rpm", "n"), th("Best shifts, rpm", "n"), th("Took, kJ", "n", "Brought to the level"),
    th("Best, same time, kJ", "n"), th("Difference", "n"), th("Best, any time, kJ", "n"), th("Difference", "n"), th("In, s", "n")),
  accelerations.map((one) => h("tr", { class: one.reason ? "out" : "" }, h("th", { scope: "row" }, elapsed(one.from_s)), n(number(KMH * one.from_mps)), n(number(KMH * one.to_mps)), n(number(one.time_s)),
    h("td", { class: "wide" }, one.reason || one.style), n(shifts(one.shift_rpm)), n(shifts(one.best_shift_rpm)), n(kilojoules(one.driven_j)), n(kilojoules(one.same_time_j)), n(share(one.same_time_percent)),
    n(kilojoules(one.free_j)), n(share(one.free_percent)), n(number(one.free_s, 1)))), "tall");

/** Every stretch between two stops: both drives' fuel, or why it wasn't scored. */
export const sectionTable = (sections) => table("Stretches between stops, driven and at their best",
  h("tr", {}, th("From"), th("To"), th("Distance", "n"), th("Driven, kJ", "n"), th("Best, kJ", "n"), th("Less", "n"), th("Shifts", "n"), th("Best drive")),
  sections.map((one) => h("tr", { class: one.scored ? "" : "out" }, h("th", { scope: "row" }, elapsed(one.from_s)), h("td", {}, elapsed(one.to_s)), n(km(one.to_m - one.from_m)),
    n(kilojoules(one.driven_j)), n(kilojoules(one.best_j)), n(one.scored ? `${number(100 * (1 - one.best_j / one.driven_j), 1)}\u202f%` : "–"),
    n(one.scored ? `${number(one.shifts)} → ${number(one.best_shifts)}` : "–"), h("td", { class: "wide" }, one.scored ? one.verdict : one.reason))), "tall");
