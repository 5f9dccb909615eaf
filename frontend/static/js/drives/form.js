/** A problem as a form: every change goes into the document at once, errors stand beside their fields. */

import { h, show } from "../core/dom.js";
import { editable, fieldOf, put, typedNumber, valueOf } from "./paths.js";
import { groupsOf } from "./fields.js";
import { roadField } from "./road.js";

const idOf = (path) => `pose-field-${path.replace(/[^\w]+/g, "-")}`;
const scaled = (value, factor) => (typeof value === "number" ? value * factor : value);

/** How a value is written as text, and read back; what can't be read goes to the server as it is, which says what is wrong. */
const AS_TEXT = {
  number: { write: (value, { factor }) => editable(scaled(value, factor)), read: (text, { factor }) => back(typedNumber(text), factor) },
  numbers: { write: (value, { factor }) => (Array.isArray(value) ? value.map((one) => editable(scaled(one, factor))).join(", ") : editable(value)),
    read: (text, { factor }) => text.split(/[,;]\s*/).filter((part) => part.trim()).map((part) => back(typedNumber(part), factor)) },
  words: { write: (value) => (value ?? []).join(", "), read: (text) => text.split(/[,;]\s*/).map((part) => part.trim()).filter(Boolean) },
  points: { write: (value) => (value ?? []).map((point) => point.join(" ")).join("\n"), read: (text) => text.trim().split("\n").map((line) => line.trim().split(/[\s,;]+/).map(typedNumber)) },
  json: { write: (value) => (value === undefined || value === null ? "" : JSON.stringify(value, null, 1)), read: (text) => JSON.parse(text) },
  text: { write: (value) => String(value ?? ""), read: (text) => text.trim() },
};

/** From what is shown to SI, without the rounding that 3.6 leaves behind. */
const back = (value, factor) => (typeof value === "number" && factor !== 1 ? Number((value / factor).toPrecision(12)) : value);

export class PoseForm {
  /**
   * @param {HTMLFormElement} form
   * @param {{changed: () => void, noted: (notes: string[]) => void, carId: () => string}} hooks
   * @param {(problem: object) => object[]} groups What fields a document has; those of a drive unless said otherwise.
   */
  constructor(form, hooks, groups = groupsOf) {
    Object.assign(this, { form, hooks, groups });
  }

  /** Show a problem; the document itself is what is edited. */
  show(problem) {
    this.problem = problem;
    const held = this.form.contains(document.activeElement) ? document.activeElement.id : "";
    this.open = new Set([...this.form.querySelectorAll("details[open]")].map((box) => box.dataset.title));
    show(this.form, this.groups(problem).map((group) => this.group(group)));
    if (held) document.getElementById(held)?.focus();
  }

  group({ title, heading, fields, folds, brief }) {
    const grid = h("div", { class: "form-grid" }, fields.map((field) => this.field(field)));
    if (!folds) return h("div", { class: "section" }, heading && h("h3", {}, heading), grid);
    return h("details", { class: "form-group pose-group", dataset: { title }, open: this.open.has(title) }, h("summary", {}, title, brief && h("span", { class: "quiet" }, ` · ${brief}`)), grid);
  }

  field(field) {
    if (field.type === "note") return h("p", { class: "quiet small" }, field.text);
    if (field.type === "road") return this.framed(field, roadField(this.problem, this.hooks.carId, (notes) => this.laid(notes)), true);
    if (field.type === "time") return this.time(field);
    if (field.type === "check") return this.check(field);
    if (field.type === "choice") return this.framed(field, this.choice(field));
    return this.framed(field, this.text(field));
  }

  /** Other parts were put into the problem, such as a road: its wishes are shown, and what is to be known of it. */
  laid(notes) {
    this.show(this.problem);
    this.hooks.noted(notes);
    this.hooks.changed();
  }

  /** A control with its label, unit, help and the place of its error. */
  framed(field, control, plain = false) {
    const help = `${idOf(field.path)}-help`;
    if (!plain) Object.assign(control, { id: idOf(field.path) }).setAttribute("aria-describedby", help);
    const label = plain ? h("span", { class: "label" }, field.label) : h("label", { htmlFor: idOf(field.path) }, field.label);
    return h("div", { class: `field${field.wide || plain ? " wide-field" : ""}`, dataset: { path: field.path } }, label,
      h("div", { class: "with-unit" }, control, field.unit && h("span", { class: "unit nowrap" }, field.unit)), h("p", { class: "help", id: help }, field.help ?? ""),
      h("p", { class: "error", id: `${idOf(field.path)}-error`, hidden: true }));
  }

