/** Trips as a table, with the switch that leaves one out of its car's map. */

import { at, patch } from "../core/api.js";
import { h } from "../core/dom.js";
import { duration, km, litres, per100, when } from "../core/format.js";
import { announce, complain } from "../core/notify.js";
import { table } from "../core/ui.js";
import { tripMark } from "../core/verdict.js";

/** @typedef {{withCar?: boolean, leftOut?: (trip: object) => void}} TripTableOptions */

function head({ withCar, leftOut }) {
  const column = (text, kind) => h("th", { scope: "col", class: kind }, text);
  return h("tr", {}, column("Trip"), withCar && column("Car"), column("Started"), column("Time", "n"), column("Distance", "n"),
    column("Fuel", "n"), column("Average", "n"), column("State"), leftOut && column("In the map"));
}

/** The switch of one trip; goes back when the server refuses. */
function mapSwitch(trip, row, leftOut) {
  const box = h("input", { type: "checkbox", checked: trip.in_map, ariaLabel: `${trip.name} counts for the map` });
  box.addEventListener("change", async () => {
    try {
      const changed = await patch(at("trips", trip.id), { in_map: box.checked });
      Object.assign(trip, changed);
      row.classList.toggle("out", !trip.in_map);
      announce(`${trip.name} ${trip.in_map ? "counts for the map again" : "is left out of the map"}`);
      leftOut(trip);
    } catch (error) {
      box.checked = trip.in_map;
      complain(error);
    }
  });
  return h("label", { class: "check" }, box);
}

/** One row. */
export function tripRow(trip, options) {
  const row = h("tr", { class: trip.in_map ? "" : "out" });
  row.append(h("th", { scope: "row" }, h("a", { href: `/trips/${trip.id}` }, trip.name || trip.filename)));
  if (options.withCar) row.append(h("td", {}, h("a", { href: `/cars/${trip.car_id}` }, trip.car_name)));
  const numeric = (content) => h("td", { class: "n" }, content);
  row.append(h("td", {}, when(trip.started_at)), numeric(duration(trip.duration_s)), numeric(km(trip.distance_m)),
    numeric(litres(trip.fuel_l)), numeric(per100(trip.fuel_l, trip.distance_m)), h("td", {}, tripMark(trip)));
  if (options.leftOut) row.append(h("td", {}, mapSwitch(trip, row, options.leftOut)));
  return row;
}

/** A table of trips. */
export const tripTable = (caption, trips, options = {}) => table(caption, head(options), trips.map((trip) => tripRow(trip, options)));
