/** Formulas through the efficiency map: which target and class, side by side as contours with residuals, and as numbers. */

import { API, at, get, query } from "../core/api.js";
import { byId, checked, h, show } from "../core/dom.js";
import { Figure } from "../core/figure.js";
import { measureText, number, percent } from "../core/format.js";
import { announce, guarded, problemBox } from "../core/notify.js";
import { coefficientTable, comparison } from "./fit-tables.js";

const TARGETS = [["eta", "η"], ["phi", "1/η"], ["p_in", "Fuel power"]];
const DEGREES = [["2", "Power 2"], ["3", "3"], ["4", "4"], ["own", "Own terms"]];
const REMEDIES = [["none", "Leave"], ["border", "Border of no efficiency"], ["cut", "Cut off"], ["drive", "Where to drive"]];
const SMALL_PX = 270;
const LOAD_PX = 340;
const FORMATS = [["json", "JSON"], ["csv", "CSV"], ["engine", "Engine of a drive problem"]];

/** A row of choices, one of them chosen. */
function choice(name, legend, options) {
  return h("fieldset", { class: "segmented" }, h("legend", { class: "visually-hidden" }, legend), options.map(([value, text], i) =>
    h("label", {}, h("input", { type: "radio", name, value, checked: i === 0 }), h("span", {}, text))));
}

/** A choice with its name in front, for those who see it. */
const named = (text, group) => h("div", { class: "named" }, h("span", { class: "quiet small", ariaHidden: "true" }, text), group);

/** What the reader has chosen, as the API asks for it. */
function asked() {
  const own = checked("fit-degree") === "own";
  return {
    target: checked("fit-target"), degree: own ? "" : checked("fit-degree"), remedy: checked("fit-remedy"),
    terms: own ? byId("fit-terms").value.trim() || "1,w,T,wT,w2,T2" : "",
  };
}

/** A border of no efficiency has no 1/η and no fuel power. */
function keepSense() {
  const border = document.querySelector('input[name="fit-remedy"][value="border"]');
  border.disabled = checked("fit-target") !== "eta";
  if (border.disabled && border.checked) document.querySelector('input[name="fit-remedy"][value="none"]').checked = true;
  byId("fit-own").hidden = checked("fit-degree") !== "own";
}

function gapsView({ gaps, remedy }) {
  if (gaps.length === 0) return remedy === "drive" && h("p", { class: "quiet" }, "Below the full load that was seen, no larger region is missing.");
  return h("details", { class: "section", open: remedy === "drive" }, h("summary", {}, "Where driving would help most"),
    h("ul", { class: "reasons" }, gaps.map((gap) => h("li", {}, gap.words))));
}

function proposal(found, showDegree) {
  const { best_of_all: best } = found;
  const elsewhere = best.name !== found.best && best.degree !== found.degree;
  return h("div", { class: "section", role: "status" },
    h("p", {}, "Proposed: ", h("strong", {}, found.best), `. ${found.why}`),
    elsewhere && h("p", { class: "quiet" }, `Among all ${best.compared} formulas of every power, ${best.name} would be proposed `,
      `(${number(100 * best.cross_validated_eta, 2)} points). `,
      h("button", { class: "btn bare small", on: { click: () => showDegree(best.degree) } }, `Show power ${best.degree}`)));
}

/** One formula: its numbers, contours and residuals. Returns the view and what draws its figures. */
function card(one, url) {
  const places = [["contour", "efficiency by the formula"], ["residuals", "cells minus formula"]].map(([name, what]) => [name, what, h("div", { class: "figure" })]);
  const view = h("article", { class: "card fit" },
    h("header", {}, h("h3", {}, one.name), one.proposed && h("span", { class: "verdict good" }, h("span", { ariaHidden: "true" }, "●"), "proposed")),
    h("p", { class: "quiet small" }, `R² ${number(one.r_squared, 3)} · misses cells left out by ${number(100 * one.cross_validated_eta, 2)} points`,
      one.peak && [" · best ", percent(one.peak.efficiency), ` at ${number(one.peak.rpm)}\u202frpm, ${measureText(one.peak.nm, "Nm")}`]),
    h("div", { class: "fit-figures" }, places.map(([, , place]) => place)),
    one.warnings.length > 0 && h("ul", { class: "reasons small" }, one.warnings.map((text) => h("li", {}, text))),
    h("details", {}, h("summary", {}, "Coefficients"), coefficientTable(one)));
  const draw = async () => {
    for (const [name, what, place] of places) await new Figure(place, { label: `${one.name}: ${what}`, height: SMALL_PX }).load(url(name, one.name));
  };
  return { view, draw };
}

