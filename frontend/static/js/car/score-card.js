/** "Drive it on less": what to do differently, and what that would have saved. */

import { h } from "../core/dom.js";
import { km, measureText, number, plural } from "../core/format.js";

const MOST_ADVICE = 2;

/** What all scored trips together say, in one line. */
function together(score) {
  const scored = score.trips.filter((trip) => trip.score !== null).length;
  const share = (100 * score.saved_l) / score.fuel_l;
  const around = (100 * score.saved_sd_l) / score.fuel_l;
  if (share < around) return [`${plural(scored, "trip")} took no more than the best drives known, as far as can be told.`];
  return [`Driving so would have saved ${number(share)} ±\u202f${number(around, around < 1 ? 1 : 0)}\u202f% (${measureText(score.saved_l, "L", 2)}) over ${plural(scored, "trip")} and `, km(score.distance_m), "."];
}

/** The card; an invitation where no trip has a score yet. */
export function scoreCard(score, carId) {
  const pose = h("p", {}, h("a", { class: "btn small", href: `/drives/new?car=${encodeURIComponent(carId)}` }, "Pose a drive"));
  if (score.score === null) {
    return score.trips.length > 0 && h("section", { class: "card" }, h("h2", {}, "Drive it on less"), h("p", { class: "quiet small" }, score.reason), pose);
  }
  const latest = score.trips.find((trip) => trip.trip_id === score.advice_trip_id);
  return h("section", { class: "card" }, h("header", {}, h("h2", {}, "Drive it on less"), h("span", { class: "quiet" }, "Score ", h("strong", {}, number(score.score)))),
    score.advice.slice(0, MOST_ADVICE).map((text) => h("p", {}, text)), h("p", { class: score.advice.length > 0 ? "quiet" : "" }, together(score)),
    latest && h("p", { class: "small" }, h("a", { href: `/trips/${latest.trip_id}#score` }, `See ${latest.name}`)), pose);
}
