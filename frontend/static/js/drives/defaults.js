/** What a free problem starts from: the thesis' car (Sebesta 2010, 4.4), and an ordinary wish for each kind. */

const VEHICLE = {
  mass_kg: 920, accelerated_mass_kg: 948, cd: 0.39, frontal_area_m2: 1.93, crr: 0.01, air_density_kgpm3: 1.2, gravity_mps2: 9.805, wheel_radius_m: 0.2954,
};
const ENGINE = {
  phi: [9.436, -0.018136, -0.068797, 3.7201e-6, 2.1965e-5, 3.6204e-4], speed_rpm: [1000, 6000], torque_nm: [10, 100], full_load: null, idle_fuel_power_w: 0,
};
const { phi: COEFFICIENTS, ...LIMITS } = ENGINE;
/** The same engine by its fuel power, and one that is known from the wheels only. */
const ENGINES = {
  phi: ENGINE, p_in: { p_in: COEFFICIENTS, terms: ["wT", "w2T", "wT2", "w2T2", "w3T", "wT3"], ...LIMITS }, willans: { willans: [5000, 2.2, 1e-5], power_w: [0, 40000], force_n: [-3000, 4000] },
};
const GEARS = { type: "gears", ratios: [13.25, 9.604, 7.37, 5.796, 4.208, 3.23], neutral: false, shift_cost_j: 0 };
const CVT = { type: "cvt", neutral: false };
const IDLE_W = 6000;
const SHIFT_J = 2000; // or gears change for next to nothing
const BRAKES_N = 5500;
const LIMIT_MPS = 25;

/** Two kilometres over a hill. */
const HILL = {
  distance_m: [0, 400, 800, 1200, 1600, 2000], elevation_m: [0, 4, 22, 30, 12, 10], speed_limit_mps: [LIMIT_MPS, LIMIT_MPS, LIMIT_MPS, LIMIT_MPS, LIMIT_MPS, LIMIT_MPS],
};

const WISHES = {
  accelerate: { from_speed_mps: 10, to_speed_mps: 100 / 3.6, time_s: null },
  distance: { from_speed_mps: 10, distance_m: 1000 },
  route: { road: HILL, from_speed_mps: 15, to_speed_mps: 15, min_speed_mps: 5, max_time_s: 120, brake_max_n: BRAKES_N },
};
const BALL = { kind: "ball_and_wheel", x1: 1, x2: 0.5, u_min: -1, u_max: 1, gamma: 1 };

/** A complete problem of a kind. */
export function freeProblem(kind) {
  if (kind === "ball_and_wheel") return structuredClone(BALL);
  const rolls = kind === "route" ? { engine: { ...ENGINE, idle_fuel_power_w: IDLE_W }, transmission: { ...GEARS, neutral: true, shift_cost_j: SHIFT_J } } : {};
  return structuredClone({ kind, vehicle: VEHICLE, engine: ENGINE, transmission: kind === "distance" ? CVT : GEARS, ...WISHES[kind], ...rolls });
}

/** Give a problem an engine of another sort to start from; a drive known from the wheels has no gears. */
export function takeEngine(problem, sort, carId) {
  problem.engine = structuredClone(sort === "map" ? { map: carId, fit: "willans" } : ENGINES[sort]);
  if (sort === "willans") delete problem.transmission;
  else problem.transmission ??= structuredClone(problem.kind === "distance" ? CVT : GEARS);
}

/** Gears need ratios, a CVT has none. */
export function takeTransmission(problem, type) {
  const { ratios, ...others } = problem.transmission;
  problem.transmission = type === "cvt" ? { ...others, type } : { ...others, type, ratios: ratios ?? [...GEARS.ratios] };
}
