/** One job: its stages, how long each took, its log, and what can be done about it. */

import { at, get, post } from "../core/api.js";
import { h, show } from "../core/dom.js";
import { duration, instant, when } from "../core/format.js";
import { busy, problemBox } from "../core/notify.js";

const STATES = {
  queued: ["○", "waiting", "none"], running: ["◔", "running", "busy"], succeeded: ["●", "done", "good"],
  failed: ["■", "failed", "bad"], cancelled: ["□", "cancelled", "none"],
};
const STAGE_MARKS = { succeeded: "✓", running: "◔", failed: "■", cancelled: "□", skipped: "–" };
const STAGE_WORDS = {
  decode: "Decode", observe: "Observe", map: "Map", health: "Health", battery: "Battery", score: "Score", simulate: "Simulate",
  estimate: "Estimate", reestimate: "Estimate all again", curve: "Fit the curve", report: "Run the report",
};
const LOG_LINES = 500;

/** Whether a job can still change by itself. */
export const alive = (job) => job.state === "queued" || job.state === "running";

/** State as shape and word. */
function stateMark(state) {
  const [shape, word, kind] = STATES[state] ?? ["○", state, "none"];
  return h("span", { class: `verdict ${kind}` }, h("span", { ariaHidden: "true" }, shape), word);
}

const stageName = (name) => STAGE_WORDS[name] ?? name.charAt(0).toUpperCase() + name.slice(1);

function secondsOf(stage, now) {
  const start = instant(stage.started_at);
  return stage.state === "running" && start ? Math.max(0, (now - start) / 1000) : stage.seconds;
}

/** Share of a running stage that is done, 0 to 1, or null when it can't tell. */
const shareOf = (stage) => (stage && Number.isFinite(stage.progress) && stage.progress > 0 ? Math.min(1, stage.progress) : null);

export class JobView {
  /** @param {object} job @param {{withTitle?: boolean, changed?: (job: object) => void, logOpened?: (view: JobView) => void}} [options] */
  constructor(job, options = {}) {
    this.options = options;
    this.lines = [];
    this.mark = h("span");
    this.actions = h("span");
    this.body = h("div");
    this.log = h("pre", { class: "log", tabIndex: 0, ariaLabel: "Log" });
    this.logBox = h("details", { on: { toggle: () => options.logOpened?.(this) } }, h("summary", { class: "quiet small" }, "Log"), this.log);
    this.job = job;
    this.node = h("article", { class: "card job" },
      h("div", { class: "line" }, options.withTitle !== false && h("span", { class: "name" }, this.title()), this.mark, this.actions),
      this.body, this.logBox);
    this.update(job);
  }

  /** Show the job as it is now; what can be clicked is only replaced when it changes. */
  update(job) {
    this.job = job;
    const running = job.stages.find((stage) => stage.state === "running");
    const share = shareOf(running);
    show(this.mark, stateMark(job.state));
    const offered = `${job.state} ${job.cancel_requested}`;
    if (offered !== this.offered) show(this.actions, this.buttons());
    this.offered = offered;
    show(this.body,
      h("ol", { class: "stages" }, job.stages.map((stage) => this.stage(stage))),
      job.state === "running" && h("progress", { max: 1, ariaLabel: running ? `${stageName(running.name)} in progress` : "In progress", ...(share === null ? {} : { value: share }) }),
      running?.detail && h("p", { class: "quiet small" }, running.detail),
      job.problem && problemBox(job.problem),
      h("p", { class: "quiet small" }, "Started ", when(job.started_at ?? job.created_at), job.attempt > 1 && ` · attempt ${job.attempt}`,
        job.cancel_requested && alive(job) && " · stopping at the next safe point"));
    this.options.changed?.(job);
  }

  /** Let the clock of the running stage go on. */
  tick() {
    const running = this.job.stages.find((stage) => stage.state === "running");
    const clock = this.body.querySelector("li.running .clock");
    if (running && clock) clock.textContent = duration(secondsOf(running, Date.now()));
  }

  title() {
    const { trip_id: trip, drive_id: drive, battery_id: battery, car_id: car, title, kind } = this.job;
    if (!trip && !drive && !battery && !car && this.job.stages[0]?.name === "report") return h("a", { href: "/batteries/report" }, title);
    const href = trip ? `/trips/${trip}` : drive ? `/drives/${drive}` : battery ? `/batteries/${battery}` : car ? `/cars/${car}` : null;
    return href ? h("a", { href }, title || kind) : title || kind;
  }

  stage(stage) {
    const seconds = secondsOf(stage, Date.now());
    const share = shareOf(stage);
    return h("li", { class: stage.state },
      h("span", { class: "mark", ariaHidden: "true" }, STAGE_MARKS[stage.state] ?? "·"), stageName(stage.name),
      h("span", { class: "visually-hidden" }, stage.state),
      Number.isFinite(seconds) && h("span", { class: "unit clock" }, duration(seconds)),
      stage.state === "running" && share !== null && h("span", { class: "unit" }, `${Math.round(100 * share)} %`));
  }

  buttons() {
    const { state, cancel_requested: stopping } = this.job;
    const act = (word, path) => h("button", { class: "btn small",
      on: { click: (event) => busy(event.currentTarget, async () => this.update(await post(at("jobs", this.job.id, `/${path}`)))) } }, word);
    if (alive(this.job)) return stopping ? null : act("Cancel", "cancel");
    return state === "failed" || state === "cancelled" ? act("Try again", "retry") : null;
  }

  /** Ask for the job again; several calls at once become one. */
  refresh() {
    this.refreshing ??= new Promise((resolve) => { setTimeout(resolve, 150); })
      .then(() => { this.refreshing = null; return get(at("jobs", this.job.id)); })
      .then((job) => this.update(job), () => undefined);
    return this.refreshing;
  }

  /** Add a line to the log and keep its end in view. */
  append(line) {
    this.lines.push(line);
    if (this.lines.length > LOG_LINES) this.lines.shift();
    this.log.textContent = this.lines.join("\n");
    this.log.scrollTop = this.log.scrollHeight;
  }
}
