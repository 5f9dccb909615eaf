/** One battery: what is in it now, what is left of it, how sure one is, and where that comes from. */

import { API, at, get, patch, post, query, remove } from "../core/api.js";
import { byId, h, show } from "../core/dom.js";
import { Figure } from "../core/figure.js";
import { plural, when } from "../core/format.js";
import { busy, complain, guarded, toast } from "../core/notify.js";
import { plotly } from "../core/plotly.js";
import { countJobs } from "../core/shell.js";
import { actions, askName, confirmed, tabs } from "../core/ui.js";
import { Ageing } from "../battery/ageing.js";
import { showCircuit } from "../battery/circuit.js";
import { showConfig } from "../battery/config.js";
import { CurveEditor } from "../battery/curve.js";
import { showData, wireData } from "../battery/data.js";
import { showFit } from "../battery/fit.js";
import { ratedOf, showFacts, showState, showWarnings } from "../battery/state.js";
import { JobFeed } from "../jobs/job-feed.js";
import { alive } from "../jobs/job-view.js";

const { batteryId } = document.body.dataset;
const path = at("batteries", batteryId);
const wanted = new URLSearchParams(location.search).get("estimate");
const RENEW_MS = 300;
const FIGURE_PX = 320;
const EXPORTS = [["csv", "CSV", "the history as a table"], ["parquet", "Parquet", "the history, for analysis"], ["json", "JSON", "the history with everything known"]];
const battery = {};
const parts = {};
const figures = {};
let renewal = null;

plotly().catch(() => undefined); // comes while the data does; a failure is told where something is to be drawn
const feed = new JobFeed({
  appeared: (job) => job.battery_id === batteryId && alive(job) && follow(job),
  over: (job) => (job.battery_id === batteryId || isTripOfCar(job)) && guarded(() => ended(job)),
});

/** Whether a job works on a trip of the battery's car, which may tell of the battery. */
const isTripOfCar = (job) => job.car_id === battery.car_id && job.stages.some((stage) => stage.name === "battery");

/** Address of a figure: of the estimate that is shown. */
const url = (name) => `${path}/figures/${name}${query({ estimate: wanted })}`;

function follow(job) {
  const { node } = feed.view(job, { withTitle: false });
  if (!node.isConnected) byId("battery-jobs").append(node);
  countJobs();
}

/** A job about this battery is over: take up what it found. */
async function ended(job) {
  countJobs();
  show(byId("data-outcome"));
  if (job.state === "succeeded") feed.view(job).node.remove(); // what it found says more
  if (job.stages[0]?.name === "curve") await (job.state === "succeeded" ? get(`${path}/curve`).then((fitted) => parts.curve?.propose(fitted)) : parts.curve?.failed(job));
  clearTimeout(renewal);
  renewal = setTimeout(() => guarded(load), RENEW_MS);
}

function showHead() {
  const { config, newest } = battery;
  document.title = `${battery.name} · Ponthy`;
  byId("battery-title").textContent = battery.name;
  const cells = (config.series ?? 1) * (config.parallel ?? 1);
  const rated = ratedOf(config);
  show(byId("battery-sub"), h("a", { href: `/cars/${battery.car_id}` }, battery.car_name), ` · ${plural(cells, "cell")}`, cells > 1 && ` (${config.series ?? 1} in series, ${config.parallel ?? 1} side by side)`,
    Number.isFinite(rated) && ` · rated ${rated}\u202fAh each`, newest && [" · last data ", when(newest.ended_at)]);
  show(byId("export-items"), EXPORTS.map(([format, name, what]) => h("a", { href: `${API}/${path}/export${query({ format })}`, download: "" }, name, h("small", {}, what))));
}

function showNote() {
  const old = wanted && battery.shown && battery.newest && battery.shown.id !== battery.newest.id;
  show(byId("battery-note"),
    !battery.newest && h("div", { class: "empty" }, h("h2", {}, "Nothing is known of it yet"), h("p", {}, "Send a file with current and voltage, or upload a trip of its car that holds them."),
      h("div", { class: "actions" }, h("a", { class: "btn", href: "#data" }, "Add data"), h("a", { class: "btn", href: `/upload?car=${encodeURIComponent(battery.car_id)}` }, "Upload a trip"))),
    battery.missing?.length > 0 && h("p", { class: "note" }, `Nothing can be estimated before the configuration is complete. It lacks: ${battery.missing.join(", ")}. `, h("a", { href: "#config" }, "Complete it")),
    old && h("p", { class: "note" }, `This is what ${battery.shown.source} said. `, h("a", { href: `/batteries/${batteryId}` }, "Show the newest")));
}

async function draw() {
  const options = { height: FIGURE_PX, tall: true };
  figures.soc ??= new Figure(byId("soc-figure"), { label: "State of charge", ...options });
  figures.soh ??= new Figure(byId("soh-figure"), { label: "State of health", ...options });
  await Promise.all([figures.soc.load(`${API}/${url("soc")}`), figures.soh.load(`${API}/${path}/figures/soh`)]);
}

/** What is of one estimate and says nothing before there is one. */
const estimated = (fill) => (panel) => (battery.shown ? fill(panel, battery, url) : show(panel, h("p", { class: "quiet" }, "Nothing has been estimated yet.")));

/** A battery that was taken out of its car's file keeps its history; the page does without a configuration. */
function withoutConfig(error) {
  if (error.status !== 409) throw error;
  return {};
}

async function load() {
  const [now, config] = await Promise.all([get(path), get(`${path}/config`).catch(withoutConfig), countJobs()]);
  Object.assign(battery, now, { config });
  battery.shown = wanted ? await get(at("batteries", batteryId, `/estimates/${encodeURIComponent(wanted)}`)) : battery.newest;
  showHead();
  showNote();
  byId("battery-ready").hidden = !battery.shown;
  if (battery.shown) {
    byId("soc-of").textContent = battery.shown.source;
    showState(battery.shown, config);
    showFacts(battery.shown);
    showWarnings(battery.shown);
  }
  showData(battery).catch(complain);
  parts.ageing?.renew();
  for (const panel of ["circuit", "fit"]) if (parts[panel]) parts[panel]();
  if (!parts.wired) wire();
  if (battery.shown) await draw();
}

function wire() {
  parts.wired = true;
  wireData(battery, follow);
  const kept = (name, fill) => (panel) => { (parts[name] = () => estimated(fill)(panel))(); };
  tabs(document.querySelector(".tabs"), {
    "panel-ageing": (panel) => { parts.ageing = new Ageing(panel, battery); },
    "panel-circuit": kept("circuit", showCircuit), "panel-fit": kept("fit", showFit),
    "panel-curve": (panel) => { parts.curve = new CurveEditor(panel, battery, { follow, saved: load }); },
    "panel-config": () => guarded(async () => { parts.config = await showConfig(battery, load); }),
  });
}

addEventListener("hashchange", () => document.querySelector(".tabs").scrollIntoView());
actions(byId("battery-menu"), {
  rename: async () => {
    const name = await askName("Rename this battery", "Name", battery.name, "Rename");
    if (name) await patch(path, { name }).then((changed) => { Object.assign(battery, changed); showHead(); }, complain);
  },
  again: (button) => busy(button, async () => {
    follow(await post(`${path}/reestimate`));
    toast("All estimates of this battery are made again.");
  }),
  delete: (button) => busy(button, async () => {
    if (!(await confirmed(`Delete “${battery.name}”?`, "Its history and its tests go with it, and it is taken out of the car’s file. This can't be taken back.", "Delete"))) return;
    await remove(path);
    location.assign("/batteries");
  }),
});
await guarded(load);
