/** Tables of dynamometers and manufacturers over the car's map, and its level corrected by one when the reader says so. */

import { API, at, get, post, query, remove, request } from "../core/api.js";
import { checked, h, show } from "../core/dom.js";
import { Figure } from "../core/figure.js";
import { measureText, number, plural } from "../core/format.js";
import { announce, busy, guarded, problemBox, toast } from "../core/notify.js";
import { agreed, confirmed, table } from "../core/ui.js";

const FIGURE_PX = 560;
const FUELS = [["", "the car's fuel"], ["petrol", "petrol"], ["diesel", "diesel"], ["e10", "E10"], ["e85", "E85"], ["lpg", "LPG"]];
const VIEWS = [["overlay", "Lines over the map"], ["corrected", "Level corrected"], ["difference", "Difference"], ["left", "Difference, corrected"]];
const POINTS = { class: "n" };

function numbers(found) {
  const row = (name, before, after) => h("tr", {}, h("th", { scope: "row" }, name), h("td", POINTS, before), h("td", POINTS, after));
  const th = (text, kind) => h("th", { scope: "col", class: kind }, text);
  const same = "the same";
  return table("The map beside the table", h("tr", {}, th(`In ${plural(found.cells, "cell")}`), th("As it is", "n"), th("Level corrected", "n")), [
    row("Map over table", `${number(found.scale, 3)} ± ${number(found.scale_sd, 3)}`, "1"),
    row("Difference, root mean square", `${number(100 * found.rmse, 2)} points`, `${number(100 * found.rmse_scaled, 2)} points`),
    row("Correlation of the shapes", number(found.correlation, 3), same),
    row("Best point, map less table", `${measureText(found.peak_rpm, "rpm")}, ${measureText(found.peak_nm, "Nm")}`, same),
    row("Injector flow, l/s", number(found.level.before, 6), found.level.impossible ? "–" : `${number(found.level.after, 6)} ± ${number(found.level.sd, 6)}`),
  ]);
}

/** Ask with both levels before the eyes; only then is the car file changed. */
async function apply(found, carId, path, again) {
  const trips = (await get(at("cars", carId))).trip_count;
  const text = [h("p", {}, `The injectors' flow in the car file becomes ${number(found.level.after, 6)} instead of ${number(found.level.before, 6)} l/s, and ${plural(trips, "trip")} run again with it. The file as it is now can be put back from its history.`),
    h("p", {}, "This is right only if it is the fuel that is counted wrongly:"), h("ul", { class: "reasons" }, found.other_reasons.map((reason) => h("li", {}, reason)))];
  if (!(await agreed("Correct the map's level?", text, `Correct and run ${plural(trips, "trip")} again`))) return;
  const done = await post(`${path}/apply`, { version: found.version, key: found.level.key });
  toast(`The car file is now revision ${done.revision}; ${plural(done.jobs.length, "trip")} run again.`, h("a", { href: "/jobs" }, "Watch"));
  again();
}

/** One table beside the newest map. */
async function beside(place, carId, row, again) {
  const path = at("cars", carId, `/references/${row.id}`);
  let found;
  try {
    found = await get(`${path}/agreement`);
  } catch (error) {
    show(place, problemBox(error));
    return;
  }
  const box = h("div", { class: "figure" });
  const figure = new Figure(box, { label: `${row.name} over the map`, height: FIGURE_PX });
  const draw = () => {
    const view = checked("reference-view");
    const name = view === "overlay" || view === "corrected" ? "overlay" : "difference";
    figure.load(`${API}/${path}/figures/${name}${query({ corrected: view === "corrected" || view === "left" })}`);
  };
  const views = h("fieldset", { class: "segmented" }, h("legend", { class: "visually-hidden" }, "Drawn as"),
    VIEWS.map(([value, text], i) => h("label", {}, h("input", { type: "radio", name: "reference-view", value, checked: i === 0, on: { change: draw } }), h("span", {}, text))));
  const correct = h("button", { class: "btn", disabled: found.level.impossible !== "", on: { click: () => busy(correct, () => apply(found, carId, path, again)) } }, "Correct the level…");
  show(place, h("div", { class: "section" }, views), box, numbers(found), h("div", { class: "form-end" }, correct, h("span", { class: "quiet" }, found.level.impossible || "Nothing is changed before you have confirmed it.")));
  draw();
}

function addForm(carId, added) {
  const file = h("input", { id: "reference-file", type: "file", accept: ".csv,text/csv", required: true });
  const name = h("input", { id: "reference-name", maxLength: 200, value: "Dynamometer", required: true });
  const fuel = h("select", { id: "reference-fuel" }, FUELS.map(([value, text]) => h("option", { value }, text)));
  const [button, outcome] = [h("button", { class: "btn" }, "Add the table"), h("div", { role: "status" })];
  const field = (label, input) => h("div", { class: "field" }, h("label", { htmlFor: input.id }, label), input);
  const form = h("form", {}, h("div", { class: "form-grid" }, field("CSV with rpm, nm and efficiency, fuel_gps or bsfc_gpkwh", file), field("Name", name), field("Measured with", fuel)),
    h("div", { class: "form-end" }, button), outcome);
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    busy(button, async () => {
      show(outcome);
      try {
        const said = query({ name: name.value, filename: file.files[0].name, fuel: fuel.value });
        await request(at("cars", carId, `/references${said}`), { method: "POST", headers: { "Content-Type": "text/csv" }, body: file.files[0] });
        announce("Added");
        added();
      } catch (error) {
        show(outcome, problemBox(error));
      }
    });
  });
  return form;
}

/** Fill the section of the tables. */
export function showReferences(place, carId) {
  const [list, drawn] = [h("div"), h("div")];
  const renew = () => guarded(async () => {
    const { items } = await get(at("cars", carId, "/references"));
    const shown = h("select", { id: "reference-shown", ariaLabel: "Table", on: { change: () => draw() } }, items.map((row) => h("option", { value: row.id }, row.name)));
    const draw = () => beside(drawn, carId, items.find((row) => row.id === shown.value), renew);
    const gone = h("button", { class: "btn small", on: { click: () => busy(gone, async () => {
      const row = items.find((one) => one.id === shown.value);
      if (!(await confirmed(`Remove “${row.name}”?`, "Maps and car file stay as they are.", "Remove"))) return;
      await remove(at("cars", carId, `/references/${row.id}`));
      await renew();
    }) } }, "Remove");
    show(list, items.length > 0 && h("div", { class: "switches" }, shown, gone));
    show(drawn);
    if (items.length > 0) await draw();
  }, list);
  show(place, h("section", { class: "card section" }, h("header", {}, h("h2", {}, "A dynamometer's or manufacturer's table")), list, drawn,
    h("details", { class: "section" }, h("summary", {}, "Add a table"), addForm(carId, renew))));
  renew();
}
