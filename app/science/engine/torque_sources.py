"""The torque that the engine reports beside the one that the car's motion tells, and what the difference is made of."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from app.science.arrays import BoolArray, FloatArray
from app.science.engine.ecu import ecu_points
from app.science.engine.rules import PointRules
from app.science.errors import ScienceError
from app.science.logger.recording import Recording
from app.science.observer.result import Observation
from app.science.vehicle.model import Vehicle

RADPS_PER_RPM = np.pi / 30.0
FEWEST_MOMENTS = 20
CHANGE_S = 1.0
STEADY_SHARE = 1.0 / 3.0
SURE_SIGMAS = 2.0

Sampler = Callable[[FloatArray], FloatArray]


@dataclass(frozen=True, slots=True)
class Explanation:
    """One thing that could make the two differ.

    Attributes
    ----------
    words : str
        What it is, and in what unit ``value`` is.
    value, sd : float
        What the drive says it is, starting from zero with the standard deviation ``usual``.
    usual : float
    power_w : float
        Its mean part of the reported power less the observed one.
    """

    words: str
    value: float
    sd: float
    usual: float
    power_w: float


@dataclass(frozen=True, slots=True)
class TorqueSources:
    """Moments at which the engine reported its torque while it drove the car, arrays of shape (n,).

    Attributes
    ----------
    t_s, engine_speed_rpm, gear : array
    reported_nm, observed_nm, observed_sd_nm : array
        ``observed`` is from an observer that did not hear the reported torque.
    fuel_power_w : array
    steady : bool array
        The third of the moments at which the observed power changes least.
    work_ratio, work_ratio_sd : float
        Observed over reported work.
    steady_rms_w, changing_rms_w : float
        Difference of the powers in the steadiest third and in the least steady one.
    ages_s : dict of str to float
        How far the samples of other signals are from those of the torque, in the median.
    explanations : tuple of Explanation
    left_rms_w : float
        What they leave unexplained.
    """

    t_s: FloatArray
    engine_speed_rpm: FloatArray
    gear: FloatArray
    reported_nm: FloatArray
    observed_nm: FloatArray
    observed_sd_nm: FloatArray
    fuel_power_w: FloatArray
    steady: BoolArray
    work_ratio: float
    work_ratio_sd: float
    steady_rms_w: float
    changing_rms_w: float
    ages_s: dict[str, float]
    explanations: tuple[Explanation, ...]
    left_rms_w: float


def torque_sources(alone: Observation, recording: Recording, vehicle: Vehicle, rules: PointRules) -> TorqueSources:
    """Compare the torques of a trip.

    Parameters
    ----------
    alone : Observation
        Made without the reported torque.
    recording : Recording
        With ``engine_torque_nm``.
    vehicle : Vehicle
    rules : PointRules

    Raises
    ------
    ScienceError
        When the engine drove the car at fewer than 20 of the moments.
    """
    points, c = ecu_points(alone, recording, vehicle, rules), alone.columns
    if len(points) < FEWEST_MOMENTS:
        raise ScienceError(
            f"The engine reported its torque at {len(points)} moments at which it drove the car; it takes "
            f"{FEWEST_MOMENTS} to compare it with the car's motion."
        )
    t = points.t_s

    def at(values: FloatArray, shift_s: float = 0.0) -> FloatArray:
        known = np.isfinite(values)
        return np.interp(t + shift_s, c["t_s"][known], values[known])

    thrust_power = c["thrust_n"] * c["speed_mps"]
    observed, turning = at(thrust_power), points.engine_speed_rpm * RADPS_PER_RPM
    change = np.abs(at(thrust_power, CHANGE_S) - at(thrust_power, -CHANGE_S))
    calm, lively = np.quantile(change, [STEADY_SHARE, 1.0 - STEADY_SHARE])
    difference = points.power_w - observed
    ratio, ratio_sd = _ratio(points.power_w, observed)
    explanations, left = _explained(difference, change, observed, _motion(at, c, vehicle), vehicle)
    return TorqueSources(
        t_s=t,
        engine_speed_rpm=points.engine_speed_rpm,
        gear=np.round(at(c["gear"])),
        reported_nm=points.torque_nm,
        observed_nm=observed / turning,
        observed_sd_nm=at(c["thrust_n_sd"]) * at(c["speed_mps"]) / turning,
        fuel_power_w=points.fuel_power_w,
        steady=change <= calm,
        work_ratio=ratio,
        work_ratio_sd=ratio_sd,
        steady_rms_w=_rms(difference[change <= calm]),
        changing_rms_w=_rms(difference[change >= lively]),
        ages_s={name: _age(recording, name) for name in ("engine_speed_rpm", "fuel_rate_lph") if name in recording},
        explanations=explanations,
        left_rms_w=left,
    )


def _ratio(reported: FloatArray, observed: FloatArray) -> tuple[float, float]:
    """Return observed over reported work and its standard deviation by leaving out one moment after the other."""
    ratio = float(observed.sum() / reported.sum())
    without = (observed.sum() - observed) / (reported.sum() - reported)
    return ratio, float(np.sqrt((len(without) - 1.0) / len(without) * np.sum((without - without.mean()) ** 2)))


def _motion(at: Sampler, c: Mapping[str, FloatArray], vehicle: Vehicle) -> dict[str, FloatArray]:
    """Return speed, and acceleration with the share of gravity along the road, at the moments."""
    acceleration = np.gradient(c["speed_mps"], c["t_s"])
    slope = vehicle.gravity_mps2 * np.sin(c["pitch_rad"])
    return {"speed": at(c["speed_mps"]), "along": at(acceleration + slope)}


def _explained(
    difference: FloatArray, change: FloatArray, observed: FloatArray, motion: dict[str, FloatArray], vehicle: Vehicle
) -> tuple[tuple[Explanation, ...], float]:
    """Share the difference out by least squares, each part held to what is usual of it.

    All parts are of the observed motion: the reported power, whose signals are of different ages, has the noise.
    A moment counts the less, the more the power changes around it: its noise grows in proportion, as the drive shows.
    """
    speed, mass = motion["speed"], vehicle.mass_kg
    half_rho = 0.5 * vehicle.air_density_kgpm3
    causes = (
        ("losses between crankshaft and wheels, or a reported torque that reads high, as a share", 0.08, observed),
        ("rolling resistance above the car file's, as a coefficient", 0.003, mass * vehicle.gravity_mps2 * speed),
        ("drag area above the car file's, m²", 0.15 * vehicle.cd * vehicle.frontal_area_m2, half_rho * speed**3),
        ("mass above the car file's, as a share of it", 0.10, mass * speed * motion["along"]),
    )
    columns = np.column_stack([usual * power for _, usual, power in causes])
    weight = np.ones(len(difference))
    coefficients, covariance = np.zeros(len(causes)), np.eye(len(causes))
    for _ in range(5):
        left = np.abs(difference - columns @ coefficients)
        line = np.polynomial.Polynomial.fit(change, left, 1, w=1.0 / np.maximum(change, change.mean()))(change)
        weight = 1.0 / np.maximum(1.2533 * line, 0.2 * left.mean()) ** 2  # mean absolute to standard deviation
        covariance = np.linalg.inv((columns * weight[:, np.newaxis]).T @ columns + np.eye(len(causes)))
        coefficients = covariance @ (columns.T @ (weight * difference))
    explanations = tuple(
        Explanation(
            words=words,
            value=float(usual * coefficient),
            sd=float(usual * sd),
            usual=usual,
            power_w=float(np.mean(column * coefficient)),
        )
        for (words, usual, _), coefficient, sd, column in zip(
            causes, coefficients, np.sqrt(np.diag(covariance)), columns.T, strict=True
        )
    )
    return explanations, _rms(difference - columns @ coefficients)


def _age(recording: Recording, name: str) -> float:
    """Return how far in time the nearest sample of a signal is from those of the reported torque, in the median."""
    torque, other = recording["engine_torque_nm"].t_s, recording[name].t_s
    right = np.clip(np.searchsorted(other, torque), 1, len(other) - 1)
    return float(np.median(np.minimum(np.abs(other[right] - torque), np.abs(torque - other[right - 1]))))


def _rms(values: FloatArray) -> float:
    return float(np.sqrt(np.mean(values**2)))


def words(found: TorqueSources) -> list[str]:
    """Return what the comparison says."""
    share, sd = 100.0 * found.work_ratio, 100.0 * found.work_ratio_sd
    said = [
        f"Over {len(found.t_s)} loaded moments the car's motion accounts for {share:.0f} ± {sd:.0f} % of the work that "
        "the engine reports.",
        f"Where the power is steadiest the two differ by {found.steady_rms_w / 1e3:.1f} kW, where it changes most by "
        f"{found.changing_rms_w / 1e3:.1f} kW (root mean square).",
    ]
    late = [f"{name} {age:.1f} s" for name, age in _named(found.ages_s) if age > 0.2]
    if late:
        said.append(
            f"Not all signals are asked for at the same time: away from the torque's samples are {' and '.join(late)}. "
            "In between they are interpolated, which scatters both efficiencies while the power changes."
        )
    for one in found.explanations:
        sure = abs(one.value) > SURE_SIGMAS * one.sd
        learned = one.sd < 0.7 * one.usual
        verdict = "that is more than chance" if sure else ("not told from zero" if learned else "the drive can't tell")
        said.append(
            f"{one.words[0].upper()}{one.words[1:]}: {one.value:+.2g} ± {one.sd:.2g}, "
            f"{one.power_w / 1e3:+.2f} kW in the mean; {verdict}."
        )
    said.append(f"Together they leave {found.left_rms_w / 1e3:.1f} kW (root mean square) unexplained.")
    return [text.replace(": -", ": −").replace(", -", ", −") for text in said]


def _named(ages: dict[str, float]) -> list[tuple[str, float]]:
    names = {"engine_speed_rpm": "engine speed", "fuel_rate_lph": "fuel rate"}
    return [(names[name], age) for name, age in ages.items()]
