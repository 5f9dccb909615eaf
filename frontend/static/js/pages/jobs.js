/** All jobs, newest first, live. */

import { get, query } from "../core/api.js";
import { byId, h, show } from "../core/dom.js";
import { guarded } from "../core/notify.js";
import { countJobs } from "../core/shell.js";
import { paged } from "../core/ui.js";
import { JobFeed } from "../jobs/job-feed.js";

const list = byId("jobs");
const filter = byId("state-filter");

const feed = new JobFeed({
  appeared,
  over: () => countJobs(),
  status: (open) => { byId("connection").textContent = open ? "Live" : "Connecting again…"; },
});

/** A job that began after the page was opened goes on top. */
function appeared(job) {
  if (filter.value) return;
  list.querySelector(".empty")?.remove();
  list.prepend(feed.view(job).node);
  countJobs();
}

function append(jobs, first) {
  if (first) show(list);
  if (first && jobs.length === 0) {
    show(list, h("div", { class: "empty" }, h("h2", {}, filter.value ? "No such jobs" : "No jobs yet"),
      h("p", {}, "A job appears here when a trip is uploaded or run again.")));
  }
  list.append(...jobs.map((job) => feed.view(job).node));
}

const load = () => guarded(() => paged((cursor) => get(`jobs${query({ state: filter.value, cursor })}`), append, byId("more")));

filter.addEventListener("change", load);
await Promise.all([load(), countJobs()]);
