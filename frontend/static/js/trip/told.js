/** What the trip's sensors can tell of each state, what is lost with each of them, and what every minute tells. */

import { API, at, get } from "../core/api.js";
import { h, show } from "../core/dom.js";
import { Figure } from "../core/figure.js";
import { percent } from "../core/format.js";
import { problemBox } from "../core/notify.js";
import { table } from "../core/ui.js";
import { signal } from "./signals.js";

const SENSORS = {
  vss: "Wheel ticks", speed: "Reported speed", acc: "Accelerometer", gps: "Satellites", dem: "Road heights", fuel: "Fuel", engine: "Engine turns",
  heading: "Compass", pitch: "Pitch", yaw_rate: "Gyroscope", curvature_h: "Road curvature", engine_torque: "Torque",
};
const SIGNS = {
  always: ["●", "good", "Told"], changing: ["◐", "doubtful", "Told only while speed, direction and slope change"], never: ["○", "bad", "Not told"],
};
const FIGURE_PX = 440;

const named = (lost) => lost.map((sensor) => SENSORS[sensor] ?? sensor.replaceAll("_", " ")).join(" and ").replace(/ and (.)/g, (_, letter) => ` and ${letter.toLowerCase()}`);

/** When a state is told: moving or standing, with these sensors lost. */
const when = (loss, state, standing) => (standing ? { true: "always", false: "never" }[loss.standing[state]] : loss.moving[state]);

function sign(value, usual) {
  const [mark, kind, words] = SIGNS[value];
  return h("td", { class: value === usual ? "mark" : "mark lost" }, h("span", { class: `sign ${kind}`, ariaHidden: "true" }, mark), h("span", { class: "visually-hidden" }, words));
}

function lossTable({ losses, states }, standing) {
  const th = (text, props = {}) => h("th", { scope: "col", class: "mark", ...props }, text);
  const [whole, ...rest] = losses;
  const head = [
    h("tr", {}, h("th", { scope: "col", rowSpan: 2 }, "State"), th("With all", { rowSpan: 2 }), rest.length > 0 && th("Without", { colSpan: rest.length, scope: "colgroup" }), th("Minutes that tell it", { rowSpan: 2, class: "n" })),
    h("tr", {}, rest.map((loss) => th(named(loss.lost)))),
  ];
  const rows = Object.entries(states).map(([state, { told_share: share }]) => h("tr", {}, h("th", { scope: "row" }, signal(state).label),
    losses.map((loss) => sign(when(loss, state, standing), when(whole, state, standing))), h("td", { class: "n" }, percent(share, 0))));
  return table(`What is told ${standing ? "at a standstill" : "on the move"}, with all sensors and without each of them`, head, rows, "told");
}

function legend() {
  return h("p", { class: "quiet small signs" }, Object.values(SIGNS).map(([mark, kind, words]) => h("span", {}, h("span", { class: `sign ${kind}`, ariaHidden: "true" }, mark), ` ${words}`)));
}

/** Fill the panel. */
export async function showTold(panel, trip) {
  show(panel, h("p", { class: "waiting" }, "Loading what the sensors tell…"));
  let told;
  try {
    told = await get(at("trips", trip.id, "/observability"));
  } catch (error) {
    show(panel, problemBox(error));
    return;
  }
  const place = h("div", {});
  const draw = (standing) => show(place, lossTable(told, standing));
  const choice = (text, standing) => h("label", {}, h("input", { type: "radio", name: "told-when", checked: !standing, on: { change: () => draw(standing) } }), h("span", {}, text));
  const minutes = h("div", { class: "figure" });
  show(panel,
    h("section", { class: "card" }, h("header", {}, h("h2", {}, "What the sensors tell, and what is lost with each"),
      h("fieldset", { class: "segmented" }, h("legend", { class: "visually-hidden" }, "The car is"), choice("Moving", false), choice("Standing", true))),
    place, legend()),
    h("div", { class: "columns section" },
      h("section", { class: "card" }, h("h2", {}, "In words"), h("ul", { class: "reasons section" }, told.losses.map(({ words }) => h("li", {}, words))),
        h("p", { class: "quiet small section" }, "A state is told when no two values of it give the same measurements: the rank test on the model's equations, whatever the noise.", told.sensors.includes("dem") && " Road heights are looked up at positions, so without satellites they usually go, too.")),
      h("section", { class: "card" }, h("h2", {}, "What each minute tells by itself"),
        h("p", { class: "quiet small" }, "Strong colour: the minute's own measurements tell it closely. Blank: they say nothing of it. A state counts as told where less than a fifth of the uncertainty is left that one has without any sensor. It is the least uncertainty possible; the observer, whose thrust may change at any time, has the minutes around it instead."), minutes)));
  draw(false);
  new Figure(minutes, { label: "What each minute tells", height: FIGURE_PX, tall: true }).load(`${API}/${at("trips", trip.id, "/figures/told")}`);
}
