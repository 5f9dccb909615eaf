/** All drives, newest first, of one car or of all; two of them can be laid side by side. */

import { get, query } from "../core/api.js";
import { byId, h, show } from "../core/dom.js";
import { guarded } from "../core/notify.js";
import { countJobs } from "../core/shell.js";
import { paged } from "../core/ui.js";
import { driveRow, driveTable } from "../drives/table.js";
import { JobFeed } from "../jobs/job-feed.js";

const RENEW_MS = 300;
const filter = byId("car-filter");
const compare = byId("compare-drives");
let marked = [];
let renewal = null;

function mark(drive, on) {
  marked = on ? [...marked, drive.id] : marked.filter((id) => id !== drive.id);
  compare.textContent = marked.length === 2 ? "Compare these two" : "Compare two";
  compare.toggleAttribute("disabled", marked.length !== 2);
}

function append(drives, first) {
  if (!first) {
    byId("drives").querySelector("tbody").append(...drives.map((drive) => driveRow(drive, mark)));
    return;
  }
  marked = [];
  compare.hidden = drives.length < 2;
  show(byId("drives"), drives.length > 0 ? driveTable("Drives", drives, mark)
    : h("div", { class: "empty" }, h("h2", {}, "No drives yet"),
      h("p", {}, "Pose one: how to reach a speed, cover a distance or drive a road on the least fuel, and how one knows."),
      h("div", { class: "actions" }, h("a", { class: "btn", href: "/drives/new" }, "Pose a drive"))));
}

const list = () => paged((cursor) => get(`drives${query({ car_id: filter.value, cursor })}`), append, byId("more"));

/** A drive that was solved meanwhile is shown with its numbers, unless somebody is choosing two. */
function renew(job) {
  if (job.kind !== "drive" || marked.length > 0) return;
  clearTimeout(renewal);
  renewal = setTimeout(() => guarded(list), RENEW_MS);
}

new JobFeed({ over: renew });
compare.addEventListener("click", () => location.assign(`/drives/compare${query({ a: marked[0], b: marked[1] })}`));
filter.addEventListener("change", () => {
  history.replaceState(null, "", `/drives${query({ car: filter.value })}`);
  guarded(list);
});
await guarded(async () => {
  filter.append(...(await get("cars?limit=200")).items.map((car) => h("option", { value: car.id }, car.name)));
  filter.value = new URLSearchParams(location.search).get("car") ?? "";
  if (filter.selectedIndex < 0) filter.value = "";
  await Promise.all([list(), countJobs()]);
});
