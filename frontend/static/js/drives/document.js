/** The problem as it was posed, what its engine became, and where the answer comes from. */

import { h, show } from "../core/dom.js";
import { report } from "../trip/report.js";

/** A document as indented text. */
export const indented = (value) => JSON.stringify(value, null, 2);

const card = (title, value) => h("section", { class: "card" }, h("h2", {}, title), h("pre", { class: "log section", tabIndex: 0, ariaLabel: title }, indented(value)));

/** Fill the panel. */
export function showDocument(panel, drive, answer) {
  show(panel, h("div", { class: "columns" }, card("The problem, in SI units", drive.problem), drive.engine && card("What the map’s engine became", drive.engine)),
    h("div", { class: "section" }, report({ provenance: answer.provenance ?? {} })));
}
