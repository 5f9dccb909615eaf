"""How much the observer trusts its model and its sensors: presets and tuning files."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, fields, replace
from difflib import get_close_matches
from sys import float_info
from typing import Any

from app.science.errors import TuningError


@dataclass(frozen=True, slots=True)
class Tuning:
    """Spectral densities of the process noise and variances of the measurements.

    Process noise ``q_*`` is the diagonal of Q_c (Sebesta 2010, Table 3.2), state unit squared per second. Where a
    density depends on speed it is ``q · max(v, 1)**exponent``. Measurement noise ``r_*`` is a variance in the unit of
    the measurement squared (Table 3.3); of the accelerometer it is ``(floor + slope · v)²`` per axis.

    ``unsteady_boost`` multiplies ``q_thrust`` where thrust may change within a fraction of a second: around a gear
    change, and where the wheel ticks show that the acceleration changes.

    ``*_order`` is the number of terms of the local polynomial model of a quantity that the thesis takes for constant
    (Note 12): 1 as there, 2 with a slope, 3 with a curve; ``q_*_slope`` and ``q_*_curve`` are the densities of these.
    ``ukf_*`` are α, β, κ of the unscented filters. ``aekf_*`` are of the adaptive high-gain filter (A.4.4): the
    innovation above which G rises and below which it falls by one each window, and the largest G.
    """

    name: str = "default"
    q_distance: float = 1e-06
    q_speed: float = 1e-05
    q_thrust: float = 5000.0
    q_heading: float = 0.0001
    q_pitch: float = 2.5e-09
    q_north: float = 0.01
    q_east: float = 0.01
    q_down: float = 0.0003
    q_curvature_h: float = 2e-05
    q_curvature_v: float = 2e-09
    curvature_v_exponent: float = 1.0
    q_fuel_energy: float = 0.01
    q_fuel_power: float = 1e9
    q_engine_angle: float = 0.001
    q_engine_speed: float = 300.0
    q_bias_i: float = 1e-10
    q_bias_j: float = 1e-10
    q_bias_k: float = 1e-10
    unsteady_boost: float = 300.0
    r_distance: float = 0.0001
    r_speed: float = 0.04
    r_gnss_speed: float = 0.04
    r_standstill: float = 0.0001
    acc_floor_i: float = 0.05
    acc_slope_i: float = 0.0136
    acc_floor_j: float = 0.3
    acc_slope_j: float = 0.02
    acc_floor_k: float = 0.05
    acc_slope_k: float = 0.05
    r_heading: float = 0.03
    r_pitch: float = 0.03
    r_gps_horizontal: float = 1200.0
    r_gps_vertical: float = 10000.0
    r_road_altitude: float = 0.08
    r_curvature_h: float = 1000000.0
    r_yaw_rate: float = 4e-4
    r_fuel_energy: float = 1.0
    r_fuel_power: float = 1000000.0
    r_engine_angle: float = 0.01
    r_engine_speed: float = 25.0
    r_engine_torque: float = 100.0
    thrust_order: int = 1
    q_thrust_slope: float = 1e4
    q_thrust_curve: float = 1e4
    fuel_power_order: int = 1
    q_fuel_power_slope: float = 1e10
    q_fuel_power_curve: float = 1e11
    engine_speed_order: int = 1
    q_engine_speed_slope: float = 1e3
    q_engine_speed_curve: float = 1e4
    ukf_alpha: float = 0.5
    ukf_beta: float = 2.0
    ukf_kappa: float = 0.0
    aekf_upper: float = 8.0
    aekf_lower: float = 2.0
    aekf_window_s: float = 1.0
    aekf_gain_max: float = 3.0

    @property
    def thrust_slope_noise(self) -> tuple[float, ...]:
        """Densities of what the thrust's local model adds to its 13 companions."""
        return (self.q_thrust_slope, self.q_thrust_curve)[: self.thrust_order - 1]

    @property
    def fuel_noise(self) -> tuple[float, ...]:
        """Densities of fuel energy, fuel power, and of what the local model of the power adds."""
        slopes = (self.q_fuel_power_slope, self.q_fuel_power_curve)[: self.fuel_power_order - 1]
        return (self.q_fuel_energy, self.q_fuel_power, *slopes)

    @property
    def engine_noise(self) -> tuple[float, ...]:
        """Densities of engine angle, engine speed, and of what the local model of the speed adds."""
        slopes = (self.q_engine_speed_slope, self.q_engine_speed_curve)[: self.engine_speed_order - 1]
        return (self.q_engine_angle, self.q_engine_speed, *slopes)


