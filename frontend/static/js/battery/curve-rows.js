/** Rows of state of charge and volts, edited in place. */

import { h, show } from "../core/dom.js";
import { table } from "../core/ui.js";
import { editable, typedNumber } from "../drives/paths.js";

const STEPS = 20;
const WHERE = /^ocv\[(\d+)\](?:\[([01])\])?/;

/** A polynomial's value. */
const valueAt = (coefficients, soc) => coefficients.reduceRight((sum, one) => sum * soc + one, 0);

/** Rows of a curve: those of a table, or of a polynomial at even steps. */
export function rowsOf({ ocv, ocv_soc_range: range }) {
  if (!ocv?.length) return [[0, 3], [1, 4]];
  if (Array.isArray(ocv[0])) return ocv.map((row) => [...row]);
  const [from, to] = range ?? [0, 1];
  return Array.from({ length: STEPS + 1 }, (_, i) => from + ((to - from) * i) / STEPS).map((soc) => [Number(soc.toFixed(4)), Number(valueAt(ocv, soc).toFixed(5))]);
}

export class CurveRows {
  /** @param {HTMLElement} place @param {() => void} changed Called after every change. */
  constructor(place, changed) {
    Object.assign(this, { place, changed, rows: [] });
  }

  show(rows) {
    this.rows = rows;
    const th = (text, kind) => h("th", { scope: "col", class: kind }, text);
    show(this.place, table("Rows of the curve", h("tr", {}, th("State of charge, %", "n"), th("Volts of a cell", "n"), th("")), rows.map((row, i) => this.row(row, i)), "tall"));
  }

  row(row, i) {
    const cell = (k, label, factor) => {
      const input = h("input", { class: "number", autocomplete: "off", inputMode: "decimal", ariaLabel: `${label}, row ${i + 1}`, value: editable(typeof row[k] === "number" ? row[k] * factor : row[k]), dataset: { row: i, column: k } });
      input.addEventListener("input", () => {
        const value = typedNumber(input.value);
        row[k] = typeof value === "number" ? Number((value / factor).toPrecision(12)) : value;
        this.changed();
      });
      return h("td", { class: "n filling" }, input);
    };
    const button = (text, label, act) => h("button", { type: "button", class: "btn bare small", ariaLabel: `${label} row ${i + 1}`, on: { click: act } }, text);
    return h("tr", {}, cell(0, "State of charge", 100), cell(1, "Volts", 1), h("td", { class: "row-actions" },
      button("+", "Put a row in after", () => this.insert(i)), this.rows.length > 2 && button("✕", "Take out", () => this.remove(i))));
  }

  /** Put a row in halfway to the next one, or as far behind the last. */
  insert(i) {
    const [here, next] = [this.rows[i], this.rows[i + 1]];
    const [other, share] = next ? [next, 0.5] : [this.rows[i - 1], -1];
    this.rows.splice(i + 1, 0, here.map((value, k) => Number((value + share * (other[k] - value)).toPrecision(8))));
    this.show(this.rows);
    this.place.querySelector(`[data-row="${i + 1}"]`)?.focus();
    this.changed();
  }

  remove(i) {
    this.rows.splice(i, 1);
    this.show(this.rows);
    this.place.querySelector(`[data-row="${Math.min(i, this.rows.length - 1)}"]`)?.focus();
    this.changed();
  }

  /** Mark the row that a refusal speaks of; false where it speaks of none. */
  mark(path) {
    this.clear();
    const [, row, column = "1"] = WHERE.exec(path ?? "") ?? [];
    const input = row === undefined ? null : this.place.querySelector(`[data-row="${row}"][data-column="${column}"]`);
    input?.setAttribute("aria-invalid", "true");
    return Boolean(input);
  }

  clear() {
    this.place.querySelectorAll("[aria-invalid]").forEach((input) => input.removeAttribute("aria-invalid"));
  }
}
