/** A half-round gauge with a needle, and the arrow that says faster or slower. */

import { svg } from "../core/dom.js";

const CENTRE = 100;
const RADIUS = 80;
const TICKS = 5;

const point = (share, radius) => {
  const angle = Math.PI * (1 - share);
  return [CENTRE + radius * Math.cos(angle), CENTRE - radius * Math.sin(angle)];
};
const arc = (from, to) => `M ${point(from, RADIUS).join(" ")} A ${RADIUS} ${RADIUS} 0 0 1 ${point(to, RADIUS).join(" ")}`;

export class Gauge {
  /** @param {{top: number, unit: string, stops?: string[]}} scale From 0 to `top`; `stops` colour the arc from left to right. */
  constructor(scale) {
    this.scale = scale;
    const id = `arc-${scale.unit.replace(/\W/g, "")}`;
    const stops = scale.stops ?? ["currentColor", "currentColor"];
    this.band = svg("path", { class: "gauge-band", d: "" });
    this.needle = svg("line", { class: "gauge-needle", x1: CENTRE, y1: CENTRE, x2: CENTRE - RADIUS + 8, y2: CENTRE });
    this.words = svg("text", { x: CENTRE, y: CENTRE + 24, class: "gauge-value" }, "–");
    this.node = svg("svg", { viewBox: "0 0 200 130", role: "img", class: "gauge" },
      svg("defs", {}, svg("linearGradient", { id }, ...stops.map((colour, k) => svg("stop", { offset: k / (stops.length - 1), "stop-color": colour })))),
      svg("path", { class: "gauge-arc", d: arc(0, 1), stroke: `url(#${id})` }), this.band,
      ...Array.from({ length: TICKS + 1 }, (_, k) => {
        const [x, y] = point(k / TICKS, RADIUS + 12);
        return svg("text", { x, y: y + 3, class: "gauge-tick" }, String(Math.round((k * scale.top) / TICKS)));
      }), this.needle, svg("circle", { cx: CENTRE, cy: CENTRE, r: 5, class: "gauge-hub" }), this.words);
  }

  /**
   * Show a value, or words in its place when there is none.
   * @param {number|null} value
   * @param {string} text
   * @param {number} [sd] Drawn as a band of two of it to each side.
   */
  show(value, text, sd = 0) {
    const share = (x) => Math.min(1, Math.max(0, x / this.scale.top));
    const known = Number.isFinite(value);
    this.needle.setAttribute("transform", `rotate(${180 * share(known ? value : 0)} ${CENTRE} ${CENTRE})`);
    this.needle.classList.toggle("off", !known);
    this.band.setAttribute("d", known && sd > 0 ? arc(share(value - 2 * sd), share(value + 2 * sd)) : "");
    this.words.textContent = text;
    this.node.setAttribute("aria-label", text);
  }
}

const UP = "M 50 6 L 92 52 H 66 V 94 H 34 V 52 H 8 Z";

export class Arrow {
  constructor() {
    this.shape = svg("path", { d: UP });
    this.node = svg("svg", { viewBox: "0 0 100 100", role: "img", class: "arrow" }, this.shape, svg("circle", { cx: 50, cy: 50, r: 26, class: "arrow-dot" }));
  }

  /** Point up for faster, down for slower; the further off, the stronger. 0 is on target, null is no target. */
  show(off, strength) {
    this.node.dataset.points = off === null ? "none" : off > 0 ? "up" : off < 0 ? "down" : "on";
    this.shape.setAttribute("transform", off < 0 ? "rotate(180 50 50)" : "");
    this.shape.setAttribute("fill-opacity", String(0.25 + 0.75 * strength));
    this.node.setAttribute("aria-label", off === null ? "No target here" : off > 0 ? "Faster" : off < 0 ? "Slower" : "On target");
  }
}
