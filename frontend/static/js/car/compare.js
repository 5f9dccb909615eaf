/** Two maps beside each other: versions of this car, another car's map, or two periods. */

import { API, at, get, query } from "../core/api.js";
import { byId, checked, h, show } from "../core/dom.js";
import { Figure } from "../core/figure.js";
import { number, percent, plural, when } from "../core/format.js";
import { complain, guarded, problemBox } from "../core/notify.js";
import { table } from "../core/ui.js";
import { showReferences } from "./references.js";

const FIGURE_PX = 480;
const CARS = 200;
const WORST = 12;
const FEWEST_CELLS = 10;

const field = (label, input) => h("div", { class: "field" }, h("label", { htmlFor: input.id }, label), input);
const select = (id, options, chosen, changed) => h("select", { id, on: { change: changed } },
  options.map(([value, text]) => h("option", { value, selected: value === chosen }, text)));
const day = (id, changed) => h("input", { id, type: "date", on: { change: changed } });
const named = (one) => [String(one.version), `${one.version}, made ${when(one.created_at).textContent}, ${plural(one.trips, "trip")}`];

/** The inputs of each way to compare; each says what it chooses as `{ first, second }`, or null as long as that is open. */
function choices(versions, cars, changed) {
  const options = versions.map(named);
  const newer = versions[0];
  const older = versions.slice(1).find((one) => one.trusted_cells >= FEWEST_CELLS) ?? newer;
  const [first, second] = [select("compare-first", options, String(older.version), changed), select("compare-second", options, String(newer.version), changed)];
  const car = select("compare-car", cars.map((one) => [one.id, one.name]), cars[0]?.id, changed);
  const dates = ["first-from", "first-to", "second-from", "second-to"].map((id) => day(`compare-${id}`, changed));
  const span = (from, to) => (from.value || to.value ? `${from.value}..${to.value}` : null);
  const both = (one, other) => (one && other ? { first: one, second: other } : null);
  return {
    versions: { inputs: [field("First", first), field("Second", second)], chosen: () => both(first.value, second.value), open: "" },
    cars: { inputs: [cars.length ? field("Second: the newest map of", car) : h("p", { class: "quiet" }, "There is no other car with a map yet.")],
      chosen: () => both("latest", car.value && `${car.value}:latest`), open: "First is this car's newest map." },
    periods: { inputs: dates.map((input, i) => field(["First from", "to", "Second from", "to"][i], input)),
      chosen: () => both(span(dates[0], dates[1]), span(dates[2], dates[3])), open: "Choose two periods; an end left empty is open." },
  };
}

function numbersTable(found) {
  const row = (name, ...values) => h("tr", {}, h("th", { scope: "row" }, name), h("td", { class: "n" }, values));
  return table("The two maps in numbers", null, [
    row("Second over first", `${number(found.level, 3)} ± ${number(found.level_sd, 3)}`),
    row("Cells known in both", number(found.common_cells)), row("of them better, beyond chance", number(found.better_cells)), row("of them worse, beyond chance", number(found.worse_cells)),
    row("Known in the first alone", number(found.only_first)), row("Known in the second alone", number(found.only_second)),
    row("Trips in first, second", `${number(found.first.trips)}, ${number(found.second.trips)}`),
  ]);
}

function changedTable(found) {
  const changed = found.cells.filter((cell) => cell.significant).sort((a, b) => Math.abs(b.difference) - Math.abs(a.difference)).slice(0, WORST);
  if (changed.length === 0) return null;
  const th = (text) => h("th", { scope: "col", class: "n" }, text);
  const td = (...content) => h("td", { class: "n" }, content);
  return h("details", { class: "section" }, h("summary", {}, `Cells that changed most (${changed.length} of ${number(found.changed_cells)})`),
    table("Cells that changed most", h("tr", {}, th("rpm"), th("Nm"), th("First"), th("Second"), th("Points, ±1σ")),
      changed.map((cell) => h("tr", {}, td(number(cell.rpm)), td(number(cell.nm)), td(percent(cell.first)), td(percent(cell.second)),
        td(`${cell.difference > 0 ? "+" : "−"}${number(100 * Math.abs(cell.difference), 1)} ± ${number(100 * cell.sd, 1)}`)))));
}

/** Fill the tab; returns what renews it. */
export function showCompare(carId) {
  const place = byId("compare");
  const [said, box, inputs] = [h("div"), h("div", { class: "figure" }), h("div", { class: "form-grid" })];
  let [ways, figure] = [null, null];
  const draw = async () => {
    const way = ways[checked("compare-kind")];
    const chosen = way.chosen();
    box.hidden = !chosen;
    if (!chosen) {
      show(said, way.open && h("p", { class: "quiet" }, way.open));
      return;
    }
    try {
      const found = await get(at("cars", carId, `/maps/compare${query(chosen)}`));
      const name = (side) => (side.car_id === carId ? side.title : `${side.car_name}, ${side.title}`);
      show(said, h("p", { class: "quiet small" }, `First: ${name(found.first)}. Second: ${name(found.second)}.`), h("ul", { class: "reasons" }, found.words.map((text) => h("li", {}, text))), numbersTable(found), changedTable(found));
      figure ??= new Figure(box, { label: "Difference of the two maps", height: FIGURE_PX });
      await figure.load(`${API}/${at("cars", carId, "/maps/compare/figures/difference")}${query(chosen)}`);
    } catch (error) {
      box.hidden = true;
      show(said, problemBox(error));
    }
  };
  const changed = () => draw().catch(complain);
  const choose = () => {
    show(inputs, ways[checked("compare-kind")].inputs);
    changed();
  };
  const fill = async () => {
    const [versions, cars] = await Promise.all([get(at("cars", carId, "/maps")), get(`cars${query({ limit: CARS })}`)]);
    if (versions.items.length === 0) {
      show(place, h("div", { class: "empty" }, h("h2", {}, "Nothing to compare yet"), h("p", {}, "Maps are compared as soon as this car has one.")));
      return;
    }
    ways = choices(versions.items, cars.items.filter((car) => car.id !== carId && car.latest_map), changed);
    const radio = (value, text, first) => h("label", {}, h("input", { type: "radio", name: "compare-kind", value, checked: first, on: { change: choose } }), h("span", {}, text));
    const references = h("div");
    show(place, h("section", { class: "card" },
      h("header", {}, h("h2", {}, "Two maps"), h("fieldset", { class: "segmented" }, h("legend", { class: "visually-hidden" }, "What is compared"),
        radio("versions", "Versions", true), radio("cars", "Another car", false), radio("periods", "Periods", false))),
      inputs, h("div", { class: "columns section" }, said, box)), references);
    choose();
    showReferences(references, carId);
  };
  guarded(fill, place);
  return () => { if (!ways) guarded(fill, place); };
}
