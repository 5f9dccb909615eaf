/** A trip as a display in the car would have shown it: arrow to the target speed, efficiency meter, costate meter. */

import { at, get } from "../core/api.js";
import { byId, checked, h, show } from "../core/dom.js";
import { clockAt, measureText, number } from "../core/format.js";
import { announce, problemBox } from "../core/notify.js";
import { Arrow, Gauge } from "../dash/gauge.js";
import { Player } from "../dash/player.js";

const KMH = 3.6;
const ON_TARGET_KMH = 1.5;
const STRONG_KMH = 12;
const JOULES_PER_ML = 32e3; // of petrol; the display gives energy in the millilitres a driver knows
const VIRIDIS = ["#440154", "#3b528b", "#21918c", "#5ec962", "#fde725"];
const TELL_EVERY_S = 15;
const { tripId } = document.body.dataset;

const arrow = new Arrow();
const efficiency = new Gauge({ top: 50, unit: "%", stops: VIRIDIS });
const worth = new Gauge({ top: 10, unit: "ml" });

/** The reading of a moment: numbers between two steps, all else as it was at the step before. */
function reader(trip) {
  const { columns, step_s: step } = trip;
  const last = columns.t_s.length - 1;
  return (t) => {
    const k = Math.min(last, Math.floor(t / step));
    const part = k < last ? t / step - k : 0;
    const between = (name) => {
      const [from, to] = [columns[name][k], columns[name][Math.min(last, k + 1)]];
      return from === null || to === null ? from : from + part * (to - from);
    };
    return { between, held: (name) => columns[name][k] };
  };
}

function showSpeed({ between, held }) {
  const [now, target] = [between("speed_mps"), between("target_mps")];
  const off = target === null ? null : KMH * (target - now);
  const close = off !== null && Math.abs(off) < ON_TARGET_KMH;
  arrow.show(off === null ? null : close ? 0 : off, Math.min(1, Math.abs(off ?? 0) / STRONG_KMH));
  byId("dash-now").textContent = number(KMH * now);
  byId("dash-target").textContent = off === null ? "no target here" : close ? `on target, ${measureText(KMH * target, "km/h")}`
    : `${off > 0 ? "faster" : "slower"}: target ${measureText(KMH * target, "km/h")}`;
  const [gear, best] = [held("gear"), held("best_gear")];
  const named = (g) => (g ? `gear ${number(g)}` : "clutch open");
  byId("dash-gear").textContent = gear === null ? "" : best === null || best === gear ? named(gear) : `${named(gear)}, better ${named(best)}`;
}

function showEfficiency({ between }) {
  const value = between("efficiency");
  if (value === null) {
    efficiency.show(null, "no fuel");
    show(byId("dash-split"));
    return;
  }
  const sd = between("efficiency_sd") ?? 0;
  efficiency.show(100 * value, `${number(100 * value)} ± ${number(Math.max(1, 100 * sd))} %`, 100 * sd);
  const parts = [["speed", "to_speed"], ["height", "to_height"], ["air and tyres", "to_resistance"]];
  show(byId("dash-split"), parts.map(([word, name]) => h("span", {}, `${word} ${number(100 * between(name))} %`)));
}

function showWorth({ between }) {
  const costate = between("costate");
  const ml = costate === null ? null : costate / KMH / JOULES_PER_ML;
  worth.show(ml, ml === null ? "not known here" : `${number(ml, 1)} ml`);
  byId("dash-worth-why").textContent = ml === null ? "" : "of fuel, if the rest is driven at its best";
}

function start(trip) {
  const read = reader(trip);
  let told = -TELL_EVERY_S;
  const player = new Player(trip.columns.t_s.length * trip.step_s, (t) => {
    const moment = read(t);
    showSpeed(moment);
    showEfficiency(moment);
    showWorth(moment);
    byId("dash-clock").textContent = clockAt(trip.started_at, t);
    byId("dash-slider").value = String(t);
    if (player.playing && Math.abs(t - told) >= TELL_EVERY_S * player.times) {
      told = t;
      announce(`${byId("dash-now").textContent} km/h, ${byId("dash-target").textContent}`);
    }
  });
  const [play, slider] = [byId("dash-play"), byId("dash-slider")];
  slider.max = String(player.duration);
  slider.setAttribute("aria-describedby", "dash-help");
  slider.addEventListener("input", () => player.set(Number(slider.value)));
  play.addEventListener("click", () => player.toggle());
  player.changed = () => { play.textContent = player.playing ? "Pause" : "Play"; };
  for (const one of document.querySelectorAll("input[name=dash-times]")) one.addEventListener("change", () => { player.times = Number(checked("dash-times")); });
  addEventListener("keydown", (event) => {
    if (event.target.closest("button, a, .segmented")) return;
    if (player.key(event)) event.preventDefault();
  });
  document.addEventListener("visibilitychange", () => document.hidden && player.pause());
  player.set(0);
}

try {
  const trip = await get(at("trips", tripId, "/dashboard"));
  byId("dash-title").textContent = trip.name;
  document.title = `${trip.name} · Dashboard · Ponthy`;
  show(byId("dash-arrow"), arrow.node);
  show(byId("dash-efficiency"), efficiency.node);
  show(byId("dash-worth"), worth.node);
  byId("dash-note").hidden = !trip.reason;
  byId("dash-note").textContent = trip.reason && `There is no target to show: ${trip.reason}`;
  byId("dash-face").hidden = byId("dash-foot").hidden = false;
  start(trip);
} catch (error) {
  show(byId("problem"), problemBox(error));
}
