/** The car's health at a glance, beside the map. */

import { h, svg } from "../core/dom.js";
import { number } from "../core/format.js";
import { healthMark } from "../core/verdict.js";

const BARS = 16;
const MIDDLE = 20;

/** The changes of the latest trips as bars up and down from the usual. */
function bars(trend) {
  const values = trend.estimate.slice(-BARS);
  const top = Math.max(trend.band, ...values.map(Math.abs)) || 1;
  const width = 100 / values.length;
  const rects = values.map((value, i) => svg("rect", { x: i * width + 0.15 * width, width: 0.7 * width,
    y: MIDDLE - (MIDDLE * Math.max(value, 0)) / top, height: Math.max((MIDDLE * Math.abs(value)) / top, 0.6) },
  svg("title", {}, `${trend.names.at(i - values.length)}: ${number(value, 1)} ${trend.unit}`)));
  const words = `${trend.title} of the last ${values.length} trips, from ${number(Math.min(...values), 1)} to ${number(Math.max(...values), 1)} ${trend.unit} from the usual`;
  return svg("svg", { viewBox: "0 0 100 40", preserveAspectRatio: "none", class: "bars", role: "img", "aria-label": words }, rects);
}

/** The card: alerts in words, and the trend that matters most. */
export function healthCard(health) {
  if (health.trends.length === 0 && health.alerts.length === 0) return null;
  const trend = health.trends.find((one) => one.quantity === health.alerts[0]?.quantity) ?? health.trends[0];
  return h("section", { class: "card" }, h("header", {}, h("h2", {}, "Health"), healthMark(health.state)),
    health.alerts.length > 0 ? health.alerts.map((alert) => h("p", {}, h("strong", {}, alert.words), ".")) : h("p", {}, health.words),
    trend && [bars(trend), h("p", { class: "quiet small" }, `${trend.title}, trip by trip, from its usual.`)],
    h("p", {}, h("a", { href: "#health" }, health.alerts.length > 0 ? "See what to look at" : "See the trends")));
}
