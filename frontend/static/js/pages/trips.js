/** All trips, newest first, of one car or of all. */

import { get, query } from "../core/api.js";
import { byId, h, show } from "../core/dom.js";
import { guarded } from "../core/notify.js";
import { countJobs } from "../core/shell.js";
import { paged } from "../core/ui.js";
import { tripRow, tripTable } from "../lists/trip-table.js";

const options = { withCar: true, leftOut: () => undefined };
const filter = byId("car-filter");

function append(trips, first) {
  if (!first) {
    byId("trips").querySelector("tbody").append(...trips.map((trip) => tripRow(trip, options)));
    return;
  }
  show(byId("trips"), trips.length > 0 ? tripTable("Trips", trips, options)
    : h("div", { class: "empty" }, h("h2", {}, "No trips yet"), h("p", {}, "Drop a logger image or a table of signals, and it appears here."),
      h("div", { class: "actions" }, h("a", { class: "btn", href: "/upload" }, "Upload a trip"))));
}

const list = () => paged((cursor) => get(`trips${query({ car_id: filter.value, cursor })}`), append, byId("more"));

filter.addEventListener("change", () => {
  history.replaceState(null, "", `/trips${query({ car: filter.value })}`);
  guarded(list);
});
await guarded(async () => {
  const cars = (await get("cars?limit=200")).items;
  filter.append(...cars.map((car) => h("option", { value: car.id }, car.name)));
  filter.value = new URLSearchParams(location.search).get("car") ?? "";
  if (filter.selectedIndex < 0) filter.value = "";
  await Promise.all([list(), countJobs()]);
});
