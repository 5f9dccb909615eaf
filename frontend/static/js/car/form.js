/** The car file as a form: one field a value, errors beside the field they belong to. */

import { at, get, put } from "../core/api.js";
import { h, show } from "../core/dom.js";
import { announce, busy, problemBox } from "../core/notify.js";

const idOf = (path) => `field-${path.replace(/[^\w]+/g, "-")}`;

const short = (value) => String(Number(value.toPrecision(6))).replace("-", "−");

function control(field) {
  const shared = { id: idOf(field.path), name: field.path, "aria-describedby": `${idOf(field.path)}-help` };
  if (field.kind === "choice") {
    const choices = ["", ...(field.choices ?? [])];
    return h("select", shared, choices.map((choice) => h("option", { value: choice, selected: choice === (field.value ?? "") }, choice || "not said")));
  }
  if (field.kind === "list") return h("textarea", { ...shared, rows: 3, autocomplete: "off", spellcheck: false, value: field.value ?? "" });
  const numeric = field.kind === "number";
  const standard = field.default ?? null;
  return h("input", { ...shared, autocomplete: "off", spellcheck: false, value: field.value ?? "", inputMode: numeric ? "decimal" : "text",
    class: numeric ? "number" : "", placeholder: standard === null ? "" : String(standard) });
}

/** Groups that most cars leave empty: folded until something is said. */
const FOLDED = { Battery: "Of electric and hybrid cars", "Battery estimator": "How its state is estimated; the defaults serve most" };

/** Limits that are there to keep nonsense out tell a reader nothing. */
const telling = (field) => field.kind === "number" && Number.isFinite(field.minimum) && field.maximum < 1e5 && (field.minimum === 0 || Math.abs(field.minimum) >= 1e-3);

function fieldView(field) {
  const limits = telling(field) ? ` From ${short(field.minimum)} to ${short(field.maximum)}.` : "";
  return h("div", { class: "field", dataset: { path: field.path } },
    h("label", { htmlFor: idOf(field.path) }, field.label),
    h("div", { class: "with-unit" }, control(field), field.unit && h("span", { class: "unit" }, field.unit)),
    h("p", { class: "help", id: `${idOf(field.path)}-help` }, `${field.help ?? ""}${limits}`),
    h("p", { class: "error", id: `${idOf(field.path)}-error`, hidden: true }));
}

function groupView(name, members) {
  const grid = h("div", { class: "form-grid" }, members.map(fieldView));
  const folded = FOLDED[name] && members.every((field) => (field.value ?? null) === null);
  return h("fieldset", { class: "form-group" }, name && h("legend", {}, name), folded ? h("details", {}, h("summary", {}, FOLDED[name]), grid) : grid);
}

/** What the reader typed: numbers where they are numbers, text as it is otherwise (the server says what is wrong), null for nothing. */
function typed(field, text) {
  if (text.trim() === "") return null;
  if (field.kind === "list") return text.trim().split(/[\s;]+/).join(" ");
  if (field.kind !== "number") return text;
  const value = Number(text.replace(/[\s\u202f]/g, "").replace(/^(-?\d+),(\d+)$/, "$1.$2").replace("−", "-"));
  return Number.isNaN(value) ? text : value;
}

function mark(form, path, message) {
  const place = [...form.querySelectorAll(".field")].find((node) => node.dataset.path === path);
  if (!place) return null;
  place.closest("details")?.setAttribute("open", "");
  const [input, error] = [place.querySelector("input, select, textarea"), place.querySelector(".error")];
  input.setAttribute("aria-invalid", "true");
  input.setAttribute("aria-errormessage", error.id);
  error.textContent = message;
  error.hidden = false;
  return input;
}

function clearMarks(form) {
  for (const input of form.querySelectorAll("[aria-invalid]")) input.removeAttribute("aria-invalid");
  for (const error of form.querySelectorAll(".error")) error.hidden = true;
}

/** Which fields a refusal speaks of: `{path: message}`. */
function faultsOf(problem) {
  if (problem.fields) return problem.fields;
  return problem.field ? { [problem.field.replace(/^body\.(values\.)?/, "")]: problem.detail } : {};
}

/** Show the form in `place`; `saved` is called with the place for what comes next. */
export async function showForm(place, carId, saved) {
  const path = at("cars", carId, "/config/form");
  const { fields } = await get(path);
  const groups = Map.groupBy(fields, (field) => field.group || "");
  const outcome = h("div", { role: "status" });
  const form = h("form", { noValidate: true },
    [...groups].map(([name, members]) => groupView(name, members)),
    h("div", { class: "form-end" }, h("button", { class: "btn primary" }, "Save"), h("span", { class: "quiet" }, "Only what you change is written; the rest of the file stays as it is.")), outcome);
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    busy(form.querySelector("button.primary"), async () => {
      clearMarks(form);
      const changed = fields.map((field) => [field, typed(field, form.elements[field.path].value)]).filter(([field, value]) => value !== (field.value ?? null));
      if (changed.length === 0) {
        show(outcome, h("p", { class: "quiet" }, "Nothing has changed."));
        return;
      }
      try {
        await put(path, { values: Object.fromEntries(changed.map(([field, value]) => [field.path, value])) });
        for (const [field, value] of changed) field.value = value;
        await saved(outcome);
      } catch (problem) {
        const faults = Object.entries(faultsOf(problem)).map(([at_, message]) => mark(form, at_, message)).filter(Boolean);
        show(outcome, faults.length === 0 && problemBox(problem));
        faults[0]?.focus();
        announce(problem.detail);
      }
    });
  });
  show(place, form);
}
