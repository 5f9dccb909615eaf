/** A figure made in Python: fetched, drawn, redrawn on a change of theme or size, and always readable as a table. */

import { askAhead, request } from "./api.js";
import { h, show } from "./dom.js";
import { figureTable } from "./figure-table.js";
import { problemBox } from "./notify.js";
import { plotly } from "./plotly.js";
import { currentTheme, onTheme } from "./theme.js";

// No chart leaves this machine: Plotly would offer to upload it to its maker's cloud.
const CONFIG = {
  plotlyServerURL: "", showSendToCloud: false, displaylogo: false, responsive: false, scrollZoom: false, showTips: false, doubleClick: "reset",
  modeBarButtonsToRemove: ["sendChartToCloud", "select2d", "lasso2d", "autoScale2d", "zoomIn2d", "zoomOut2d", "toggleSpikelines"],
};

const themed = (url) => `${url}${url.includes("?") ? "&" : "?"}theme=${currentTheme()}`;

/** Ask now for a figure that is going to be drawn: it comes while the page and Plotly are still being made ready. */
export const figureAhead = (url) => askAhead(themed(url));

export class Figure {
  /**
   * @param {HTMLElement} box Where the figure goes; emptied first.
   * @param {{label: string, height: number, tall?: boolean, config?: object, adjust?: (figure: object) => void, drawn?: (plot: HTMLElement) => void}} options
   *   `tall` lets the figure say its own height; `adjust` may change the figure before it is drawn; `drawn` is called after every drawing.
   */
  constructor(box, options) {
    this.options = options;
    this.box = box;
    this.url = null;
    this.plot = h("div", { class: "plot", role: "group", ariaLabel: options.label });
    this.overlay = h("div", { class: "plot-box" }, this.plot);
    this.under = h("span", {}, (this.badge = h("span", {})));
    this.tablePlace = h("div", { hidden: true });
    this.tableButton = h("button", { class: "btn bare small", ariaExpanded: "false", on: { click: () => this.toggleTable() } }, "Show as table");
    this.footer = h("div", { class: "under" }, this.under, this.tableButton);
    box.style.setProperty("--height", `${options.height}px`);
    show(box, this.overlay, this.tablePlace, this.footer);
    show(this.plot, h("p", { class: "waiting" }, "Drawing…"));
    onTheme(() => this.url && this.load(this.url));
    new ResizeObserver(() => this.resize()).observe(box);
  }

  /** Fetch and draw; a newer call makes an older one void. Returns whether this one was drawn. */
  async load(url) {
    this.url = url;
    this.pending?.abort();
    const mine = (this.pending = new AbortController());
    try {
      const [library, response] = await Promise.all([plotly(), request(themed(url), { signal: mine.signal })]);
      const figure = await response.json();
      if (mine.signal.aborted) return false;
      await this.draw(library, figure);
      return true;
    } catch (error) {
      if (error.name === "AbortError") return false;
      this.fail(error);
      return false;
    }
  }

  async draw(library, figure) {
    this.figure = figure;
    this.failed = false;
    if (this.options.tall && figure.layout.height) this.options.height = figure.layout.height;
    this.box.style.setProperty("--height", `${this.options.height}px`);
    figure.layout = { ...figure.layout, autosize: true, height: this.options.height };
    delete figure.layout.width;
    this.options.adjust?.(figure);
    if (!this.drawnOnce) this.plot.replaceChildren();
    this.drawnOnce = true;
    await library.react(this.plot, figure.data, figure.layout, { ...CONFIG, ...this.options.config });
    this.width = this.plot.clientWidth;
    this.badge.textContent = figure.layout.meta?.badge ?? "";
    if (!this.tablePlace.hidden) this.fillTable();
    this.options.drawn?.(this.plot);
  }

  fail(error) {
    if (this.drawnOnce) window.Plotly?.purge(this.plot);
    this.drawnOnce = false;
    this.failed = true;
    show(this.plot, problemBox(error, h("button", { class: "btn small", on: { click: () => this.load(this.url) } }, "Draw again")));
  }

  /** Draw again at the present width, or at another height. */
  resize(height = this.options.height) {
    const changed = height !== this.options.height || (this.drawnOnce && this.plot.clientWidth && this.plot.clientWidth !== this.width);
    this.options.height = height;
    this.box.style.setProperty("--height", `${height}px`);
    if (!changed || !this.drawnOnce) return;
    this.width = this.plot.clientWidth;
    window.Plotly.relayout(this.plot, { height, autosize: true }).then(() => this.options.drawn?.(this.plot));
  }

  toggleTable() {
    const open = this.tablePlace.hidden;
    this.tablePlace.hidden = !open;
    this.overlay.hidden = open;
    this.tableButton.textContent = open ? "Show as figure" : "Show as table";
    this.tableButton.ariaExpanded = String(open);
    if (open) this.fillTable();
    else this.resize();
  }

  fillTable() {
    if (this.figure && !this.failed) show(this.tablePlace, figureTable(this.figure, this.options.label));
  }
}
