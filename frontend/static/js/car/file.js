/** The car file: as a form, as XML, and as it was before. */

import { at, get, post } from "../core/api.js";
import { byId, checked, h, show } from "../core/dom.js";
import { plural, when } from "../core/format.js";
import { announce, busy, guarded, toast } from "../core/notify.js";
import { table } from "../core/ui.js";
import { showForm } from "./form.js";
import { showXml } from "./xml-editor.js";

/** After saving, the trips still show the old car until they run again. */
async function offerRerun(carId, outcome, changed) {
  const car = await get(at("cars", carId));
  const run = h("button", { class: "btn small", type: "button", on: { click: () => busy(run, async () => {
    await post(at("cars", carId, "/reprocess"));
    show(outcome);
    toast("All trips of this car run again.", h("a", { href: "/jobs" }, "Watch"));
  }) } }, "Run all trips again");
  changed(car);
  announce("Saved");
  show(outcome, h("p", {}, "Saved. ", car.trip_count > 0 && [`The ${plural(car.trip_count, "trip")} keep their results until they run again. `, run]));
}

async function showHistory(place, carId) {
  const { items } = await get(at("cars", carId, "/config/revisions"));
  show(place, table("Earlier car files", h("tr", {}, h("th", { scope: "col" }, "Saved"), h("th", { scope: "col" }, "Fingerprint (SHA-256)")),
    items.map((one) => h("tr", {}, h("td", {}, when(one.created_at)), h("td", {}, h("code", {}, (one.sha256 ?? one.config_sha256 ?? "").slice(0, 16)))))));
}

/** Fill the tab of the car file; `changed` is told of the car after each save. */
export function showFile(carId, changed) {
  const place = byId("file-view");
  const saved = (outcome) => offerRerun(carId, outcome, changed);
  const views = { form: () => showForm(place, carId, saved), xml: () => showXml(place, carId, saved), history: () => showHistory(place, carId) };
  const draw = () => guarded(views[checked("file-view")], place);
  byId("file-switch").addEventListener("change", draw);
  draw();
}
