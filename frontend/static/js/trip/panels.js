/** The tabs below the plots: operating points, how the file was decoded, all numbers, notes. */

import { API, at, get, patch } from "../core/api.js";
import { byId, h, show } from "../core/dom.js";
import { Figure } from "../core/figure.js";
import { busy, guarded } from "../core/notify.js";
import { report } from "./report.js";

/** Operating points over engine speed and torque. */
export function showPoints(trip) {
  new Figure(byId("points"), { label: "Operating points", height: 480 }).load(`${API}/${at("trips", trip.id, "/figures/points")}`);
}

/** What was found in the file, packet by packet. */
export function showDecoded(panel, trip) {
  show(panel, h("p", { class: "waiting" }, "Loading the report…"));
  const place = h("div");
  guarded(async () => {
    const answer = await get(at("trips", trip.id, "/decode-report"));
    show(panel, place, report(answer));
  }, place).then(() => panel.contains(place) || show(panel, place));
}

/** The summary and where it came from. */
export function showNumbers(panel, trip) {
  const about = { filter: trip.filter, tuning: trip.tuning, smoothed: trip.smoothed, code_version: trip.code_version, file: trip.filename, segment: trip.segment };
  show(panel, report({ summary: trip.summary, provenance: trip.provenance, run: about }));
}

/** Notes are saved on request and said to be. */
export function wireNotes(trip) {
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
