/** "Drive it on less": what to do differently, and what that would have saved. */

import { at, post } from "../core/api.js";
import { h } from "../core/dom.js";
import { km, measureText, number, plural } from "../core/format.js";
import { busy, toast } from "../core/notify.js";

const MOST_ADVICE = 2;

/** What all scored trips together say, in one line. */
function together(score) {
  const scored = score.trips.filter((trip) => trip.score !== null).length;
  const share = (100 * score.saved_l) / score.fuel_l;
  const around = (100 * score.saved_sd_l) / score.fuel_l;
  if (share < around) return [`${plural(scored, "trip")} took no more than the best drives known, as far as can be told.`];
  return [`Driving so would have saved ${number(share)} ±\u202f${number(around, around < 1 ? 1 : 0)}\u202f% (${measureText(score.saved_l, "L", 2)}) over ${plural(scored, "trip")} and `, km(score.distance_m), "."];
}

/** The way to scores that rest on the newest map; nothing where all do. */
function renewal(score, carId) {
  const old = score.trips.filter((trip) => trip.map_version !== score.newest_map_version).length;
  if (old === 0 || score.newest_map_version === null) return null;
  return h("button", { class: "btn bare small", on: { click: (event) => busy(event.currentTarget, async () => {
    const { items } = await post(at("cars", carId, "/score"));
    toast(items.length > 0 ? `${plural(items.length, "trip")} will be scored.` : "The trips are being worked on, and are scored in the end.", h("a", { href: "/jobs" }, "Watch"));
  }) } }, `Score ${plural(old, "trip")} with the newest map`);
}

/** The card; an invitation where no trip has a score yet. */
export function scoreCard(score, carId) {
  const pose = h("p", {}, h("a", { class: "btn small", href: `/drives/new?car=${encodeURIComponent(carId)}` }, "Pose a drive"));
  if (score.score === null) {
    return score.trips.length > 0 && h("section", { class: "card" }, h("h2", {}, "Drive it on less"), h("p", { class: "quiet small" }, score.reason), renewal(score, carId), pose);
  }
  const latest = score.trips.find((trip) => trip.trip_id === score.advice_trip_id);
  return h("section", { class: "card" }, h("header", {}, h("h2", {}, "Drive it on less"), h("span", { class: "quiet" }, "Score ", h("strong", {}, number(score.score)))),
    score.advice.slice(0, MOST_ADVICE).map((text) => h("p", {}, text)), h("p", { class: score.advice.length > 0 ? "quiet" : "" }, together(score)),
    latest && h("p", { class: "small" }, h("a", { href: `/trips/${latest.trip_id}#score` }, `See ${latest.name}`)), renewal(score, carId), pose);
}
