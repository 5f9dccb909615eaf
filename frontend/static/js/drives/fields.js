/** The fields of a problem as people write them: words, units, and the factor to SI. */

import { takeEngine, takeTransmission } from "./defaults.js";
import { KMH, substance } from "./words.js";

const number = (path, label, unit, more = {}) => ({ type: "number", path, label, unit, factor: 1, ...more });
const speed = (path, label, more = {}) => number(path, label, "km/h", { factor: KMH, ...more });

const VEHICLE = { title: "Car", folds: true, fields: [
  number("vehicle.mass_kg", "Mass", "kg"), number("vehicle.accelerated_mass_kg", "Accelerated mass", "kg", { help: "Counts what turns, too: wheels and engine." }),
  number("vehicle.cd", "Drag coefficient", ""), number("vehicle.frontal_area_m2", "Frontal area", "m²"), number("vehicle.crr", "Rolling resistance", "", { help: "Force over weight, for example 0.010." }),
  number("vehicle.wheel_radius_m", "Wheel radius", "m"), number("vehicle.air_density_kgpm3", "Air density", "kg/m³"), number("vehicle.gravity_mps2", "Gravity", "m/s²"),
] };

const RANGES = [
  { type: "numbers", path: "engine.speed_rpm", label: "Engine speed, lowest and highest", unit: "rpm", factor: 1 }, { type: "numbers", path: "engine.torque_nm", label: "Torque, lowest and highest", unit: "Nm", factor: 1 },
  { type: "points", path: "engine.full_load", label: "Full load", unit: "rpm Nm", optional: true, help: "One point a line; empty where only the highest torque limits." },
  number("engine.idle_fuel_power_w", "Burnt at idle", "kW", { factor: 1e-3, optional: true }),
];
const ENGINES = {
  map: [
    { type: "text", path: "engine.map", label: "Map", help: "A car’s identifier for its newest map, or CAR:VERSION." },
    { type: "choice", path: "engine.fit", label: "Formula through the map", options: [["", "Convex, through idle (default)"], ["phi", "Table 4.1 of the thesis"]], optional: true },
  ],
  phi: [{ type: "numbers", path: "engine.phi", label: "1/η: coefficients of 1, ω, T, ωT, ω², T²", unit: "", factor: 1, wide: true, help: "Engine speed ω in rad/s, torque T in Nm." }, ...RANGES],
  p_in: [{ type: "numbers", path: "engine.p_in", label: "Fuel power: coefficients", unit: "W", factor: 1, wide: true }, { type: "words", path: "engine.terms", label: "of the terms", unit: "", wide: true }, ...RANGES],
  willans: [
    { type: "numbers", path: "engine.willans", label: "c₀, c₁, c₂ of fuel power over wheel power", unit: "W", factor: 1, wide: true, help: "P_fuel = c₀ + c₁·P + c₂·P²; c₀ burns always." },
    { type: "numbers", path: "engine.power_w", label: "Wheel power, lowest and highest", unit: "kW", factor: 1e-3 }, { type: "numbers", path: "engine.force_n", label: "Wheel force, lowest and highest", unit: "kN", factor: 1e-3 },
  ],
};
const GEARS = [
  { type: "choice", path: "transmission.type", label: "Transmission", options: [["gears", "Gears"], ["cvt", "Continuously variable"]], takes: takeTransmission },
  { type: "numbers", path: "transmission.ratios", label: "Total ratios, first gear first", unit: "", factor: 1, wide: true, only: (problem) => problem.transmission?.type === "gears", help: "Turns of the engine for one of the wheel." },
  { type: "check", path: "transmission.neutral", label: "May roll in neutral", help: "The engine then burns what it does at idle." },
  number("transmission.shift_cost_j", "Charged for a shift", "kJ", { factor: 1e-3, optional: true, help: "Keeps a drive from changing gear for next to nothing. Not counted as fuel." }),
];
const BRAKES = number("brake_max_n", "Brakes, at most", "kN", { factor: 1e-3, optional: true, help: "With gears they act in neutral." });
const WISHES = {
  accelerate: [speed("from_speed_mps", "From"), speed("to_speed_mps", "To"),
    { type: "time", path: "time_s", label: "In which time", words: ["Free: whatever takes least", "Exactly"] }],
  distance: [speed("from_speed_mps", "Starting at"), number("distance_m", "Distance", "m"), { type: "note", text: "On the level, in any time, to any speed at its end." }],
  route: [{ type: "road", path: "road", label: "Road" }, speed("from_speed_mps", "Starting at"), speed("to_speed_mps", "Ending at"), speed("min_speed_mps", "Never below"),
    { type: "time", path: "max_time_s", label: "In which time", words: ["Free: whatever takes least", "At most"] }, BRAKES],
  ball_and_wheel: [number("x1", "x₁ at the start", ""), number("x2", "x₂ at the start", ""), number("u_min", "Lowest control", "", { help: "Below 0." }), number("u_max", "Highest control", "", { help: "Above 0." }), number("gamma", "γ", "", { help: "x₁′ = x₂ and x₂′ = γ u." })],
};
/** What counts besides fuel: carbon dioxide, and every emission that has a map. */
const costOf = (problem) => [
  number("cost.weights.fuel", "Weight of fuel", "", { optional: true, help: "Empty: 1." }),
  ...["co2", ...Object.keys(problem.cost?.emissions ?? {})].map((name) => number(`cost.weights.${name}`, `Weight of ${substance(name)}`, "kJ/g", { factor: 1e-3, optional: true })),
  { type: "json", path: "cost.emissions", label: "Emission maps (JSON)", unit: "", optional: true, wide: true, redraws: true,
    help: "{\"nox\": {\"rpm\": […], \"nm\": […], \"gps\": [[…]]}}: g/s over engine speed and torque, a row for each engine speed." },
];

