/** Does the observer agree with its sensors? The verdict with its reasons, sensor by sensor, and the innovations over time. */

import { API, at, get } from "../core/api.js";
import { h, show } from "../core/dom.js";
import { Figure } from "../core/figure.js";
import { number, percent } from "../core/format.js";
import { problemBox } from "../core/notify.js";
import { table } from "../core/ui.js";
import { verdictMark } from "../core/verdict.js";

const SENSORS = {
  vss: "Vehicle speed sensor", speed: "Vehicle speed, reported", inj: "Injectors", acc_i: "Accelerometer, forward", acc_j: "Accelerometer, sideways", acc_k: "Accelerometer, vertical",
  gps_north: "Position, north", gps_east: "Position, east", gps_altitude: "Position, height", heading: "Course over ground",
  dem_altitude: "Road height", road_heading: "Road direction", standstill: "Standstill", fuel_energy: "Fuel, injection by injection", fuel_power: "Fuel flow",
  engine_angle: "Engine turns", engine_speed: "Engine speed", engine_torque: "Engine torque, reported",
};
const sensorName = (name) => SENSORS[name] ?? name.replaceAll("_", " ");

function sensorTable(rows) {
  const th = (text, kind, title) => h("th", { scope: "col", class: kind, title }, text);
  return table("How well each sensor agrees", h("tr", {}, th("Sensor"), th("Measurements", "n"), th("Refused", "n"), th("NIS", "n", "Mean normalised innovation squared; 1 is ideal"), th("Inside 2σ", "n", "95.4 % is ideal")),
    rows.map((row) => h("tr", {}, h("th", { scope: "row" }, sensorName(row.sensor)), h("td", { class: "n" }, number(row.count)), h("td", { class: "n" }, number(row.rejected)),
      h("td", { class: "n" }, number(row.nis_mean, 2)), h("td", { class: "n" }, percent(row.within_two_sigma)))));
}

/** Fill the panel. */
export async function showHealth(panel, trip) {
  const sensors = h("div", {}, h("p", { class: "waiting" }, "Loading the sensors…"));
  const agreement = h("div", { class: "figure" });
  const innovations = h("div", { class: "figure" });
  const list = (items) => h("ul", { class: "reasons" }, items.map((text) => h("li", {}, text)));
  show(panel, h("div", { class: "columns" },
    h("section", { class: "card" }, h("header", {}, h("h2", {}, "Verdict"), verdictMark(trip.verdict)),
      trip.reasons.length > 0 ? list(trip.reasons) : h("p", { class: "quiet" }, "No reason was given."),
      trip.warnings.length > 0 && [h("h3", { class: "section" }, "Warnings"), list(trip.warnings)],
      h("p", { class: "quiet small section" }, "Healthy: the measurements differ from the model's predictions by no more than their stated noise explains (NIS up to about 1, 95 % or more inside 2σ)."),
      h("div", { class: "section" }, agreement)),
    h("section", { class: "card" }, h("h2", {}, "Sensors"), h("div", { class: "section" }, sensors)),
  ), h("section", { class: "card section" }, h("h2", {}, "Innovations: measured minus predicted, in standard deviations"), innovations));
  new Figure(agreement, { label: "Agreement of the sensors", height: 300, tall: true }).load(`${API}/${at("trips", trip.id, "/figures/sensors")}`);
  new Figure(innovations, { label: "Innovations", height: 420, tall: true }).load(`${API}/${at("trips", trip.id, "/figures/innovations")}`);
  try {
    const answer = await get(at("trips", trip.id, "/consistency"));
    show(sensors, sensorTable(answer.items ?? answer.sensors ?? answer));
  } catch (error) {
    show(sensors, problemBox(error));
  }
}
