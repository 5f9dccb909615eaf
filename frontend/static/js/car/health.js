/** A car's health: alerts in words, each quantity's trend beside its usual, and the trips this rests on. */

import { API, at, get, post, query, remove } from "../core/api.js";
import { byId, h, show } from "../core/dom.js";
import { Figure } from "../core/figure.js";
import { number, percent, plural, when } from "../core/format.js";
import { busy, complain, guarded, toast } from "../core/notify.js";
import { agreed, table } from "../core/ui.js";
import { alertMark, healthMark } from "../core/verdict.js";

const ROLES = { baseline: "says what is usual", watched: "is compared with it", before: "before the new usual" };
const HISTORY = 50;
const FIGURE_PX = 260;

const tripLink = (id, name) => h("a", { href: `/trips/${id}` }, name);
const around = (estimate, sd, unit) => [number(estimate, 1), h("span", { class: "quiet" }, ` ±\u202f${number(sd, 1)}\u202f${unit}`)];

/** How probable something is; what is all but certain is not called certain. */
const sureness = (chance) => (chance > 0.99 ? ["more than ", percent(0.99, 0)] : percent(chance, 0));

/** One alert; what is not over has buttons. */
function alertView(alert, health, again) {
  const since = health.trips.find((trip) => trip.trip_id === alert.since_trip_id);
  const over = alert.state === "cleared";
  const see = h("button", { class: "btn", on: { click: () => busy(see, async () => {
    await post(at("cars", health.car_id, `/health/alerts/${alert.id}/seen`));
    again();
  }) } }, "I have seen it");
  const usual = h("button", { class: "btn", on: { click: () => busy(usual, () => takeAsUsual(alert, health, again)) } }, "This is its new usual…");
  return h("article", { class: "proposal" },
    h("header", {}, h("h3", {}, alert.words), alertMark(alert.state)),
    h("ul", { class: "reasons" },
      !over && h("li", {}, alert.advice),
      since && h("li", {}, "Since ", tripLink(since.trip_id, since.name), " of ", when(alert.since_at), "."),
      h("li", {}, "That this is the cause, and none of the others: ", sureness(alert.chance), "."),
      alert.seen_at && h("li", {}, "Seen ", when(alert.seen_at), alert.seen_by && ` by ${alert.seen_by}`, "."),
      over && h("li", {}, alert.cleared_words, " ", when(alert.cleared_at))),
    !over && h("div", { class: "form-end" }, alert.state === "open" && see, usual));
}

async function takeAsUsual(alert, health, again) {
  const text = h("p", {}, "From the first trip of this change on, the car's trips say anew what is usual for it, and its alerts are over. The trips before are kept, but no longer compared. This can be taken back.");
  if (!(await agreed("Take this as the car's new usual?", text, "Take as usual"))) return;
  await post(at("cars", health.car_id, "/health/usual"), alert.since_trip_id ? { since_trip_id: alert.since_trip_id } : {});
  toast("The car is assessed anew.", h("a", { href: "/jobs" }, "Watch"));
  again();
}

/** From when on the trips say what is usual, with the way back. */
function usualLine(health, again) {
  if (!health.usual_since) return null;
  const back = h("button", { class: "btn bare small", on: { click: () => busy(back, async () => {
    await remove(at("cars", health.car_id, "/health/usual"));
    toast("The car's first trips say again what is usual; it is assessed anew.");
    again();
  }) } }, "Go back to its first trips");
  return h("p", { class: "quiet" }, "Its usual was set anew and begins ", when(health.usual_since), ". ", back);
}

function stateView(health, again) {
  const chance = health.false_alarms_per_200_trips;
  return h("section", { class: "card", ariaLabel: "State" }, h("header", {}, h("h2", {}, health.alerts.length > 0 ? "What has changed" : health.words || "Health"), healthMark(health.state)),
    health.reason && h("p", {}, health.reason),
    health.baseline_needed > 0 && health.trends.length === 0 && h("p", { class: "quiet" }, `${plural(health.baseline_trips, "trip")} of the ${number(health.baseline_needed)} that are needed to know what is usual.`),
    health.trends.length > 0 && h("p", { class: "quiet" }, `${plural(health.baseline_trips, "trip")} say what is usual. By chance alone about ${number(chance, chance < 0.1 ? 2 : 1)} alarms are to be expected in 200 healthy trips.`),
    usualLine(health, again),
    health.alerts.map((alert) => alertView(alert, health, again)));
}