const ENGINE_WORDS = { map: "The car’s map", phi: "A formula of 1/η", p_in: "A formula of fuel power", willans: "A Willans line at the wheels" };
const ENGINE_CHOICE = { type: "choice", path: "engine", label: "Given by", options: Object.entries(ENGINE_WORDS), now: (problem) => engineOf(problem), takes: takeEngine };

/** What a folded group holds, in a few words. */
const brief = {
  Engine: (problem) => ENGINE_WORDS[engineOf(problem)].toLowerCase(),
  Gears: ({ transmission: t }) => (t?.type === "cvt" ? "continuously variable" : `${t?.ratios?.length ?? 0} gears${t?.neutral ? " and neutral" : ""}`),
  Car: ({ vehicle: v }) => [v?.mass_kg && `${Math.round(v.mass_kg)} kg`, v?.cd && v?.frontal_area_m2 && `drag area ${(v.cd * v.frontal_area_m2).toFixed(2)} m²`].filter(Boolean).join(", "),
  "Weights and emissions": ({ cost }) => (cost ? Object.keys({ fuel: 1, ...cost.weights }).map(substance).join(", ") : "fuel alone"),
};

/** What kind of engine a problem has. */
export const engineOf = (problem) => Object.keys(ENGINES).find((name) => problem.engine?.[name] !== undefined) ?? "phi";

/** Groups of fields of a problem, in the order in which one thinks of them. */
export function groupsOf(problem) {
  const wish = { title: "", fields: WISHES[problem.kind] ?? [] };
  if (problem.kind === "ball_and_wheel") return [wish];
  const willans = engineOf(problem) === "willans";
  const groups = [wish, { title: "Engine", folds: true, fields: [ENGINE_CHOICE, ...ENGINES[engineOf(problem)]] }, { title: "Gears", folds: true, fields: GEARS }, VEHICLE, { title: "Weights and emissions", folds: true, fields: costOf(problem) }];
  return groups.filter((group) => !(willans && group.title === "Gears")).map((group) => ({ ...group, brief: brief[group.title]?.(problem), fields: group.fields.filter((field) => !field.only || field.only(problem)) }));
}
