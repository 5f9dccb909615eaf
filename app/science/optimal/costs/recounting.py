"""A drive found for a weighted cost, told as fuel, CO2 and each emission."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from scipy.interpolate import PchipInterpolator

from app.science.arrays import FloatArray
from app.science.optimal.advice import advise
from app.science.optimal.answer import Answer, Trajectory
from app.science.optimal.costs.weighted import CO2, FUEL, Cost, Emission, WeightedDrive, WeightedEngine, in_gear
from app.science.optimal.fuel_checks import fuel_power_w

WORTH_SAYING = 0.01
LEAST_ROWS = 4
BURNED = "Fuel power"
ABOUT_THE_DRIVE = ("tracking", "stages")
"""Further numbers of an answer that tell of the drive and not of what it costs."""


def recounted(answer: Answer, engine: WeightedEngine | WeightedDrive) -> Answer:
    """Return an answer to the weighted problem with its fuel, its CO2 and its emissions.

    Energies and masses are integrals over the rows of the trajectory, scaled by what the weighted energy is over its
    own integral over these rows; so they add up to the weighted energy to about 1e-6.

    Parameters
    ----------
    answer : Answer
        Whose fuel is the weighted cost.
    engine : WeightedEngine or WeightedDrive
    """
    shown, cost = answer.trajectory, engine.cost
    fuel_w = _fuel_w(shown, engine)
    whole = _integral(shown.t_s, shown.fuel_power_w)
    scale = answer.fuel_energy_j / whole if whole > 0.0 else 1.0
    fuel_j = scale * _integral(shown.t_s, fuel_w)
    by_table = {one.name: _rates(shown, one, table=True) for one in cost.emissions}
    by_formula = {one.name: _rates(shown, one, table=False) for one in cost.emissions}
    grams = {name: scale * _integral(shown.t_s, rates) for name, rates in by_table.items()}
    trajectory = replace(shown, fuel_power_w=fuel_w)
    moved = {name: value for name, value in answer.more.items() if name not in ABOUT_THE_DRIVE}
    kept = {name: value for name, value in answer.more.items() if name in ABOUT_THE_DRIVE}
    told: dict[str, Any] = {
        "weights": dict(cost.weights),
        "weighted_energy_j": answer.fuel_energy_j,
        "weighted_by_map_j": cost.of_fuel * fuel_j + sum(cost.weight(name) * mass for name, mass in grams.items()),
        "weighted_power_w": shown.fuel_power_w.tolist(),
        "co2_g_per_mj": cost.co2_g_per_mj,
        "emissions": {
            one.name: _of_emission(one, scale * _integral(shown.t_s, by_formula[one.name]), by_table[one.name])
            for one in cost.emissions
        },
        **moved,
    }
    certificate = answer.certificate
    return replace(
        answer,
        fuel_energy_j=fuel_j,
        trajectory=trajectory,
        advice=advise(trajectory),
        warnings=(*(of_the_cost(line) for line in answer.warnings), *misfits(cost)),
        certificate=replace(certificate, notes=(*certificate.notes, in_words(cost))),
        more={**kept, "emissions_g": {CO2: fuel_j * cost.co2_g_per_mj * 1e-6, **grams}, "cost": told},
    )


def in_words(cost: Cost) -> str:
    """Say what the certificate is about."""
    parts = [f"{weight:g} × fuel" for name, weight in cost.weights if name == FUEL and weight]
    parts += [f"{weight:g} J/g × {name}" for name, weight in cost.weights if name != FUEL and weight]
    by_formula = ", with emissions by their formulas" if cost.emissions else ""
    whole = " + ".join(parts)
    return f"The certificate, the multiplier and the costates are those of the weighted cost, {whole}{by_formula}."


def of_the_cost(warning: str) -> str:
    """Say what a warning about fuel is about where the weighted cost stands in for it."""
    if warning.startswith(BURNED):
        return f"The weighted cost{warning.removeprefix(BURNED)}"
    return f"Counting the weighted cost as fuel: {warning}"


def misfits(cost: Cost) -> tuple[str, ...]:
    """Warn of formulas that don't follow their tables."""
    said = []
    for one in cost.emissions:
        peak = one.peak_gps
        if peak > 0.0 and one.largest_gps > WORTH_SAYING * peak:
            said.append(
                f"The formula that stands in for the map of {one.name} misses it by {one.rms_gps:.3g} g/s rms "
                f"({100.0 * one.rms_gps / peak:.1f} % of the map's largest value), at most by {one.largest_gps:.3g} "
                f"g/s ({100.0 * one.largest_gps / peak:.1f} %). emissions_g is by the map itself."
            )
    return tuple(said)


def _of_emission(one: Emission, formula_g: float, rates: FloatArray) -> dict[str, Any]:
    return {
        "by_formula_g": formula_g,
        "gps": rates.tolist(),
        "terms": [list(term) for term in one.terms],
        "coefficients": list(one.coefficients),
        "rms_gps": one.rms_gps,
        "largest_gps": one.largest_gps,
        "peak_gps": one.peak_gps,
    }


def _fuel_w(shown: Trajectory, engine: WeightedEngine | WeightedDrive) -> FloatArray:
    """Return what the engine as posed burns along a drive, W."""
    if isinstance(engine, WeightedDrive):
        return shown.fuel_power_w / engine.cost.of_fuel
    omega, torque = shown.engine_speed_radps, shown.torque_nm
    pulls = in_gear(omega, torque)
    pulled = fuel_power_w(engine.fuel, np.where(pulls, omega, 0.0), np.where(pulls, torque, 0.0))
    return np.asarray(np.where(pulls, pulled, engine.fuel.idle_fuel_power_w))


def _rates(shown: Trajectory, one: Emission, *, table: bool) -> FloatArray:
    """Return an emission along a drive, g/s."""
    pulls = in_gear(shown.engine_speed_radps, shown.torque_nm)
    omega, torque = (np.where(pulls, x, 0.0) for x in (shown.engine_speed_radps, shown.torque_nm))
    found = (one.by_table if table else one.by_formula)(omega, torque)
    return np.asarray(np.where(pulls, found, one.idle_gps))


def _integral(t_s: FloatArray, rate: FloatArray) -> float:
    """Integrate over each stretch without a jump, by a spline that doesn't overshoot; it leaves some 1e-6."""
    total = 0.0
    for rows in np.split(np.arange(t_s.size), np.flatnonzero(np.diff(t_s) <= 0.0) + 1):
        t, values = t_s[rows], rate[rows]
        if len(rows) < LEAST_ROWS:
            total += float(np.trapezoid(values, t))
        else:
            total += float(PchipInterpolator(t, values).integrate(t[0], t[-1]))
    return total
