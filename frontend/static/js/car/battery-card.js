/** The car's battery at a glance: what is in it, what is left of it, and the way to its page. */

import { get, query } from "../core/api.js";
import { h, show } from "../core/dom.js";
import { when } from "../core/format.js";
import { share } from "../battery/words.js";

function card({ id, name, newest, missing }) {
  const href = `/batteries/${id}`;
  if (!newest) {
    return h("section", { class: "card battery-card" }, h("header", {}, h("h2", {}, "Battery"), h("a", { class: "btn small", href: missing?.length ? `${href}#config` : `${href}#data` }, missing?.length ? "Complete its configuration" : "Add data")),
      h("p", { class: "quiet" }, `Nothing has been estimated of ${name} yet.`));
  }
  const fact = (value, words) => h("div", {}, h("dt", {}, words), h("dd", {}, value));
  return h("section", { class: "card battery-card" }, h("header", {}, h("h2", {}, "Battery"), h("a", { class: "btn small", href }, "See the battery")),
    h("dl", { class: "facts" }, fact(share(newest.soc, newest.soc_sd), "in it"), fact(share(newest.soh, newest.soh_sd), "of its capacity is left")),
    h("p", { class: "quiet small" }, "When ", newest.source, " ended, ", when(newest.ended_at), "."));
}

/** Fill the place; it stays empty for a car without a battery. */
export async function showCarBattery(place, carId) {
  const { items } = await get(`batteries${query({ car_id: carId })}`);
  show(place, items.map(card));
}
