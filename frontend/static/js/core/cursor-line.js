/** A cursor over figures: an upright line through panels that share one axis, and a dot on a plane. */

import { h } from "./dom.js";

export class CursorLine {
  /** @param {import("./figure.js").Figure} figure */
  constructor(figure) {
    this.figure = figure;
    this.node = h("div", { class: "cursor-line", hidden: true });
    figure.overlay.append(this.node);
  }

  /** Where on the shared axis the pointer is; null beside the panels and while something is dragged. */
  under(event) {
    const axis = this.figure.plot._fullLayout?.xaxis;
    if (!axis || event.buttons) return null;
    const x = event.clientX - this.figure.plot.getBoundingClientRect().left - axis._offset;
    return x >= 0 && x <= axis._length ? axis.p2d(x) : null;
  }

  /** Put the line at a place of the axis. */
  put(value) {
    const layout = this.figure.plot._fullLayout;
    if (!layout?.xaxis) return;
    const { xaxis, _size: size } = layout;
    const x = xaxis.d2p(value);
    this.node.hidden = !(x >= 0 && x <= xaxis._length);
    this.node.style.height = `${size.h}px`;
    this.node.style.transform = `translate(${xaxis._offset + x}px, ${size.t}px)`;
  }
}

export class CursorDot {
  /** @param {import("./figure.js").Figure} figure */
  constructor(figure) {
    this.figure = figure;
    this.node = h("div", { class: "cursor-dot", hidden: true });
    figure.overlay.append(this.node);
  }

  /** Put the dot at a place of the plane; without one it is hidden. */
  put(across, up) {
    const { xaxis, yaxis } = this.figure.plot._fullLayout ?? {};
    this.node.hidden = !(Number.isFinite(across) && Number.isFinite(up) && xaxis?._length);
    if (this.node.hidden) return;
    this.node.style.transform = `translate(${xaxis.d2p(across) + xaxis._offset}px, ${yaxis.d2p(up) + yaxis._offset}px)`;
  }
}
