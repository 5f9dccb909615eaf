"""What a fuel polynomial is like inside its box: it must burn something, and where it is concave is named."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.science.arrays import FloatArray
from app.science.fields import ProblemError
from app.science.optimal.problem import RADPS_PER_RPM, PolynomialEngine, WillansDrive

LOOKS = 61
CURVED = 1e-9


def fuel_power_w(engine: PolynomialEngine, omega: FloatArray, torque: FloatArray) -> FloatArray:
    """Return the fuel power at engine speeds (rad/s) and torques (Nm), W."""
    total: FloatArray = np.zeros(np.broadcast_shapes(np.shape(omega), np.shape(torque)))
    for (i, j), c in zip(engine.terms, engine.coefficients, strict=True):
        total += c * omega**i * torque**j
    return np.asarray(total)


def full_load_nm(engine: PolynomialEngine, rpm: FloatArray) -> FloatArray:
    """Return the largest torque at engine speeds (rpm), Nm."""
    if not engine.full_load:
        return np.full(np.shape(rpm), engine.torque_nm[1])
    line = np.array(engine.full_load)
    return np.asarray(np.minimum(engine.torque_nm[1], np.interp(rpm, line[:, 0], line[:, 1])))


def check_fuel(engine: PolynomialEngine, path: str) -> None:
    """Refuse an engine that would make fuel, or that has no torque to give; ``path`` names its coefficients."""
    rpm = np.linspace(*engine.speed_rpm, LOOKS)[:, None]
    top = full_load_nm(engine, rpm)
    if (top <= engine.torque_nm[0]).all():
        raise ProblemError(
            "engine.full_load", f"the engine never gives more than the lowest torque, {engine.torque_nm[0]:g} Nm."
        )
    torque = engine.torque_nm[0] + np.linspace(0.0, 1.0, LOOKS)[None, :] * np.maximum(top - engine.torque_nm[0], 0.0)
    power = fuel_power_w(engine, rpm * RADPS_PER_RPM, torque)
    if power.min() < -1e-9 * np.abs(power).max():
        i, j = np.unravel_index(int(power.argmin()), power.shape)
        raise ProblemError(
            path,
            f"fuel power is {power[i, j]:.4g} W, below zero, at {rpm[i, 0]:.0f} rpm and {torque[i, j]:.1f} Nm; "
            "narrow speed_rpm or torque_nm to where the formula holds.",
        )


@dataclass(frozen=True, slots=True)
class Concavity:
    """Where fuel power is concave in torque.

    Attributes
    ----------
    share : float
        Of the field below full load, 0 to 1.
    below_nm, above_nm : float
        Highest and lowest torque at which it is concave.
    from_bottom : bool
        Whether the lowest torque belongs to it.
    """

    share: float
    below_nm: float
    above_nm: float
    from_bottom: bool


def concavity(engine: PolynomialEngine | WillansDrive) -> Concavity | None:
    """Return where fuel power is concave in torque (for a Willans drive: in power, W); None where nowhere."""
    if isinstance(engine, WillansDrive):
        low, high = engine.power_w
        return Concavity(1.0, high, low, True) if engine.willans[2] < 0.0 else None
    rpm = np.linspace(*engine.speed_rpm, LOOKS)[:, None]
    torque = np.linspace(*engine.torque_nm, 4 * LOOKS)[None, :]
    omega = np.maximum(rpm * RADPS_PER_RPM, 1e-6)
    curve = np.zeros((LOOKS, 4 * LOOKS))
    size = np.zeros((LOOKS, 4 * LOOKS))
    for (i, j), c in zip(engine.terms, engine.coefficients, strict=True):
        if j >= 2:
            part = c * omega**i * (j * (j - 1)) * torque ** (j - 2)
            curve += part
            size += np.abs(part)
    inside = torque <= full_load_nm(engine, rpm)
    concave = inside & (curve < -CURVED * size)
    if not concave.any():
        return None
    at = np.broadcast_to(torque, concave.shape)[concave]
    return Concavity(float(concave.sum() / inside.sum()), float(at.max()), float(at.min()), bool(concave[:, 0].any()))
