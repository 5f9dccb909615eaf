/** Which trips count in the car's map. */

import { at, get, patch } from "../core/api.js";
import { h, show } from "../core/dom.js";
import { busy, guarded, toast } from "../core/notify.js";

const VERDICTS = [["all", "all trips"], ["doubtful", "healthy and doubtful trips"], ["healthy", "healthy trips only"]];
const SOURCES = [["both", "the engine or the observer"], ["ecu", "the engine only"], ["observer", "the observer only"]];

const field = (label, input) => h("div", { class: "field" }, h("label", { htmlFor: input.id }, label), input);
const select = (id, options, chosen) => h("select", { id }, options.map(([value, text]) => h("option", { value, selected: value === chosen }, text)));
const day = (id, value) => h("input", { id, type: "date", value: value ? value.slice(0, 10) : "" });

/** Fill the place with the form. */
export function showRules(place, carId) {
  guarded(async () => {
    const path = at("cars", carId, "/maps/rules");
    const rules = await get(path);
    const [verdicts, source] = [select("rules-verdicts", VERDICTS, rules.verdicts), select("rules-source", SOURCES, rules.torque_source)];
    const [since, until] = [day("rules-since", rules.since), day("rules-until", rules.until)];
    const smoothed = h("input", { id: "rules-smoothed", type: "checkbox", checked: rules.smoothed_only });
    const button = h("button", { class: "btn" }, "Make the map by these rules");
    const form = h("form", {}, h("div", { class: "form-grid" }, field("By the observer's verdict", verdicts), field("Torque from", source), field("Begun on or after", since), field("Begun before", until)),
      h("label", { class: "check" }, smoothed, "Smoothed trips only"), h("div", { class: "form-end" }, button, h("span", { class: "quiet" }, "A further version is made; the older ones stay. A trip left out by hand stays out.")));
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      busy(button, async () => {
        await patch(path, { verdicts: verdicts.value, torque_source: source.value, since: since.value || null, until: until.value || null, smoothed_only: smoothed.checked });
        toast("The map is being made by these rules.", h("a", { href: "/jobs" }, "Watch"));
      });
    });
    show(place, h("details", { class: "section" }, h("summary", {}, "Which trips count in the map"), form));
  }, place);
}
