/** One car: its efficiency map large, its trips, the map's versions, and its file. */

import { API, at, get, patch, post, query, remove } from "../core/api.js";
import { byId, checked, h, show } from "../core/dom.js";
import { Figure } from "../core/figure.js";
import { km, measureText, number, plural } from "../core/format.js";
import { busy, complain, guarded, toast } from "../core/notify.js";
import { hasWebgl, plotly } from "../core/plotly.js";
import { countJobs } from "../core/shell.js";
import { actions, askName, confirmed, tabs } from "../core/ui.js";
import { showCarBattery } from "../car/battery-card.js";
import { showCalibration } from "../car/calibration.js";
import { showCompare } from "../car/compare.js";
import { showFile } from "../car/file.js";
import { showFits } from "../car/fits.js";
import { healthCard } from "../car/health-card.js";
import { showHealth } from "../car/health.js";
import { showRules } from "../car/rules.js";
import { scoreCard } from "../car/score-card.js";
import { belowCards, sideCards } from "../car/side.js";
import { versionTable } from "../car/versions.js";
import { JobFeed } from "../jobs/job-feed.js";
import { alive } from "../jobs/job-view.js";
import { healthMark } from "../core/verdict.js";
import { average } from "../lists/car-card.js";
import { tripTable } from "../lists/trip-table.js";

const { carId, mapVersion } = document.body.dataset;
const mine = (rest = "") => at("cars", carId, rest);
const TRIPS = 200;
const WIDE_PX = 600;
const RENEW_MS = 300;
let car = null;
let shown = null;
let figure = null;
let newestTable = null;
let health = null;

plotly().catch(() => undefined); // comes while the data does; a failure is told where something is to be drawn
const feed = new JobFeed({ appeared: noticeJob, over: (job) => job.car_id === carId && renew() });
let renewal = null;
let renewCalibration = () => undefined;
let renewCompare = () => undefined;
let renewFits = () => undefined;
let renewHealth = () => undefined;

/** A job that works on this car is told of until it is over, then the page takes up its result. */
function noticeJob(job) {
  if (job.car_id !== carId) return;
  feed.view(job);
  if (car) showNote();
  countJobs();
}

/** Take up new results; several at once are taken up together. */
function renew() {
  clearTimeout(renewal);
  renewal = setTimeout(() => {
    guarded(load);
    renewCalibration();
    renewCompare();
    renewFits();
    renewHealth();
  }, RENEW_MS);
}

function showNote() {
  const working = [...feed.views.values()].filter((view) => alive(view.job)).length;
  const old = mapVersion !== "latest" && car.latest_map && shown && shown.version !== car.latest_map.version;
  show(byId("map-note"),
    old && h("p", { class: "note" }, `This is version ${shown.version} of the map. `, h("a", { href: `/cars/${carId}` }, `Show the newest, ${car.latest_map.version}`)),
    working > 0 && h("p", { class: "quiet", role: "status" }, `${plural(working, "job")} of this car running; the map renews itself. `, h("a", { href: "/jobs" }, "See them")));
}

function showFacts() {
  document.title = `${car.name} · Ponthy`;
  byId("car-name").textContent = car.name;
  const facts = [
    [car.trip_count === 1 ? "trip" : "trips", number(car.trip_count)], ["driven", km(car.distance_m)], ["average", average(car)],
    car.vehicle?.mass_kg && ["mass", measureText(car.vehicle.mass_kg, "kg")],
    car.vehicle?.fuel_name && ["fuel", car.vehicle.fuel_name],
    health && health.state !== "unknown" && ["health", healthMark(health.state)],
  ].filter(Boolean);
  show(byId("facts"), facts.map(([name, value]) => h("div", {}, h("dt", {}, name), h("dd", {}, value))));
}

/** Address of the figure: the map as the switches say, in 2-D perhaps with the newest table's lines over it. */
function figureUrl() {
  const [view, quantity] = [checked("view"), checked("quantity")];
  const withTable = byId("with-table").checked && view === "contour";
  return withTable ? `${API}/${mine(`/references/${newestTable.id}/figures/overlay`)}${query({ version: shown.version, quantity })}`
    : `${API}/${mine(`/maps/${shown.version}/figures/${view}`)}${query({ quantity })}`;
}

/** The switch that lays the newest table over the map; there is none without a table. */
async function offerTable() {
  [newestTable] = (await get(mine(`/references${query({ limit: 1 })}`))).items;
  byId("table-switch").hidden = !newestTable;
  if (!newestTable) byId("with-table").checked = false;
  byId("with-table").title = newestTable ? `Lines of “${newestTable.name}” over the map` : "";
}