function emptyView(health) {
  return h("div", { class: "empty" }, h("h2", {}, "Nothing to compare with yet"), h("p", {}, health.reason),
    h("div", { class: "actions" }, h("a", { class: "btn", href: `/upload?car=${health.car_id}` }, "Upload a trip")));
}

const LEAST_IDLES = 3;

/** What the car burns standing still, once a few trips have told. */
const idleView = (health) => health.idle.length >= LEAST_IDLES
  && trendView({ quantity: "idle", title: "Idle consumption", words: "Standing, with the engine running. Bars: how far it varied within the trip; dotted: the median. Warm-up and air conditioning show here, too; no alarm is raised." }, health.car_id);

/** The trend of one quantity; a click on a trip's point opens the trip. */
function trendView(trend, carId) {
  const box = h("div", { class: "figure" });
  let linked = false;
  const link = (plot) => {
    if (linked) return;
    linked = true;
    plot.on("plotly_click", ({ points }) => points[0]?.customdata && location.assign(`/trips/${encodeURIComponent(points[0].customdata[0])}`));
  };
  const figure = new Figure(box, { label: `${trend.title}, trip by trip`, height: FIGURE_PX, drawn: link });
  figure.load(`${API}/${at("cars", carId, `/health/figures/${trend.quantity}`)}`);
  return h("section", { class: "card" }, h("h2", {}, trend.title), h("p", { class: "quiet small" }, trend.words), box);
}

function tripsView(health) {
  const column = (text, kind) => h("th", { scope: "col", class: kind }, text);
  const told = health.trends.map((trend) => [trend, new Map(trend.trip_ids.map((id, i) => [id, around(trend.estimate[i], trend.sd[i], trend.unit)]))]);
  const rows = health.trips.toReversed().map((trip) => h("tr", { class: trip.role === "left_out" ? "out" : "" },
    h("th", { scope: "row" }, tripLink(trip.trip_id, trip.name)), h("td", {}, when(trip.started_at)),
    told.map(([, of]) => h("td", { class: "n" }, of.get(trip.trip_id) ?? "–")), h("td", { class: "wide" }, trip.why || ROLES[trip.role])));
  const counted = health.trips.filter((trip) => trip.role !== "left_out").length;
  return h("details", { class: "section" }, h("summary", {}, `Trips this rests on (${counted} of ${health.trips.length})`),
    h("p", { class: "quiet" }, "Change from the usual on each trip, as if nothing else had changed, ±1σ."),
    table("Trips and what they say", h("tr", {}, column("Trip"), column("Started"), told.map(([trend]) => column(trend.title, "n")), column("What it is here")), rows));
}

function historyView(alerts, health) {
  if (alerts.length === 0) return null;
  return h("details", { class: "section" }, h("summary", {}, `Alerts that are over (${alerts.length})`), alerts.map((alert) => alertView(alert, health)));
}

/** Fill the tab of the car's health; returns what renews it. */
export function showHealth(carId, changed) {
  const box = byId("health");
  let shown = "";
  const again = () => { renew(); changed(); };
  const fill = async () => {
    const [health, over] = await Promise.all([get(at("cars", carId, "/health")), get(`alerts${query({ car_id: carId, state: "cleared", limit: HISTORY })}`)]);
    const now = JSON.stringify([health, over.items]);
    if (now === shown) return;
    shown = now;
    const known = health.trends.length > 0 || health.alerts.length > 0;
    show(box, known || health.trips.length > 0 ? stateView(health, again) : emptyView(health),
      (health.trends.length > 0 || health.idle.length >= LEAST_IDLES) && h("div", { class: "trends section" }, health.trends.map((trend) => trendView(trend, carId)), idleView(health)),
      health.trends.length > 0 && h("p", { class: "quiet small" }, "Bands: one and two standard deviations of each trip. Grey: where healthy trips lie. Dashed: the car changed there. Squares: trips within an alert."),
      health.trips.length > 0 && tripsView(health), historyView(over.items, health));
  };
  const renew = () => fill().catch(complain);
  guarded(fill, box);
  return renew;
}
