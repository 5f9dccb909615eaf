/** The tabs below the plots: operating points, how the file was decoded, all numbers, notes. */

import { API, at, get, patch } from "../core/api.js";
import { byId, h, show } from "../core/dom.js";
import { Figure } from "../core/figure.js";
import { busy, guarded } from "../core/notify.js";
import { report } from "./report.js";
import { showTorques } from "./torques.js";

/** Operating points over engine speed and torque. */
export function showPoints(_panel, trip) {
  new Figure(byId("points"), { label: "Operating points", height: 480 }).load(`${API}/${at("trips", trip.id, "/figures/points")}`);
  guarded(() => showTorques(byId("torques"), trip), byId("torques"));
}

/** What was found in the file, packet by packet. */
export function showDecoded(panel, trip) {
  const place = h("div");
  show(panel, place, h("p", { class: "waiting" }, "Loading the report…"));
  guarded(async () => {
    const { report: details, ...answer } = await get(at("trips", trip.id, "/decode-report"));
    show(panel, place, report({ ...answer, ...details }));
  }, place);
}

/** The summary and where it came from. */
export function showNumbers(panel, trip) {
  show(panel, report({ summary: trip.summary, provenance: { file: trip.filename, ...trip.provenance } }));
}

/** Notes are saved on request and said to be. */
export function wireNotes(_panel, trip) {
  const [area, state] = [byId("notes"), byId("notes-state")];
  area.value = trip.notes ?? "";
  area.addEventListener("input", () => { state.textContent = "Not saved yet"; });
  byId("notes-form").addEventListener("submit", (event) => {
    event.preventDefault();
    busy(event.submitter, async () => {
      Object.assign(trip, await patch(at("trips", trip.id), { notes: area.value }));
      state.textContent = "Saved";
    });
  });
}
