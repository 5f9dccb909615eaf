/** The observer's columns as people read them; words, units and decimals come with the page from the server's one table. */

const QUANTITIES = JSON.parse(document.body.dataset.quantities ?? "{}");
const GROUPS = {
  Motion: ["speed_mps", "thrust_n", "power_w", "distance_m"],
  Engine: ["efficiency", "torque_nm", "engine_speed_radps", "gear", "fuel_power_w", "fuel_energy_j", "engine_angle_rad"],
  Road: ["alt_m", "pitch_rad", "heading_rad", "curvature_h_radpm", "curvature_v_radpm"],
  Position: ["lat_deg", "lon_deg", "north_m", "east_m", "down_m"],
};

/** A column as the page shows it: `{label, unit, factor, decimals}`. */
export const signal = (name) => QUANTITIES[name] ?? { label: name, unit: "", factor: 1, decimals: 3 };

/** All columns by group, for choosing: `[[group, [name, …]], …]`. */
export function signalGroups() {
  const known = Object.entries(GROUPS).map(([group, names]) => [group, names.filter((name) => name in QUANTITIES)]);
  const placed = new Set(known.flatMap(([, names]) => names));
  return [...known, ["Sensors", Object.keys(QUANTITIES).filter((name) => !placed.has(name))]].filter(([, names]) => names.length > 0);
}

export const DEFAULT_SIGNALS = ["speed_mps", "thrust_n", "torque_nm", "engine_speed_radps", "efficiency"];
const KEY = "ponthy-signals";

/** The signals this reader likes to see stacked. */
export function chosenSignals() {
  try {
    const kept = JSON.parse(localStorage.getItem(KEY) ?? "null");
    const known = Array.isArray(kept) ? kept.filter((name) => name in QUANTITIES) : [];
    return known.length ? known : DEFAULT_SIGNALS;
  } catch {
    return DEFAULT_SIGNALS;
  }
}

/** Keep the choice in this browser. */
export function keepSignals(names) {
  try {
    localStorage.setItem(KEY, JSON.stringify(names));
  } catch {
    // Storage is blocked: the choice holds for this page only.
  }
}
