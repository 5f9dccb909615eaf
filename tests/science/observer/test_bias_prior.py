"""A trip that begins with what earlier ones know: better first minutes, and no harm from a wrong belief."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from app.cli.bench.carry_over import errors_of, look, prior_of, trips_of_car
from app.science.observer.carry_over import BiasPrior, final_bias
from app.science.observer.result import Observation
from app.science.virtualcar.simulate import SimulatedTrip

GPS_ONLY = frozenset({"dem"})


@cache
def driven() -> tuple[SimulatedTrip, ...]:
    return tuple(trips_of_car(9401, (900.0, 900.0, 600.0)))


@cache
def prior() -> BiasPrior:
    found = prior_of(list(driven()[:2]), GPS_ONLY)
    assert found is not None
    return found


def seen(belief: BiasPrior | None, smooth: bool = False) -> Observation:
    return look(driven()[2], belief, smooth, GPS_ONLY)


def test_the_start_is_what_is_believed() -> None:
    first = seen(prior()).columns
    for axis, name in enumerate(("bias_i_mps2", "bias_j_mps2", "bias_k_mps2")):
        assert first[name][0] == pytest.approx(prior().mean[axis], abs=2.0 * prior().sd[axis])
        assert first[f"{name}_sd"][0] <= prior().sd[axis] * 1.0001
        truth = driven()[2].truth[name][0]
        assert abs(truth - prior().mean[axis]) < 3.0 * prior().sd[axis]


def test_the_first_minutes_are_better_and_the_map_is_no_worse() -> None:
    trip = driven()[2]
    filtered, smoothed = (
        [errors_of(trip, seen(belief, smooth)) for belief in (prior(), None)] for smooth in (False, True)
    )
    assert filtered[0].pitch_deg < 0.9 * filtered[1].pitch_deg
    assert filtered[0].thrust_n < filtered[1].thrust_n
    assert smoothed[0].pitch_deg < 1.05 * smoothed[1].pitch_deg
    assert smoothed[0].eta < 1.01 * smoothed[1].eta


def test_a_wrong_belief_is_given_up() -> None:
    """As after somebody took the logger off and fastened it again, half a dozen standard deviations away."""
    wrong = BiasPrior((prior().mean[0] + 0.4, prior().mean[1], prior().mean[2] - 0.4), prior().sd)
    ends = [final_bias(seen(belief), 75.0) for belief in (wrong, None)]
    assert ends[0] is not None
    assert ends[1] is not None
    assert np.abs(np.subtract(ends[0].mean, ends[1].mean)).max() < 0.03
    assert seen(wrong).verdict != "failed"
