/** Pose a drive: what to do, with which car, and its numbers as a form or as JSON. */

import { at, get, post, query } from "../core/api.js";
import { byId, checked, h, show } from "../core/dom.js";
import { announce, busy, guarded, problemBox } from "../core/notify.js";
import { countJobs } from "../core/shell.js";
import { freeProblem } from "../drives/defaults.js";
import { indented } from "../drives/document.js";
import { PoseForm } from "../drives/form.js";
import { plainly } from "../drives/paths.js";
import { lay } from "../drives/road.js";
import { KINDS } from "../drives/words.js";

const ABOUT = {
  accelerate: "Reach a higher speed on the level: which gear, which torque, when to shift.", distance: "Cover a distance on the level and roll out: how fast, and when to let go.",
  route: "Drive a road with its hills and limits in the time there is.", ball_and_wheel: "The thesis’ small problem with a known answer, to see the method at work.",
};
const CHECK_MS = 400;
const CARS = 200;
const car = byId("pose-car");
let problem = freeProblem("accelerate");
let checking = null;
let turn = 0;

const noted = (notes) => show(byId("pose-notes"), notes.length > 0 && h("ul", { class: "reasons small quiet" }, notes.map((text) => h("li", {}, text))));
const form = new PoseForm(byId("pose-form"), { changed: () => checkSoon(), noted, carId: () => car.value });
const asked = () => ({ problem, ...(car.value && { car_id: car.value }), ...(byId("pose-name").value.trim() && { name: byId("pose-name").value.trim() }) });

/** Put a refusal beside its field, or under the form where it has none. */
function tell(error, focus) {
  const path = error.path ?? error.field ?? error.limit ?? "";
  const control = checked("view") === "form" ? form.mark(path, plainly(error.detail, path)) : null;
  show(byId("pose-outcome"), !control && problemBox(error));
  if (focus) control?.focus();
  announce(error.detail || error.title);
}

/** Ask whether the problem can be read as it is; an older answer is dropped. */
async function check() {
  const mine = (turn += 1);
  try {
    const found = await post("drives/check", asked());
    if (mine !== turn) return;
    form.clear();
    show(byId("pose-outcome"), (found.warnings ?? []).map((text) => h("p", { class: "note" }, text)));
    byId("pose-check").textContent = "The problem can be solved as it stands.";
  } catch (error) {
    if (mine !== turn) return;
    form.clear();
    byId("pose-check").textContent = "";
    tell(error, false);
  }
}

function checkSoon() {
  byId("pose-check").textContent = "";
  clearTimeout(checking);
  checking = setTimeout(check, CHECK_MS);
}

/** Show the problem in the view that is chosen. */
function display() {
  const json = checked("view") === "json";
  byId("pose-form").hidden = json;
  byId("pose-json").hidden = !json;
  if (json) byId("json-area").value = indented(problem);
  else form.show(problem);
  const radio = document.querySelector(`input[name="kind"][value="${problem.kind}"]`);
  if (radio) radio.checked = true;
  car.disabled = problem.kind === "ball_and_wheel";
}

/** Take what stands in the text; says where it is not JSON. */
function readText() {
  const area = byId("json-area");
  area.removeAttribute("aria-invalid");
  try {
    const read = JSON.parse(area.value);
    if (read === null || typeof read !== "object" || Array.isArray(read)) throw new Error("A problem is an object of named fields, {…}.");
    problem = read;
    return true;
  } catch (error) {
    area.setAttribute("aria-invalid", "true");
    show(byId("pose-outcome"), problemBox({ title: "Not JSON yet", detail: error.message }));
    return false;
  }
}

/** Start anew: from the car's file and map, or free; an earlier road is kept. Returns what was decided on the way. */
async function filled(kind) {
  const { road } = problem.kind === "route" ? problem : {};
  const own = car.value && kind !== "ball_and_wheel" && await get(`drives/template${query({ car_id: car.value, kind })}`);
  problem = own ? own.problem : freeProblem(kind);
  if (road && kind === "route") problem.road = road;
  return own?.notes ?? [];
}

/** Show a problem that was made, with what was decided on the way. */
async function begin(notes) {
  show(byId("pose-outcome"));
  noted(notes);
  display();
  await check();
}

const start = async (kind) => begin(await filled(kind));

/** Start from a drive that was posed before. */
async function startFrom(id, field) {
  const drive = await get(at("drives", id));
  problem = structuredClone(drive.problem);
  car.value = drive.car_id ?? "";
  if (car.selectedIndex < 0) car.value = "";
  await begin([]);
  if (field) form.reach(field, drive.failure && plainly(drive.failure.detail, field))?.focus();
}

/** Start from the road of a trip, driven by its car in no more time than it took. */
async function startAlong(tripId) {
  const [trip, road] = await Promise.all([get(at("trips", tripId)), post("drives/roads", { trip_id: tripId })]);
  car.value = trip.car_id;
  if (car.selectedIndex < 0 || car.selectedOptions[0].disabled) car.value = "";
  const notes = await filled("route");
  lay(problem, road);
  byId("pose-name").value = `${trip.name || trip.filename}, on the least fuel`;
  await begin([...(road.notes ?? []), ...notes.filter((text) => !text.startsWith("The road is an example"))]);
}

async function solve() {
  if (checked("view") === "json" && !readText()) return;
  try {
    const drive = await post("drives", asked());
    location.assign(`/drives/${drive.id}`);
  } catch (error) {
    form.clear();
    tell(error, true);
  }
}

byId("pose-solve").addEventListener("click", (event) => busy(event.currentTarget, solve));
byId("pose-form").addEventListener("submit", (event) => {
  event.preventDefault();
  busy(byId("pose-solve"), solve);
});
byId("view-switch").addEventListener("change", () => {
  if (checked("view") === "json" || readText()) display();
  else document.querySelector('input[name="view"][value="json"]').checked = true;
});
byId("json-area").addEventListener("input", () => readText() && checkSoon());
car.addEventListener("change", () => guarded(() => start(problem.kind)));

await guarded(async () => {
  const wanted = new URLSearchParams(location.search);
  show(byId("kind-cards"), Object.entries(KINDS).map(([value, name]) => h("label", { class: "kind-card" },
    h("input", { type: "radio", name: "kind", value, on: { change: () => guarded(() => start(value)) } }), h("span", {}, h("strong", {}, name), h("span", { class: "quiet small" }, ABOUT[value])))));
  const cars = (await get(`cars${query({ limit: CARS })}`)).items;
  show(car, h("option", { value: "" }, "No car of mine: the thesis’ car"), cars.map((one) => h("option", { value: one.id, disabled: !one.latest_map }, one.latest_map ? one.name : `${one.name} (no map yet)`)));
  car.value = wanted.get("car") ?? "";
  if (car.selectedIndex < 0) car.value = "";
  const kind = KINDS[wanted.get("kind")] ? wanted.get("kind") : "accelerate";
  const first = () => {
    if (wanted.get("from")) return startFrom(wanted.get("from"), wanted.get("field"));
    return wanted.get("trip") ? startAlong(wanted.get("trip")) : start(kind);
  };
  await Promise.all([first(), countJobs()]);
});
