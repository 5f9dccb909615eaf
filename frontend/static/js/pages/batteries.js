/** All batteries, the most worn one first, and a new one for a car. */

import { at, get, post, query } from "../core/api.js";
import { byId, h, show } from "../core/dom.js";
import { NOTHING, when } from "../core/format.js";
import { busy, complain, guarded, problemBox } from "../core/notify.js";
import { countJobs } from "../core/shell.js";
import { closable, paged, table } from "../core/ui.js";
import { typedNumber } from "../drives/paths.js";
import { CHEMISTRIES, startingConfig } from "../battery/starting.js";
import { around, share } from "../battery/words.js";

const dialog = byId("new-battery-dialog");
const CARS = 200;
const BATTERIES = 200;
const LEAST_ESTIMATES = 3;
const trends = {};
let rows = [];

const th = (text, kind) => h("th", { scope: "col", class: kind }, text);
const head = () => h("tr", {}, th("Battery"), th("State of health", "n"), th("State of charge", "n"), th("Trend", "n"), th("Capacity of a cell", "n"), th("Car"), th("Last data"));

function row(battery) {
  const { newest } = battery;
  const n = (...content) => h("td", { class: "n" }, ...content);
  return h("tr", {}, h("th", { scope: "row" }, h("a", { href: `/batteries/${battery.id}` }, battery.name)), n(share(newest?.soh, newest?.soh_sd)), n(share(newest?.soc, newest?.soc_sd)),
    n(h("span", { id: `trend-${battery.id}` }, NOTHING)), n(around(newest?.capacity_ah, newest?.capacity_ah_sd, "Ah")), h("td", {}, h("a", { href: `/cars/${battery.car_id}` }, battery.car_name)), h("td", {}, when(newest?.ended_at)));
}

/** How fast each loses capacity, one after the other: it is worked out when it is asked for. */
async function fillTrends() {
  for (const battery of rows.filter(({ estimates }) => estimates >= LEAST_ESTIMATES)) {
    trends[battery.id] ??= (await get(at("batteries", battery.id, "/ageing"))).capacity.trend ?? {};
    const { slope_share_per_year: slope, slope_share_per_year_sd: sd } = trends[battery.id];
    const place = document.getElementById(`trend-${battery.id}`);
    if (place && Number.isFinite(slope)) show(place, around(slope, sd, "%/year", 100));
  }
}

/** All that were fetched so far, the most worn one first; those nothing is known of last. */
function append(items, first) {
  rows = first ? items : [...rows, ...items];
  if (rows.length === 0) {
    show(byId("batteries"), h("div", { class: "empty" }, h("h2", {}, "No batteries yet"),
      h("p", {}, "A battery belongs to a car: say how many cells it has and what they are rated at. Data come with the car’s trips, or as a file."),
      h("div", { class: "actions" }, h("button", { class: "btn", on: { click: open } }, "Add the first battery"))));
    return;
  }
  const worn = ({ newest }) => newest?.soh ?? Infinity;
  show(byId("batteries"), table("Batteries, the most worn one first", head(), rows.toSorted((a, b) => worn(a) - worn(b)).map(row)));
  fillTrends().catch(complain);
}

async function open() {
  const { items } = await get(`cars${query({ limit: CARS })}`);
  const free = items.filter((car) => !car.battery_ids?.length);
  show(byId("new-battery-problem"), free.length === 0 && h("p", { class: "note" }, "Every car has a battery already. ", h("a", { href: "/cars" }, "Add a car first")));
  show(byId("battery-car"), free.map((car) => h("option", { value: car.id }, car.name)));
  show(byId("battery-chemistry"), Object.entries(CHEMISTRIES).map(([value, name]) => h("option", { value }, name)));
  dialog.showModal();
}

/** Read a field that must hold a number above zero; says so beside the form where it does not. */
function positive(id, name) {
  const value = typedNumber(byId(id).value);
  const right = typeof value === "number" && value > 0;
  byId(id).toggleAttribute("aria-invalid", !right);
  if (!right) {
    byId(id).setAttribute("aria-invalid", "true");
    byId(id).focus();
    throw Object.assign(new Error(`${name} is a number above zero.`), { title: `${name} is missing`, detail: `${name} is a number above zero.` });
  }
  return value;
}

async function create() {
  try {
    const [rated, series, parallel] = [positive("battery-rated", "Rated capacity"), positive("battery-series", "Cells in series"), positive("battery-parallel", "Strings side by side")];
    const name = byId("battery-name").value.trim();
    const config = startingConfig(byId("battery-chemistry").value, rated, series, parallel);
    const battery = await post("batteries", { car_id: byId("battery-car").value, ...(name && { name }), config });
    location.assign(`/batteries/${battery.id}#curve`);
  } catch (error) {
    show(byId("new-battery-problem"), problemBox(error));
  }
}

closable(dialog);
byId("new-battery").addEventListener("click", (event) => busy(event.currentTarget, open));
byId("new-battery-form").addEventListener("submit", (event) => {
  event.preventDefault();
  busy(event.submitter ?? byId("new-battery"), create);
});
await guarded(() => Promise.all([paged((cursor) => get(`batteries${query({ cursor, limit: BATTERIES })}`), append, byId("more")), countJobs()]));
