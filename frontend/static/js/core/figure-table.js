/** The numbers behind a figure as a table: one series at a time, a few hundred rows at a time. */

import { h, show } from "./dom.js";
import { number } from "./format.js";
import { column } from "./plotly.js";
import { table } from "./ui.js";

const ROWS = 200;
const MAP_TYPES = new Set(["scattermap", "scattermapbox", "scattergeo"]);
const GRID_TYPES = new Set(["contour", "heatmap", "surface"]);

const plain = (text) => String(text ?? "").replace(/<[^>]*>/g, " ").trim();
const titleOf = (axis) => plain(axis?.title?.text ?? axis?.title);
const axisKey = (reference, letter) => `${letter}axis${(reference ?? letter).slice(1)}`;

/** Whether a trace carries data of its own (a band or a decoration does not). */
function hasData(trace) {
  return trace.hoverinfo !== "skip" && trace.visible !== false && trace.visible !== "legendonly" && trace.type !== "scatterpolar"
    && rowsOf(trace).length > 0;
}

function gridRows(trace) {
  const [xs, ys, z] = [column(trace.x), column(trace.y), column(trace.z)];
  const rows = [];
  for (let j = 0; j < z.length; j += 1) {
    for (let i = 0; i < z[j].length; i += 1) {
      if (z[j][i] !== null && Number.isFinite(z[j][i])) rows.push([xs[i], ys[j], z[j][i]]);
    }
  }
  return rows;
}

function rowsOf(trace) {
  if (GRID_TYPES.has(trace.type)) return gridRows(trace);
  const columns = MAP_TYPES.has(trace.type) ? [trace.lat, trace.lon] : [trace.x, trace.y, trace.z];
  const colour = trace.marker?.color;
  if (colour && typeof colour === "object") columns.push(colour);
  const values = columns.filter(Boolean).map(column);
  if (values.length === 0) return [];
  return Array.from({ length: values[0].length }, (_, i) => values.map((of) => of[i]))
    .filter((row) => row.every((cell) => cell !== null && cell !== undefined && !Number.isNaN(cell)));
}

function headOf(trace, layout) {
  if (MAP_TYPES.has(trace.type)) return ["Latitude °", "Longitude °", "Colour"];
  const scene = trace.type === "surface" || trace.type === "scatter3d" ? layout[trace.scene ?? "scene"] ?? {} : null;
  const x = layout.meta?.column ?? (titleOf(scene ? scene.xaxis : layout[axisKey(trace.xaxis, "x")]) || shared(layout, "x") || "x");
  const y = titleOf(scene ? scene.yaxis : layout[axisKey(trace.yaxis, "y")]) || plain(trace.name) || "y";
  const z = titleOf(scene?.zaxis) || plain(trace.colorbar?.title?.text) || plain(trace.name) || "value";
  return [x, y, z];
}

/** Stacked plots write the time only under the lowest one. */
function shared(layout, letter) {
  return Object.entries(layout).filter(([key]) => key.startsWith(`${letter}axis`)).map(([, axis]) => titleOf(axis)).find(Boolean);
}

function cell(value) {
  if (typeof value !== "number") return String(value);
  const size = Math.abs(value);
  return number(value, Number.isInteger(value) ? 0 : size >= 1000 ? 1 : size >= 10 ? 2 : size >= 0.01 ? 4 : 6);
}

/** Make the table of a figure. */
export function figureTable(figure, label) {
  const traces = figure.data.filter(hasData);
  if (traces.length === 0) return h("p", { class: "quiet" }, "There are no numbers behind this figure.");
  const place = h("div");
  const draw = (index, count) => {
    const trace = traces[index];
    const rows = rowsOf(trace);
    const head = headOf(trace, figure.layout).slice(0, rows[0]?.length ?? 2);
    show(place,
      table(`${label}: ${plain(trace.name) || "values"}`, h("tr", {}, head.map((text) => h("th", { class: "n", scope: "col" }, text))),
        rows.slice(0, count).map((row) => h("tr", {}, row.map((value) => h("td", { class: "n" }, cell(value)))))),
      rows.length > count && h("button", { class: "btn bare small", on: { click: () => draw(index, count + 5 * ROWS) } },
        `Showing ${number(count)} of ${number(rows.length)} rows; show more`));
  };
  draw(0, ROWS);
  if (traces.length === 1) return place;
  const choice = h("select", { ariaLabel: "Series shown in the table", on: { change: () => draw(Number(choice.value), ROWS) } },
    traces.map((trace, index) => h("option", { value: index }, plain(trace.name) || titleOf(figure.layout[axisKey(trace.yaxis, "y")]) || `Series ${index + 1}`)));
  return h("div", { class: "stack-gap" }, choice, place);
}
