"""The same problem by plain NumPy: all controls on a grid that is narrowed, dynamic programming over the gears.

It shares no code with the compiled solution. With a price on time it bounds from below what any drive that takes a
given time can burn (weak duality).
"""

from __future__ import annotations

import numpy as np

from app.science.arrays import FloatArray
from app.science.optimal.accelerate.kernels import CVT, GEARS, WILLANS, DriveNumbers
from app.science.optimal.problem import Accelerate

CELLS = {GEARS: 400, CVT: 120, WILLANS: 400}
LEVELS = 6
NODES, WEIGHTS = np.polynomial.legendre.leggauss(3)


def least_lagrangian(problem: Accelerate, drive: DriveNumbers, mu: float, through: tuple[int, ...] = ()) -> float:
    """Return the least fuel plus charges plus μ times time of rising from one speed to the other, J.

    ``through`` names gears, from 0, that are used in this order and no others.
    """
    start, end = problem.from_speed_mps, problem.to_speed_mps
    ends = np.linspace(start, end, CELLS[drive.kind] + 1)
    if drive.kind == GEARS:
        limits = np.outer((drive.engine.lowest_radps, drive.engine.highest_radps), 1.0 / drive.spd_1pm).ravel()
        ends = np.union1d(ends, limits[(limits > start) & (limits < end)])
    half = 0.5 * np.diff(ends)
    v = (0.5 * (ends[1:] + ends[:-1]))[:, None] + half[:, None] * NODES[None, :]
    columns = [(half[:, None] * WEIGHTS * _least(v, gear, drive, mu)).sum(axis=1) for gear in range(len(drive.spd_1pm))]
    costs = np.column_stack(columns)
    charge = problem.transmission.shift_cost_j
    if through:
        total = np.append(costs[0, through[0]], np.full(len(through) - 1, np.inf))
        for row in costs[1:]:
            total = np.minimum(total, np.append(np.inf, total[:-1] + charge)) + row[list(through)]
        return float(total[-1])
    total = costs[0]
    for row in costs[1:]:
        total = np.minimum(total, total.min() + charge) + row
    return float(total.min())


def _least(v: FloatArray, gear: int, drive: DriveNumbers, mu: float) -> FloatArray:
    """Return the least (P + μ) / v̇ over the controls at each speed; infinite where none speeds the car up."""
    engine = drive.engine
    resistance = drive.drag_kgpm * v**2 + drive.rolling_n
    geared = drive.kind in (GEARS, CVT)
    side = np.linspace(0.0, 1.0, 41 if drive.kind == CVT else 1)[:, None]
    depth = np.linspace(0.0, 1.0, 41)[None, :]
    centre = np.full((2, *v.shape), 0.5)
    width = 1.0
    best = np.full(v.shape, np.inf)
    for _ in range(LEVELS):
        a = np.clip(centre[0][..., None, None] + width * (side - 0.5), 0.0, 1.0)
        b = np.clip(centre[1][..., None, None] + width * (depth - 0.5), 0.0, 1.0)
        a, b = np.broadcast_arrays(a, b)
        speed = v[..., None, None]
        if geared:
            omega = engine.lowest_radps + a * (engine.highest_radps - engine.lowest_radps)
            if drive.kind == GEARS:
                omega = np.broadcast_to(speed * drive.spd_1pm[gear], b.shape)
            x, fuel = _engine(omega, b, drive)
            force = omega * x / speed
        else:
            low = np.maximum(drive.power_w[0], drive.force_n[0] * speed)
            high = np.minimum(drive.power_w[1], drive.force_n[1] * speed)
            x = low + b * (high - low)
            fuel = drive.willans[0] + drive.willans[1] * x + drive.willans[2] * x**2
            force = x / speed
        pull = force - resistance[..., None, None]
        cost = np.where(pull > 0.0, (fuel + mu) / np.where(pull > 0.0, pull, 1.0), np.inf)
        cost = np.where(np.isfinite(cost), cost, np.inf).reshape(*v.shape, -1)
        at = cost.argmin(axis=-1)[..., None]
        found = np.take_along_axis(cost, at, axis=-1)[..., 0]
        better = found < best
        best = np.where(better, found, best)
        for k, grid in enumerate((a, b)):
            here = np.take_along_axis(grid.reshape(*v.shape, -1), at, axis=-1)[..., 0]
            centre[k] = np.where(better, here, centre[k])
        width *= 0.1
    return np.asarray(best * drive.accelerated_kg)


def _engine(omega: FloatArray, share: FloatArray, drive: DriveNumbers) -> tuple[FloatArray, FloatArray]:
    """Return torque at a share of what is allowed at an engine speed, and fuel power; NaN beyond its speeds."""
    engine = drive.engine
    top = np.full(omega.shape, engine.highest_nm)
    if len(engine.full_load_radps):
        top = np.minimum(top, np.interp(omega, engine.full_load_radps, engine.full_load_nm))
    slack = 1e-12 * engine.highest_radps
    usable = (
        (omega >= engine.lowest_radps - slack) & (omega <= engine.highest_radps + slack) & (top >= engine.lowest_nm)
    )
    torque = engine.lowest_nm + share * (top - engine.lowest_nm)
    fuel = np.zeros(omega.shape)
    for i, row in enumerate(engine.fuel_w):
        for j, c in enumerate(row):
            if c != 0.0:
                fuel = fuel + c * omega**i * torque**j
    return torque, np.where(usable, fuel, np.nan)
