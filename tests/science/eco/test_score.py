"""The score of a trip: parts add up, late shifts cost, and the best drive itself has nothing to gain."""

from __future__ import annotations

import json
from collections.abc import Mapping

import numpy as np
import pytest

from app.science.arrays import FloatArray
from app.science.eco.best import plan_of
from app.science.eco.result import TripScore
from app.science.eco.score import score_trip
from app.science.optimal.problem import Route
from app.science.optimal.route.plan import Plan
from app.science.progress import Progress
from tests.science.eco.trips import CAR, driven, map_document, states


@pytest.fixture(scope="module")
def late() -> TripScore:
    return score_trip(driven(4800.0), CAR, map_document())


@pytest.fixture(scope="module")
def early() -> TripScore:
    return score_trip(driven(1900.0), CAR, map_document())


def test_late_shifts_cost(late: TripScore, early: TripScore) -> None:
    assert late.score.value < early.score.value - 5.0
    assert late.saved_l.value > early.saved_l.value
    assert 60.0 < late.score.value < early.score.value <= 100.0
    assert any("instead of" in line or "higher gears" in line for line in late.advice)


def test_everything_adds_up(late: TripScore) -> None:
    lost_j = late.driven_j - late.best_j
    assert sum(part.energy_j for part in late.parts) == pytest.approx(lost_j, rel=1e-9)
    assert sum(part.litres for part in late.parts) == pytest.approx(late.saved_l.value, rel=1e-9)
    places = [*(cell.lost_l for cell in late.cells), *(part.litres for part in late.elsewhere)]
    assert sum(places) == pytest.approx(late.saved_l.value, rel=1e-9)
    steps = np.diff(late.along.distance_m).mean()
    assert float(late.along.lost_lpkm.sum() * steps / 1000.0) == pytest.approx(late.saved_l.value, rel=0.02)
    (section,) = late.sections
    assert sum(part.energy_j for part in section.parts) == pytest.approx(lost_j, rel=1e-9)
    rest = next(part for part in late.parts if part.name == "rest")
    assert abs(rest.percent) < 1.0
    assert late.score.value + late.saved_percent.value == pytest.approx(100.0)


def test_the_best_drive_is_no_slower_and_keeps_the_limits(late: TripScore) -> None:
    (section,) = late.sections
    assert section.scored
    assert section.best_s is not None
    assert section.best_s <= section.to_s - section.from_s + 1e-6
    assert (late.along.best_speed_mps <= late.along.limit_mps + 1e-6).all()


def test_a_trip_that_is_the_best_drive_has_nothing_to_gain() -> None:
    found: list[tuple[Route, Plan]] = []

    def remember(problem: Route, progress: Progress) -> Plan:
        found.append((problem, plan_of(problem, progress)))
        return found[-1][1]

    score_trip(driven(4800.0), CAR, map_document(), solver=remember)
    again = score_trip(as_states(*found[0]), CAR, map_document())
    assert again.score.value == pytest.approx(100.0, abs=1.5)


def as_states(problem: Route, plan: Plan) -> Mapping[str, FloatArray]:
    """Return the states of a plan that brakes with a gear in, with a second of rest at both ends."""
    t = np.concatenate(([0.0], np.cumsum(2.0 * np.diff(plan.edges_m) / (plan.speed_mps[1:] + plan.speed_mps[:-1]))))
    even = np.arange(0.0, t[-1], 0.05)
    piece = np.clip(np.searchsorted(t, even, side="right") - 1, 0, len(plan.gear) - 1)
    accel = (np.diff(plan.speed_mps) / np.diff(t))[piece]
    gear = plan.gear.copy()
    for k in range(1, len(gear)):
        gear[k] = gear[k] or gear[k - 1]
    still = np.zeros(40)
    return states(
        np.arange(len(even) + 80) * 0.05,
        np.concatenate((still, np.interp(even, t, plan.speed_mps), still)),
        np.concatenate((still, accel, still)),
        np.concatenate((still.astype(np.int64), gear[piece], still.astype(np.int64))),
    )


def test_a_document_comes_back_through_json(late: TripScore) -> None:
    document = json.loads(json.dumps(late.document()))
    again = TripScore.from_document(document, late.along.columns())
    assert again.document() == late.document()
    assert again.along.best_gear == pytest.approx(late.along.best_gear)
    assert again.sections == late.sections


def test_accelerations_stand_beside_pontryagin(late: TripScore) -> None:
    (rise,) = late.accelerations
    assert rise.to_mps == pytest.approx(22.0, abs=0.2)
    assert rise.shift_rpm == pytest.approx([4800.0] * len(rise.shift_rpm), rel=0.02)
    assert rise.free_j is not None
    assert rise.same_time_j is not None
    assert rise.free_j <= rise.same_time_j * 1.001
    assert rise.same_time_j < rise.driven_j
    assert late.table[0].energy_kj == pytest.approx(rise.driven_j / 1000.0)
    assert late.table[1].percent == pytest.approx(rise.free_percent)


def test_a_section_whose_motion_is_not_known_is_told_and_the_rest_is_scored() -> None:
    one, other = (driven(3000.0, seconds=45.0, top_mps=15.0) for _ in range(2))
    other["thrust_n"][300:320] = np.nan
    shift = {"t_s": one["t_s"][-1] + 0.05, "distance_m": one["distance_m"][-1]}
    both = {name: np.concatenate((one[name], other[name] + shift.get(name, 0.0))) for name in one}
    found = score_trip(both, CAR, map_document())
    assert [section.scored for section in found.sections] == [True, False]
    assert "motion is not known" in found.sections[1].reason
    assert any("1 section is not scored" in line for line in found.warnings)
    assert np.isfinite(found.score.value + found.score.sd)
