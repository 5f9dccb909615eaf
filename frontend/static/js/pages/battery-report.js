/** The report's figures, redrawn from our own run, with what it says beside what we found. */

import { API, at, get, post } from "../core/api.js";
import { byId, h, show } from "../core/dom.js";
import { Figure } from "../core/figure.js";
import { when } from "../core/format.js";
import { busy, guarded, problemBox, toast } from "../core/notify.js";
import { plotly } from "../core/plotly.js";
import { countJobs } from "../core/shell.js";
import { table } from "../core/ui.js";
import { FIGURES, claimsOf } from "../battery/report-claims.js";
import { JobFeed } from "../jobs/job-feed.js";
import { alive } from "../jobs/job-view.js";

const FIGURE_PX = 320;
let drawn = false;

plotly().catch(() => undefined); // comes while the data does; a failure is told where something is to be drawn
const isReport = (job) => job.stages.some((stage) => stage.name === "report");
const feed = new JobFeed({ appeared: (job) => isReport(job) && alive(job) && follow(job), over: (job) => isReport(job) && job.state === "succeeded" && guarded(ended) });

function follow(job) {
  show(byId("report-job"), feed.view(job, { withTitle: false }).node);
  countJobs();
}

async function ended() {
  if (drawn) location.reload();
  else await load();
}

async function run() {
  const job = await post("batteries/report");
  if (alive(job)) follow(job);
  else toast("These runs are up to date: the program hasn’t changed since.");
}

function claimsTable(report) {
  const th = (text) => h("th", { scope: "col" }, text);
  return table("Claims and findings", h("tr", {}, th("Figure"), th("The report says"), th("Our run")),
    claimsOf(report).map(([figure, said, found]) => h("tr", {}, h("th", { scope: "row" }, h("a", { href: `#figure-${figure}` }, figure)), h("td", {}, said), h("td", {}, found))));
}

function figureCard([number, title, words]) {
  const box = h("div", { class: "figure" });
  new Figure(box, { label: `Figure ${number}: ${title}`, height: FIGURE_PX, tall: true }).load(`${API}/batteries/report/figures/${number}`);
  return h("section", { class: "card", id: `figure-${number}` }, h("header", {}, h("h2", {}, title), h("span", { class: "quiet" }, `Fig. ${number}`)), h("p", { class: "quiet small" }, words), box);
}

/** Why there is nothing to show: nobody asked yet, it is being worked out, or it failed. */
async function missing(error) {
  if (error.code === "report-not-ready") follow(await get(at("jobs", error.job_id)));
  const again = h("button", { class: "btn primary", on: { click: (event) => busy(event.currentTarget, run) } }, "Run it");
  show(byId("report-empty"), error.code === "no-report" ? h("div", { class: "empty" }, h("h2", {}, "Not run yet"),
    h("p", {}, "Ten days with two and three terms, and a hundred days with fading capacity. A worker needs about half a minute for them."), h("div", { class: "actions" }, again))
    : error.code !== "report-not-ready" && problemBox(error, again));
}

async function load() {
  let report = null;
  try {
    report = await get("batteries/report");
  } catch (error) {
    await missing(error);
  }
  byId("run-report").hidden = !report;
  byId("report-ready").hidden = !report;
  if (!report) return;
  drawn = true;
  show(byId("report-empty"));
  show(byId("claims"), claimsTable(report));
  show(byId("report-figures"), FIGURES.map(figureCard));
  show(byId("report-about"), h("p", { class: "quiet small" }, "Worked out ", when(report.provenance.made_at), ` by version ${report.provenance.code_version}.`));
}

byId("run-report").addEventListener("click", (event) => busy(event.currentTarget, run));
await guarded(load);
await countJobs();
