/** One drive: what to do, in words, what it takes, how one knows, and what else was tried. */

import { API, at, get, patch, post, query, remove } from "../core/api.js";
import { byId, h, show } from "../core/dom.js";
import { when } from "../core/format.js";
import { busy, complain, guarded, problemBox, toast } from "../core/notify.js";
import { plotly } from "../core/plotly.js";
import { countJobs } from "../core/shell.js";
import { actions, askName, confirmed, tabs } from "../core/ui.js";
import { driveMark } from "../core/verdict.js";
import { Along } from "../drives/along.js";
import { showCertificate, showVerdict } from "../drives/certificate.js";
import { showCompetitors } from "../drives/competitors.js";
import { showDocument } from "../drives/document.js";
import { showAdvice, showFacts, showWarnings } from "../drives/result.js";
import { plainly } from "../drives/paths.js";
import { KINDS } from "../drives/words.js";
import { fronts, methods } from "../drives/work.js";
import { JobFeed } from "../jobs/job-feed.js";
import { alive } from "../jobs/job-view.js";

const { driveId } = document.body.dataset;
const path = at("drives", driveId);
const EXPORTS = [
  ["csv", "CSV", "the trajectory as a table"], ["parquet", "Parquet", "the trajectory, for analysis"], ["json", "Answer", "JSON, as ./ponthy drive --json"],
  ["problem", "Problem", "JSON that ./ponthy drive takes"],
];
const UNDER_WAY = ["waiting", "solving"];
const drive = {};
const work = {};
let drawn = false;

plotly().catch(() => undefined); // comes while the data does; a failure is told where something is to be drawn
const feed = new JobFeed({ over: (job) => job.drive_id === driveId && guarded(() => ended(job)) });

/** A job about this drive is over: take up what it found. */
async function ended(job) {
  countJobs();
  const piece = Object.entries(drive.jobs ?? {}).find(([name, id]) => id === job.id && name !== "solve");
  const [stage] = job.stages;
  if (stage?.name === "solve" && drawn) location.reload(); // solved anew: everything is drawn from its beginning
  else if (stage?.name === "solve") await load();
  else await work[piece?.[0] ?? stage?.name]?.over(job);
}

function showHead() {
  document.title = `${drive.name} · Ponthy`;
  byId("drive-name").textContent = drive.name;
  const car = drive.car_id ? h("a", { href: `/cars/${drive.car_id}` }, drive.car_name ?? "its car") : "no car of its own";
  show(byId("drive-sub"), KINDS[drive.kind] ?? drive.kind, " · ", car, drive.map && [" · map version ", h("a", { href: `/cars/${drive.map.car_id}/maps/${drive.map.version}` }, drive.map.version)], " · posed ", when(drive.created_at));
  show(byId("drive-verdict"), !UNDER_WAY.includes(drive.state) && driveMark(drive)); // until then its job says more
  Object.assign(byId("pose-again"), { hidden: false, href: `/drives/new${query({ from: driveId })}` });
  show(byId("export-items"), EXPORTS.filter(([format]) => drive.state === "solved" || format === "problem").map(([format, name, what]) =>
    h("a", { href: `${API}/${path}/export${query({ format })}`, download: "" }, name, h("small", {}, what))));
}

/** Why there is no answer, with a way back to the field that can change it. */
function showFailure() {
  const { failure } = drive;
  const place = failure && (failure.limit || failure.field || failure.path || "");
  const again = h("a", { class: "btn primary", href: `/drives/new${query({ from: driveId, field: failure?.limits?.[0] ?? place })}` }, "Change the problem");
  const retry = h("button", { class: "btn", on: { click: (event) => busy(event.currentTarget, solveAgain) } }, "Solve again");
  show(byId("drive-failure"), failure && !UNDER_WAY.includes(drive.state) && (drive.state === "cancelled"
    ? h("p", { class: "note" }, "This drive was cancelled before it was solved. ", retry)
    : problemBox({ ...failure, field: null, title: drive.state === "infeasible" ? "No drive does this" : failure.title, detail: plainly(failure.detail, place) }, again, drive.state === "failed" && retry)));
}

async function solveAgain() {
  follow(await post(`${path}/solve`));
}

function follow(job) {
  show(byId("drive-job"), h("div", { class: "stack-gap" }, feed.view(job, { withTitle: false }).node));
  countJobs();
}

/** The answer in full; drawn once, as an answer does not change. */
async function draw() {
  drawn = true;
  const answer = await get(`${path}/answer`);
  const ball = drive.kind === "ball_and_wheel";
  showAdvice(answer);
  showFacts(answer);
  showWarnings(drive, answer);
  showVerdict(byId("verdict-card"), drive, answer);
  byId("drive-ready").hidden = false;
  byId("over-switch").hidden = ball;
  byId("path-title").textContent = ball ? "The synthesis" : drive.problem.engine.willans ? "Fuel over power at the wheels" : "Through the engine’s map";
  if (ball) byId("advice-title").textContent = "What to do";
  for (const tab of ball ? ["competitors", "methods", "front"] : []) byId("drive-ready").querySelector(`#tab-${tab}`).hidden = true;
  const along = new Along(driveId, ball ? { plane: "synthesis", label: "The synthesis" } : {});
  const drawing = along.draw();
  const begin = (name, make) => async (panel) => {
    work[name] = make(panel, drive, feed);
    if (!drive.jobs[name]) return; // nobody has asked for it yet
    const job = await get(at("jobs", drive.jobs[name]));
    if (job.state === "succeeded") await work[name].load();
    else work[name].follow(job);
  };
  tabs(document.querySelector(".tabs"), {
    "panel-certificate": (panel) => drawing.then(() => showCertificate(panel, drive, answer)),
    "panel-competitors": (panel) => showCompetitors(panel, drive, answer),
    "panel-methods": (panel) => guarded(() => begin("compare", methods)(panel)), "panel-front": (panel) => guarded(() => begin("front", fronts)(panel)),
    "panel-document": (panel) => showDocument(panel, drive, answer),
  });
  await drawing;
}

async function load() {
  Object.assign(drive, await get(path));
  showHead();
  showFailure();
  if (drive.job_id && UNDER_WAY.includes(drive.state)) {
    const job = await get(at("jobs", drive.job_id));
    if (!alive(job)) return load(); // it ended between the two questions
    follow(job);
  } else {
    show(byId("drive-job"));
  }
  return drive.state === "solved" && !drawn ? draw() : undefined;
}

actions(byId("drive-menu"), {
  rename: async () => {
    const name = await askName("Rename this drive", "Name", drive.name, "Rename");
    if (name) await patch(path, { name }).then((changed) => { Object.assign(drive, changed); showHead(); }, complain);
  },
  compare: () => location.assign(`/drives/compare${query({ a: driveId })}`),
  again: (button) => busy(button, async () => {
    await solveAgain();
    toast("This drive is solved again.");
  }),
  delete: (button) => busy(button, async () => {
    if (!(await confirmed(`Delete “${drive.name}”?`, "Its answer goes with it. This can't be taken back.", "Delete"))) return;
    await remove(path);
    location.assign("/drives");
  }),
});
await guarded(load);
await countJobs();
