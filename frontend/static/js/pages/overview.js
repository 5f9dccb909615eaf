/** What to do first on an empty Ponthy; otherwise what runs, which cars there are, and the latest trips. */

import { get, post } from "../core/api.js";
import { byId, show } from "../core/dom.js";
import { plural } from "../core/format.js";
import { busy, guarded } from "../core/notify.js";
import { countJobs, session } from "../core/shell.js";
import { JobFeed } from "../jobs/job-feed.js";
import { alive } from "../jobs/job-view.js";
import { carCard } from "../lists/car-card.js";
import { alertRow } from "../lists/alert-row.js";
import { ranking } from "../lists/ranking.js";
import { tripTable } from "../lists/trip-table.js";

const CARDS = 6;
const TRIPS = 8;
const ALERTS = 10;
const RENEW_MS = 500;
let renewal = null;
const showRanking = ranking(byId("ranking"), byId("ranked"), byId("more-ranked"));
const feed = new JobFeed({
  appeared: follow,
  over: () => {
    clearTimeout(renewal);
    renewal = setTimeout(() => guarded(load), RENEW_MS);
  },
});

/** Show a job that began just now. */
function follow(job) {
  if (!alive(job)) return;
  byId("running-jobs").prepend(feed.view(job).node);
  byId("running").hidden = false;
  countJobs();
}

async function load() {
  const [me, cars, trips, running, queued, alerts] = await Promise.all([
    session(), get(`cars?limit=${CARDS}`), get(`trips?limit=${TRIPS}`), get("jobs?state=running&limit=5"), get("jobs?state=queued&limit=5"), get(`alerts?state=current&limit=${ALERTS}`),
  ]);
  const jobs = [...running.items, ...queued.items];
  const empty = cars.items.length === 0 && trips.items.length === 0;
  byId("first").hidden = !empty || jobs.length > 0;
  byId("actions").hidden = empty;
  byId("demo").hidden = byId("demo-note").hidden = !me.demo?.available;
  byId("lead").textContent = empty ? "Each car's truth: where it went, and what it does with its fuel."
    : `${plural(cars.items.length, "car")}${cars.next_cursor ? " and more" : ""}, ${jobs.length ? `${plural(jobs.length, "job")} running or waiting` : "nothing running"}.`;
  byId("running").hidden = jobs.length === 0;
  show(byId("running-jobs"), jobs.map((job) => feed.view(job).node));
  byId("alerts").hidden = alerts.items.length === 0;
  show(byId("alert-list"), alerts.items.map(alertRow));
  byId("cars").hidden = cars.items.length === 0;
  show(byId("car-cards"), cars.items.map((car) => carCard(car)));
  byId("recent").hidden = trips.items.length === 0;
  show(byId("recent-trips"), tripTable("Latest trips", trips.items, { withCar: true }));
  await showRanking();
  await countJobs();
}

byId("demo").addEventListener("click", (event) => busy(event.currentTarget, async () => {
  await post("demo");
  await load();
}));
await guarded(load);
