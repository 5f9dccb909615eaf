/** Where the trip went, coloured by speed, with the cursor as a dot. Without WebGL it is a plan in metres instead of a map. */

import { API, at, query } from "../core/api.js";
import { h } from "../core/dom.js";
import { Figure } from "../core/figure.js";
import { hasWebgl } from "../core/plotly.js";

export class Track {
  /** @param {HTMLElement} box @param {object} trip @param {import("./cursor.js").Cursor} cursor @param {number} height */
  constructor(box, trip, cursor, height) {
    Object.assign(this, { trip, cursor, flat: !hasWebgl() });
    this.figure = new Figure(box, { label: "Map, coloured by speed", height, config: { scrollZoom: true }, drawn: (plot) => this.drawn(plot) });
    this.dot = h("div", { class: "cursor-dot", hidden: true });
    this.figure.overlay.append(this.dot);
  }

  /** Columns that say where the dot is: across, up. */
  get columns() {
    return this.flat ? ["east_m", "north_m"] : ["lon_deg", "lat_deg"];
  }

  async load() {
    const path = `${API}/${at("trips", this.trip.id, "/figures/track")}`;
    await this.figure.load(path + query({ variant: this.flat ? "plan" : "" }));
    if (!this.figure.failed || this.flat) return;
    this.flat = true; // the map could not be drawn after all
    await this.load();
  }

  drawn(plot) {
    if (this.listening !== plot.on) {
      this.listening = plot.on;
      for (const event of ["plotly_hover", "plotly_click"]) {
        plot.on(event, ({ points }) => Number.isFinite(points[0]?.customdata) && this.cursor.set(points[0].customdata));
      }
      plot.on("plotly_relayouting", () => this.place());
      plot.on("plotly_relayout", () => this.place());
    }
    const map = this.map();
    if (map && map !== this.watched) {
      this.watched = map;
      map.on("move", () => this.place());
    }
    this.place();
  }

  map() {
    return this.figure.plot._fullLayout?.map?._subplot?.map ?? null;
  }

  /** The cursor is at that place (in the units of `columns`), or nowhere. */
  put(across, up) {
    this.spot = Number.isFinite(across) && Number.isFinite(up) ? [across, up] : null;
    this.place();
  }

  place() {
    const pixel = this.spot && this.pixel(this.spot);
    this.dot.hidden = !pixel;
    if (pixel) this.dot.style.transform = `translate(${pixel[0]}px, ${pixel[1]}px)`;
  }

  /** Where a place is in the drawing, or null while it is out of sight. */
  pixel([across, up]) {
    const map = this.map();
    if (map) {
      const { x, y } = map.project([across, up]);
      const [box, frame] = [map.getContainer().getBoundingClientRect(), this.figure.overlay.getBoundingClientRect()];
      return x >= 0 && y >= 0 && x <= box.width && y <= box.height ? [x + box.left - frame.left, y + box.top - frame.top] : null;
    }
    const { xaxis, yaxis } = this.figure.plot._fullLayout ?? {};
    if (!this.flat || !xaxis?._length) return null;
    const [x, y] = [xaxis.d2p(across), yaxis.d2p(up)];
    return x >= 0 && y >= 0 && x <= xaxis._length && y <= yaxis._length ? [x + xaxis._offset, y + yaxis._offset] : null;
  }
}
