"""The costate of a drive that its method knows nothing of: the adjoint equation along it, scaled to fit H best."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from app.science.arrays import FloatArray
from app.science.optimal.accelerate.kernels import CVT, GEARS, WILLANS, DriveNumbers
from app.science.optimal.methods.found import Found, acceleration_mps2
from app.science.optimal.methods.model import highest_torque_nm, polynomial

STEP = 1e-30
AT_LIMIT = 1e-9
NARROW = 1e-9


class Adjoint(NamedTuple):
    """A costate λ_v, J s/m, along a drive, and the price of a second, W."""

    costate: FloatArray
    mu_w: float


def fitted(drive: DriveNumbers, found: Found, mu_w: float | None) -> Adjoint:
    """Return the costate for which H stays nearest to μ (least squares over time); both are affine in its end.

    λ' = −∂H/∂v is linear in λ, so H along the drive is affine in λ(T); where the price of time is not given it is
    fitted, too (Sebesta 2010, B.14, B.19).
    """
    t, power = found.trajectory.t_s, found.trajectory.fuel_power_w
    rate, forcing = _partials(drive, found)
    step = np.diff(t)
    decay = 0.5 * (rate[1:] + rate[:-1]) * step
    push = 0.5 * (forcing[1:] + forcing[:-1]) * step
    own, driven = np.ones(len(t)), np.zeros(len(t))
    held = np.where(np.abs(decay) > NARROW, np.expm1(decay) / np.where(np.abs(decay) > NARROW, decay, 1.0), 1.0)
    for k in range(len(step) - 1, -1, -1):  # backwards: near standstill λ grows too fast to be followed forwards
        own[k] = np.exp(decay[k]) * own[k + 1]
        driven[k] = np.exp(decay[k]) * driven[k + 1] - push[k] * held[k]
    accel = acceleration_mps2(drive, found)
    weight = np.sqrt(0.5 * (np.append(step, 0.0) + np.append(0.0, step)))
    columns = [own * accel, *([] if mu_w is not None else [-np.ones(len(t))])]
    target = power - driven * accel + (mu_w or 0.0)
    solved = np.linalg.lstsq(np.column_stack(columns) * weight[:, None], target * weight, rcond=None)[0]
    return Adjoint(own * solved[0] + driven, float(solved[1]) if mu_w is None else mu_w)


def _partials(drive: DriveNumbers, found: Found) -> tuple[FloatArray, FloatArray]:
    """Return ∂v̇/∂v, 1/s, and ∂P/∂v, W s/m, at each row, the control held (a torque at full load stays there)."""
    now = found.trajectory
    v = now.speed_mps
    by_speed = np.full(len(v), 0.0) - 2.0 * drive.drag_kgpm * v
    fuel = np.zeros(len(v))
    pulls = np.isfinite(now.torque_nm) if drive.kind != WILLANS else np.ones(len(v), dtype=bool)
    if drive.kind == GEARS:
        ratio = np.where(pulls, drive.spd_1pm[np.maximum(now.gear - 1, 0)], 0.0)
        omega, torque = np.where(pulls, now.engine_speed_radps, 1.0), np.where(pulls, now.torque_nm, 0.0)
        highest = highest_torque_nm(drive, omega + 1j * STEP)
        rise = np.where(torque >= np.real(highest) * (1.0 - AT_LIMIT), np.imag(highest) / STEP, 0.0)
        along = polynomial(drive, omega + 1j * STEP, torque + 1j * STEP * rise)
        by_speed += ratio**2 * rise
        fuel = np.where(pulls, ratio * np.imag(along) / STEP, 0.0)
    elif drive.kind == CVT:
        by_speed -= np.where(pulls, found.force_n / v, 0.0)
    else:
        strongest = found.force_n >= drive.force_n[1] * (1.0 - AT_LIMIT)
        power = found.force_n * v
        by_speed -= np.where(strongest, 0.0, found.force_n / v)
        fuel = np.where(strongest, found.force_n * (drive.willans[1] + 2.0 * drive.willans[2] * power), 0.0)
    return np.asarray(by_speed / drive.accelerated_kg), np.asarray(fuel)
