/** Calibration from driving: what the trips propose to change in the car file, applied only when the reader says so. */

import { at, get, patch, post } from "../core/api.js";
import { byId, h, show } from "../core/dom.js";
import { number, plural, when } from "../core/format.js";
import { announce, busy, complain, guarded, toast } from "../core/notify.js";
import { agreed, table } from "../core/ui.js";
import { confidenceMark } from "../core/verdict.js";
import { roadLoadView } from "./road-load.js";

const MOST_DIGITS = 8;
const NEEDS = [
  "The accelerometer's mounting and scale: some braking, some bends and a stop or two, with positions or wheel ticks.",
  "Metres per wheel tick and the clock: a few kilometres with good positions.",
  "Injector lag and flow: a drive with long and short pulses, and what filled the tank up again.",
];

/** Decimals that show a number as far as it is known: two digits of its standard deviation. */
const digitsOf = (sd) => Math.min(MOST_DIGITS, Math.max(0, 1 - Math.floor(Math.log10(sd > 0 ? sd : 1))));

function changeRow({ label, unit, before, after, sd }) {
  const digits = digitsOf(sd);
  const cell = (...content) => h("td", { class: "n" }, content);
  return h("tr", {}, h("th", { scope: "row" }, unit ? `${label}, ${unit}` : label), cell(before === null ? h("span", { class: "quiet" }, "not said") : number(before, digits)),
    cell(h("strong", {}, number(after, digits)), h("span", { class: "quiet" }, ` ±\u202f${number(sd, digits)}`)));
}

function changeTable(proposal) {
  const column = (text, kind) => h("th", { scope: "col", class: kind }, text);
  const head = h("tr", {}, column("Value"), column("Car file", "n"), column("From driving, ±1σ", "n"));
  return table(proposal.title, head, proposal.changes.map(changeRow));
}

/** One proposal; those that may be applied have a box to tick. */
function proposalView(proposal, box) {
  const title = h("h3", {}, proposal.title);
  return h("article", { class: "proposal" },
    h("header", {}, box ? h("label", { class: "check" }, box, title) : title, confidenceMark(proposal.confidence)),
    proposal.changes.length > 0 && changeTable(proposal),
    h("ul", { class: "reasons" }, proposal.evidence.map((text) => h("li", {}, text))));
}

/** The litres after a trip, saved when they are typed; 0 or nothing forgets them. */
function fillingInput(trip, again) {
  const input = h("input", { class: "number", inputMode: "decimal", autocomplete: "off", value: trip.refuelled_l ?? "", ariaLabel: `Litres filled up after ${trip.name}` });
  input.addEventListener("change", async () => {
    try {
      await patch(at("trips", trip.trip_id), { refuelled_l: Number(input.value.replace(",", ".") || 0) });
      announce("Saved");
      again();
    } catch (error) {
      input.value = trip.refuelled_l ?? "";
      complain(error);
    }
  });
  return input;
}

function tripsView(trips, again) {
  const counted = trips.filter((trip) => trip.counts).length;
  const column = (text, kind) => h("th", { scope: "col", class: kind }, text);
  const rows = trips.toReversed().map((trip) => h("tr", { class: trip.counts ? "" : "out" },
    h("th", { scope: "row" }, h("a", { href: `/trips/${trip.trip_id}` }, trip.name)), h("td", {}, when(trip.started_at)),
    h("td", {}, trip.counts ? saysNothingOf(trip) : trip.why), h("td", { class: "filling" }, fillingInput(trip, again))));
  return h("details", { class: "section" }, h("summary", {}, `Trips this rests on (${counted} of ${trips.length})`),
    h("p", { class: "quiet small" }, "Where the tank was filled up right after a trip, note the litres: fillings measure the injectors' flow."),
    table("Trips this rests on", h("tr", {}, column("Trip"), column("Started"), column("Counts"), column("Filled up after it, L", "n")), rows));
}

function saysNothingOf(trip) {
  const missing = Object.values(trip.missing);
  return missing.length === 0 ? "fully" : h("details", {}, h("summary", {}, "in part"), h("ul", { class: "reasons" }, missing.map((text) => h("li", {}, text))));
}

