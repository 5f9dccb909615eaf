"""How the engine's part is modelled: as rows of a linear model about the road load found so far."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from app.science.arrays import BoolArray, FloatArray
from app.science.roadload.pool import Pool
from app.science.roadload.splines import bending, hump_slopes, humps, products, roughness
from app.science.vehicle.model import Vehicle

DRIVELINE, DRIVELINE_SD = 0.95, 0.5
"""Share of the reported torque that reaches the wheels; deliberately open, since it is what tells the mass."""
FRICTION_SD = 0.1
"""Of an offset in the reported torque, in parts of the largest torque driven."""
SD_SHARE = 0.5
"""Errors of force over two seconds beside the observer's standard deviation at any moment, on virtual cars."""
FUEL_SHARE, FUEL_FLOOR = 0.01, 0.005
"""Of the fuel per turn that a smooth function of speed and torque leaves open, and in parts of the largest."""
SPEED_HUMPS, TORQUE_HUMPS = 12, 16
"""Fewer could not follow measured engines, more change nothing."""
LOWEST_TORQUE, HIGHEST_TORQUE = -0.05, 1.2
"""Reach of the humps in parts of the largest torque with the file's road load, which may be wrong."""
ENDS = (0.002, 0.998)
EFFICIENCY = 0.33
FLATTEST, STEEPEST = 0.02, 3.0
LOOSE = 1e-4
FIRST_LOG, LEAST_LOG, MOST_LOG = 3, 0, 6
"""Powers of ten that the penalties on roughness are looked for among."""

ROAD = 2
"""The last columns: drag and rolling resistance, each relative to what the car's file says."""
DRAG, ROLLING = -2, -1


@dataclass(frozen=True, slots=True)
class Rows:
    """Windows as rows: ``target`` ≈ ``design`` · coefficients; arrays of shape (n,) and (n, p).

    ``counts`` tells which of them say anything.
    """

    design: FloatArray
    target: FloatArray
    variance: FloatArray
    counts: BoolArray


@dataclass(frozen=True, slots=True)
class Normal:
    """Normal equations: Σ w x xᵀ, Σ w x y, Σ w y², and of how many rows."""

    gram: FloatArray
    right: FloatArray
    squares: float
    count: int


class Engine(Protocol):
    """A model of the engine's part, with p − 2 coefficients of its own before the road's two."""

    @property
    def mean(self) -> FloatArray:
        """Prior of its coefficients, shape (p − 2,)."""
        ...

    @property
    def precision(self) -> FloatArray:
        """Inverse variance of that, shape (p − 2,)."""
        ...

    def rows(self, solution: FloatArray | None) -> Rows:
        """Return the rows about a solution (p,), or about the file's road load."""
        ...

    def smoothing(self, normal: Normal | None) -> FloatArray:
        """Return the penalty on its own coefficients, shape (p, p), as strong as the data show it should be."""
        ...


def road_columns(pool: Pool, vehicle: Vehicle) -> FloatArray:
    """Return what drag and rolling resistance of the file take of the specific force, m/s², shape (n, 2)."""
    drag = vehicle.drag_area_kgpm / vehicle.mass_kg * pool.speed_squared_m2ps2
    return np.column_stack([drag, vehicle.crr * pool.normal_mps2])


class TorqueEngine:
    """The torque that the engine reports, times a free factor, less a free friction: linear in everything."""

    def __init__(self, pool: Pool, vehicle: Vehicle) -> None:
        """Scale friction by the largest torque and speed driven."""
        most, fastest = float(pool.input.max()), float(pool.engine_speed_radps.max())
        lead = np.where(pool.coasts, 0.0, pool.engine_speed_radps / (vehicle.mass_kg * pool.speed_mps))
        friction = lead * max(most, 1.0)
        turning = friction * pool.engine_speed_radps / max(fastest, 1.0)
        design = np.column_stack([lead * pool.input, friction, turning, -road_columns(pool, vehicle)])
        variance = pool.specific_force_sd_mps2**2
        self._rows = Rows(design, pool.specific_force_mps2, variance, np.ones(len(pool.trip), np.bool_))
        self.mean = np.array([DRIVELINE, 0.0, 0.0])
        self.precision = 1.0 / np.array([DRIVELINE_SD, FRICTION_SD, FRICTION_SD]) ** 2

    def rows(self, solution: FloatArray | None) -> Rows:
        """Return the same rows whatever the solution."""
        return self._rows

    def smoothing(self, normal: Normal | None) -> FloatArray:
        """Return no penalty besides the prior."""
        return np.zeros((len(self.mean) + ROAD,) * 2)


