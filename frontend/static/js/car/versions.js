/** Versions of a car's map, newest first, each with its exports. */

import { API, at, query } from "../core/api.js";
import { h } from "../core/dom.js";
import { number, percent, plural, when } from "../core/format.js";
import { table } from "../core/ui.js";

const FORMATS = [["json", "JSON"], ["csv", "CSV"], ["svg", "SVG"], ["png", "PNG"]];

/** Address of an exported map. */
const exportUrl = (carId, version, format) => `${API}/${at("cars", carId, `/maps/${version}/export`)}${query({ format })}`;

const MOST_NAMES = 3;

function trips(word, list) {
  if (!list?.length) return null;
  const names = list.slice(0, MOST_NAMES).map((trip) => trip.name).join(", ");
  return `${word} ${list.length > MOST_NAMES ? `${names} and ${number(list.length - MOST_NAMES)} more` : names}`;
}

/** What is different from the version before, in words. */
function changes(one) {
  const made = one.changes;
  if (!made) return one.version === 1 ? "the first" : "–";
  const shift = made.level === undefined ? null : 100 * (made.level - 1);
  const level = shift === null ? null : Math.abs(shift) > 200 * made.level_sd
    ? `level ${shift > 0 ? "+" : "−"}${number(Math.abs(shift), 1)} ± ${number(100 * made.level_sd, 1)} %` : "same level";
  const cells = made.changed_cells > 0 && `${plural(made.changed_cells, "cell")} changed`;
  const said = [trips("with", made.added), trips("without", made.removed), trips("observed anew:", made.observed_anew),
    made.rules_changed && "other rules", made.car_file_changed && "other car file", level, cells].filter(Boolean);
  return said.length ? said.join("; ") : "–";
}

/** The table of versions; `shown` is the one on the page. */
export function versionTable(carId, versions, shown) {
  const th = (text, kind) => h("th", { scope: "col", class: kind }, text);
  return table("Map versions",
    h("tr", {}, th("Version"), th("Made"), th("Trips", "n"), th("Points", "n"), th("Cells", "n"), th("Trusted", "n"), th("Best", "n"), th("What changed"), th("Download")),
    versions.map((one) => h("tr", {},
      h("th", { scope: "row" }, one.version === shown ? `${one.version}, shown above` : h("a", { href: `/cars/${carId}/maps/${one.version}` }, `${one.version}`)),
      h("td", {}, when(one.created_at)), h("td", { class: "n" }, number(one.trips)), h("td", { class: "n" }, number(one.points)),
      h("td", { class: "n" }, number(one.cells)), h("td", { class: "n" }, number(one.trusted_cells)), h("td", { class: "n" }, percent(one.best?.efficiency)), h("td", { class: "wide" }, changes(one)),
      h("td", { class: "nowrap" }, FORMATS.map(([format, name], i) => [i > 0 && " · ",
        h("a", { href: exportUrl(carId, one.version, format), download: "", ariaLabel: `Version ${one.version} as ${name}` }, name)])))));
}
