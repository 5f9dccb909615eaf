/** Where the trip went, coloured by speed, with the cursor as a dot. Without WebGL it is a plan in metres instead of a map. */

import { API, at, query } from "../core/api.js";
import { h } from "../core/dom.js";
import { Figure, figureAhead } from "../core/figure.js";
import { hasWebgl } from "../core/plotly.js";
import { valueAt } from "./value-at.js";

const EDGE_PX = 40;
const WORLD_PX = 512;
const MOST_ZOOM = 17;
const SMALLEST_DEG = 1e-4;

/** Degrees of longitude that are as long on the map as the way from the equator to a latitude. */
const mercator = (lat) => (180 / Math.PI) * Math.asinh(Math.tan((lat * Math.PI) / 180));

const figurePath = (tripId, flat) => `${API}/${at("trips", tripId, "/figures/track")}${query({ variant: flat ? "plan" : "" })}`;

/** Ask now for the map. */
export const trackAhead = (tripId) => figureAhead(figurePath(tripId, false));

export class Track {
  /** @param {HTMLElement} box @param {object} trip @param {import("./cursor.js").Cursor} cursor @param {{height: number}} options */
  constructor(box, trip, cursor, options) {
    Object.assign(this, { trip, cursor, flat: false });
    this.figure = new Figure(box, { label: "Map, coloured by speed", ...options, config: { scrollZoom: true }, adjust: (figure) => this.fit(figure), drawn: (plot) => this.drawn(plot) });
    this.dot = h("div", { class: "cursor-dot", hidden: true });
    this.figure.overlay.append(this.dot);
  }

  /** Columns that say where the dot is: across, up. */
  get columns() {
    return this.flat ? ["east_m", "north_m"] : ["lon_deg", "lat_deg"];
  }

  /** Roughly where the trip was at a time, from the points that are drawn. */
  spotAt(t) {
    const path = this.figure.figure?.data?.find((trace) => Array.isArray(trace.customdata));
    if (!path) return null;
    return [path.lon ?? path.x, path.lat ?? path.y].map((value) => valueAt({ t: path.customdata, value }, t));
  }

  async load() {
    this.flat ||= !hasWebgl();
    await this.figure.load(figurePath(this.trip.id, this.flat));
    if (!this.figure.failed || this.flat) return;
    this.flat = true; // the map could not be drawn after all
    await this.load();
  }

  /** Show it at another height, filled by the track again. */
  resize(height) {
    const { figure: drawn, plot } = this.figure;
    this.figure.resize(height);
    if (!drawn?.layout.map || !plot.clientWidth) return;
    this.fit(drawn);
    const { center, zoom } = drawn.layout.map;
    window.Plotly.relayout(plot, { "map.center": center, "map.zoom": zoom });
  }

  /** Let the track fill the room there is; Python could not know how much. */
  fit({ data, layout }) {
    if (!layout.map) return;
    layout.height = this.figure.options.height;
    const lat = data.flatMap((trace) => trace.lat ?? []);
    const lon = data.flatMap((trace) => trace.lon ?? []);
    const [south, north, west, east] = [Math.min(...lat), Math.max(...lat), Math.min(...lon), Math.max(...lon)];
    const { l = 0, r = 0, t = 0, b = 0 } = layout.margin ?? {};
    const across = (this.figure.plot.clientWidth - l - r - 2 * EDGE_PX) / Math.max(east - west, SMALLEST_DEG);
    const up = (layout.height - t - b - 2 * EDGE_PX) / Math.max(mercator(north) - mercator(south), SMALLEST_DEG);
    layout.map = { ...layout.map, zoom: Math.min(MOST_ZOOM, Math.log2((360 * Math.min(across, up)) / WORLD_PX)) };
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

  /** The cursor is at that place (across and up, in the units of `columns`), or nowhere. */
  put(spot) {
    this.spot = spot?.every(Number.isFinite) ? spot : null;
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
