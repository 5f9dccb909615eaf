"""Distances: the thesis' corner is rejected, drives are extremals, and another method finds nothing better."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp
from scipy.optimize import minimize

from app.science.optimal.answer import Answer
from app.science.optimal.distance.answering import answer, car_of
from app.science.optimal.distance.coasting import steady
from app.science.optimal.distance.extremals import cheapest_cruise, extremals
from app.science.optimal.problem import Distance, Infeasible
from app.science.optimal.reading import read_problem
from tests.science.optimal.documents import SMART, TABLE_4_1

WILLANS = {"willans": [5000.0, 2.2, 1e-5], "power_w": [0.0, 40000.0], "force_n": [-3000.0, 4000.0]}


def posed(**changes: Any) -> Distance:
    """Return the thesis' car with a CVT over a distance, with changes to the document."""
    document = {
        "kind": "distance",
        "vehicle": dict(SMART),
        "engine": dict(TABLE_4_1),
        "transmission": {"type": "cvt"},
        "from_speed_mps": 8.5,
        "distance_m": 5000.0,
    }
    problem = read_problem(document | changes)
    assert isinstance(problem, Distance)
    return problem


@pytest.fixture(scope="module")
def thesis() -> Answer:
    return answer(posed())


def test_corner_is_rejected(thesis: Answer) -> None:
    """(1000 rpm, 10 Nm) all the way fails maximality, and the better competitor is named."""
    (corner,) = thesis.more["candidates"]
    assert corner["verdict"] == "rejected"
    assert corner["max_h_minus_mu_w"] > 1e4
    assert corner["fuel_energy_j"] > 1.1 * thesis.fuel_energy_j
    assert "1000 rpm, 10.0 Nm" in thesis.certificate.notes[0]
    assert "pulse and glide" in thesis.certificate.notes[0]


def test_thesis_formulas() -> None:
    """(4.5)-(4.11): the speed solves (4.6), λ_x is P̃/ṽ, and λ_v(0) is the costate's own equation from the end."""
    car = car_of(posed())
    found = steady(car, 5000.0)
    assert found is not None
    omega, torque = 1000.0 * np.pi / 30.0, 10.0
    a = TABLE_4_1["phi"]
    phi = a[0] + a[1] * omega + a[2] * torque + a[3] * omega * torque + a[4] * omega**2 + a[5] * torque**2
    drag, rolling = 0.5 * 1.2 * 0.39 * 1.93, 0.010 * 920.0 * 9.805
    assert drag * found.speed_mps**3 + rolling * found.speed_mps == pytest.approx(omega * torque, rel=1e-12)
    assert found.price_n == pytest.approx(omega * torque * phi / found.speed_mps, rel=1e-9)
    alpha = (omega * torque / found.speed_mps**2 + 2.0 * drag * found.speed_mps) / 948.0
    run = solve_ivp(lambda _s, y: found.price_n - alpha * y, (0.0, 5000.0 / found.speed_mps), [0.0], rtol=1e-11)
    assert found.lambda_v == pytest.approx(run.y[0, -1], rel=1e-8)


def test_no_classical_optimum(thesis: Answer) -> None:
    """Where only pulse and glide reaches the least, that is said, and the drive stays within 2e-5 of the bound."""
    assert thesis.certificate.verdict == "best found"
    assert "No classical optimum exists" in thesis.warnings[-1]
    assert 0.0 <= thesis.fuel_energy_j / thesis.more["bound_j"] - 1.0 <= 2e-5
    other = thesis.certificate.independent
    assert other is not None
    assert abs(other.relative_gap) < 2e-4


def test_start_at_the_cruise(thesis: Answer) -> None:
    """From the cruising speed itself pulses begin at once, and a metre costs what it costs there."""
    cruise = thesis.more["cruise"]
    problem = posed(from_speed_mps=cruise["speed_mps"], distance_m=2000.0)
    longer = answer(problem).more["bound_j"]
    shorter = min(
        one.fuel_j
        for one in extremals(car_of(problem), problem.from_speed_mps, 1500.0, cheapest_cruise(car_of(problem)))
    )
    assert longer - shorter == pytest.approx(500.0 * cruise["fuel_jpm"], rel=1e-9)


