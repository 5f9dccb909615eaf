/** The title row of a trip: what it is, its verdict, exports, and what can be done with it. */

import { API, at, patch, post, query, remove } from "../core/api.js";
import { byId, h, show } from "../core/dom.js";
import { duration, km, litres, per100, span } from "../core/format.js";
import { busy, problemBox, toast } from "../core/notify.js";
import { actions, askName, closable, confirmed } from "../core/ui.js";
import { tripMark } from "../core/verdict.js";

const EXPORTS = [
  ["kmz", "KMZ", "the track for Google Earth, coloured by speed"], ["csv", "CSV", "all columns as text"], ["parquet", "Parquet", "all columns, for analysis"],
  ["mat", "MAT", "for MATLAB, the thesis' set of files"], ["geojson", "GeoJSON", "the track for maps and GIS"],
];
const FILTERS = [
  ["ekf", "Extended Kalman filter, fast (default)"],
  ["rk4-ekf", "Extended Kalman filter, Runge–Kutta as in the thesis"],
  ["dd-ekf", "Extended Kalman filter, discrete"],
  ["sr-ekf", "Extended Kalman filter, square root"],
  ["ukf", "Unscented Kalman–Bucy filter"],
  ["sr-ukf", "Unscented Kalman–Bucy filter, square root"],
  ["aekf", "Adaptive high-gain filter (needs heights)"],
];
const SENSORS = [["gps", "Satellite positions"], ["dem", "Road heights"], ["acc", "Accelerometer"], ["vss", "Vehicle speed sensor"], ["inj", "Injectors"]];

/** Write the title, the facts and the state of the trip. */
export function showHead(trip) {
  const times = span(trip.started_at, trip.duration_s);
  document.title = `${trip.name || trip.filename} · Ponthy`;
  byId("trip-title").textContent = trip.name || trip.filename;
  const facts = [times, trip.duration_s !== null && duration(trip.duration_s), trip.distance_m > 0 && km(trip.distance_m), trip.fuel_l > 0 && litres(trip.fuel_l),
    trip.fuel_l > 0 && trip.distance_m > 100 && per100(trip.fuel_l, trip.distance_m), h("a", { href: `/cars/${trip.car_id}` }, trip.car_name)].filter(Boolean);
  show(byId("trip-sub"), facts.map((fact, i) => [i > 0 && " · ", fact]));
  show(byId("trip-verdict"), trip.state === "ready" && h("span", { class: "quiet" }, "Observer: "), tripMark(trip));
  show(byId("export-items"), EXPORTS.map(([format, name, what]) =>
    h("a", { href: `${API}/${at("trips", trip.id, "/export")}${query({ format })}`, download: "" }, name, h("small", {}, what))));
  byId("trip-menu").querySelector('[data-action="leave-out"]').textContent = trip.in_map ? "Leave out of the map" : "Count for the map again";
  show(byId("trip-note"), !trip.in_map && h("p", { class: "note" }, "This trip is left out of its car's efficiency map."));
}

/** Wire the menus of a trip that is filled in later. `again` is called with the job of a new run. */
export function wireHead(trip, again) {
  actions(byId("trip-menu"), {
    rename: async () => {
      const name = await askName("Rename this trip", "Name", trip.name || trip.filename, "Rename");
      if (name) await change(trip, { name });
    },
    pose: () => location.assign(`/drives/new${query({ trip: trip.id })}`),
    "leave-out": (button) => busy(button, async () => {
      await change(trip, { in_map: !trip.in_map });
      toast(trip.in_map ? "The trip counts for the map again; the map renews itself." : "The trip is left out; the map renews itself.");
    }),
    delete: (button) => busy(button, async () => {
      if (!(await confirmed(`Delete “${trip.name || trip.filename}”?`, "The trip, its results and its file are removed, and the map is made without it. This can't be taken back.", "Delete"))) return;
      await remove(at("trips", trip.id));
      location.assign(`/cars/${trip.car_id}`);
    }),
  });
  byId("run-again").addEventListener("click", () => runAgain(trip, again));
}

async function change(trip, values) {
  Object.assign(trip, await patch(at("trips", trip.id), values));
  showHead(trip);
}

/** Read the entries of a tuning file; the server says which of them it can't use. */
async function tuningIn(file) {
  try {
    return JSON.parse(await file.text());
  } catch (error) {
    throw { title: "Not a tuning file", detail: `${file.name}: this is not JSON (${error.message}).` };
  }
}

/** Ask how the observer should run again. */
function runAgain(trip, again) {
  const dialog = byId("run-dialog");
  const outcome = h("div");
  const without = trip.provenance?.without ?? [];
  const tuning = h("select", { id: "run-tuning" }, [["default", "Default"], ["thesis-2010", "Thesis of 2010"]].map(([value, text]) =>
    h("option", { value, selected: value === trip.tuning }, text)));
  const file = h("input", { type: "file", id: "run-tuning-file", accept: ".json,application/json" });
  const filter = h("select", { id: "run-filter" }, FILTERS.map(([value, text]) => h("option", { value, selected: value === trip.filter }, text)));
  const smooth = h("input", { type: "checkbox", checked: trip.smoothed ?? true });
  const carry = h("input", { type: "checkbox", checked: true });
  const sensors = SENSORS.map(([name, text]) => [name, h("input", { type: "checkbox", checked: !without.includes(name) }), text]);
  const form = h("form", {},
    h("h2", {}, "Run again with…"),
    h("div", { class: "field" }, h("label", { htmlFor: "run-filter" }, "Filter"), filter),
    h("div", { class: "field" }, h("label", { htmlFor: "run-tuning" }, "Tuning of the observer"), tuning),
    h("div", { class: "field" }, h("label", { htmlFor: "run-tuning-file" }, "… or a tuning file (JSON)"), file),
    h("fieldset", { class: "field" }, h("legend", { class: "label" }, "Sensors it may use"), sensors.map(([, box, text]) => h("label", { class: "check" }, box, h("span", {}, text)))),
    h("label", { class: "check" }, smooth, h("span", {}, "Smooth: look at the whole trip, not only at the past")),
    h("label", { class: "check" }, carry, h("span", {}, "Begin with what the car's earlier trips know of the accelerometer's biases")),
    outcome,
    h("div", { class: "form-end" }, h("button", { class: "btn", type: "button", dataset: { close: "" } }, "Cancel"), h("button", { class: "btn primary" }, "Run")));
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    busy(event.submitter, async () => {
      try {
        const job = await post(at("trips", trip.id, "/reprocess"), { filter: filter.value, tuning: file.files.length > 0 ? await tuningIn(file.files[0]) : tuning.value, smooth: smooth.checked, carry_over: carry.checked, without: sensors.filter(([, box]) => !box.checked).map(([name]) => name) });
        dialog.close();
        again(job);
      } catch (problem) {
        show(outcome, problemBox(problem));
      }
    });
  });
  show(dialog, form);
  closable(dialog);
  dialog.showModal();
}