class FuelEngine:
    """Fuel per turn as a smooth function h of engine speed and torque, the torque being what motion calls for.

    q = h(ω, T(δ, γ)), T = M v (f + δ D/M v² + γ C n)/ω, about the last δ, γ: q + h_T J (δ, γ) = h + h_T J (δ', γ').
    That way round, since a measured engine can burn the same at two torques, but never two fuels at one; where more
    torque costs no fuel, h_T is nought and the window says nothing of the road.
    """

    def __init__(self, pool: Pool, vehicle: Vehicle) -> None:
        """Take the ranges of speed and torque from what was driven."""
        self._pool, self._coasts = pool, pool.coasts
        driven = ~pool.coasts
        road = road_columns(pool, vehicle)
        omega = np.where(driven, pool.engine_speed_radps, 1.0)
        lever = vehicle.mass_kg * pool.speed_mps / omega
        torque = lever * (pool.specific_force_mps2 + road.sum(axis=1))
        self._scale_nm = max(float(np.quantile(torque[driven], ENDS[1])), 1.0) if driven.any() else 1.0
        slow, fast = np.quantile(omega[driven], ENDS) if driven.any() else (1.0, 2.0)
        self._lever = lever / self._scale_nm
        self._road = road
        self._fuel = pool.input / omega * EFFICIENCY / self._scale_nm
        self._speed_humps = humps(omega, float(slow), float(max(fast, slow + 1.0)), SPEED_HUMPS)
        count = SPEED_HUMPS * TORQUE_HUMPS
        self.mean, self.precision = np.zeros(count), np.full(count, LOOSE)
        self._rough = roughness(SPEED_HUMPS, TORQUE_HUMPS)
        self._bends = [np.linalg.eigvalsh(bending(count)) for count in (SPEED_HUMPS, TORQUE_HUMPS)]

    def rows(self, solution: FloatArray | None) -> Rows:
        """Return the rows about a solution; torque that pushes no car tells nothing."""
        own = len(self.mean)
        at = np.ones(ROAD) if solution is None else solution[own:]
        force = self._pool.specific_force_mps2 + self._road @ at
        torque = self._lever * force
        along = humps(torque, LOWEST_TORQUE, HIGHEST_TORQUE, TORQUE_HUMPS)
        if solution is None:
            slope = np.ones(len(torque))
        else:
            steps = hump_slopes(torque, LOWEST_TORQUE, HIGHEST_TORQUE, TORQUE_HUMPS)
            steeps = np.sum((self._speed_humps @ solution[:own].reshape(SPEED_HUMPS, TORQUE_HUMPS)) * steps, axis=1)
            slope = np.clip(steeps, FLATTEST, STEEPEST)
        turns = np.where(self._coasts, 1.0, slope * self._lever)
        engine = np.where(self._coasts[:, None], 0.0, products(self._speed_humps, along))
        design = np.column_stack([engine, turns[:, None] * self._road])
        fuel = np.where(self._coasts, 0.0, self._fuel)
        known = np.where(self._coasts, -self._pool.specific_force_mps2, fuel + turns * (self._road @ at))
        misfit = np.where(self._coasts, 0.0, FUEL_SHARE * fuel + FUEL_FLOOR)
        share = np.where(self._coasts, 1.0, SD_SHARE)
        variance = (share * turns * self._pool.specific_force_sd_mps2) ** 2 + misfit**2
        return Rows(design, known, variance, np.asarray(self._coasts | (torque > 0.0)))

    def smoothing(self, normal: Normal | None) -> FloatArray:
        """Return the penalty on roughness along either axis that makes the data most likely (REML)."""
        if normal is None:
            return self._penalty(FIRST_LOG, FIRST_LOG)
        best = (FIRST_LOG, FIRST_LOG)
        known = {best: self._unlikely(normal, *best)}
        while True:
            around = [(best[0] + step, best[1]) for step in (-1, 1)] + [(best[0], best[1] + step) for step in (-1, 1)]
            for one in around:
                if one not in known and max(one) <= MOST_LOG and min(one) >= LEAST_LOG:
                    known[one] = self._unlikely(normal, *one)
            lowest = min(known, key=known.__getitem__)
            if lowest == best:
                return self._penalty(*best)
            best = lowest

    def _penalty(self, speed: int, torque: int) -> FloatArray:
        penalty = np.zeros((len(self.mean) + ROAD,) * 2)
        penalty[:-ROAD, :-ROAD] = 10.0**speed * self._rough[0] + 10.0**torque * self._rough[1]
        return penalty

    def _unlikely(self, normal: Normal, speed: int, torque: int) -> float:
        """Return minus twice the restricted log-likelihood, the noise's size taken out."""
        penalty = self._penalty(speed, torque) + np.diag(np.concatenate([self.precision, np.full(ROAD, 1.0)]))
        whole = np.linalg.cholesky(normal.gram + penalty)
        left = np.linalg.solve(whole, normal.right)
        rough = 10.0**speed * self._bends[0][:, None] + 10.0**torque * self._bends[1][None, :]
        known = np.log(rough + LOOSE).sum()
        misfit = max(normal.squares - float(left @ left), 1e-12)
        return normal.count * float(np.log(misfit)) + 2.0 * float(np.log(np.diag(whole)).sum()) - float(known)
