/** How one knows: the certificate's numbers, each with what it means, and the Hamiltonian along the drive. */

import { API, at } from "../core/api.js";
import { h, show } from "../core/dom.js";
import { Figure } from "../core/figure.js";
import { table } from "../core/ui.js";
import { certificateMark } from "../core/verdict.js";
import { energyText, shareText, tiny } from "./words.js";

const FIGURE_PX = 360;
const VERDICTS = {
  optimal: "The maximum principle holds all along the drive, and no other drive can burn noticeably less: the gap to an independent lower bound is closed.",
  extremal: "The maximum principle holds all along the drive, but the gap to an independent lower bound is not closed. A better drive may exist, by no more than that gap.",
  "best found": "This is the best drive that was found. It is not proven to be the best there is; the gap says how much could be left.",
  rejected: "At some point of this drive another control would be better, so this is not the best drive.",
};

/** What a verdict means; a ball has no fuel to count. */
const meaning = (drive, verdict) => (VERDICTS[verdict] ?? "").replace("burn noticeably less", drive.kind === "ball_and_wheel" ? "take noticeably less time" : "burn noticeably less");

const row = (name, value, words) => h("tr", {}, h("th", { scope: "row" }, name, h("div", { class: "quiet small plain" }, words)), h("td", { class: "n" }, value));
const watts = (value) => (Number.isFinite(value) ? `${tiny(value)}\u202fW` : "–");

/** Rows of the certificate; a share is of the largest fuel power of the drive. */
function rows(answer, certificate) {
  const peak = Math.max(...(answer.trajectory.fuel_power_w ?? [0]));
  const share = (value) => (peak > 0 && Number.isFinite(value) ? ` That is ${shareText(value / peak)} of the largest fuel power.` : "");
  const { independent } = certificate;
  const unit = peak > 0 ? watts : tiny;
  const unknown = Number.isFinite(certificate.hamiltonian_drift_w) ? "" : " Not known here: this drive was found on a grid and has no smooth costates.";
  return [
    row("Hamiltonian drift", unit(certificate.hamiltonian_drift_w), `How far H leaves its constant value along the drive. On the best drive it does not leave it.${share(certificate.hamiltonian_drift_w)}${unknown}`),
    row("Transversality", unit(certificate.transversality), "By how much the condition at the free end is missed. 0 is exact."),
    row("Best other control", unit(certificate.max_h_minus_mu_w), `The largest H − μ that any other allowed control reaches anywhere. Above 0, that control would have been better.${share(certificate.max_h_minus_mu_w)}`),
    independent && row("Gap", shareText(independent.relative_gap), `How much more this drive takes than the other method says: ${independent.method}.`),
    Number.isFinite(certificate.lower_bound_j) && row("Lower bound", energyText(certificate.lower_bound_j), "No drive burns less than this."),
    certificate.shift_charges_j > 0 && row("Charged for shifts", energyText(certificate.shift_charges_j), "Counted when drives are compared, but not burnt."),
    certificate.controllable !== undefined && row("Controllable", certificate.controllable ? "yes" : "no", "Whether the control moves both states independently all along (rank of the Lie brackets)."),
  ].filter(Boolean);
}

/** Fill the panel. */
export function showCertificate(panel, drive, answer) {
  const { certificate } = answer;
  const head = h("tr", {}, h("th", { scope: "col" }, "Number, and what it means"), h("th", { scope: "col", class: "n" }, "Value"));
  const place = h("div", { class: "figure" });
  const withFigure = drive.kind !== "ball_and_wheel" && Boolean(answer.costates?.speed);
  show(panel,
    h("p", {}, certificateMark(certificate.verdict), " ", meaning(drive, certificate.verdict)),
    h("div", { class: withFigure ? "columns section" : "section" },
      h("section", { class: "card" }, h("h2", {}, "Certificate"), h("div", { class: "section" }, table("Certificate", head, rows(answer, certificate))),
        certificate.notes?.length > 0 && h("ul", { class: "reasons section" }, certificate.notes.map((text) => h("li", {}, text)))),
      withFigure && h("section", { class: "card" }, h("h2", {}, "The Hamiltonian along the drive"),
        h("p", { class: "quiet small" }, "The best drive takes, at every moment, the control with the largest H. Its own H stays at μ; thin lines show what each gear could have reached at its best."), place)));
  if (withFigure) new Figure(place, { label: "The Hamiltonian along the drive", height: FIGURE_PX, tall: true }).load(`${API}/${at("drives", drive.id, "/figures/hamiltonian")}`);
}

/** The certificate in short, for beside the figures. */
export function showVerdict(card, drive, { certificate }) {
  const gap = certificate.independent?.relative_gap;
  show(card, h("header", {}, h("h2", {}, "How one knows"), certificateMark(certificate.verdict)), h("p", { class: "small" }, meaning(drive, certificate.verdict)),
    Number.isFinite(gap) && h("p", { class: "quiet small" }, `Gap to an independent method: ${shareText(gap)}.`));
}
