/** Drives as a table; two of them can be chosen to be compared. */

import { h } from "../core/dom.js";
import { NOTHING, when } from "../core/format.js";
import { table } from "../core/ui.js";
import { driveMark } from "../core/verdict.js";
import { KINDS, energy, timeText, way } from "./words.js";

const column = (text, kind) => h("th", { scope: "col", class: kind }, text);

function head(withChoice) {
  return h("tr", {}, column("Drive"), column("Kind"), column("Car"), column("Fuel", "n"), column("Time", "n"), column("Distance", "n"),
    column("Verdict"), column("Posed"), withChoice && column("Compare"));
}

/** One row; `chosen` is called with the drive and whether it is marked to be compared. */
export function driveRow(drive, chosen) {
  const numeric = (value, shown) => h("td", { class: "n" }, Number.isFinite(value) ? shown(value) : h("span", { class: "quiet" }, NOTHING));
  const box = chosen && h("input", { type: "checkbox", ariaLabel: `Compare ${drive.name}`, disabled: drive.state !== "solved" || drive.kind === "ball_and_wheel", on: { change: () => chosen(drive, box.checked) } });
  return h("tr", {},
    h("th", { scope: "row" }, h("a", { href: `/drives/${drive.id}` }, drive.name)),
    h("td", {}, KINDS[drive.kind] ?? drive.kind),
    h("td", {}, drive.car_id ? h("a", { href: `/cars/${drive.car_id}` }, drive.car_name ?? "its car") : h("span", { class: "quiet" }, "free")),
    numeric(drive.fuel_energy_j, energy), numeric(drive.time_s, timeText), numeric(drive.distance_m, way),
    h("td", {}, driveMark(drive)), h("td", {}, when(drive.created_at)), box && h("td", {}, h("label", { class: "check" }, box)));
}

/** A table of drives. */
export const driveTable = (caption, drives, chosen = null) => table(caption, head(chosen !== null), drives.map((drive) => driveRow(drive, chosen)));
