/** What a trip says of the car's battery: in words, its state of charge, and what the model left of the voltage. */

import { API, at, get, query } from "../core/api.js";
import { byId, h, show } from "../core/dom.js";
import { Figure } from "../core/figure.js";
import { sentence } from "../drives/result.js";
import { PARAMETERS, around, share, shareText, sureness } from "../battery/words.js";

/** What the trip says of the battery; null where the car has none, or the trip holds nothing of it. */
async function estimateOf(trip) {
  const { items: [battery] } = await get(`batteries${query({ car_id: trip.car_id })}`);
  if (!battery) return null;
  const { items: [found] } = await get(`${at("batteries", battery.id, "/estimates")}${query({ trip_id: trip.id })}`);
  return found ?? null;
}

function numbers(found) {
  const row = (name, value) => [h("dt", {}, name), h("dd", {}, value)];
  return h("dl", { class: "pairs section" }, row("State of charge, at the end", share(found.soc, found.soc_sd)), row("State of health", share(found.soh, found.soh_sd)),
    PARAMETERS.map(([name, words, unit, factor]) => row(words, around(found[name], found[`${name}_sd`], unit, factor))));
}

function fill(panel, found) {
  const page = `/batteries/${found.battery_id}?estimate=${found.id}`;
  if (found.reason) {
    show(panel, h("section", { class: "card" }, h("h2", {}, "Battery"), h("p", { class: "note section" }, found.reason), h("p", { class: "section" }, h("a", { class: "btn", href: `/batteries/${found.battery_id}` }, "See the battery"))));
    return;
  }
  const box = (title) => [title, h("div", { class: "figure" })];
  const figures = { soc: box("State of charge"), current: box("Current and voltage"), residual: box("Measured less predicted voltage") };
  show(panel, h("div", { class: "trends" },
    h("section", { class: "card" }, h("h2", {}, "Battery"), h("p", { class: "section" }, `${shareText(found.soc, found.soc_sd)} was left in it at the end. It holds ${shareText(found.soh, found.soh_sd)} of what it is rated at; that is ${sureness(found.soh_sd)}.`),
      (found.warnings ?? []).map((text) => h("p", { class: "note" }, sentence(text))), numbers(found), h("p", { class: "section" }, h("a", { class: "btn", href: page }, "See it on the battery’s page"))),
    Object.values(figures).map(([title, place]) => h("section", { class: "card" }, h("h2", {}, title), place))));
  for (const [name, [title, place]] of Object.entries(figures)) {
    new Figure(place, { label: title, height: 300, tall: true }).load(`${API}/${at("batteries", found.battery_id, `/figures/${name}`)}${query({ estimate: found.id })}`);
  }
}

/** Show the tab where the trip says something of a battery; its panel is filled when it is opened. */
export async function offerBattery(trip) {
  const found = await estimateOf(trip);
  const tab = byId("tab-battery");
  tab.hidden = !found;
  if (!found) return () => undefined;
  return (panel) => fill(panel, found);
}
