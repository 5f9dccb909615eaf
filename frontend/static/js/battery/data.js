/** Files of measurements: one is dropped and estimated; and everything that was estimated so far. */

import { at, get, query, remove, request } from "../core/api.js";
import { byId, h, show } from "../core/dom.js";
import { NOTHING, measure, plural, when } from "../core/format.js";
import { busy, problemBox } from "../core/notify.js";
import { confirmed, paged, table } from "../core/ui.js";
import { droppable } from "../upload/drop.js";
import { share } from "./words.js";

const FILES = 50;

/** Send a file as it is; returns the answer. */
export async function sendFile(path, file, values = {}) {
  const headers = { "Content-Type": "application/octet-stream" };
  const response = await request(`${path}${query({ filename: file.name, ...values })}`, { method: "POST", headers, body: file });
  return response.json();
}

const moment = (text) => (text ? new Date(text).toISOString() : null);

/** Wire the drop zone; `follow` shows the job that works on a file. */
export function wireData(battery, follow) {
  droppable(byId("data-drop"), byId("data-file"), async ([file]) => {
    const outcome = byId("data-outcome");
    show(outcome, h("p", { class: "quiet section" }, `Sending ${file.name}…`));
    try {
      const answer = await sendFile(at("batteries", battery.id, "/data"), file, { began_at: moment(byId("data-began").value) });
      show(outcome, h("p", { class: "quiet section" }, answer.duplicate ? `The very same data were sent before, as ${answer.file.name}. ` : `${file.name} has arrived${answer.job ? " and is being worked on" : ""}. `,
        answer.duplicate && answer.estimate && h("a", { href: `/batteries/${battery.id}?estimate=${answer.estimate.id}` }, "See what they said")));
      if (answer.job) follow(answer.job);
    } catch (error) {
      show(outcome, h("div", { class: "section" }, problemBox(error)));
    }
  });
}

function row(estimate, battery) {
  const n = (...content) => h("td", { class: "n" }, ...content);
  const name = estimate.trip_id ? h("a", { href: `/trips/${estimate.trip_id}#battery` }, estimate.source) : estimate.source;
  const failed = !Number.isFinite(estimate.soc);
  return h("tr", { class: failed ? "out" : "" }, h("th", { scope: "row" }, name), h("td", {}, when(estimate.began_at)), n(share(estimate.soc, estimate.soc_sd)), n(share(estimate.soh, estimate.soh_sd)),
    n(failed ? NOTHING : measure(1e3 * estimate.voltage_rms_v, "mV", 2)),
    h("td", { class: "wide" }, failed ? estimate.reason : estimate.warnings?.length ? plural(estimate.warnings.length, "remark") : ""),
    h("td", { class: "row-actions" }, !failed && h("a", { class: "btn bare small", href: `/batteries/${battery.id}?estimate=${estimate.id}` }, "Show")));
}

/** Files from which nothing could be learnt, with the reason. */
async function refusedFiles(battery, again) {
  const { items } = await get(`${at("batteries", battery.id, "/data")}${query({ limit: FILES })}`);
  const bad = items.filter((file) => file.problem && !file.estimate_id);
  const away = (file) => (event) => busy(event.currentTarget, async () => {
    if (!(await confirmed(`Remove ${file.name}?`, "The file is deleted.", "Remove"))) return;
    await remove(at("batteries", battery.id, `/data/${file.id}`));
    await again();
  });
  return bad.map((file) => h("div", { class: "section" }, h("h3", {}, file.name, ", sent ", when(file.created_at)), problemBox(file.problem, h("button", { class: "btn small", on: { click: away(file) } }, "Remove the file"))));
}

/** List what was estimated, the latest first, and what could not be. */
export async function showData(battery) {
  const [refused] = await Promise.all([refusedFiles(battery, () => showData(battery)), showEstimates(battery)]);
  show(byId("refused-files"), refused);
}

function showEstimates(battery) {
  return paged((cursor) => get(`${at("batteries", battery.id, "/estimates")}${query({ cursor })}`), (items, first) => {
    const th = (text, kind) => h("th", { scope: "col", class: kind }, text);
    if (first && items.length === 0) {
      show(byId("estimates"), h("p", { class: "quiet" }, "Nothing has been estimated yet. Trips of this car that hold battery_current_a and battery_voltage_v are taken by themselves."));
      return;
    }
    if (first) {
      show(byId("estimates"), table("What was estimated", h("tr", {}, th("From"), th("Began"), th("State of charge, at its end", "n"), th("State of health", "n"), th("Left of the voltage", "n"), th("Remarks"), th("")), []));
    }
    byId("estimates").querySelector("tbody").append(...items.map((one) => row(one, battery)));
  }, byId("more"));
}
