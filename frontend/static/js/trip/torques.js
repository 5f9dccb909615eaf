/** The torque that the engine reports beside the one that the car's motion tells: a figure, and what the difference is made of. */

import { API, at, get } from "../core/api.js";
import { h, show } from "../core/dom.js";
import { Figure } from "../core/figure.js";

const FIGURE_PX = 780;

/** Fill the place below the operating points; it stays empty where the engine reports no torque. */
export async function showTorques(place, trip) {
  if (!trip.summary.torques_compared) return;
  const found = await get(at("trips", trip.id, "/torque-sources"));
  const box = h("div", { class: "figure" });
  show(place, h("section", { class: "card section" }, h("h2", {}, "The engine's own torque beside the car's motion"),
    h("p", { class: "quiet small" }, "The observer ran once more without the reported torque, so that the two know nothing of each other. Each dot is a sample of the reported torque; the dotted line is where both agree."),
    box, h("h3", { class: "section" }, "Why they differ, as far as this trip tells"), h("ul", { class: "reasons" }, found.words.map((text) => h("li", {}, text)))));
  new Figure(box, { label: "Reported torque beside the car's motion", height: FIGURE_PX, tall: true }).load(`${API}/${at("trips", trip.id, "/figures/torque-sources")}`);
}
