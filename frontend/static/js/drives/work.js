/** What is worked out on request: methods compared, and fronts. Each has a job, and a result that stays. */

import { API, at, get, post, query } from "../core/api.js";
import { h, show } from "../core/dom.js";
import { Figure } from "../core/figure.js";
import { NOTHING, measureText, number } from "../core/format.js";
import { busy, problemBox } from "../core/notify.js";
import { table } from "../core/ui.js";
import { certificateMark } from "../core/verdict.js";
import { energyText, shareText, substance, timeText, tiny } from "./words.js";

const FIGURE_PX = 400;
const NONE_YET = 409;
const POINTS = 9;
const column = (text, kind) => h("th", { scope: "col", class: kind }, text);
const cell = (text) => h("td", { class: "n" }, text);

/** A piece of work: asks for the stored result, offers to have it made, and shows its job meanwhile. */
class Piece {
  /** @param {HTMLElement} panel @param {object} drive @param {import("../jobs/job-feed.js").JobFeed} feed */
  constructor(panel, drive, feed, { name, path, ask, found }) {
    Object.assign(this, { drive, feed, name, path, ask, found });
    [this.job, this.result, this.outcome] = [h("div"), h("div"), h("div")];
    show(panel, ask.intro, h("div", { class: "form-end" }, ask.inputs, this.button()), this.outcome, this.job, this.result);
  }

  button() {
    const button = h("button", { class: "btn", on: { click: () => busy(button, () => this.start()) } }, this.ask.word);
    return button;
  }

  async start() {
    show(this.outcome);
    try {
      this.follow(await post(at("drives", this.drive.id, `/${this.path}`), this.ask.body()));
    } catch (problem) {
      show(this.outcome, problemBox(problem));
    }
  }

  /** Show the job until it is over. */
  follow(job) {
    show(this.job, this.feed.view(job, { withTitle: false }).node);
  }

  /** A job is over: its result takes its place. */
  async over(job) {
    if (job.state === "succeeded") {
      show(this.job);
      await this.load();
    }
  }

  async load() {
    try {
      const document_ = await get(at("drives", this.drive.id, `/${this.name}`));
      this.found(this.result, document_, (figure) => `${API}/${at("drives", this.drive.id, `/figures/${figure}`)}${query({ made: document_.provenance?.job_id })}`);
    } catch (error) {
      if (error.status !== NONE_YET) show(this.result, problemBox(error));
    }
  }
}

function methodRow(row) {
  const failed = Boolean(row.reason);
  return h("tr", { class: failed ? "out" : "" }, h("th", { scope: "row" }, row.title, h("div", { class: "quiet small plain" }, row.source ?? "")),
    failed ? h("td", { colSpan: 5 }, row.reason)
      : [cell(energyText(row.fuel_energy_j)), cell(timeText(row.time_s)), cell(shareText(row.relative_error)), cell(Number.isFinite(row.milliseconds) ? measureText(row.milliseconds, "ms", row.milliseconds < 10 ? 2 : 0) : NOTHING), h("td", {}, row.verdict ?? "")]);
}

function showComparison(place, comparison, figureUrl) {
  const rows = comparison.rows ?? [];
  const box = h("div", { class: "figure" });
  show(place, h("div", { class: "stack-gap section" },
    table("All methods on this drive", h("tr", {}, column("Method"), column("Fuel", "n"), column("Time", "n"), column("Error in energy", "n"), column("Took", "n"), column("What it is worth")), rows.map(methodRow)),
    h("p", { class: "quiet small" }, "Errors are relative to the best certified energy of the table; a negative one beat it within its own accuracy. Milliseconds hang on the machine and on what else it does."),
    h("section", { class: "card" }, h("h2", {}, "Error and time"), box)));
  new Figure(box, { label: "Error and time of every method", height: FIGURE_PX }).load(figureUrl("methods"));
}

/** Fill the panel of the methods; returns its piece of work. */
export function methods(panel, drive, feed) {
  return new Piece(panel, drive, feed, { name: "comparison", path: "compare", found: showComparison, ask: {
    intro: h("p", {}, "The same problem is solved by every method that applies: what each finds, how far off it is, and how long it takes."), inputs: [], word: "Compare methods", body: () => ({}),
  } });
}

/** What fuel can be weighed against: the problem's own emissions, and time. */
const weighable = (problem) => [...Object.keys(problem.cost?.emissions ?? {}), "time"];

/** What an axis counts: its title, and how its values are written. */
function axisOf(name) {
  if (name === "time_s") return ["Time, s", (value) => number(value, 2)];
  if (name.endsWith("_energy_j")) return [name === "fuel_energy_j" ? "Fuel, kJ" : "Weighted energy, kJ", (value) => number(value / 1000, 1)];
  return [`${substance(name.replace(/_g$/, ""))}, g`, (value) => tiny(value, 3)];
}

const weightsOf = ({ weights = {} }) => Object.entries(weights).map(([name, weight]) => `${substance(name)} ${tiny(weight, 3)}`).join(", ") || NOTHING;

function showFront(place, front, figureUrl) {
  const box = h("div", { class: "figure" });
  const names = [front.x_axis, front.y_axis];
  const axes = names.map(axisOf);
  const more = [["fuel_energy_j", energyText], ["time_s", timeText]].filter(([name]) => !names.includes(name));
  const row = (point) => h("tr", {}, [point.x, point.y].map((value, i) => cell(axes[i][1](value))), more.map(([name, shown]) => cell(shown(point[name]))),
    h("td", {}, weightsOf(point)), h("td", {}, certificateMark(point.verdict)));
  show(place, h("div", { class: "stack-gap section" }, (front.warnings ?? []).map((text) => h("p", { class: "note" }, text)),
    h("section", { class: "card" }, h("h2", {}, `${axes[1][0].split(",")[0]} over ${axes[0][0].split(",")[0].toLowerCase()}`), box),
    table("Points of the front", h("tr", {}, axes.map(([text]) => column(text, "n")), more.map(([name]) => column(name === "time_s" ? "Time" : "Fuel", "n")), column("Weights, J/g"), column("Verdict")), front.points.map(row)),
    h("p", { class: "quiet small" }, "Each point is the best drive at its own weights. Between points joined by a dashed line no weights lead to another drive: the front is straight there, or bends inward.")));
  new Figure(box, { label: "Front", height: FIGURE_PX }).load(figureUrl("front"));
}

/** Fill the panel of the fronts; returns its piece of work. */
export function fronts(panel, drive, feed) {
  const emission = h("select", { id: "front-emission" }, weighable(drive.problem).map((name) => h("option", { value: name }, substance(name))));
  const points = h("input", { id: "front-points", class: "number", inputMode: "numeric", value: String(POINTS) });
  const field = (label, input) => h("div", { class: "field" }, h("label", { htmlFor: input.id }, label), input);
  return new Piece(panel, drive, feed, { name: "front", path: "front", found: showFront, ask: {
    intro: h("p", {}, "How much fuel less of something else costs: each point is the best drive at another price."),
    inputs: [field("Fuel against", emission), field("Points", points)], word: "Draw the front", body: () => ({ emission: emission.value, points: Number(points.value) }),
  } });
}
