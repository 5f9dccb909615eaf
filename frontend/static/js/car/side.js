/** Around the map: the best point in words, what the map covers, idle and full load, and consumption trip by trip. */

import { h, svg } from "../core/dom.js";
import { measureText, number, percent, plural, when } from "../core/format.js";
import { coverage, spread, trusted } from "./map-numbers.js";

const BARS = 24;

function bestCard({ best }) {
  return h("section", { class: "card" }, h("h2", {}, "Best point"),
    best ? [
      h("p", { class: "big" }, percent(best.efficiency)),
      h("p", {}, `at ${measureText(best.rpm, "rpm")} and ${measureText(best.nm, "Nm")}`),
      best.rpm_high > best.rpm_low && h("p", { class: "quiet" },
        `as good within 0.2 points from ${number(best.rpm_low)} to ${measureText(best.rpm_high, "rpm")}, ${number(best.nm_low)} to ${measureText(best.nm_high, "Nm")}`),
      h("p", { class: "quiet" }, best.bsfc_gpkwh ? `${measureText(best.bsfc_gpkwh, "g/kWh")}, ` : "", `spread ±${number(200 * best.sd, 1)} points (2σ)`),
    ] : h("p", { class: "quiet" }, "No cell has enough points yet. More driving under load fills the map."));
}

function confidenceCard(map, version) {
  const share = coverage(map);
  const around = spread(map);
  const row = (name, value) => [h("dt", {}, name), h("dd", {}, value)];
  return h("section", { class: "card" }, h("h2", {}, "How sure"),
    h("dl", { class: "pairs" },
      row("Trusted cells", number(trusted(map).length)), row("Cells seen", number(map.cells.length)),
      row("Below full load", percent(share, 0)), row("Spread, 2σ", around === null ? "–" : `±${number(100 * around, 1)} points`),
      version && [row("Points", number(version.points)), row("From", plural(version.trips, "trip")), row("Version", version.version), row("Made", when(version.created_at))]),
    h("p", { class: "quiet small" }, `Cells of ${number(map.cell.rpm)} rpm × ${number(map.cell.nm)} Nm; fainter ones have fewer points, blank ones none.`));
}

/** The engine at idle, and how much of its full load was seen. */
function limitsCard({ idle, full_load_reached: reached }) {
  const known = (reached ?? []).filter(Boolean).length;
  if (!idle && !reached?.length) return null;
  return h("section", { class: "card" }, h("h2", {}, "Idle and full load"),
    idle ? h("dl", { class: "pairs" },
      h("dt", {}, "Idle"), h("dd", {}, `${number(idle.rpm)} ± ${measureText(2 * idle.rpm_sd, "rpm")}`),
      h("dt", {}, "It burns"), h("dd", {}, measureText(idle.litres_per_hour, "L/h", 2)))
      : h("p", { class: "quiet small" }, "No stop with the engine running, or its fuel is unknown."),
    h("p", { class: "quiet small" }, known > 0
      ? `Full load was reached at ${number(known)} of ${number(reached.length)} engine speeds; elsewhere the dotted line is the most that was seen.`
      : "Full load was not reached: the dotted line is the most that was seen."));
}

/** What the map's makers could not believe, with what to check. */
function doubtsCard({ warnings }) {
  if (!warnings?.length) return null;
  return h("section", { class: "card" }, h("h2", {}, "Doubtful"), warnings.map((warning) => h("p", {}, warning)));
}

/** Consumption of the latest trips as bars, oldest first; each can be reached as a link by its trip's row instead. */
function trendCard(trips) {
  const known = trips.filter((trip) => trip.fuel_l > 0 && trip.distance_m > 1000).slice(0, BARS).reverse();
  if (known.length < 2) return null;
  const values = known.map((trip) => (1e5 * trip.fuel_l) / trip.distance_m);
  const top = Math.max(...values);
  const width = 100 / known.length;
  const bars = known.map((trip, i) => svg("rect", { x: i * width + 0.15 * width, width: 0.7 * width, y: 40 * (1 - values[i] / top), height: (40 * values[i]) / top,
    class: trip.in_map ? "" : "out" }, svg("title", {}, `${trip.name}: ${number(values[i], 1)} L/100 km`)));
  const words = `From ${number(Math.min(...values), 1)} to ${number(top, 1)} L/100 km over the last ${known.length} trips`;
  return h("section", { class: "card" }, h("h2", {}, "Consumption, trip by trip"),
    svg("svg", { viewBox: "0 0 100 40", preserveAspectRatio: "none", class: "bars", role: "img", "aria-label": words }, bars),
    h("p", { class: "quiet small" }, `${words}.`));
}

/** The cards beside the map, with what the car's scores and its health say among them. */
export const sideCards = (map, version, score, health) => [bestCard(map), score, health, doubtsCard(map), confidenceCard(map, version)];

/** The cards below the map. */
export const belowCards = (map, trips) => [limitsCard(map), trendCard(trips)];
