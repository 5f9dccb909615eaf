/** Choosing which signals are stacked, and in which order. */

import { h, show } from "../core/dom.js";
import { closable } from "../core/ui.js";
import { DEFAULT_SIGNALS, signal, signalGroups } from "./signals.js";

const MOST = 8;

/**
 * Ask which signals to show.
 * @param {HTMLDialogElement} dialog
 * @param {string[]} shown
 * @param {(names: string[]) => void} choose
 */
export function chooseSignals(dialog, shown, choose) {
  const box = (name) => h("label", { class: "check" },
    h("input", { type: "checkbox", name: "signal", value: name, checked: shown.includes(name) }),
    h("span", {}, signal(name).label, " ", h("span", { class: "unit" }, signal(name).unit)));
  const hint = h("p", { class: "quiet small", role: "status" });
  const picked = () => [...form.querySelectorAll("input:checked")].map((input) => input.value);
  const check = () => {
    const count = picked().length;
    hint.textContent = count > MOST ? `At most ${MOST} fit on a page; ${count} are chosen.` : "New ones are added below the others.";
    form.querySelector("button.primary").disabled = count === 0 || count > MOST;
  };
  const form = h("form", { method: "dialog" },
    h("h2", {}, "Signals over time"),
    h("div", { class: "chooser" }, signalGroups().map(([group, names]) => h("fieldset", {}, h("legend", { class: "quiet small" }, group), names.map(box)))),
    hint,
    h("div", { class: "form-end" },
      h("button", { class: "btn bare", type: "button", on: { click: () => { choose(DEFAULT_SIGNALS); dialog.close(); } } }, "As at first"),
      h("button", { class: "btn", type: "button", dataset: { close: "" } }, "Cancel"), h("button", { class: "btn primary" }, "Show")));
  form.addEventListener("change", check);
  form.addEventListener("submit", () => {
    const now = picked();
    choose([...shown.filter((name) => now.includes(name)), ...now.filter((name) => !shown.includes(name))]);
  });
  show(dialog, form);
  closable(dialog);
  check();
  dialog.showModal();
}