/** A wide figure leaves room beside the surface, so the eye can come closer than on a phone. */
function comeCloser({ layout }) {
  const eye = layout.scene?.camera?.eye;
  if (eye && figure.plot.clientWidth > WIDE_PX) for (const axis of ["x", "y", "z"]) eye[axis] *= 0.74;
}

/** Draw the map as the switches say. */
async function draw() {
  if (checked("view") === "surface" && !hasWebgl()) {
    toast("This browser can't draw in 3-D, so the map stays flat.");
    document.querySelector('input[name="view"][value="contour"]').checked = true;
  }
  byId("quantity-switch").disabled = checked("view") === "counts";
  byId("table-switch").disabled = checked("view") !== "contour";
  figure ??= new Figure(byId("map-figure"), { label: "Efficiency map", height: 560, adjust: comeCloser });
  await figure.load(figureUrl());
}

function emptyMap(items) {
  const trips = car.trip_count > 0;
  const failed = trips && items.every((trip) => trip.verdict === "failed");
  show(byId("map-note"), h("div", { class: "empty" }, h("h2", {}, "No efficiency map yet"),
    h("p", {}, failed ? "The observer failed on every trip. Perhaps the car file is wrong: see what the trips say about it."
      : trips ? "It appears as soon as a trip has been worked through." : "Upload a trip, and the map of this engine begins to fill."),
    h("div", { class: "actions" }, failed ? h("a", { class: "btn", href: "#calibration" }, "See the calibration")
      : trips ? h("a", { class: "btn", href: "/jobs" }, "See the jobs") : h("a", { class: "btn", href: `/upload?car=${carId}` }, "Upload a trip"))));
}

async function load() {
  const [now, trips, versions, state, open] = await Promise.all([
    get(mine()), get(`trips${query({ car_id: carId, limit: TRIPS })}`), get(mine("/maps")), get(mine("/health")),
    Promise.all(["running", "queued"].map((state) => get(`jobs${query({ state })}`))), countJobs(),
  ]);
  car = now;
  health = state;
  open.flatMap((page) => page.items).filter((job) => job.car_id === carId).forEach((job) => feed.view(job));
  shown = versions.items.find((one) => String(one.version) === mapVersion) ?? (mapVersion === "latest" ? car.latest_map : null);
  showFacts();
  showCarBattery(byId("car-battery"), carId).catch(complain);
  show(byId("trips"), trips.items.length ? tripTable("Trips of this car", trips.items, { leftOut: () => countJobs() })
    : h("p", { class: "quiet" }, "No trips yet. ", h("a", { href: `/upload?car=${carId}` }, "Upload the first one")));
  show(byId("versions"), versions.items.length ? versionTable(carId, versions.items, shown?.version) : h("p", { class: "quiet" }, "No versions yet."));
  byId("map-area").hidden = !shown;
  if (!shown) {
    emptyMap(trips.items);
    return;
  }
  showNote();
  await offerTable();
  const drawing = draw();
  const [map, score] = await Promise.all([get(mine(`/maps/${shown.version}`)), get(mine("/score"))]);
  show(byId("side"), sideCards(map, shown, scoreCard(score, carId), healthCard(health)));
  show(byId("below"), belowCards(map, trips.items));
  await drawing;
}

actions(byId("car-menu"), {
  rename: async () => {
    const name = await askName("Rename this car", "Name", car.name, "Rename");
    if (name) await patch(mine(), { name }).then((changed) => { car = changed; showFacts(); }, complain);
  },
  rerun: (button) => busy(button, async () => {
    await post(mine("/reprocess"));
    toast("All trips of this car run again.", h("a", { href: "/jobs" }, "Watch"));
  }),
  delete: (button) => busy(button, async () => {
    const what = car.trip_count ? `${plural(car.trip_count, "trip")}, its maps and its file go with it.` : "Its file goes with it.";
    if (!(await confirmed(`Delete “${car.name}”?`, `${what} This can't be taken back.`, "Delete"))) return;
    await remove(`${mine()}?with_trips=true`);
    location.assign("/cars");
  }),
});
for (const id of ["view-switch", "quantity-switch", "table-switch"]) byId(id).addEventListener("change", () => guarded(draw));
tabs(document.querySelector(".tabs"), {
  "panel-fits": () => { renewFits = showFits(carId, mapVersion); },
  "panel-maps": () => showRules(byId("rules"), carId),
  "panel-compare": () => { renewCompare = showCompare(carId); },
  "panel-health": () => { renewHealth = showHealth(carId, renew); },
  "panel-calibration": () => { renewCalibration = showCalibration(carId, renew); },
  "panel-file": () => showFile(carId, (changed) => { car = { ...car, ...changed }; showFacts(); }),
});
await guarded(load);
