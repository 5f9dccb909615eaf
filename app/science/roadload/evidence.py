"""What one trip says of its car's road load: normal equations, small enough to keep for every trip and to add up."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import IntEnum
from typing import Any

import numpy as np

from app.science.arrays import BoolArray, FloatArray, IntArray
from app.science.roadload.levels import EfficiencySums, efficiency_sums
from app.science.roadload.priors import PRIORS, Priors
from app.science.roadload.terms import Model, Terms, terms_of
from app.science.roadload.windows import Regime, RoadLoadWindows
from app.science.vehicle.model import Vehicle

LEAST_WINDOWS = 30
IDLE_SHARE, IDLE_PERCENT = 1.5, 3.0
"""An engine that burns hardly more than its lightest moments is near idle, where fuel doesn't tell power."""
MISFIT = 0.005
"""Of the engine's power that a smooth function leaves open, in parts of its fuel power."""
HUBER_SDS, COAST_SDS = 2.0, 3.0
MAD_TO_SD, LEAST_SCALE = 1.4826, 0.1
ROUNDS = 6
GROUP_S = 12.0
"""Windows are averaged over so long: the smoother blurs forces for a few seconds, which would look like less engine."""
CLUSTER_S = 60.0
"""Errors of windows further apart are independent: slopes come from altitudes with a memory of seconds."""
STEEP, CHANGING_MPS2 = 0.02, 0.3


class Source(IntEnum):
    """What a window tells the road load by."""

    COASTING = 0
    GRAVITY = 1
    ACCELERATION = 2
    CRUISING = 3


@dataclass(frozen=True, slots=True)
class RoadLoadEvidence:
    """Normal equations of one trip for the coefficients of `Terms`.

    Attributes
    ----------
    model : {"fuel", "torque"}
    gram : array, shape (4, p, p)
        By `Source`: weighted products of the columns.
    right : array, shape (p,)
    meat : array, shape (p, p)
        Covariance of ``right`` about the trip's own solution, from minutes taken as independent.
    windows : tuple of int
        Used, by `Source`.
    seconds : float
    speed_mps : (lowest, highest)
        10 % and 90 % quantiles.
    offset_sd : float
        A constant error of the trip's specific force, in parts of the file's rolling resistance.
    levels : EfficiencySums
    """

    model: Model
    gram: FloatArray
    right: FloatArray
    meat: FloatArray
    windows: tuple[int, int, int, int]
    seconds: float
    speed_mps: tuple[float, float]
    offset_sd: float
    levels: EfficiencySums

    def to_dict(self) -> dict[str, Any]:
        """Return the same as plain dicts, lists and numbers, ready for JSON."""
        return {
            "model": self.model,
            "gram": self.gram.tolist(),
            "right": self.right.tolist(),
            "meat": self.meat.tolist(),
            "windows": list(self.windows),
            "seconds": self.seconds,
            "speed_mps": list(self.speed_mps),
            "offset_sd": self.offset_sd,
            "levels": self.levels.to_dict(),
        }

    @classmethod
    def from_dict(cls, plain: Mapping[str, Any]) -> RoadLoadEvidence:
        """Return what `to_dict` was made from."""
        coasting, gravity, acceleration, cruising = plain["windows"]
        slowest, fastest = plain["speed_mps"]
        return cls(
            model=plain["model"],
            gram=np.array(plain["gram"]),
            right=np.array(plain["right"]),
            meat=np.array(plain["meat"]),
            windows=(coasting, gravity, acceleration, cruising),
            seconds=float(plain["seconds"]),
            speed_mps=(float(slowest), float(fastest)),
            offset_sd=float(plain["offset_sd"]),
            levels=EfficiencySums.from_dict(plain["levels"]),
        )


@dataclass(frozen=True, slots=True)
class _Grouped:
    """Averages, shape (m, k), and their weights, (m,)."""

    rows: FloatArray
    weights: FloatArray