function emptyView({ trips }, carId, again) {
  if (trips.some((trip) => trip.counts)) {
    return h("div", { class: "empty" }, h("h2", {}, "The trips agree with the car file"), h("p", {}, "Whatever they can tell lies within its uncertainty of what the file says."));
  }
  const run = h("button", { class: "btn", on: { click: () => busy(run, async () => {
    await post(at("cars", carId, "/reprocess"));
    toast("All trips of this car run again.", h("a", { href: "/jobs" }, "Watch"));
    again();
  }) } }, "Run all trips again");
  if (trips.length > 0) {
    return h("div", { class: "empty" }, h("h2", {}, "No trip has run with this car file yet"),
      h("p", {}, "What the trips say about it stands here as soon as they have."), h("div", { class: "actions" }, run));
  }
  return h("div", { class: "empty" }, h("h2", {}, "Nothing is known from driving yet"),
    h("p", {}, "Ponthy finds out by itself how the logger sits in the car, once it has driven."),
    h("ul", { class: "needs" }, NEEDS.map((text) => h("li", {}, text))),
    h("div", { class: "actions" }, h("a", { class: "btn", href: `/upload?car=${carId}` }, "Upload a trip")));
}

/** The proposals that may be applied, and the button that does it. */
function formView(found, carId, applied) {
  const offered = found.proposals.filter((one) => one.applicable)
    .map((one) => [one, h("input", { type: "checkbox", name: one.name, checked: one.confidence === "sure" })]);
  if (offered.length === 0) return null;
  const button = h("button", { class: "btn primary" }, "Apply and run again…");
  const form = h("form", {}, offered.map(([one, box]) => proposalView(one, box)), h("div", { class: "form-end" }, button,
    h("span", { class: "quiet" }, "Only what is ticked is changed. The file as it is now stays in its history.")));
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    const chosen = offered.filter(([, box]) => box.checked).map(([one]) => one);
    if (chosen.length === 0) {
      toast("Tick what is to be changed.");
      return;
    }
    busy(button, () => apply(found, chosen, carId, applied));
  });
  return form;
}

async function apply(found, chosen, carId, applied) {
  const trips = (await get(at("cars", carId))).trip_count;
  const what = h("ul", { class: "reasons" }, chosen.map((one) => h("li", {}, one.title)));
  const text = h("p", {}, `A new revision of the car file is made and ${trips === 1 ? "the trip of this car runs" : `all ${plural(trips, "trip")} of this car run`} again with it. The file as it is now can be put back from its history.`);
  if (!(await agreed("Change the car file?", [what, text], `Apply and run ${plural(trips, "trip")} again`))) return;
  const done = await post(at("cars", carId, "/calibration/apply"), { names: chosen.map((one) => one.name), key: found.key });
  toast(`The car file is now revision ${done.revision}; ${plural(done.jobs.length, "trip")} run again.`, h("a", { href: "/jobs" }, "Watch"));
  applied();
}

/** Fill the tab of the calibration; `applied` is called when the car file has changed. Returns what renews it. */
export function showCalibration(carId, applied) {
  const [said, resists, rests] = [h("div"), h("div"), h("div")];
  let shown = { proposals: null, road: null, trips: null };
  const fill = async () => {
    const found = await get(at("cars", carId, "/calibration"));
    const now = { proposals: JSON.stringify([found.key, found.proposals]), road: JSON.stringify(found.road_load), trips: JSON.stringify(found.trips.map((trip) => ({ ...trip, refuelled_l: null }))) };
    if (now.proposals !== shown.proposals) show(said, saidView(found, carId, applied));
    if (now.road !== shown.road) show(resists, roadLoadView(found.road_load));
    if (now.trips !== shown.trips) show(rests, found.trips.length > 0 && tripsView(found.trips, renew));
    shown = now;
  };
  const renew = () => fill().catch(complain);
  show(byId("calibration"), said, resists, rests);
  guarded(fill, said);
  return renew;
}

function saidView(found, carId, applied) {
  if (found.proposals.length === 0) return emptyView(found, carId, applied);
  const told = found.proposals.filter((one) => !one.applicable);
  return [h("div", { class: "card" }, h("header", {}, h("h2", {}, "What the trips say about the car file")),
    formView(found, carId, applied) ?? h("p", {}, "Nothing in the file needs a change, as far as the trips can tell.")),
  told.length > 0 && h("div", { class: "card section" }, h("header", {}, h("h2", {}, "Only told, not applied")), told.map((one) => proposalView(one, null)))];
}
