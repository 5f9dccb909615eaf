/** The upload page: files are dropped, sorted by kind, given to a car, and sent. */

import { get, post } from "../core/api.js";
import { byId, h, show } from "../core/dom.js";
import { bytes, plural } from "../core/format.js";
import { busy, guarded, toast } from "../core/notify.js";
import { countJobs } from "../core/shell.js";
import { JobFeed } from "../jobs/job-feed.js";
import { droppable } from "../upload/drop.js";
import { kindOf } from "../upload/kind.js";
import { forget, unfinished } from "../upload/memory.js";
import { UploadRow } from "../upload/row.js";
import { discard } from "../upload/tus.js";

const feed = new JobFeed({ over: () => countJobs() });
const wanted = new URLSearchParams(location.search).get("car");
let cars = [];
let rows = [];
let picked = null;

const ready = () => rows.filter((row) => row.state === "ready");

/** Offer the cars, a new car from each XML file, and a plain new car. */
function offerCars() {
  const select = byId("car");
  const files = rows.filter((row) => row.kind === "car" && row.state !== "removed");
  const options = [
    ...files.map((row) => [row.car?.id ?? `file:${rows.indexOf(row)}`, `the new car of ${row.file.name}`]),
    ...cars.map((car) => [car.id, car.name]),
    ["default", "a new car, with default values for now"],
  ];
  show(select, options.map(([value, text]) => h("option", { value }, text)));
  const values = options.map(([value]) => value);
  select.value = [picked, files.length > 0 && !wanted ? values[0] : wanted, values[0]].find((value) => values.includes(value));
}

/** Which car the trips go to; made now when it is new. */
async function chosenCar() {
  const value = byId("car").value;
  if (value.startsWith("file:")) return rows[Number(value.slice(5))].car?.id ?? null;
  if (value !== "default") return value;
  const car = await post("cars", { name: "My car" });
  cars.push(car);
  return car.id;
}

function refresh() {
  rows = rows.filter((row) => row.state !== "removed");
  const waiting = ready();
  byId("queue").hidden = rows.length === 0;
  byId("kinds").hidden = rows.length > 0;
  byId("drop").classList.toggle("compact", rows.length > 0);
  byId("start").hidden = waiting.length === 0;
  byId("start").textContent = waiting.length > 1 ? `Send ${plural(waiting.length, "file")}` : "Send";
  byId("car-choice").hidden = !waiting.some((row) => row.kind === "trip" && !row.entry);
}

async function add(files) {
  for (const file of files) {
    const row = new UploadRow(file, await kindOf(file), feed, refresh);
    rows.push(row);
    byId("queue-rows").append(row.node);
  }
  refresh();
  offerCars();
  listUnfinished();
  byId("start").focus();
}

/** Cars first and heights next, since trips need them; one file after the other. */
async function send() {
  const waiting = ready();
  const of = (kind) => waiting.filter((row) => row.kind === kind);
  for (const row of of("car")) await row.start();
  const trips = of("trip");
  const car = trips.some((row) => !row.entry) ? await chosenCar() : null;
  if (trips.some((row) => !row.entry) && !car) {
    toast("The car's file was refused, so its trips wait. Correct the file, or choose another car.");
    return;
  }
  offerCars();
  const [mappingRow] = of("mapping");
  const mapping = mappingRow ? await mappingRow.readMapping() : null;
  if (mappingRow && !mapping) return;
  for (const row of [...of("elevation"), ...trips]) await row.start(car, mapping);
  await countJobs();
}

/** What this browser began and did not finish. */
function listUnfinished() {
  const open = unfinished().filter((entry) => !rows.some((row) => row.entry?.url === entry.url || row.upload?.url === entry.url));
  byId("unfinished").hidden = open.length === 0;
  show(byId("unfinished-rows"), open.map((entry) => h("div", { class: "card upload-row" }, h("div", { class: "line" },
    h("span", { class: "name" }, entry.name), h("span", { class: "quiet" }, `${bytes(entry.size)}; drop the same file to go on`),
    h("button", { class: "btn small", on: { click: (event) => busy(event.currentTarget, async () => { await discard(entry.url); forget(entry.url); listUnfinished(); }) } }, "Forget")))));
}

const known = guarded(async () => {
  cars = (await get("cars?limit=200")).items;
  offerCars();
  listUnfinished();
});
byId("car").addEventListener("change", (event) => { picked = event.target.value; });
droppable(byId("drop"), byId("files"), async (files) => {
  await known; // without the cars the choice would be a wrong one
  await add(files);
});
byId("start").addEventListener("click", (event) => busy(event.currentTarget, send));
await countJobs();
