"""The 17 states by name (Sebesta 2010, 1.15), in the order of the paper."""

from enum import IntEnum


class State(IntEnum):
    """Index of a state in the paper's vector."""

    DISTANCE = 0
    SPEED = 1
    THRUST = 2
    HEADING = 3
    PITCH = 4
    NORTH = 5
    EAST = 6
    DOWN = 7
    CURVATURE_H = 8
    CURVATURE_V = 9
    FUEL_ENERGY = 10
    FUEL_POWER = 11
    ENGINE_ANGLE = 12
    ENGINE_SPEED = 13
    BIAS_I = 14
    BIAS_J = 15
    BIAS_K = 16


STATE_COLUMNS: tuple[str, ...] = (
    "distance_m",
    "speed_mps",
    "thrust_n",
    "heading_rad",
    "pitch_rad",
    "north_m",
    "east_m",
    "down_m",
    "curvature_h_radpm",
    "curvature_v_radpm",
    "fuel_energy_j",
    "fuel_power_w",
    "engine_angle_rad",
    "engine_speed_radps",
    "bias_i_mps2",
    "bias_j_mps2",
    "bias_k_mps2",
)
"""Column of `states.parquet` for each state."""

DERIVED_COLUMNS: tuple[str, ...] = ("lat_deg", "lon_deg", "alt_m", "torque_nm", "power_w", "efficiency", "gear")
"""What follows from the states, in the same table."""
