/** How map and plots share the page: chosen from a menu and kept in this browser. A phone has one column and no choice. */

import { actions } from "../core/ui.js";

const KEY = "ponthy-trip-layout";
const USUAL = "beside";
const NAMES = [USUAL, "above", "plots", "map"];
const phone = matchMedia("(max-width: 720px)");

function kept() {
  try {
    const name = localStorage.getItem(KEY);
    return NAMES.includes(name) ? name : USUAL;
  } catch {
    return USUAL;
  }
}

function keep(name) {
  try {
    localStorage.setItem(KEY, name);
  } catch {
    // Storage is blocked: the choice holds for this page only.
  }
}

export class Layout {
  /** @param {HTMLElement} menu Its buttons are named by `data-action`. @param {HTMLElement} grid Holds map and plots; the style sheet does the rest. */
  constructor(menu, grid) {
    Object.assign(this, { menu, grid, chosen: kept() });
    this.changed = new Set();
    actions(menu, Object.fromEntries(NAMES.map((name) => [name, () => this.choose(name)])));
    phone.addEventListener("change", () => this.apply());
    this.apply();
  }

  /** What is shown now. */
  get name() {
    return phone.matches ? USUAL : this.chosen;
  }

  get withMap() {
    return this.name !== "plots";
  }

  get withPlots() {
    return this.name !== "map";
  }

  choose(name) {
    this.chosen = name;
    keep(name);
    this.apply();
    this.menu.querySelector("summary").focus();
  }

  apply() {
    this.grid.dataset.layout = this.name;
    for (const button of this.menu.querySelectorAll("[data-action]")) button.ariaPressed = String(button.dataset.action === this.chosen);
    this.changed.forEach((listener) => listener());
  }
}
