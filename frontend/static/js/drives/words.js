/** How drives are told: kinds, verdicts, energies and speeds as people read them. */

import { measure, measureText, number } from "../core/format.js";

export const KINDS = { accelerate: "Acceleration", distance: "Distance", route: "Road", ball_and_wheel: "Ball on a wheel" };
export const KMH = 3.6;
const MEGA = 1e7;

/** Energy of the fuel; megajoules where kilojoules would be long. */
export const energy = (joules) => (Math.abs(joules) >= MEGA ? measure(joules / 1e6, "MJ", 2) : measure(joules / 1e3, "kJ", 1));

/** The same as plain text. */
export const energyText = (joules) => (Math.abs(joules) >= MEGA ? measureText(joules / 1e6, "MJ", 2) : measureText(joules / 1e3, "kJ", 1));

/** Metres, or kilometres from one on. */
export const way = (metres) => (Math.abs(metres) >= 1000 ? measure(metres / 1000, "km", metres < 1e5 ? 2 : 1) : measure(metres, "m", 1));

/** Seconds with a tenth, or minutes and seconds. */
export function timeText(seconds) {
  if (!Number.isFinite(seconds)) return "–";
  if (seconds < 120) return measureText(seconds, "s", seconds < 10 ? 2 : 1);
  const whole = Math.round(seconds);
  return `${number(Math.floor(whole / 60))}\u202fmin ${number(whole % 60)}\u202fs`;
}

/** A share as per cent, small ones with a power of ten. */
export function shareText(share) {
  if (!Number.isFinite(share)) return "–";
  const percent = 100 * share;
  if (percent === 0) return "0\u202f%";
  const power = Math.floor(Math.log10(Math.abs(percent)));
  if (power >= -3) return `${number(percent, Math.max(0, 1 - power))}\u202f%`;
  return `${tiny(percent)}\u202f%`;
}

const SUBSTANCES = { co2: "CO₂", nox: "NOₓ", hc: "HC", co: "CO", pm: "particles" };

/** An emission as people write it. */
export const substance = (name) => SUBSTANCES[name] ?? name;

const RAISED = [..."⁰¹²³⁴⁵⁶⁷⁸⁹"];

/** A number with so many digits, as `1.6 × 10⁻⁶` where it is very small or large. */
export function tiny(value, digits = 2) {
  if (!Number.isFinite(value)) return "–";
  if (value === 0) return "0";
  const power = Math.floor(Math.log10(Math.abs(value)));
  if (power >= -2 && power < 4) return number(value, Math.max(0, digits - 1 - power));
  const raised = [...String(Math.abs(power))].map((digit) => RAISED[Number(digit)]).join("");
  return `${number(value / 10 ** power, digits - 1)}\u202f×\u202f10${power < 0 ? "⁻" : ""}${raised}`;
}
