/** The car file as text with line numbers; a refused line is marked where it stands. */

import { API, at, request, sendXml } from "../core/api.js";
import { h, show } from "../core/dom.js";
import { busy, problemBox } from "../core/notify.js";

/** Start and end of a line (counted from 1) in a text. */
function lineRange(text, line) {
  const lines = text.split("\n");
  const start = lines.slice(0, line - 1).reduce((sum, one) => sum + one.length + 1, 0);
  return [start, start + (lines[line - 1]?.length ?? 0)];
}

class Editor {
  constructor(text) {
    this.numbers = h("ol", { ariaHidden: "true" });
    this.area = h("textarea", { class: "code", spellcheck: false, autocomplete: "off", value: text, ariaLabel: "XML of the car", wrap: "off" });
    this.area.addEventListener("input", () => this.count());
    this.area.addEventListener("scroll", () => { this.numbers.scrollTop = this.area.scrollTop; });
    this.node = h("div", { class: "editor" }, this.numbers, this.area);
    this.count();
  }

  count() {
    const lines = this.area.value.split("\n").length;
    while (this.numbers.children.length < lines) this.numbers.append(h("li", {}, String(this.numbers.children.length + 1)));
    while (this.numbers.children.length > lines) this.numbers.lastChild.remove();
  }

  clear() {
    this.numbers.querySelectorAll(".bad").forEach((line) => line.classList.remove("bad"));
    this.area.removeAttribute("aria-invalid");
  }

  mark(line) {
    this.area.setAttribute("aria-invalid", "true");
    this.numbers.children[line - 1]?.classList.add("bad");
    const [start, end] = lineRange(this.area.value, line);
    this.area.focus();
    this.area.setSelectionRange(start, end);
    this.area.scrollTop = Math.max(0, (line - 6) * 20);
    this.numbers.scrollTop = this.area.scrollTop;
  }
}

/** Show the editor in `place`; `saved` is called with the place for what comes next. */
export async function showXml(place, carId, saved) {
  const path = at("cars", carId, "/config");
  const editor = new Editor(await (await request(path)).text());
  const outcome = h("div", { role: "status" });
  const save = h("button", { class: "btn primary", on: { click: () => busy(save, async () => {
    editor.clear();
    show(outcome);
    try {
      await sendXml("PUT", path, editor.area.value);
      await saved(outcome);
    } catch (problem) {
      show(outcome, problemBox(problem));
      if (problem.line) editor.mark(problem.line);
    }
  }) } }, "Save");
  show(place, editor.node, h("div", { class: "form-end" }, save, h("a", { class: "btn bare", href: `${API}/${path}`, download: "car.xml" }, "Download")), outcome);
}
