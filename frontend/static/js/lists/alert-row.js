/** An alert of some car in a list: what changed, since when, and where to read on. */

import { h } from "../core/dom.js";
import { when } from "../core/format.js";
import { alertMark } from "../core/verdict.js";

/** One row; the whole story stands on the car's page. */
export const alertRow = (alert) => h("article", { class: "proposal" },
  h("header", {}, h("h3", {}, h("a", { href: `/cars/${alert.car_id}#health` }, alert.car_name)), alertMark(alert.state)),
  h("p", {}, `${alert.words}. ${alert.advice}`), h("p", { class: "quiet small" }, "Since ", when(alert.since_at), "."));
