/** The configuration as a form or as JSON; what is refused stands beside its field. */

import { at, get, put } from "../core/api.js";
import { byId, checked, h, show } from "../core/dom.js";
import { announce, busy, problemBox } from "../core/notify.js";
import { indented } from "../drives/document.js";
import { PoseForm } from "../drives/form.js";
import { plainly } from "../drives/paths.js";
import { configGroups } from "./config-fields.js";

/** Fill the tab; `saved` is called after the configuration has changed. */
export async function showConfig(battery, saved) {
  const path = at("batteries", battery.id, "/config");
  const outcome = byId("config-outcome");
  const area = byId("config-area");
  const form = new PoseForm(byId("config-form"), { changed: () => show(outcome), noted: () => undefined, carId: () => battery.car_id }, configGroups);
  let document_ = await get(path);

  const display = () => {
    const json = checked("config-view") === "json";
    byId("config-form").hidden = json;
    byId("config-json").hidden = !json;
    if (json) area.value = indented(document_);
    else form.show(document_);
  };

  /** Take what stands in the text; says where it is not JSON. */
  const readText = () => {
    try {
      document_ = JSON.parse(area.value);
      area.removeAttribute("aria-invalid");
      return true;
    } catch (error) {
      area.setAttribute("aria-invalid", "true");
      show(outcome, problemBox({ title: "Not JSON yet", detail: error.message }));
      return false;
    }
  };

  const save = async () => {
    form.clear();
    if (checked("config-view") === "json" && !readText()) return;
    try {
      await put(path, document_);
      show(outcome, h("p", { class: "note" }, "Saved. Estimates made before keep what they were made with; choose “Estimate all again” to renew them."));
      await saved();
    } catch (error) {
      const place = error.path ?? error.field ?? "";
      const control = checked("config-view") === "form" ? form.mark(place, plainly(error.detail ?? "", place)) : null;
      show(outcome, !control && problemBox(error));
      control?.focus();
      announce(error.detail || error.title);
    }
  };

  byId("config-switch").addEventListener("change", () => {
    if (checked("config-view") === "json" || readText()) display();
    else document.querySelector('input[name="config-view"][value="json"]').checked = true;
  });
  byId("config-save").addEventListener("click", (event) => busy(event.currentTarget, save));
  byId("config-form").addEventListener("submit", (event) => {
    event.preventDefault();
    busy(byId("config-save"), save);
  });
  display();
  return { renew: async () => { document_ = await get(path); display(); } };
}