  text(field) {
    const { write, read } = AS_TEXT[field.type];
    const several = field.type === "points" || field.type === "json";
    const control = h(several ? "textarea" : "input", { value: write(valueOf(this.problem, field.path), field), autocomplete: "off", spellcheck: false,
      class: field.type === "number" ? "number" : several ? "code" : "", ...(several ? { rows: 4 } : {}) });
    control.addEventListener("input", () => this.write(field, control.value.trim() === "" ? undefined : () => read(control.value, field)));
    if (field.redraws) control.addEventListener("change", () => this.show(this.problem));
    return control;
  }

  /** Put what was typed into the document; text that can't be read is marked where it stands. */
  write(field, read) {
    this.clear(field.path);
    try {
      put(this.problem, field.path, read === undefined ? undefined : read());
      this.hooks.changed();
    } catch (error) {
      this.mark(field.path, `This is not JSON yet: ${error.message}`);
    }
  }

  choice(field) {
    const now = field.now?.(this.problem) ?? valueOf(this.problem, field.path) ?? "";
    const control = h("select", {}, field.options.map(([value, text]) => h("option", { value, selected: value === now }, text)));
    control.addEventListener("change", () => {
      if (field.takes) field.takes(this.problem, control.value, this.hooks.carId());
      else this.write(field, control.value === "" ? undefined : () => control.value);
      if (field.takes) this.laid([]);
    });
    return control;
  }

  check(field) {
    const box = h("input", { type: "checkbox", id: idOf(field.path), checked: valueOf(this.problem, field.path) === true, on: { change: () => this.write(field, () => box.checked) } });
    return h("div", { class: "field", dataset: { path: field.path } }, h("label", { class: "check" }, box, h("span", {}, field.label)), h("p", { class: "help" }, field.help), h("p", { class: "error", id: `${idOf(field.path)}-error`, hidden: true }));
  }

  time(field) {
    const now = valueOf(this.problem, field.path);
    const [free, bound] = field.words;
    const seconds = h("input", { class: "number", value: editable(now), ariaLabel: `${bound}, seconds`, hidden: now === null || now === undefined, autocomplete: "off",
      on: { input: () => this.write(field, () => typedNumber(seconds.value)) } });
    const unit = h("span", { class: "unit", hidden: seconds.hidden }, "s");
    const choice = h("select", { on: { change: () => {
      seconds.hidden = unit.hidden = choice.value === "free";
      this.write(field, () => (choice.value === "free" || seconds.value === "" ? null : typedNumber(seconds.value)));
      if (!seconds.hidden) seconds.focus();
    } } }, h("option", { value: "free" }, free), h("option", { value: "bound", selected: !seconds.hidden }, bound));
    const view = this.framed(field, choice);
    view.querySelector(".with-unit").append(seconds, unit);
    return view;
  }

  /** The place of a field, by a path that may go on inside it or stop before it. */
  place(path) {
    const wanted = fieldOf(path);
    const places = [...this.form.querySelectorAll(".field")];
    return places.find((one) => one.dataset.path === wanted) ?? places.find((one) => wanted.startsWith(`${one.dataset.path}.`));
  }

  /** Bring a field into sight, with an error where there is one; returns its control. */
  reach(path, message = null) {
    if (message) return this.mark(path, message);
    const place = this.place(path);
    place?.closest("details")?.setAttribute("open", "");
    return place?.querySelector("input, select, textarea") ?? null;
  }

  /** Tell an error beside its field; returns the control, nothing where the form has no such field. */
  mark(path, message) {
    const place = this.place(path);
    if (!place) return null;
    place.closest("details")?.setAttribute("open", "");
    const [control, error] = [place.querySelector("input, select, textarea, button"), place.querySelector(".error")];
    control.setAttribute("aria-invalid", "true");
    control.setAttribute("aria-errormessage", error.id);
    error.textContent = message;
    error.hidden = false;
    return control;
  }

  /** Take errors away: of one field, or of all. */
  clear(path = null) {
    for (const place of path === null ? this.form.querySelectorAll(".field") : [this.place(path)]) {
      place?.querySelector("[aria-invalid]")?.removeAttribute("aria-invalid");
      const error = place?.querySelector(".error");
      if (error) error.hidden = true;
    }
  }
}
