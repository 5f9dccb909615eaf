/** Small behaviours of the frame: tabs, menus, dialogs, questions. */

import { h, show } from "./dom.js";

/**
 * Make a `role=tablist` work: arrow keys, the address' hash, and a call the first time a panel is shown.
 * @param {HTMLElement} list
 * @param {Record<string, (panel: HTMLElement) => void>} onFirst By panel id.
 */
export function tabs(list, onFirst = {}) {
  const buttons = [...list.querySelectorAll('[role="tab"]')];
  const seen = new Set();
  const select = (button, focus) => {
    for (const other of buttons) {
      const panel = document.getElementById(other.getAttribute("aria-controls"));
      const on = other === button;
      other.setAttribute("aria-selected", String(on));
      other.tabIndex = on ? 0 : -1;
      panel.hidden = !on;
      if (on && !seen.has(panel.id)) {
        seen.add(panel.id);
        onFirst[panel.id]?.(panel);
      }
    }
    const { left, width } = button.getBoundingClientRect();
    list.scrollLeft += left + width / 2 - list.getBoundingClientRect().left - list.clientWidth / 2; // a phone shows but some of them
    if (focus) {
      button.focus();
      history.replaceState(null, "", `#${button.id.replace("tab-", "")}`);
    }
  };
  list.addEventListener("click", (event) => {
    const button = event.target.closest('[role="tab"]');
    if (button) select(button, true);
  });
  list.addEventListener("keydown", (event) => {
    const usable = buttons.filter((button) => !button.hidden);
    const index = usable.indexOf(document.activeElement);
    const next = { ArrowRight: index + 1, ArrowLeft: index - 1, Home: 0, End: usable.length - 1 }[event.key];
    if (next === undefined) return;
    event.preventDefault();
    select(usable[(next + usable.length) % usable.length], true);
  });
  const fromHash = () => buttons.find((button) => !button.hidden && button.id === `tab-${location.hash.slice(1)}`);
  addEventListener("hashchange", () => fromHash() && select(fromHash()));
  select(fromHash() ?? buttons[0]);
}

/** Close open menus on Escape, on a click elsewhere, and after a choice. */
export function menus() {
  document.addEventListener("click", (event) => {
    for (const menu of document.querySelectorAll("details.menu[open]")) {
      if (!menu.contains(event.target) || event.target.closest("details.menu > div")) menu.open = false;
    }
  });
  document.addEventListener("keydown", (event) => {
    if (event.key !== "Escape") return;
    for (const menu of document.querySelectorAll("details.menu[open]")) {
      menu.open = false;
      menu.querySelector("summary").focus();
    }
  });
}

/** What `data-action` buttons of a menu do. */
export function actions(menu, handlers) {
  menu.addEventListener("click", (event) => {
    const button = event.target.closest("[data-action]");
    if (button) handlers[button.dataset.action]?.(button);
  });
}

function ask(title, body, word, danger) {
  const dialog = h("dialog", { "aria-labelledby": "question-title" },
    h("form", { method: "dialog" },
      h("h2", { id: "question-title" }, title), body,
      h("div", { class: "form-end" },
        h("button", { class: "btn", value: "", type: "button", on: { click: () => dialog.close("") } }, "Cancel"),
        h("button", { class: danger ? "btn danger" : "btn primary", value: "yes" }, word))));
  document.body.append(dialog);
  dialog.showModal();
  return new Promise((resolve) => {
    dialog.addEventListener("close", () => {
      resolve(dialog.returnValue === "yes");
      dialog.remove();
    });
  });
}

/** Ask before something that can't be taken back. */
export const confirmed = (title, text, word) => ask(title, h("p", {}, text), word, true);

/** Ask before something that is large, but can be taken back. */
export const agreed = (title, body, word) => ask(title, body, word, false);

/** Ask for a name; null when the reader cancels or leaves it empty. */
export async function askName(title, label, value, word) {
  const input = h("input", { id: "question-name", value: value ?? "", maxLength: 200, required: true, autocomplete: "off" });
  const yes = ask(title, h("div", { class: "field" }, h("label", { htmlFor: "question-name" }, label), input), word);
  input.select();
  return (await yes) && input.value.trim() ? input.value.trim() : null;
}

/** Wire the close buttons of a dialog that stands in the template. */
export function closable(dialog) {
  dialog.addEventListener("click", (event) => {
    if (event.target.closest("[data-close]")) dialog.close();
  });
}

/** A table in a box of its own that scrolls sideways and can be reached by keyboard. */
export function table(caption, head, rows, kind = "") {
  return h("div", { class: `table-box ${kind}`, role: "region", ariaLabel: caption, tabIndex: 0 },
    h("table", {}, h("caption", { class: "visually-hidden" }, caption), head && h("thead", {}, head), h("tbody", {}, rows)));
}

/** Show a list page by page: `row` by `row`, with a button for more while there is more. */
export function paged(fetchPage, append, moreBox) {
  const next = async (cursor) => {
    const page = await fetchPage(cursor);
    append(page.items, !cursor);
    show(moreBox, page.next_cursor && h("button", { class: "btn", on: { click: () => next(page.next_cursor) } }, "Show more"));
  };
  return next(null);
}
