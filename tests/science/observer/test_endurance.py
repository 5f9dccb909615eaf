"""Ten hours in one go: the covariance stays symmetric, positive and bounded, and the truth stays within it."""

from __future__ import annotations

import numpy as np
import pytest

from app.cli.bench.endurance import MODEL, START_VARIANCE, Health, drive, endure
from app.science.observer import motion_kernels as mk
from app.science.observer.events import MotionEvents
from app.science.observer.motion import observe_motion

HOURS, RATE_HZ = 10, 10.0


@pytest.fixture(scope="module")
def hours() -> list[Health]:
    return list(endure(HOURS, RATE_HZ))


def test_the_covariance_stays_symmetric_and_positive(hours: list[Health]) -> None:
    assert [health.hours for health in hours] == list(range(1, HOURS + 1))
    assert hours[-1].events > 1e6
    assert max(health.asymmetry for health in hours) < 1e-11
    assert min(health.smallest_eigenvalue for health in hours) > 0.01


def test_no_standard_deviation_grows_from_hour_to_hour(hours: list[Health]) -> None:
    """North and east together: ten minutes without positions make whatever lies across the course uncertain."""
    sd = np.array([health.sd for health in hours])
    sd[:, mk.N] = np.hypot(sd[:, mk.N], sd[:, mk.E])
    kept = [state for state in range(mk.SIZE) if state != mk.E]
    assert (sd[1:, kept] < 1.1 * sd[0, kept]).all()


def test_the_truth_stays_within_the_uncertainty(hours: list[Health]) -> None:
    errors = np.array([health.error for health in hours])
    assert np.abs(errors).max() < 4.0
    assert 0.3 < float(np.mean(errors**2)) < 1.5


def test_the_smoother_gets_through_it_too() -> None:
    parts = [events for events, _ in drive(HOURS, 2.0)]
    names = MotionEvents.__dataclass_fields__
    events = MotionEvents(**{name: np.concatenate([getattr(part, name) for part in parts]) for name in names})
    nodes = int(np.count_nonzero(events.kind == mk.NODE))
    x0 = np.zeros(mk.SIZE)
    x0[mk.V] = 20.0
    filtered, smoothed = (observe_motion(events, MODEL, x0, START_VARIANCE, nodes, smooth=s) for s in (False, True))
    assert np.isfinite(smoothed.state).all()
    assert (smoothed.variance > 0.0).all()
    settled = slice(60, None)
    assert (smoothed.variance[settled] <= filtered.variance[settled] * (1.0 + 1e-6)).all()