/** Fuel power over torque: shown for P_in, where idle and convexity matter. */
function loadCard(found, url) {
  const place = h("div", { class: "figure" });
  const pick = h("select", { ariaLabel: "Formula shown", on: { change: () => figure.load(url("load", pick.value)) } },
    found.fits.map((one) => h("option", { value: one.name, selected: one.proposed }, one.name)));
  const figure = new Figure(place, { label: "Fuel power over torque", height: LOAD_PX });
  const view = h("article", { class: "card section" }, h("header", {}, h("h3", {}, "Fuel power over torque"), h("div", {}, pick)), place);
  return { view, draw: () => figure.load(url("load", pick.value)) };
}

function downloads(base, params) {
  return h("p", { class: "quiet small" }, "Save: ", FORMATS.map(([format, name], i) => [i > 0 && " · ",
    h("a", { href: `${API}/${base}/export${query({ ...params, format })}`, download: "" }, name)]));
}

function refused(error, place) {
  if (error.status === 404) {
    show(place, h("div", { class: "empty" }, h("h2", {}, "No efficiency map yet"), h("p", {}, "Formulas are laid through the map as soon as there is one.")));
  } else if (error.status === 422 && checked("fit-degree") !== "own") {
    show(place, h("div", { class: "empty" }, h("h2", {}, "No formula"), h("p", {}, error.detail)));
  } else if (error.status === 422) {
    show(place, problemBox(error));
  } else {
    throw error;
  }
}

/** Fill the tab; returns what renews it when the map has changed. */
export function showFits(carId, version) {
  const base = at("cars", carId, `/maps/${version}/fits`);
  const place = h("div", { class: "fit-result" });
  let [turn, shown] = [0, ""];
  const fill = async () => {
    const mine = (turn += 1);
    keepSense();
    const params = asked();
    place.ariaBusy = "true";
    try {
      const found = await get(`${base}${query(params)}`);
      const text = JSON.stringify([found, params]);
      if (mine !== turn || text === shown) return;
      shown = text;
      await showAll(found, params, () => mine === turn);
    } catch (error) {
      shown = "";
      if (mine === turn) refused(error, place);
    } finally {
      if (mine === turn) place.ariaBusy = "false";
    }
  };
  const showAll = async (found, params, current) => {
    const url = (name, formula) => `${API}/${base}/figures/${name}${query({ ...params, formula })}`;
    const cards = found.fits.map((one) => card(one, url));
    const load = found.target === "p_in" ? loadCard(found, url) : null;
    show(place, proposal(found, showDegree), comparison(found), gapsView(found), h("div", { class: "fits section" }, cards.map(({ view }) => view)), load?.view, downloads(base, params));
    announce(`${found.fits.length} formulas, proposed: ${found.best}`);
    for (const { draw } of load ? [...cards, load] : cards) {
      if (!current()) return;
      await draw();
    }
  };
  const renew = () => guarded(fill, byId("fits-problem"));
  const showDegree = (degree) => {
    document.querySelector(`input[name="fit-degree"][value="${degree}"]`).checked = true;
    renew();
  };
  show(byId("fits-choices"), named("Formula of", choice("fit-target", "Formula of", TARGETS)), named("Highest power", choice("fit-degree", "Highest power of one variable", DEGREES)),
    named("Regions without data", choice("fit-remedy", "Regions without data", REMEDIES)));
  show(byId("fits"), place);
  byId("panel-fits").addEventListener("change", (event) => event.target.closest("#fits-choices, #fit-own") && renew());
  renew();
  return renew;
}
