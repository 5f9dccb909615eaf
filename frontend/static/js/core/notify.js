/** Telling the reader: errors in place, short notices, and words for screen readers. */

import { byId, h, show } from "./dom.js";

/** Say something to a screen reader without moving the focus. */
export function announce(text) {
  byId("live").textContent = text;
}

/** A short notice that leaves by itself and can be closed. */
export function toast(text, ...actions) {
  const box = h("div", { class: "toast" }, h("p", {}, text), ...actions,
    h("button", { class: "btn bare small", ariaLabel: "Close this notice", on: { click: () => box.remove() } }, "✕"));
  byId("toasts").append(box);
  announce(text);
  setTimeout(() => box.remove(), 8000);
}

const PLACES = [["line", "line"], ["column", "column"], ["element", "element"], ["field", "field"], ["row", "row"], ["offset", "byte"], ["t_s", "second"]];

/** Where a problem is, in words: `line 12, element <mass>`. */
function whereOf(problem) {
  return PLACES.filter(([key]) => problem[key] !== undefined && problem[key] !== null)
    .map(([key, word]) => `${word} ${key === "element" ? `<${problem[key]}>` : problem[key]}`).join(", ");
}

/** A problem as a box: what, where, what next. */
export function problemBox(problem, ...actions) {
  const where = whereOf(problem);
  return h("div", { class: "problem", role: "alert" },
    h("p", {}, h("strong", {}, problem.title || problem.message || "That did not work")),
    problem.detail && problem.detail !== problem.title && h("p", {}, problem.detail),
    where && h("p", { class: "where" }, `Where: ${where}`),
    actions.length > 0 && h("div", { class: "form-end" }, ...actions));
}

/** Show a failed action as a notice. */
export function complain(error) {
  if (error.name === "AbortError") return;
  const box = h("div", { class: "toast" }, h("div", {}, problemBox(error)),
    h("button", { class: "btn bare small", ariaLabel: "Close this message", on: { click: () => box.remove() } }, "✕"));
  byId("toasts").append(box);
}

/** Run the page's main work; what fails is shown at the top with a way to try again. */
export async function guarded(work, place = byId("problem")) {
  try {
    show(place);
    return await work();
  } catch (error) {
    if (error.name === "AbortError") return undefined;
    if (!("status" in error)) console.error(error);
    document.querySelectorAll("p.waiting").forEach((waiting) => waiting.remove());
    const back = error.status === 404
      ? h("a", { class: "btn", href: "/" }, "To the overview")
      : h("button", { class: "btn", on: { click: () => guarded(work, place) } }, "Try again");
    show(place, problemBox(error, back));
    return undefined;
  }
}

/** Run what a button does: the button waits meanwhile, a failure is told. */
export async function busy(button, work) {
  if (button.getAttribute("aria-disabled") === "true") return undefined;
  button.setAttribute("aria-disabled", "true");
  try {
    return await work();
  } catch (error) {
    complain(error);
    return undefined;
  } finally {
    button.removeAttribute("aria-disabled");
  }
}
