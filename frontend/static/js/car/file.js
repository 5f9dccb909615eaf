/** The car file: as a form, as XML, and as it was before. */

import { at, get, patch, post } from "../core/api.js";
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

async function showHistory(place, carId, saved) {
  const { items } = await get(at("cars", carId, "/config/revisions"));
  const outcome = h("div", { role: "status" });
  const restore = (one) => {
    const button = h("button", { class: "btn small", type: "button", ariaLabel: `Put revision ${one.number} back`, on: { click: () => busy(button, async () => {
      await post(at("cars", carId, `/config/revisions/${one.number}/restore`));
      await showHistory(place, carId, saved);
      await saved(place.querySelector('[role="status"]'));
    }) } }, "Put back");
    return button;
  };
  const th = (text) => h("th", { scope: "col" }, text);
  show(place, table("Earlier car files", h("tr", {}, th("Revision"), th("Saved"), th("Where from"), th("Fingerprint (SHA-256)"), th("")),
    items.map((one, i) => h("tr", {}, h("th", { scope: "row" }, `${one.number}`), h("td", {}, when(one.created_at)), h("td", { class: "wide" }, one.note || h("span", { class: "quiet" }, "by hand")),
      h("td", {}, h("code", {}, one.sha256.slice(0, 16))), h("td", { class: "row-actions" }, i > 0 ? restore(one) : h("span", { class: "quiet" }, "in force"))))), outcome);
}

/** What the file leaves open or says oddly, and the load, which stands beside the file. */
function about(car, changed) {
  const load = h("input", { id: "car-load", class: "number", inputMode: "decimal", value: String(car.load_kg), "aria-describedby": "car-load-help" });
  const save = h("button", { class: "btn" }, "Save load");
  const form = h("form", { class: "field", noValidate: true }, h("label", { htmlFor: "car-load" }, "Load"),
    h("div", { class: "with-unit" }, load, h("span", { class: "unit" }, "kg"), save),
    h("p", { class: "help", id: "car-load-help" }, "Driver and things, which the file's mass leaves out."));
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    busy(save, async () => {
      changed(await patch(at("cars", car.id), { load_kg: Number(load.value.replace(",", ".")) }));
      toast("The load is saved. Trips keep their results until they run again.");
    });
  });
  const list = (title, items) => items?.length > 0 && h("details", { class: "section" }, h("summary", {}, `${title} (${items.length})`), h("ul", { class: "reasons" }, items.map((item) => h("li", {}, item))));
  return [car.warnings?.length > 0 && h("div", { class: "note" }, h("p", {}, "Possible, but odd:"), h("ul", { class: "reasons" }, car.warnings.map((text) => h("li", {}, text)))),
    h("div", { class: "card section" }, h("div", { class: "form-grid" }, form), list("Left open by the file, so Ponthy's defaults are used", car.defaulted), list("Kept, but not used", car.unknown))];
}

/** Fill the tab of the car file; `changed` is told of the car after each save. */
export function showFile(carId, changed) {
  const place = byId("file-view");
  const tell = (car) => {
    show(byId("file-about"), about(car, tell));
    changed(car);
  };
  const saved = (outcome) => offerRerun(carId, outcome, tell);
  const views = { form: () => showForm(place, carId, saved), xml: () => showXml(place, carId, saved), history: () => showHistory(place, carId, saved) };
  const draw = () => guarded(views[checked("file-view")], place);
  byId("file-switch").addEventListener("change", draw);
  draw();
  guarded(async () => tell(await get(at("cars", carId))), byId("file-about"));
}
