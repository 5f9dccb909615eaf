/** The road of a problem: what it is like, and another one from a file or a trip. */

import { get, post, query, request } from "../core/api.js";
import { h, show, svg } from "../core/dom.js";
import { number, when } from "../core/format.js";
import { busy, problemBox } from "../core/notify.js";
import { KMH } from "./words.js";

const TRIPS = 100;
const CLIMBS = 0.01;
const ORDINARY_KMH = 50;

/** Height along the road as a small drawing; its numbers stand beside it in words. */
function profile({ distance_m: at, elevation_m: height }, words) {
  const [from, to] = [at[0], at.at(-1)];
  const [low, high] = [Math.min(...height), Math.max(...height)];
  const points = at.map((one, i) => `${(100 * (one - from)) / (to - from)},${38 - (36 * (height[i] - low)) / Math.max(high - low, 1)}`);
  return svg("svg", { viewBox: "0 0 100 40", preserveAspectRatio: "none", class: "profile", role: "img", "aria-label": words }, svg("polygon", { points: `0,40 ${points.join(" ")} 100,40` }));
}

/** A road in a sentence. */
function wordsOf({ distance_m: at, elevation_m: height, speed_limit_mps: limits }) {
  const climbs = height.slice(1).reduce((sum, one, i) => sum + Math.max(0, one - height[i]), 0);
  const held = limits.slice(0, -1);
  const [slowest, fastest] = [Math.min(...held), Math.max(...held)].map((limit) => number(KMH * limit));
  return `${number((at.at(-1) - at[0]) / 1000, 2)} km, ${number(at.length)} points, climbs ${number(climbs, climbs < 1 && climbs > CLIMBS ? 1 : 0)} m, limits ${slowest === fastest ? slowest : `${slowest} to ${fastest}`} km/h`;
}

const drawable = (road) => ["distance_m", "elevation_m", "speed_limit_mps"].every((name) => Array.isArray(road?.[name]) && road[name].length > 1 && road[name].every(Number.isFinite));

/** Put a road into a problem, with wishes that fit it: ends as they were driven, within the limits, and the time that its driver took. */
export function lay(problem, answer) {
  const { road } = answer;
  const limits = road.speed_limit_mps;
  const lowest = Math.min(problem.min_speed_mps, ...limits);
  const end = (driven, wished, limit) => Math.min(Math.max(Number((driven ?? wished).toPrecision(6)), lowest), limit); // rounded last, it could pass the limit
  Object.assign(problem, { road, min_speed_mps: lowest, from_speed_mps: end(answer.from_speed_mps, problem.from_speed_mps, limits[0]), to_speed_mps: end(answer.to_speed_mps, problem.to_speed_mps, limits.at(-2)) });
  if (Number.isFinite(answer.time_s)) problem.max_time_s = Number(answer.time_s.toPrecision(6));
}

/** The field; `carId` says whose trips are offered, `laid` is called with what is to be known of another road. */
export function roadField(problem, carId, laid) {
  const outcome = h("div");
  const take = async (asked) => {
    show(outcome);
    try {
      const answer = await asked();
      lay(problem, answer);
      laid(answer.notes ?? []);
    } catch (error) {
      show(outcome, problemBox(error));
    }
  };
  const limit = h("input", { class: "number", id: "road-limit", inputMode: "decimal", value: String(ORDINARY_KMH) });
  const level = h("input", { type: "checkbox" });
  const given = () => query({ speed_limit_mps: limit.value.trim() && Number(limit.value.replace(",", ".")) / KMH, level: level.checked || null });
  const file = h("input", { type: "file", class: "visually-hidden", id: "road-file", accept: ".gpx,.csv,.txt,.json", on: { change: () => {
    const [one] = file.files;
    if (one) take(async () => (await request(`drives/roads${given()}`, { method: "POST", headers: { "Content-Type": "application/octet-stream" }, body: await one.arrayBuffer() })).json());
    file.value = "";
  } } });
  const trips = h("select", { ariaLabel: "Trip whose road is taken", hidden: true, on: { change: () => trips.value && take(() => post("drives/roads", { trip_id: trips.value })) } });
  const offer = h("button", { class: "btn small", type: "button", on: { click: (event) => busy(event.currentTarget, async () => {
    const { items } = await get(`trips${query({ car_id: carId(), limit: TRIPS })}`);
    show(trips, h("option", { value: "" }, items.length > 0 ? "Choose a trip…" : "There are no trips yet"), items.map((trip) => h("option", { value: trip.id }, `${trip.name || trip.filename}, ${when(trip.started_at).textContent}`)));
    trips.hidden = false;
    offer.hidden = true;
    trips.focus();
  }) } }, "From a trip…");
  const shown = drawable(problem.road) ? [profile(problem.road, wordsOf(problem.road)), h("p", { class: "small" }, wordsOf(problem.road))] : h("p", { class: "quiet" }, "No road yet: take one from a file or a trip.");
  return h("div", { class: "road-field" }, shown,
    h("div", { class: "form-end" }, h("label", { class: "btn small", htmlFor: "road-file" }, "From a file (GPX, CSV)…"), file,
      h("label", { class: "quiet small", htmlFor: "road-limit" }, "Limit where the file has none"), limit, h("span", { class: "unit" }, "km/h"),
      h("label", { class: "check quiet small" }, level, h("span", {}, "Leave heights out")), offer, trips), outcome);
}
