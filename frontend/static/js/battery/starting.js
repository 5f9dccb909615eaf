/** What a new battery starts from: typical open-circuit curves, and a circuit that fits its size. */

const CURVES = {
  lfp: [[0, 2.6], [0.05, 3.08], [0.1, 3.2], [0.2, 3.25], [0.3, 3.28], [0.4, 3.295], [0.5, 3.302], [0.6, 3.313], [0.7, 3.328], [0.8, 3.335], [0.9, 3.342], [0.97, 3.36], [1, 3.45]],
  nmc: [[0, 3], [0.05, 3.35], [0.1, 3.46], [0.2, 3.56], [0.3, 3.61], [0.4, 3.65], [0.5, 3.71], [0.6, 3.8], [0.7, 3.89], [0.8, 3.98], [0.9, 4.07], [1, 4.19]],
  lmo: [[0, 3.2], [0.05, 3.5], [0.1, 3.63], [0.2, 3.73], [0.3, 3.8], [0.4, 3.86], [0.5, 3.92], [0.6, 3.97], [0.7, 4.01], [0.8, 4.05], [0.9, 4.1], [1, 4.18]],
};

/** Chemistries by name. */
export const CHEMISTRIES = { nmc: "NMC or NCA", lfp: "LFP (iron phosphate)", lmo: "LMO (manganese)" };

const OHM_AH = 0.02; // resistance times capacity: an ordinary power cell
const RELAXATION_S = 30;

/** A configuration to start from: series and relaxation resistance fall with the size of the cell. */
export function startingConfig(chemistry, ratedAh, series, parallel) {
  const resistance = Number((OHM_AH / ratedAh).toPrecision(3));
  return {
    ocv: structuredClone(CURVES[chemistry]), series, parallel, rated_capacity_ah: ratedAh,
    initial: { capacity_ah: ratedAh, resistance_ohm: resistance, relaxation_resistance_ohm: resistance, relaxation_capacitance_f: Number((RELAXATION_S / resistance).toPrecision(3)) },
  };
}
