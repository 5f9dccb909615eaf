"""What one trip says of its car's road load: its steady windows, small enough to keep for every trip."""

from __future__ import annotations

from base64 import b64decode, b64encode
from collections.abc import Mapping
from dataclasses import dataclass
from enum import IntEnum
from typing import Any, Literal

import numpy as np

from app.science.arrays import BoolArray, FloatArray, IntArray
from app.science.roadload.levels import EfficiencySums, efficiency_sums
from app.science.roadload.windows import Regime, RoadLoadWindows
from app.science.vehicle.model import Vehicle

Model = Literal["fuel", "torque"]

LEAST_WINDOWS = 30
IDLE_SHARE, IDLE_PERCENT = 1.5, 3.0
"""An engine that burns hardly more than its lightest moments is near idle, where fuel doesn't tell power."""
STEEP, CHANGING_MPS2 = 0.02, 0.3
KEPT = (
    "t_s",
    "engine_speed_radps",
    "input",
    "speed_mps",
    "speed_squared_m2ps2",
    "normal_mps2",
    "specific_force_mps2",
    "specific_force_sd_mps2",
    "source",
)
"""Columns that are kept of each window, see `RoadLoadEvidence.kept`."""


class Source(IntEnum):
    """What a window tells the road load by."""

    COASTING = 0
    GRAVITY = 1
    ACCELERATION = 2
    CRUISING = 3


@dataclass(frozen=True, slots=True)
class RoadLoadEvidence:
    """One trip's windows, as one model of the engine uses them.

    Attributes
    ----------
    model : {"fuel", "torque"}
    kept : array of float32, shape (n, 9)
        `KEPT`, as in `RoadLoadWindows`; ``input`` is the fuel power in W or the reported torque in Nm, 0 with an open
        clutch, and ``source`` a `Source`.
    seconds : float
    speed_mps : (lowest, highest)
        10 % and 90 % quantiles.
    offset_sd : float
        A constant error of the trip's specific force, in parts of the file's rolling resistance.
    levels : EfficiencySums
    """

    model: Model
    kept: FloatArray
    seconds: float
    speed_mps: tuple[float, float]
    offset_sd: float
    levels: EfficiencySums

    def to_dict(self) -> dict[str, Any]:
        """Return the same as plain dicts, lists, texts and numbers, ready for JSON."""
        return {
            "model": self.model,
            "kept": b64encode(self.kept.astype("<f4").tobytes()).decode(),
            "seconds": self.seconds,
            "speed_mps": list(self.speed_mps),
            "offset_sd": self.offset_sd,
            "levels": self.levels.to_dict(),
        }

    @classmethod
    def from_dict(cls, plain: Mapping[str, Any]) -> RoadLoadEvidence:
        """Return what `to_dict` was made from."""
        slowest, fastest = plain["speed_mps"]
        return cls(
            model=plain["model"],
            kept=np.frombuffer(b64decode(plain["kept"]), "<f4").reshape(-1, len(KEPT)),
            seconds=float(plain["seconds"]),
            speed_mps=(float(slowest), float(fastest)),
            offset_sd=float(plain["offset_sd"]),
            levels=EfficiencySums.from_dict(plain["levels"]),
        )


def trip_evidence(windows: RoadLoadWindows, vehicle: Vehicle, model: Model) -> RoadLoadEvidence | None:
    """Return what a trip says by one model of the engine; None where it has too few windows for it.

    Parameters
    ----------
    windows : RoadLoadWindows
    vehicle : Vehicle
        As the trip was observed with.
    model : {"fuel", "torque"}
        The fuel power as a smooth function of the engine's speed and torque, or the torque it reports.
    """
    used = windows.where(usable(windows, model))
    if len(used) < LEAST_WINDOWS:
        return None
    coasts = used.kind == Regime.COAST
    told = used.fuel_power_w if model == "fuel" else used.torque_nm
    columns = [getattr(used, name) for name in KEPT if name not in ("input", "source")]
    columns.insert(KEPT.index("input"), np.where(coasts, 0.0, told))
    slowest, fastest = np.quantile(used.speed_mps, [0.1, 0.9])
    bias = used.bias_sd_mps2 if np.isfinite(used.bias_sd_mps2) else 0.0
    return RoadLoadEvidence(
        model=model,
        kept=np.nan_to_num(np.column_stack([*columns, _sources(used)])).astype(np.float32),
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


def _sources(windows: RoadLoadWindows) -> IntArray:
    driving = np.where(
        np.abs(windows.slope) >= STEEP,
        Source.GRAVITY,
        np.where(np.abs(windows.acceleration_mps2) >= CHANGING_MPS2, Source.ACCELERATION, Source.CRUISING),
    )
    return np.where(windows.kind == Regime.COAST, Source.COASTING, driving)