DEFAULT = Tuning()

THESIS_2010 = Tuning(
    name="thesis-2010",
    q_distance=0.1,
    q_speed=0.01,
    q_thrust=90000.0,
    q_heading=0.01,
    q_pitch=1.5625e-8,
    q_north=1e-4,
    q_east=1e-4,
    q_down=1e-5,
    q_curvature_h=1e-6,
    q_curvature_v=1e-9,
    curvature_v_exponent=-2.0,
    q_fuel_energy=0.01,
    q_fuel_power=50000.0,
    q_engine_angle=0.01,
    q_engine_speed=500.0,
    q_bias_i=1e-17,
    q_bias_j=1e-17,
    q_bias_k=1e-17,
    unsteady_boost=1.0,
    r_distance=0.05,
    acc_floor_i=1.0,
    acc_slope_i=0.0,
    acc_floor_j=2.0,
    acc_slope_j=0.0,
    acc_floor_k=50.0**0.5,
    acc_slope_k=0.0,
    r_heading=0.03,
    r_pitch=0.03,
    r_gps_horizontal=100.0,
    r_gps_vertical=1000.0,
    r_road_altitude=1.0,
    r_curvature_h=1e6,
    r_fuel_energy=1.0,
    r_engine_angle=0.016,
)
"""Tables 3.2 and 3.3 of Sebesta 2010 as printed; the 1/v² of Q(10, 10) is held at v = 1 m/s below that speed."""

PRESETS = {preset.name: preset for preset in (DEFAULT, THESIS_2010)}

ORDERS = ("thrust_order", "fuel_power_order", "engine_speed_order")
HIGHEST_ORDER = 3
LARGEST = float_info.max

_MAY_BE_ANY_NUMBER = {"curvature_v_exponent", "ukf_kappa"}
_MAY_BE_ZERO = {"acc_slope_i", "acc_slope_j", "acc_slope_k"}


def tuning_from_dict(entries: dict[str, object], name: str = "file") -> Tuning:
    """Build a tuning from a mapping; what it leaves out comes from the preset it names under ``base``.

    Raises
    ------
    TuningError
        For an unknown entry, or a value that can't be a covariance.
    """
    entries = dict(entries)
    base_name = entries.pop("base", "default")
    entries.pop("name", None)
    if not isinstance(base_name, str) or base_name not in PRESETS:
        raise TuningError(f"base: there is no tuning called {base_name!r}; there are {', '.join(PRESETS)}.")
    known = {field.name for field in fields(Tuning)} - {"name"}
    values: dict[str, Any] = {}
    for key, value in entries.items():
        if key not in known:
            raise TuningError(f"{key}: no such entry in a tuning. {_alike(str(key), known)}")
        if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) <= LARGEST:
            raise TuningError(f"{key}: {str(value)[:40]!r} is not a finite number.")
        lowest_allowed = key in _MAY_BE_ANY_NUMBER or value > 0 or (value == 0 and key in _MAY_BE_ZERO)
        if not lowest_allowed:
            raise TuningError(f"{key}: {value} can't be a covariance; it must be above zero.")
        if key in ORDERS and value not in range(1, HIGHEST_ORDER + 1):
            raise TuningError(f"{key}: {value} is not an order; it is 1, 2 or 3.")
        values[key] = int(value) if key in ORDERS else float(value)
    return replace(PRESETS[base_name], name=name, **values)


def _alike(key: str, known: set[str]) -> str:
    close = get_close_matches(key, known, n=1)
    return f"Did you mean {close[0]}?" if close else f"Entries are {', '.join(sorted(known))}."


def tuning_from_json(text: str | bytes, name: str = "file") -> Tuning:
    """Build a tuning from the text of a tuning file, a JSON object of entries; errors as `tuning_from_dict`."""
    try:
        entries = json.loads(text)
    except json.JSONDecodeError as error:
        raise TuningError(f"line {error.lineno}: this is not JSON ({error.msg}).") from None
    except (UnicodeDecodeError, RecursionError, ValueError):
        raise TuningError("This is not JSON: a tuning file is a text with an object of entries.") from None
    if not isinstance(entries, dict):
        raise TuningError('A tuning file is a JSON object of entries such as {"q_thrust": 1e6}.')
    return tuning_from_dict(entries, name)


def tuning_to_dict(tuning: Tuning) -> dict[str, float | str]:
    """Return every entry by name, fit to be written to a tuning file."""
    return asdict(tuning)
