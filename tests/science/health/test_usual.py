"""What is usual, learnt from made-up trips of a known engine."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from app.science.health.evidence import ENGINE, TripDesign, trip_design
from app.science.health.scale import Scale
from app.science.health.usual import QUANTITIES, Usual, fit_usual
from tests.science.health.made_up import CAR, Truth, made_up_windows


def design(seed: int, truth: Truth = Truth()) -> TripDesign:
    return trip_design(made_up_windows(seed, truth), CAR.drag_area_kgpm, CAR.crr)


@cache
def usual() -> Usual:
    return fit_usual([design(seed) for seed in range(10)], CAR.drag_area_kgpm, CAR.crr)


def test_the_force_of_an_engine_never_seen_by_itself_is_learnt() -> None:
    """Within 12 N of Table 4.1 on a new trip, of up to 3000 N."""
    windows = made_up_windows(99)
    new = design(99)
    held = usual().domain.holds(new)
    true = windows.thrust_n[held]
    off = new.rows[held, :ENGINE] @ usual().coefficients[:ENGINE] - true
    assert float(np.sqrt(np.mean(off**2))) < 12.0


def test_what_was_never_visited_is_not_judged() -> None:
    new = design(99)
    assert usual().domain.holds(new).mean() > 0.95
    racing = replace(new, engine_speed_radps=new.engine_speed_radps + 400.0)
    assert not usual().domain.holds(racing).any()


def test_scatter_between_trips_is_learnt() -> None:
    """Loads of 0, 50 and 100 kg in turn scatter by 41 kg; the rest stays at what is expected or below."""
    loads = [design(seed, Truth(mass=50.0 * (seed % 3))) for seed in range(12)]
    sd = dict(zip(QUANTITIES, fit_usual(loads, CAR.drag_area_kgpm, CAR.crr).trip_sd, strict=True))
    assert sd["mass"] == pytest.approx(41.0 * np.sqrt(12 / 17), rel=0.3)
    assert sd["rolling_resistance"] < 3.0
    assert sd["efficiency"] < 0.6


def test_braking_while_the_engine_idles_in_gear_is_not_looked_at() -> None:
    """A large engine idles on 7 kW; what the brakes do then says nothing of the engine."""
    trips = [made_up_windows(seed) for seed in range(10)]
    for trip in trips:
        trip.fuel_power_w[::10] = 7000.0
        trip.specific_force_mps2[::10] = -2.0
    braked = [trip_design(trip, CAR.drag_area_kgpm, CAR.crr) for trip in trips]
    assert fit_usual(braked, CAR.drag_area_kgpm, CAR.crr).noise < 1.1 * usual().noise


def test_windows_that_repeat_each_other_count_once() -> None:
    """Each window three times in a row: three times the noise, as if there were a third of them."""
    once = [design(seed) for seed in range(10)]
    thrice = [
        replace(
            one,
            rows=np.repeat(one.rows, 3, axis=0),
            variance=np.repeat(one.variance, 3),
            engine_speed_radps=np.repeat(one.engine_speed_radps, 3),
            fuel_power_w=np.repeat(one.fuel_power_w, 3),
        )
        for one in once
    ]
    single, triple = (fit_usual(trips, CAR.drag_area_kgpm, CAR.crr).noise for trips in (once, thrice))
    assert triple / single == pytest.approx(3.0, rel=0.15)


def test_a_heavier_car_moves_less_than_in_proportion() -> None:
    """The linear model sees M ΔM / (M + ΔM): 130 kg of 150 on 919."""
    scale = Scale.of(usual(), CAR.mass_kg)
    seen = CAR.mass_kg * 150.0 / (CAR.mass_kg + 150.0)
    assert scale.true(QUANTITIES.index("mass"), seen, 10.0)[0] == pytest.approx(150.0)


def test_efficiency_is_asked_at_the_fuel_that_counts() -> None:
    """The way back of what the linear model makes of −6 %, and small changes as they are."""
    scale = Scale.of(usual(), CAR.mass_kg)
    efficiency = QUANTITIES.index("efficiency")
    seen = float(np.interp(-6.0, scale.efficiency, scale.efficiency_seen))
    assert scale.true(efficiency, seen, 0.4)[0] == pytest.approx(-6.0, abs=0.02)
    assert scale.true(efficiency, 0.3, 0.4)[0] == pytest.approx(0.3, abs=0.05)