def test_trajectory_obeys_the_car(thesis: Answer) -> None:
    """Columns belong together: fuel is the map's, forces make the acceleration, and sums are the totals."""
    t = thesis.trajectory
    a = TABLE_4_1["phi"]
    w, m = t.engine_speed_radps, t.torque_nm
    phi = a[0] + a[1] * w + a[2] * m + a[3] * w * m + a[4] * w**2 + a[5] * m**2
    assert t.fuel_power_w == pytest.approx(w * m * phi, rel=1e-8)
    assert t.distance_m[-1] == pytest.approx(5000.0, rel=1e-9)
    dt = np.diff(t.t_s)
    assert (dt >= 0.0).all()
    fuel = 0.5 * (t.fuel_power_w[1:] + t.fuel_power_w[:-1]) @ dt
    assert fuel == pytest.approx(thesis.fuel_energy_j, rel=1e-4)
    pull = w * m / t.speed_mps - 0.5 * 1.2 * 0.39 * 1.93 * t.speed_mps**2 - 0.010 * 920.0 * 9.805
    gained = 0.5 * (pull[1:] + pull[:-1]) @ dt
    assert gained == pytest.approx(948.0 * (t.speed_mps[-1] - t.speed_mps[0]), abs=5.0)


@pytest.mark.parametrize(
    "changes",
    [
        {"distance_m": 700.0},
        {"distance_m": 700.0, "from_speed_mps": 20.0},
        {"engine": WILLANS, "distance_m": 700.0},
        {"engine": WILLANS, "from_speed_mps": 25.0},
    ],
)
def test_classical_optimum_is_certified(changes: dict[str, Any]) -> None:
    """H drifts by no more than 1e-6 of the fuel power, no control beats it, and the convex programme agrees."""
    found = answer(posed(**changes))
    certificate = found.certificate
    most = found.trajectory.fuel_power_w.max()
    assert certificate.verdict == "optimal"
    assert certificate.hamiltonian_drift_w < 1e-6 * most
    assert certificate.max_h_minus_mu_w < 1e-6 * most
    assert certificate.transversality < 1e-6 * most
    assert found.costates["speed"][-1] == pytest.approx(0.0, abs=1e-9)
    other = certificate.independent
    assert other is not None
    assert abs(other.relative_gap) < 1e-4


def test_direct_transcription_agrees() -> None:
    """Forces on 80 cells of a road of 300 m, found by a general optimiser, take the same fuel to 1e-4."""
    problem = posed(engine=WILLANS, distance_m=300.0)
    n, load, mass = 80, problem.load, problem.load.accelerated_mass_kg
    h = 300.0 / n

    def speeds(force: np.ndarray) -> np.ndarray:
        w = np.empty(n + 1)
        w[0] = 8.5**2
        for k in range(n):
            gain, drag = 2.0 * h / mass, load.drag_kgpm * h / mass
            w[k + 1] = (w[k] * (1.0 - drag) + gain * (force[k] - load.rolling_n)) / (1.0 + drag)
        return np.sqrt(np.maximum(w, 1e-3))

    def fuel(force: np.ndarray) -> float:
        v = speeds(force)
        dt = 2.0 * h / (v[1:] + v[:-1])
        # F = c0 + c1 P + c2 P² with P = f v: its mean square of speed over a cell of steady force
        power2 = force**2 * (v[1:] ** 2 + v[:-1] ** 2) / 2.0
        return float((5000.0 * dt + 2.2 * force * h + 1e-5 * power2 * dt).sum())

    found = minimize(fuel, np.full(n, 300.0), method="L-BFGS-B", bounds=[(0.0, 4000.0)] * n, options={"maxfun": 60_000})
    ours = min(one.fuel_j for one in extremals(car_of(problem), 8.5, 300.0, cheapest_cruise(car_of(problem))))
    assert ours == pytest.approx(found.fun, rel=1e-4)


def test_short_of_fuel_for_free() -> None:
    """With nothing burned in neutral the car just rolls as far as it does."""
    free = dict(TABLE_4_1) | {"idle_fuel_power_w": 0.0}
    gearbox = {"type": "cvt", "neutral": True}
    found = answer(posed(engine=free, transmission=gearbox, from_speed_mps=20.0, distance_m=500.0))
    assert found.fuel_energy_j == 0.0
    load = posed().load
    seconds = quad(lambda v: load.accelerated_mass_kg / load.resistance_n(v), found.trajectory.speed_mps[-1], 20.0)[0]
    assert found.time_s == pytest.approx(seconds, rel=1e-7)
    with pytest.raises(Infeasible, match="ever slower") as refused:
        answer(posed(engine=free, transmission=gearbox, from_speed_mps=5.0))
    assert refused.value.limit == "engine.idle_fuel_power_w"


def test_too_far_to_roll() -> None:
    """A drive too weak for its own rolling resistance is refused by how far it would get."""
    weak = WILLANS | {"force_n": [-3000.0, 50.0]}
    with pytest.raises(Infeasible, match="too far") as refused:
        answer(posed(engine=weak, from_speed_mps=5.0))
    assert refused.value.limit == "distance_m"
