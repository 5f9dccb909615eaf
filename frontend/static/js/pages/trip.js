/** One trip: map and stacked signals under one time cursor, and below them where the numbers come from. */

import { at, get } from "../core/api.js";
import { byId, h, show } from "../core/dom.js";
import { complain, guarded } from "../core/notify.js";
import { plotly } from "../core/plotly.js";
import { countJobs } from "../core/shell.js";
import { tabs } from "../core/ui.js";
import { JobFeed } from "../jobs/job-feed.js";
import { offerBattery } from "../trip/battery.js";
import { chooseSignals } from "../trip/chooser.js";
import { Cursor, steer } from "../trip/cursor.js";
import { showHead, wireHead } from "../trip/head.js";
import { showHealth } from "../trip/health.js";
import { Layout } from "../trip/layout.js";
import { showDecoded, showNumbers, showPoints, wireNotes } from "../trip/panels.js";
import { Readout } from "../trip/readout.js";
import { showScore } from "../trip/score.js";
import { chosenSignals, keepSignals } from "../trip/signals.js";
import { Stack, stackAhead } from "../trip/stack.js";
import { showTold } from "../trip/told.js";
import { Track, trackAhead } from "../trip/track.js";

const NARROW = 1100;
const NARROW_MAP_PX = 340;
const WIDE_MAP_PX = 480;
const AROUND_MAP_PX = 300;
const RENEW_MS = 300;
const { tripId, observed } = document.body.dataset;
const path = at("trips", tripId);
const trip = {};
const layout = new Layout(byId("layout-menu"), byId("trip-grid"));
let drawn = false;

if (observed !== undefined) {
  if (layout.withPlots) stackAhead(tripId);
  if (layout.withMap) trackAhead(tripId);
}
plotly().catch(() => undefined); // comes while the data does; a failure is told where something is to be drawn
const feed = new JobFeed({
  appeared: (job) => job.trip_id === tripId && follow(job),
  changed: (job) => job.trip_id === tripId && !drawn && isBeingScored(job) && guarded(load),
  over: (job) => job.trip_id === tripId && setTimeout(() => guarded(() => takeUp(job)), RENEW_MS),
});
let renewScore = () => undefined;
let showBattery = () => undefined;

/** Show the job that works on this trip, or why the last one failed. */
function follow(job) {
  const { node } = feed.view(job, { withTitle: false });
  const onlyScore = drawn && job.kind === "trip" && isBeingScored(job); // nothing moves for what the page can do without
  if (job.state !== "succeeded" && !onlyScore) show(byId("trip-job"), h("div", { class: "stack-gap" }, node));
  countJobs();
}

/** Whether all but what the page can do without is there: the battery and the trip's score. */
const isBeingScored = (job) => job.stages.some((stage) => ["battery", "score"].includes(stage.name) && stage.state === "running");

/** Take up what a job has left: a new score in its tab, a new run of the observer in all of the page. */
async function takeUp(job) {
  if (job.state === "succeeded") show(byId("trip-job"));
  const before = trip.provenance?.observe_key;
  if (job.kind !== "score") await load();
  if (drawn && before && trip.provenance.observe_key !== before) location.reload();
  else await renewed();
}

/** Take up what comes after the plots: the score, and what the trip says of the car's battery. */
async function renewed() {
  renewScore();
  await offer();
}

/** Show the tab of the battery where the trip says something of it. */
async function offer() {
  showBattery = await offerBattery(trip).catch(complain);
}

/** Map, stack, cursor and readout. The stack comes first: with it the page can be used, and this is over. */
async function draw() {
  drawn = true;
  byId("trip-ready").hidden = false;
  const cursor = new Cursor(trip.duration_s);
  let names = chosenSignals();
  const choose = h("button", { class: "btn small", ariaHasPopup: "dialog", on: { click: () => chooseSignals(byId("chooser-dialog"), names, use) } }, "+ Signal");
  const stack = new Stack(byId("stack"), trip, cursor, choose);
  const mapHeight = () => ({
    beside: innerWidth > NARROW ? stack.heightOf(names) : NARROW_MAP_PX, above: WIDE_MAP_PX, map: Math.max(WIDE_MAP_PX, innerHeight - AROUND_MAP_PX),
  })[layout.name] ?? NARROW_MAP_PX;
  const track = new Track(byId("track"), trip, cursor, { height: mapHeight() });
  const readout = new Readout(byId("readout"), trip, cursor, stack, track);
  const use = async (chosen) => {
    names = chosen;
    keepSignals(names);
    if (layout.withMap) track.resize(mapHeight());
    await stack.use(names);
    readout.use(names);
  };
  let mapped = false;
  const showMap = async () => {
    if (!layout.withMap) return;
    if (mapped) {
      track.resize(mapHeight());
      return;
    }
    mapped = true;
    track.figure.options.height = mapHeight();
    await track.load();
    readout.move();
  };
  layout.changed.add(() => {
    if (layout.withPlots) stack.use(names);
    showMap();
  });
  steer(cursor, byId("cursor-slider"), trip.started_at);
  if (layout.withPlots) await stack.use(names);
  readout.use(names);
  performance.mark("ponthy-trip-ready");
  showMap();
}

async function load() {
  Object.assign(trip, await get(path));
  showHead(trip);
  const known = trip.duration_s !== null;
  byId("run-again").hidden = byId("export-menu").hidden = !known;
  if (trip.job_id && trip.state !== "ready") follow(await get(at("jobs", trip.job_id)));
  if (!known || drawn) return;
  const drawing = draw();
  const offering = drawing.then(offer, () => undefined); // the plots go first, and tell by themselves why they can't be drawn
  if (location.hash === "#battery") await offering;
  const soon = (fill) => (panel) => drawing.then(() => fill(panel, trip)); // the plots go first
  tabs(document.querySelector(".tabs"), {
    "panel-health": soon(showHealth), "panel-told": soon(showTold), "panel-score": soon((panel) => { renewScore = showScore(panel, trip, follow); }), "panel-points": soon(showPoints), "panel-decoded": soon(showDecoded),
    "panel-battery": soon((panel) => showBattery?.(panel)), "panel-numbers": (panel) => showNumbers(panel, trip), "panel-notes": (panel) => wireNotes(panel, trip),
  });
  await drawing;
}

wireHead(trip, follow);
await guarded(load);
await countJobs();
