"""What is asked: a car, its engine and gears, and what it is to do on the least fuel (Sebesta 2010, ch. 4)."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi
from typing import Literal

from app.science.errors import ScienceError

RADPS_PER_RPM = pi / 30.0

TABLE_4_1 = ((0, 0), (1, 0), (0, 1), (1, 1), (2, 0), (0, 2))
"""Powers of engine speed and torque in the order of Table 4.1: 1, ω, T, ωT, ω², T²."""


class Infeasible(ScienceError):  # noqa: N818 - the name the design gives it
    """No drive fulfils the problem.

    Parameters
    ----------
    message : str
        Which number is impossible, by how much, and what would be possible.
    limit : str
        The limit that binds, as the path of the problem's field.
    """

    code = "infeasible"

    def __init__(self, message: str, limit: str = "") -> None:
        super().__init__(f"{limit}: {message}" if limit else message)
        self.limit = limit


@dataclass(frozen=True, slots=True)
class RoadLoad:
    """What the road and the air take from a car on its way.

    Attributes
    ----------
    mass_kg, accelerated_mass_kg : float
        The second counts what turns, too.
    cd, frontal_area_m2, crr, air_density_kgpm3, gravity_mps2, wheel_radius_m : float
    """

    mass_kg: float
    accelerated_mass_kg: float
    cd: float
    frontal_area_m2: float
    crr: float
    air_density_kgpm3: float
    gravity_mps2: float
    wheel_radius_m: float

    @property
    def drag_kgpm(self) -> float:
        """½ ρ C_d A, kg/m."""
        return 0.5 * self.air_density_kgpm3 * self.cd * self.frontal_area_m2

    @property
    def rolling_n(self) -> float:
        """M C_rr g, N; on the level."""
        return self.mass_kg * self.crr * self.gravity_mps2

    def resistance_n(self, speed_mps: float) -> float:
        """Drag and rolling resistance on the level, N."""
        return self.drag_kgpm * speed_mps**2 + self.rolling_n


@dataclass(frozen=True, slots=True)
class PolynomialEngine:
    """Fuel power as a polynomial in engine speed and torque, inside a box of both and below full load.

    Attributes
    ----------
    terms : tuple of (power of ω, power of T)
    coefficients : tuple of float
        Of fuel power in W, one for each term, with ω in rad/s and T in Nm.
    speed_rpm, torque_nm : (lowest, highest)
        In gear the torque is never below the lowest.
    full_load : tuple of (rpm, Nm)
        Largest torque, linear between the points and constant beyond them; empty where only the box limits.
    idle_fuel_power_w : float
        Burned in neutral.
    """

    terms: tuple[tuple[int, int], ...]
    coefficients: tuple[float, ...]
    speed_rpm: tuple[float, float]
    torque_nm: tuple[float, float]
    full_load: tuple[tuple[float, float], ...] = ()
    idle_fuel_power_w: float = 0.0

    @classmethod
    def of_phi(
        cls,
        phi: tuple[float, ...],
        speed_rpm: tuple[float, float],
        torque_nm: tuple[float, float],
        full_load: tuple[tuple[float, float], ...] = (),
        idle_fuel_power_w: float = 0.0,
        terms: tuple[tuple[int, int], ...] = TABLE_4_1,
    ) -> PolynomialEngine:
        """Return the engine whose fuel power is ω T φ(ω, T) (Sebesta 2010, Table 4.1)."""
        raised = tuple((i + 1, j + 1) for i, j in terms)
        return cls(raised, phi, speed_rpm, torque_nm, full_load, idle_fuel_power_w)


@dataclass(frozen=True, slots=True)
class WillansDrive:
    """A drive seen from the wheels: P_fuel = c0 + c1·P + c2·P², W, with P the power at the wheels.

    Attributes
    ----------
    willans : (c0, c1, c2)
        c0 burns always, in neutral and when braking too.
    power_w, force_n : (lowest, highest)
    """

    willans: tuple[float, float, float]
    power_w: tuple[float, float]
    force_n: tuple[float, float]


Engine = PolynomialEngine | WillansDrive


@dataclass(frozen=True, slots=True)
class Transmission:
    """Gears or a continuously variable ratio.

    Attributes
    ----------
    kind : {"gears", "cvt"}
    ratios : tuple of float
        Total, engine to wheel, first gear first; empty for a CVT.
    neutral : bool
        Whether the car may roll with the engine idling.
    shift_cost_j : float
        Charged for every change of gear; the first gear of a drive is free.
    """

    kind: Literal["gears", "cvt"]
    ratios: tuple[float, ...] = ()
    neutral: bool = False
    shift_cost_j: float = 0.0


@dataclass(frozen=True, slots=True)
class Accelerate:
    """Reach a higher speed on the level (Sebesta 2010, 4.4).

    Attributes
    ----------
    load, engine, transmission
    from_speed_mps, to_speed_mps : float
    time_s : float or None
        Exact; None leaves it free.
    brake_max_n : float
        Brakes act in neutral only; those of a CVT or a Willans drive anywhere.
    """

    load: RoadLoad
    engine: Engine
    transmission: Transmission
    from_speed_mps: float
    to_speed_mps: float
    time_s: float | None = None
    brake_max_n: float = 0.0


@dataclass(frozen=True, slots=True)
class Distance:
    """Cover a distance on the level with a CVT, in any time, to any speed at its end (Sebesta 2010, 4.5)."""

    load: RoadLoad
    engine: Engine
    transmission: Transmission
    from_speed_mps: float
    distance_m: float
    brake_max_n: float = 0.0


@dataclass(frozen=True, slots=True)
class Road:
    """A road by its points, each array as a tuple of equal length.

    Attributes
    ----------
    distance_m : tuple of float
        Along the road, growing.
    elevation_m : tuple of float
        Linear between the points; sin θ = dz/ds.
    speed_limit_mps : tuple of float
        Each holds from its point up to the next one.
    """

    distance_m: tuple[float, ...]
    elevation_m: tuple[float, ...]
    speed_limit_mps: tuple[float, ...]


@dataclass(frozen=True, slots=True)
class Route:
    """Drive a road within its limits and, where ``max_time_s`` is given, no longer than that."""

    load: RoadLoad
    engine: Engine
    transmission: Transmission
    road: Road
    from_speed_mps: float
    to_speed_mps: float
    min_speed_mps: float
    max_time_s: float | None = None
    brake_max_n: float = 0.0


@dataclass(frozen=True, slots=True)
class BallAndWheel:
    """Bring a ball on a wheel to rest on top in the least time (Sebesta 2010, App. G), in normal form."""

    x1: float
    x2: float
    u_min: float
    u_max: float
    gamma: float


DriveProblem = Accelerate | Distance | Route
Problem = DriveProblem | BallAndWheel
