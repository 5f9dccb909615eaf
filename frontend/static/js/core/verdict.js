/** Good, doubtful, bad: always a shape and a word, never only a colour. */

import { h } from "./dom.js";

const VERDICTS = {
  healthy: ["●", "healthy", "good"], doubtful: ["◐", "doubtful", "doubtful"], failed: ["■", "failed", "bad"],
};
const TRIP_STATES = {
  waiting: ["○", "waiting", "none"], decoding: ["◔", "decoding", "busy"], observing: ["◔", "observing", "busy"],
  mapping: ["◔", "updating the map", "busy"], assessing: ["◔", "assessing health", "busy"],
  failed: ["■", "failed", "bad"],
};

const CONFIDENCES = { sure: ["●", "sure", "good"], likely: ["◐", "likely", "doubtful"], weak: ["○", "weak", "none"] };

const HEALTH = { healthy: ["●", "healthy", "good"], alert: ["■", "changed", "bad"], unknown: ["○", "not known yet", "none"] };
const ALERTS = { open: ["■", "open", "bad"], seen: ["◐", "seen", "doubtful"], cleared: ["●", "over", "good"] };

const DELIVERIES = { waiting: ["○", "waiting", "none"], delivered: ["●", "delivered", "good"], dead: ["■", "given up", "bad"] };
const WEBHOOKS = { on: ["●", "active", "good"], off: ["○", "switched off", "none"], failing: ["◐", "failing", "doubtful"] };

const DRIVE_STATES = {
  waiting: ["○", "waiting", "none"], solving: ["◔", "solving", "busy"], infeasible: ["■", "impossible", "bad"], failed: ["■", "failed", "bad"],
  cancelled: ["□", "cancelled", "none"],
};
const DRIVE_VERDICTS = {
  optimal: ["●", "optimal", "good"], extremal: ["◐", "extremal", "doubtful"], "best found": ["◐", "best found", "doubtful"], rejected: ["■", "rejected", "bad"],
};

const mark = ([shape, word, kind]) => h("span", { class: `verdict ${kind}` }, h("span", { ariaHidden: "true" }, shape), word);

/** The observer's verdict, or nothing while there is none. */
export const verdictMark = (verdict) => (VERDICTS[verdict] ? mark(VERDICTS[verdict]) : null);

/** How sure a calibration is. */
export const confidenceMark = (confidence) => mark(CONFIDENCES[confidence] ?? CONFIDENCES.weak);

/** How a car is. */
export const healthMark = (state) => mark(HEALTH[state] ?? HEALTH.unknown);

/** How an alert stands. */
export const alertMark = (state) => mark(ALERTS[state] ?? ALERTS.open);

/** How a webhook's delivery stands. */
export const deliveryMark = (state) => mark(DELIVERIES[state]);

/** How a webhook does. */
export const webhookMark = (webhook) => mark(WEBHOOKS[!webhook.active ? "off" : webhook.failing_since ? "failing" : "on"]);

/** What to say of a trip in one word: its verdict once it is ready, else where it is. */
export function tripMark(trip) {
  if (trip.state === "ready" && VERDICTS[trip.verdict]) return verdictMark(trip.verdict);
  return mark(TRIP_STATES[trip.state] ?? ["●", trip.state, "none"]);
}

/** What to say of a drive in one word: the certificate's verdict once it is solved, else where it is. */
export const driveMark = (drive) => mark(DRIVE_VERDICTS[drive.verdict] && drive.state === "solved" ? DRIVE_VERDICTS[drive.verdict]
  : DRIVE_STATES[drive.state] ?? ["●", drive.state, "none"]);

/** A certificate's verdict. */
export const certificateMark = (verdict) => mark(DRIVE_VERDICTS[verdict] ?? ["○", verdict, "none"]);
