/** Versions of a car's map, newest first, each with its exports. */

import { API, at, query } from "../core/api.js";
import { h } from "../core/dom.js";
import { number, percent, when } from "../core/format.js";
import { table } from "../core/ui.js";

const FORMATS = [["json", "JSON"], ["csv", "CSV"], ["svg", "SVG"], ["png", "PNG"]];

/** Address of an exported map. */
const exportUrl = (carId, version, format) => `${API}/${at("cars", carId, `/maps/${version}/export`)}${query({ format })}`;

/** The table of versions; `shown` is the one on the page. */
export function versionTable(carId, versions, shown) {
  const th = (text, kind) => h("th", { scope: "col", class: kind }, text);
  return table("Map versions",
    h("tr", {}, th("Version"), th("Made"), th("Trips", "n"), th("Points", "n"), th("Cells", "n"), th("Trusted", "n"), th("Best", "n"), th("Download")),
    versions.map((one) => h("tr", {},
      h("th", { scope: "row" }, one.version === shown ? `${one.version}, shown above` : h("a", { href: `/cars/${carId}/maps/${one.version}` }, `${one.version}`)),
      h("td", {}, when(one.created_at)), h("td", { class: "n" }, number(one.trips)), h("td", { class: "n" }, number(one.points)),
      h("td", { class: "n" }, number(one.cells)), h("td", { class: "n" }, number(one.trusted_cells)), h("td", { class: "n" }, percent(one.best?.efficiency)),
      h("td", { class: "nowrap" }, FORMATS.map(([format, name], i) => [i > 0 && " · ",
        h("a", { href: exportUrl(carId, one.version, format), download: "", ariaLabel: `Version ${one.version} as ${name}` }, name)])))));
}
