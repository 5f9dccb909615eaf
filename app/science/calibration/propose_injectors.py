"""Proposals for the injectors: lag and flow together from several fills, the flow alone from one."""

from __future__ import annotations

import numpy as np

from app.science.calibration.fuel import Injectors, both_from, fills_of, flow_from
from app.science.calibration.proposal import Proposal
from app.science.calibration.question import SIGNIFICANT_SDS, Question, change, graded

LEAST_FLOW, SURE_FLOW, LIKELY_FLOW = 0.01, 0.01, 0.05
LEAST_LAG_S, SURE_LAG_S, LIKELY_LAG_S = 20e-6, 20e-6, 100e-6


def injectors(question: Question) -> list[Proposal]:
    """Propose lag and flow together from several fills, the flow alone from one; without any, say so."""
    fills = fills_of(question.evidences, question.refuelled_l)
    if not any("pulse_count" in evidence.numbers for evidence in question.evidences):
        return question.unknown("injector_lag") + question.unknown("injector_flow")
    injection = question.vehicle.injection
    both, flow = both_from(fills, injection), flow_from(fills, injection)
    if both is not None and graded(_lag_sd(both), SURE_LAG_S, LIKELY_LAG_S) != "weak":
        if abs(both.lag_s - injection.lag_s) > max(SIGNIFICANT_SDS * _lag_sd(both), LEAST_LAG_S):
            return [_lag_proposal(question, both, len(fills.litres), fills.trips)]
        return _flow_proposal(question, both, len(fills.litres), fills.trips)
    shortest = min(e.numbers["shortest_pulse_s"] for e in question.evidences if "shortest_pulse_s" in e.numbers)
    limit = f"the shortest pulses, {1e3 * shortest:.2f} ms, only say that it is above {-1e3 * shortest:.2f} ms"
    why = (
        f"is known to {1e6 * _lag_sd(both):.0f} µs only, from {len(fills.litres)} fills; it needs more of them, some "
        f"after town and some after motorway; {limit}"
        if both is not None
        else "can't be told from driving alone, where it looks like friction of the engine; it needs the litres of "
        f"several fills, some after town and some after motorway; {limit}"
    )
    if flow is not None:
        return question.unknown("injector_lag", why) + _flow_proposal(question, flow, len(fills.litres), fills.trips)
    return question.unknown("injector_lag", why) + question.unknown("injector_flow", "needs the litres filled in")


def _lag_sd(found: Injectors) -> float:
    return float(np.sqrt(found.covariance[1, 1]))


def _lag_proposal(question: Question, found: Injectors, fills: int, trips: int) -> Proposal:
    lag_sd, flow_sd = _lag_sd(found), float(np.sqrt(found.covariance[0, 0]))
    changes = (
        change("inj/calibration@lag", question.vehicle, found.lag_s, lag_sd, 7),
        change("inj/calibration@fuelPerSecond", question.vehicle, found.flow_lps, flow_sd, 7),
    )
    evidence = (
        f"{fills} fills after drives with pulses of different length fit a lag of {1e3 * found.lag_s:.3f} ms "
        f"± {1e6 * lag_sd:.0f} µs and a flow of {found.flow_lps:.5f} l/s ± {100 * flow_sd / found.flow_lps:.2f} %.",
        "Lag and flow come from the same litres and belong together.",
    )
    return Proposal("injector_lag", changes, evidence, graded(lag_sd, SURE_LAG_S, LIKELY_LAG_S), trips)


def _flow_proposal(question: Question, found: Injectors, fills: int, trips: int) -> list[Proposal]:
    sd, before = float(np.sqrt(found.covariance[0, 0])), question.vehicle.injection.litres_per_second
    confidence = graded(sd / found.flow_lps, SURE_FLOW, LIKELY_FLOW)
    if confidence == "weak":
        return question.unknown(
            "injector_flow", f"is known to {100 * sd / found.flow_lps:.0f} % only; it needs more litres"
        )
    if abs(found.flow_lps / before - 1.0) < max(SIGNIFICANT_SDS * sd / found.flow_lps, LEAST_FLOW):
        return []
    changed = change("inj/calibration@fuelPerSecond", question.vehicle, found.flow_lps, sd, 7)
    evidence = (
        f"{fills} {'fills' if fills > 1 else 'fill'} of {'these trips' if trips > 1 else 'this trip'} need "
        f"{found.flow_lps:.5f} l/s where the file says {before:.5f} l/s, with a lag of {1e3 * found.lag_s:.2f} ms.",
    )
    return [Proposal("injector_flow", (changed,), evidence, confidence, trips)]