def trip_evidence(
    windows: RoadLoadWindows, vehicle: Vehicle, model: Model, priors: Priors = PRIORS
) -> RoadLoadEvidence | None:
    """Return what a trip says by one model of the engine; None where it has too few windows for it.

    The specific force is a linear function of what the windows hold, so that windows can be averaged as they are,
    across gears too. One by one they would put C_d A 1 to 5 % too low, because the observer blurs quick changes of
    force.

    Parameters
    ----------
    windows : RoadLoadWindows
    vehicle : Vehicle
        As the trip was observed with.
    model : {"fuel", "torque"}
        The engine's power as a smooth function of fuel power and speed, or the torque it reports.
    priors : Priors, optional
    """
    used = windows.where(usable(windows, model))
    if len(used) < LEAST_WINDOWS:
        return None
    terms = terms_of(vehicle, model)
    columns, force = terms.columns(used), used.specific_force_mps2
    weights = _robust(used, columns, terms, priors)
    used, columns, force, weights = used.where(weights > 0.0), *(a[weights > 0.0] for a in (columns, force, weights))
    sources = _sources(used)
    grouped = _averages(np.column_stack([columns, force, used.t_s, *(sources == one for one in Source)]), weights, used)
    p = terms.size
    design, force, minute = grouped.rows[:, :p], grouped.rows[:, p], grouped.rows[:, p + 1] // CLUSTER_S
    weighted = design * grouped.weights[:, None]
    gram = np.array([(weighted * share[:, None]).T @ design for share in grouped.rows[:, p + 2 :].T])
    right = weighted.T @ force
    mean, precision = priors.of(terms)
    own = np.linalg.solve(gram.sum(axis=0) + np.diag(precision), right + precision * mean)
    counts = [int(np.count_nonzero(sources == one)) for one in Source]
    slowest, fastest = np.quantile(used.speed_mps, [0.1, 0.9])
    bias = used.bias_sd_mps2 if np.isfinite(used.bias_sd_mps2) else 0.0
    return RoadLoadEvidence(
        model=model,
        gram=gram,
        right=right,
        meat=_meat(weighted * (force - design @ own)[:, None], minute),
        windows=(counts[0], counts[1], counts[2], counts[3]),
        seconds=float(used.length_s.sum()),
        speed_mps=(float(slowest), float(fastest)),
        offset_sd=bias / (vehicle.crr * vehicle.gravity_mps2),
        levels=efficiency_sums(used.where(used.kind == Regime.DRIVE), vehicle),
    )


def usable(windows: RoadLoadWindows, model: Model) -> BoolArray:
    """Tell which windows the model can use, shape (n,); overrun never, since brakes look just like it."""
    known = np.isfinite(windows.specific_force_mps2) & (windows.specific_force_sd_mps2 > 0.0)
    coasting = known & (windows.kind == Regime.COAST)
    driving = known & (windows.kind == Regime.DRIVE) & (windows.engine_speed_radps > 0.0)
    if model == "torque":
        return np.asarray(coasting | (driving & (windows.torque_nm > 0.0)))
    fuel = windows.fuel_power_w
    driving &= np.isfinite(fuel)
    if not driving.any():
        return np.asarray(coasting)
    lightest = float(np.percentile(fuel[driving], IDLE_PERCENT))
    return np.asarray(coasting | (driving & (fuel > IDLE_SHARE * lightest)))


def _robust(windows: RoadLoadWindows, columns: FloatArray, terms: Terms, priors: Priors) -> FloatArray:
    """Return weights: Huber's for driving, and coasting only where nobody brakes."""
    mean, precision = priors.of(terms)
    f, coasts = windows.specific_force_mps2, windows.kind == Regime.COAST
    fuel = np.where(np.isfinite(windows.fuel_power_w) & ~coasts, windows.fuel_power_w, 0.0)
    misfit = MISFIT * fuel / (windows.mass_kg * windows.speed_mps)
    variance = windows.specific_force_sd_mps2**2 + misfit**2
    weights = np.where(coasts, 0.0, 1.0 / variance)
    for _ in range(ROUNDS):
        weighted = columns * weights[:, None]
        solution = np.linalg.solve(weighted.T @ columns + np.diag(precision), weighted.T @ f + precision * mean)
        apart = np.abs(f - columns @ solution) / np.sqrt(variance)
        scale = max(MAD_TO_SD * float(np.median(apart[~coasts])), LEAST_SCALE) if (~coasts).any() else 1.0
        huber = np.minimum(1.0, HUBER_SDS * scale / np.maximum(apart, LEAST_SCALE))
        weights = np.where(coasts, apart < COAST_SDS * scale, huber) / (variance * scale**2)
    return weights


def _sources(windows: RoadLoadWindows) -> IntArray:
    driving = np.where(
        np.abs(windows.slope) >= STEEP,
        Source.GRAVITY,
        np.where(np.abs(windows.acceleration_mps2) >= CHANGING_MPS2, Source.ACCELERATION, Source.CRUISING),
    )
    return np.where(windows.kind == Regime.COAST, Source.COASTING, driving)


def _averages(rows: FloatArray, weights: FloatArray, windows: RoadLoadWindows) -> _Grouped:
    """Average rows (n, k) over `GROUP_S`, each by its weight."""
    _, group = np.unique(windows.t_s // GROUP_S, return_inverse=True)
    total = np.bincount(group, weights)
    sums = np.column_stack([np.bincount(group, weights * column) for column in rows.T])
    return _Grouped(sums / total[:, None], np.asarray(total, dtype=np.float64))


def _meat(scores: FloatArray, minute: FloatArray) -> FloatArray:
    """Return Σ s sᵀ with the scores s of each minute added up, shape (p, p)."""
    _, place = np.unique(minute, return_inverse=True)
    sums = np.column_stack([np.bincount(place, column) for column in scores.T])
    return np.asarray(sums.T @ sums)
