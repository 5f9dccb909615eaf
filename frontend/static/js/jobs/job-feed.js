/** Keeps job views up to date from the fleet's stream of events. */

import { API, at, get } from "../core/api.js";
import { listen } from "../core/events.js";
import { announce } from "../core/notify.js";
import { JobView, alive } from "./job-view.js";

const TYPES = ["stage", "progress", "log", "state"];
const LOG_END_MS = 2000;
const OUTCOME = { succeeded: "done", failed: "failed", cancelled: "cancelled" };

export class JobFeed {
  /**
   * @param {{appeared?: (job: object) => void, changed?: (job: object) => void, over?: (job: object) => void, status?: (open: boolean) => void}} hooks
   *   `appeared` is called once for a job that has no view yet, `over` when a job has come to its end, however fast it was.
   */
  constructor(hooks = {}) {
    this.hooks = hooks;
    this.views = new Map();
    this.met = new Set();
    this.stop = listen(`${API}/jobs/events`, TYPES, (type, data) => this.receive(type, data), {
      status: (open) => {
        hooks.status?.(open);
        if (open) this.views.forEach((view) => view.refresh()); // a job may have ended before there were events, or while there were none
      },
    });
    // The seconds of a running stage go on between two events.
    setInterval(() => this.views.forEach((view) => view.tick()), 1000);
  }

  /** The view of a job, made when it is new here. */
  view(job, options = {}) {
    const known = this.views.get(job.id);
    if (known) {
      known.update(job);
      return known;
    }
    const view = new JobView(job, { ...options, logOpened: readLog, changed: (now) => this.changed(now) });
    this.views.set(job.id, view);
    view.wasAlive = alive(job);
    return view;
  }

  receive(type, data) {
    const view = this.views.get(data.job_id);
    if (!view) this.meet(data.job_id);
    else if (type !== "log") view.refresh();
  }

  /** An event of a job that is not shown: look at it once. */
  async meet(jobId) {
    if (this.met.has(jobId)) return;
    this.met.add(jobId);
    const job = await get(at("jobs", jobId)).catch(() => null);
    if (!job) return;
    this.hooks.appeared?.(job);
    if (!alive(job)) this.hooks.over?.(job);
  }

  changed(job) {
    this.hooks.changed?.(job);
    const view = this.views.get(job.id);
    if (!view?.wasAlive || alive(job)) return;
    view.wasAlive = false;
    announce(`${job.title || job.kind}: ${OUTCOME[job.state] ?? job.state}`);
    this.hooks.over?.(job);
  }
}

/** Read a job's log from its beginning, the first time it is opened, and follow it until the job is over. */
function readLog(view) {
  if (view.reading) return;
  view.reading = true;
  let ending = null;
  const stop = listen(`${API}/${at("jobs", view.job.id, "/events")}`, ["log", "stage", "state"], (type, data) => {
    view.append(type === "log" ? data.message : type === "stage" ? `${data.name}: ${data.state}` : `Job ${data.state}`);
    clearTimeout(ending);
    if (type === "state" && !alive(data)) ending = setTimeout(stop, LOG_END_MS);
  });
}
