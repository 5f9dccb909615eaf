"""What to simulate."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

from app.science.vehicle.model import Injection, Vehicle
from app.science.virtualcar.engine import EngineModel

RouteName = Literal["mixed", "motorway", "town", "full-load", "tunnel"]

# The Smart Roadster of Sebesta 2010, Table 3.1 and App. C.1.2. Its injectors are a little larger than the thesis'
# 0.008 l/s: with 60 kW and Table 4.1 a pulse at full load would otherwise last 17.1 ms, more than the logger's
# 16 bits of 250 ns can hold.
DEFAULT_CAR = Vehicle(
    owner="Ponthy",
    make="Smart",
    model="Roadster",
    year="2004",
    color="grey",
    engine_type="698cc Inline 3 Turbo Suprex",
    displacement_l=0.698,
    max_power_w=60e3,
    max_power_rpm=5250.0,
    max_torque_nm=110.0,
    max_torque_rpm=4500.0,
    compression_ratio=9.0,
    tyre="205/45 R16",
    wheel_radius_m=0.2954,
    accelerometer_type="LIS3LV02DL",
    transmission_type="6-spd sequential",
    gear_ratios=(13.25, 9.604, 7.37, 5.796, 4.208, 3.23),
    crr=0.010,
    injection=Injection(litres_per_second=0.0085),
)


@dataclass(frozen=True, slots=True)
class SensorSettings:
    """How good the sensors are; the defaults are the thesis' logger as issue 2 describes it.

    Attributes
    ----------
    accelerometer_sd_mps2, accelerometer_sd_per_mps : (along, sideways, vertical)
        Standard deviation of the noise at standstill and its growth with speed.
    accelerometer_correlation_s : float
        Correlation time of that noise.
    gps_sd_m, gps_correlation_s : (horizontal per axis, vertical)
        Slowly wandering part of the position error.
    gps_white_sd_m : (horizontal per axis, vertical)
        Part that is new in each fix.
    gps_latency_s : float
        From the moment of a fix to its first character at the logger.
    gps_cold_start_s : float
        Time without a fix at the beginning.
    gps_outages_per_hour : float
        Short losses of the fix, 5–40 s each, besides the tunnel's three minutes.
    """

    accelerometer_sd_mps2: tuple[float, float, float] = (0.03, 0.03, 0.03)
    accelerometer_sd_per_mps: tuple[float, float, float] = (0.008, 0.008, 0.03)
    accelerometer_correlation_s: float = 0.035
    gps_sd_m: tuple[float, float] = (2.5, 5.0)
    gps_correlation_s: tuple[float, float] = (120.0, 150.0)
    gps_white_sd_m: tuple[float, float] = (0.3, 0.5)
    gps_latency_s: float = 0.05
    gps_cold_start_s: float = 8.0
    gps_outages_per_hour: float = 2.0


@dataclass(frozen=True, slots=True)
class ImageSettings:
    """How the logger writes its image.

    Attributes
    ----------
    big_endian : bool
    clock_start_ms : int
        What the logger's 32-bit clock shows at the trip's time zero; near 2³² it wraps on the way.
    gps_packet_bytes : int
        GPS text is written in packets of this many bytes, cut anywhere.
    zero_padding_bytes : int
        Unwritten rest of the card's file behind the last packet.
    skew_every_s, error_every_s : float
        Mean time between time-skew packets and between error messages.
    """

    big_endian: bool = False
    clock_start_ms: int = 0
    gps_packet_bytes: int = 64
    zero_padding_bytes: int = 4096
    skew_every_s: float = 60.0
    error_every_s: float = 900.0


@dataclass(frozen=True, slots=True)
class Simulation:
    """One trip of the virtual car.

    Attributes
    ----------
    duration_s : float
        Length of the recording, at least 60 s.
    seed : int
        Everything random follows from it.
    route : {"mixed", "motorway", "town", "full-load", "tunnel"}
    vehicle : Vehicle or None
        The car, taken as it is. None: `DEFAULT_CAR` with a mounting drawn from the seed.
    engine : EngineModel or None
        None: Table 4.1, stretched to the car's rated torque and power. Either way the full load is lowered where
        the injectors can't deliver its fuel.
    start_lat_deg, start_lon_deg : float
    started_at_utc_s : float
        UTC at the trip's time zero, seconds since 1970-01-01.
    sensors : SensorSettings
    image : ImageSettings
    bias_mps2 : (forward, right, down) or None
        The accelerometer's biases. None: drawn from the seed; give further trips of the same car those of the first.
    truth_step_s : float
        Spacing of the truth, a multiple of 0.005 s.
    elevation_rounding_m : float
        Altitudes of the elevation table are rounded to this.
    """

    duration_s: float = 3600.0
    seed: int = 1
    route: RouteName = "mixed"
    vehicle: Vehicle | None = None
    engine: EngineModel | None = None
    start_lat_deg: float = 49.6
    start_lon_deg: float = 6.1
    started_at_utc_s: float = 1256629260.0
    sensors: SensorSettings = field(default_factory=SensorSettings)
    image: ImageSettings = field(default_factory=ImageSettings)
    bias_mps2: tuple[float, float, float] | None = None
    truth_step_s: float = 0.05
    elevation_rounding_m: float = 0.1
