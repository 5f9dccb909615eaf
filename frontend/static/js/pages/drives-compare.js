/** Two solved drives: numbers side by side, lines over each other. */

import { at, get, query } from "../core/api.js";
import { byId, h, show } from "../core/dom.js";
import { NOTHING } from "../core/format.js";
import { guarded } from "../core/notify.js";
import { countJobs } from "../core/shell.js";
import { table } from "../core/ui.js";
import { driveMark } from "../core/verdict.js";
import { Along } from "../drives/along.js";
import { KINDS, energyText, shareText, timeText } from "../drives/words.js";

const DRIVES = 200;
const [first, second] = [byId("first-drive"), byId("second-drive")];

/** Each drive as it is told on its own page, in short. */
function sideCard(drive, answer) {
  return h("section", { class: "card" }, h("header", {}, h("h2", {}, h("a", { href: `/drives/${drive.id}` }, drive.name)), driveMark(drive)),
    h("p", { class: "quiet small" }, KINDS[drive.kind] ?? drive.kind, drive.car_name && ` · ${drive.car_name}`),
    h("ol", { class: "advice-steps" }, (answer.advice ?? []).map((line) => h("li", {}, line))));
}

function difference(name, one, other, shown) {
  const known = Number.isFinite(one) && Number.isFinite(other);
  const cell = (text) => h("td", { class: "n" }, text);
  return h("tr", {}, h("th", { scope: "row" }, name), cell(Number.isFinite(one) ? shown(one) : NOTHING), cell(Number.isFinite(other) ? shown(other) : NOTHING),
    cell(known && one !== 0 ? `${other > one ? "+" : ""}${shareText(other / one - 1)}` : NOTHING));
}

/** Figures are made anew with the page, so that none draws into another's place. */
async function draw() {
  const [a, b] = await Promise.all([first.value, second.value].map((id) => get(at("drives", id))));
  const [one, other] = await Promise.all([a, b].map((drive) => get(at("drives", drive.id, "/answer"))));
  document.title = `${a.name} and ${b.name} · Ponthy`;
  show(byId("side-by-side"), sideCard(a, one), sideCard(b, other));
  const column = (text, kind) => h("th", { scope: "col", class: kind }, text);
  show(byId("differences"), table("The two drives in numbers", h("tr", {}, column("Number"), column(a.name, "n"), column(b.name, "n"), column("Second over first", "n")), [
    difference("Fuel", one.fuel_energy_j, other.fuel_energy_j, energyText), difference("Time", one.time_s, other.time_s, timeText),
    difference("Distance, km", one.distance_m, other.distance_m, (metres) => (metres / 1000).toFixed(3)),
    difference("Fuel per kilometre", one.fuel_energy_j / (one.distance_m / 1000), other.fuel_energy_j / (other.distance_m / 1000), energyText),
  ]));
  byId("compare-ready").hidden = false;
  await new Along(a.id, { other: b.id }).draw();
}

const chosen = () => `/drives/compare${query({ a: first.value, b: second.value })}`;
for (const choice of [first, second]) choice.addEventListener("change", () => first.value && second.value && location.assign(chosen()));

await guarded(async () => {
  const wanted = new URLSearchParams(location.search);
  const drives = (await get(`drives${query({ limit: DRIVES })}`)).items.filter((drive) => drive.state === "solved" && drive.kind !== "ball_and_wheel");
  for (const [choice, key] of [[first, "a"], [second, "b"]]) {
    show(choice, h("option", { value: "" }, drives.length > 0 ? "Choose a drive" : "No drive is solved yet"), drives.map((drive) => h("option", { value: drive.id }, drive.name)));
    choice.value = wanted.get(key) ?? "";
    if (choice.selectedIndex < 0) choice.value = "";
  }
  await Promise.all([first.value && second.value && draw(), countJobs()]);
});
