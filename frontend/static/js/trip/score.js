/** How near a trip was to the best drive over its own road: what to do, where it was lost, acceleration by acceleration. */

import { API, at, get, post, query } from "../core/api.js";
import { h, show } from "../core/dom.js";
import { Figure } from "../core/figure.js";
import { km, measureText, number, plural, when } from "../core/format.js";
import { busy, problemBox } from "../core/notify.js";
import { hasWebgl } from "../core/plotly.js";
import { accelerationTable, sectionTable, styleTable } from "./score-tables.js";

const NARROW_PX = 360;
const MAP_PX = 420;
const PARTS_PX = 300;

const figurePath = (trip, name, values = {}) => `${API}/${at("trips", trip.id, `/figures/score-${name}`)}${query(values)}`;
const list = (items) => h("ul", { class: "reasons" }, items.map((text) => h("li", {}, text)));

/** What the trip could have saved, in one sentence that says how sure it is. */
export function headline({ saved_l: saved, saved_percent: share, fuel_measured: measured, engine }) {
  const around = `(${number(share.value, share.sd < 1 ? 1 : 0)} ± ${number(share.sd, share.sd < 1 ? 1 : 0)}\u202f%)`;
  if (share.value < share.sd) return `This trip took no more than the best drive known, as far as can be told ${around}`;
  const litres = measureText(saved.value, "L", 2);
  if (measured !== false) return `This trip could have taken ${litres} less ${around}`;
  return `This trip could have taken less fuel ${around}: ${litres} by ${engine === "map" ? "the car's map" : "an ordinary engine"}, since none was measured`;
}

/** Which map it rests on, and the way to score it anew. */
function made(score, again) {
  const map = score.map_version === null ? " without a map of the car" : ` with version ${number(score.map_version)} of the car's map`;
  const newer = score.newest_map_version !== null && score.newest_map_version !== score.map_version;
  return h("p", { class: "quiet small section" }, "Scored ", when(score.scored_at), map,
    newer ? `; the newest is ${number(score.newest_map_version)}. ` : score.map_version === null ? ". " : ", the newest. ", newer && again("Score with the newest map"));
}

function top(score, again) {
  const { score: points, scored_m: metres, scored_percent: share, standing } = score;
  return h("section", { class: "card" },
    h("header", {}, h("h2", {}, headline(score)), h("p", { class: "score" }, "Eco-score ", h("strong", {}, number(points.value)), h("span", { class: "quiet" }, ` of 100, ±\u202f${number(points.sd, 1)}`))),
    score.advice.length > 0 ? [h("h3", {}, "What to do"), list(score.advice)] : h("p", { class: "quiet" }, "Nothing in particular would have saved much."),
    h("p", { class: "quiet section" }, "Compared were ", km(metres), ` of driving with ${number(share)}\u202f% of the trip's fuel, each stretch between two stops with the best drive over the same road, below the same limits, in no more time.`,
      standing.stops > 0 && ` Standing took ${measureText(standing.litres, "L", 2)} more in ${plural(standing.stops, "stop")}; that is in neither drive.`),
    score.warnings.length > 0 && [h("h3", { class: "section" }, "Take care"), list(score.warnings)],
    made(score, again));
}

const card = (title, words, ...content) => h("section", { class: "card" }, h("h2", {}, title), h("p", { class: "quiet small" }, words), ...content);

/** The doubts and what was assumed: how one knows. */
function grounds({ doubts, assumptions }) {
  const sources = Object.entries(doubts).map(([name, sd]) => `${name.replaceAll("_", " ")}: ± ${number(sd, 1)} percentage points`);
  return h("details", { class: "section" }, h("summary", {}, "How this was reckoned, and how sure it is"),
    assumptions.length > 0 && list(assumptions), sources.length > 0 && [h("p", { class: "section" }, "Where the uncertainty of the saving comes from:"), list(sources)]);
}

function whole(panel, trip, score, again) {
  const place = () => h("div", { class: "figure" });
  const [along, parts, cells, way, rises] = [place(), place(), place(), place(), place()];
  show(panel, top(score, again),
    h("div", { class: "section" }, card("As driven and at its best", "Solid: as driven. Dashed: the best drive. Dotted: the limit it kept. Lost here: what the drive took more than the best one at this place, per 100 km.", along)),
    h("div", { class: "trends section" },
      card("What it was lost to", "The parts add up to the whole; one below zero is where the best drive takes more.", parts),
      card("Where the engine lost it", "Millilitres more than the best drive took at the same place, by engine speed and torque; cells of the car's map.", cells),
      card("Where on the way", "The track, coloured by what was lost there.", way),
      card("Acceleration by acceleration", `Each rise of the speed beside the drives that take least to the same speed. ${plural(score.accelerations.length, "acceleration")}.`, rises)),
    score.table.length > 0 && h("section", { class: "card section" }, h("h2", {}, "All accelerations together"), styleTable(score.table)),
    score.accelerations.length > 0 && h("details", { class: "section" }, h("summary", {}, `Every acceleration (${number(score.accelerations.length)})`), accelerationTable(score.accelerations)),
    score.sections.length > 0 && h("details", { class: "section" }, h("summary", {}, `Stretches between stops (${number(score.sections.filter((one) => one.scored).length)} of ${number(score.sections.length)} scored)`), sectionTable(score.sections)),
    grounds(score));
  const draw = (box, name, label, height, options = {}, values = {}) => new Figure(box, { label, height, ...options }).load(figurePath(trip, name, values));
  draw(along, "along", "As driven and at its best", MAP_PX, { tall: true });
  draw(parts, "parts", "What it was lost to", PARTS_PX, { tall: true });
  draw(cells, "cells", "Where the engine lost it", NARROW_PX);
  draw(way, "place", "Where on the way it was lost", MAP_PX, { config: { scrollZoom: true } }, { variant: hasWebgl() ? "" : "plan" });
  draw(rises, "accelerations", "Acceleration by acceleration", NARROW_PX);
}

/** Why there is no score, and the way to one. */
function none(panel, error, again) {
  show(panel, h("div", { class: "empty" }, h("h2", {}, error.code === "not-scored" ? "Not scored yet" : "This trip has no score"), h("p", {}, error.detail),
    h("div", { class: "actions" }, again(error.code === "not-scored" ? "Score this trip" : "Score it again"))));
}

/** Fill the panel; returns what renews it. `follow` shows the job that scores. */
export function showScore(panel, trip, follow) {
  let shown = "";
  const again = (words) => h("button", { class: "btn small", on: { click: (event) => busy(event.currentTarget, async () => {
    follow(await post(at("trips", trip.id, "/score")));
  }) } }, words);
  const fill = async () => {
    const score = await get(at("trips", trip.id, "/score"));
    const now = JSON.stringify(score);
    if (now === shown) return;
    shown = now;
    whole(panel, trip, score, again);
  };
  const renew = () => fill().catch((error) => {
    shown = "";
    if (error.status === 409) none(panel, error, again);
    else show(panel, problemBox(error));
  });
  show(panel, h("p", { class: "waiting" }, "Loading the score…"));
  renew();
  return renew;
}
