/** The fields of a battery's configuration as people write them: words, units, and the factor to what is kept. */

import { ESTIMATORS } from "./words.js";

const number = (path, label, unit, more = {}) => ({ type: "number", path, label, unit, factor: 1, ...more });
const optional = (path, label, unit, more = {}) => number(path, label, unit, { optional: true, ...more });
const MILLI = { factor: 1e3 };

const CELL = { heading: "Pack and cell", fields: [
  number("series", "Cells in series", "", { help: "Divides the voltage." }), number("parallel", "Strings side by side", "", { help: "Divides the current." }),
  optional("rated_capacity_ah", "Rated capacity of one cell", "Ah", { help: "When new; the state of health is a share of it. Empty: the capacity to begin with." }),
  { type: "choice", path: "estimator", label: "Estimated with", options: [["", "The default"], ...Object.entries(ESTIMATORS)] },
] };
const CIRCUIT = { heading: "What an estimate begins with", fields: [
  number("initial.capacity_ah", "Capacity of a cell", "Ah"), number("initial.resistance_ohm", "Series resistance", "mΩ", MILLI), number("initial.relaxation_capacitance_f", "Relaxation capacitance", "F"),
  number("initial.relaxation_resistance_ohm", "Relaxation resistance", "mΩ", MILLI), optional("initial.soc", "State of charge", "0 to 1", { help: "Empty: looked up from the first voltage at rest." }),
] };
const SENSORS = { title: "Sensors", folds: true, fields: [
  optional("voltage_noise_v", "Noise of the voltage", "mV", { ...MILLI, help: "Standard deviation. Empty: found from the residuals." }), optional("current_noise_a", "Noise of the current", "mA", MILLI),
  optional("current_bias_a", "Constant error of the current", "mA", { ...MILLI, help: "How far it may be off, one cell’s share." }),
] };
const CERTAINTY = { title: "How sure one is to begin with", folds: true, fields: [
  ...[["capacity_ah", "Capacity"], ["resistance_ohm", "Series resistance"], ["relaxation_capacitance_f", "Relaxation capacitance"], ["relaxation_resistance_ohm", "Relaxation resistance"]]
    .map(([name, label]) => optional(`initial_sd.${name}`, `${label}, ±`, "share", { help: "0.1 is a tenth of the value." })),
  optional("initial_sd.soc", "State of charge, ±", "0 to 1", { help: "0.1 is ten per cent of a full charge." }),
] };
const WARMTH = { title: "Temperature and hysteresis", folds: true, fields: [
  optional("temperature.reference_c", "Parameters hold at", "°C"), optional("temperature.resistance_k", "B of the series resistance", "K", { help: "R(T) = R · exp(B (1/T − 1/T_ref))." }),
  optional("temperature.relaxation_k", "B of the relaxation", "K"), optional("temperature.capacity_per_k", "Capacity gained", "share/K", { help: "0.004 is 0.4 % a kelvin." }),
  optional("hysteresis.voltage_v", "Hysteresis of the voltage", "mV", MILLI), optional("hysteresis.rate", "Its rate", "per capacity"),
] };
const REPORT = { title: "The report’s estimator", folds: true, fields: [
  optional("terms", "Terms of the expansion", ""), { type: "numbers", path: "sigma_range_1ps", label: "Rate of the relaxation, lowest and highest", unit: "1/s", factor: 1 },
  optional("forgetting", "Forgetting", "per second"), optional("start_after_s", "Parameters stay as given for", "s"),
  ...["alpha", "r", "beta", "xi", "x10"].map((name) => optional(`gains.${name}`, `Gain Γ of ${name}`, "")),
] };
const CURVE = { fields: [{ type: "note", text: "The open-circuit curve has a tab of its own, where it can also be fitted." }] };

/** All groups; what is folded away says nothing that a beginner must know. */
export const configGroups = () => [CELL, CIRCUIT, CURVE, SENSORS, CERTAINTY, WARMTH, REPORT];
