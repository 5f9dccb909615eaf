"""The accelerometer's mounting from the directions it sees the car's axes in."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from app.science.arrays import FloatArray
from app.science.calibration.evidence import Combined
from app.science.calibration.turning import turn_matrix, turn_vector
from app.science.vehicle.model import Mounting

USUAL_BIAS_MPS2 = 0.15
"""What a cheap accelerometer reads too much, constantly: it tilts the apparent gravity by 0.9°."""
ROUNDS = 10
FORWARD, RIGHT, DOWN = range(3)


@dataclass(frozen=True, slots=True)
class Turned:
    """A mounting found from driving.

    Attributes
    ----------
    mounting : Mounting
    covariance_rad2 : array, shape (3, 3)
        Of small turns about the car's forward, right and down axes.
    scale_sd : float
    with_bends : bool
        Whether bends told where right is, too.
    disagreement : float
        Of the directions among each other, in standard deviations (root mean square); about 1 is as it should be.
    """

    mounting: Mounting
    covariance_rad2: FloatArray
    scale_sd: float
    with_bends: bool
    disagreement: float

    @property
    def sd_rad(self) -> float:
        """Standard deviation of the total angle, rad."""
        return float(np.sqrt(np.trace(self.covariance_rad2)))

    @property
    def angle_covariance(self) -> FloatArray:
        """Covariance of roll, pitch, yaw, shape (3, 3); grows without bound as the pitch nears 90°."""
        step = 1e-6
        here = angles_of(self.mounting)
        rotation = rotation_of(self.mounting)
        slope = np.empty((3, 3))
        for axis in range(3):
            moved = mounting_of(turn_matrix(step * np.eye(3)[axis]) @ rotation, 1.0)
            slope[:, axis] = np.angle(np.exp(1j * (angles_of(moved) - here))) / step
        return np.asarray(slope @ self.covariance_rad2 @ slope.T)


def rotation_of(mounting: Mounting) -> FloatArray:
    """Rotation from the sensor's axes to the car's, shape (3, 3)."""
    return replace(mounting, scale=1.0).matrix


def angles_of(mounting: Mounting) -> FloatArray:
    """Roll, pitch and yaw, rad."""
    return np.array([mounting.roll_rad, mounting.pitch_rad, mounting.yaw_rad])


def mounting_of(rotation: FloatArray, scale: float) -> Mounting:
    """Mounting with the angles of a rotation from the sensor's axes to the car's, shape (3, 3)."""
    m = rotation
    pitch = float(np.arcsin(np.clip(-m[2, 0], -1.0, 1.0)))
    return Mounting(float(np.arctan2(m[2, 1], m[2, 2])), pitch, float(np.arctan2(m[1, 0], m[0, 0])), scale)


def angle_between(one: Mounting, other: Mounting) -> FloatArray:
    """Turn about the car's axes that leads from one mounting to the other, rad, shape (3,)."""
    return turn_vector(rotation_of(other) @ rotation_of(one).T)


def find_mounting(
    forward: Combined, right: Combined | None, level: Combined, gravity: Combined, gravity_mps2: float
) -> Turned:
    """Solve for the rotation by weighted least squares, iterated from the axes themselves.

    Forward and right tell the yaw; the level, and gravity as far as no bias tilts it, tell roll and pitch.

    Parameters
    ----------
    forward, right : Combined
        Raw readings per unit of acceleration.
    level : Combined
        Direction of the car's down axis among the raw axes.
    gravity : Combined
        Mean raw reading, m/s²; a bias of `USUAL_BIAS_MPS2` in any direction is allowed for.
    gravity_mps2 : float
        Gravity at the place, m/s².
    """
    size = float(np.linalg.norm(gravity.value))
    down = Combined(-gravity.value, gravity.covariance + USUAL_BIAS_MPS2**2 * np.eye(3), gravity.trips)
    parts = [(FORWARD, forward, (RIGHT,)), (DOWN, level, (FORWARD, RIGHT)), (DOWN, down, (FORWARD, RIGHT))]
    if right is not None:
        parts.append((RIGHT, right, (FORWARD,)))
    rotation = _first_guess(forward.value, level.value)
    for _ in range(ROUNDS):
        equations = [_tilt(rotation, axis, seen, towards) for axis, seen, towards in parts]
        turns, tilts = (np.concatenate(sides) for sides in zip(*equations, strict=True))
        covariance = np.linalg.inv(turns.T @ turns)
        step = covariance @ turns.T @ tilts
        rotation = turn_matrix(step) @ rotation
    left = float(np.sum((tilts - turns @ step) ** 2)) / (len(tilts) - 3)
    scale = gravity_mps2 / size
    along = gravity.value / size
    return Turned(
        mounting=mounting_of(rotation, scale),
        covariance_rad2=covariance * max(left, 1.0),
        scale_sd=scale * float(np.sqrt(along @ down.covariance @ along)) / size,
        with_bends=right is not None,
        disagreement=float(np.sqrt(left)),
    )


def _first_guess(forward: FloatArray, down: FloatArray) -> FloatArray:
    side, down = np.cross(down, forward), down / np.linalg.norm(down)
    side /= np.linalg.norm(side)
    return np.array([np.cross(side, down), side, down])


def _tilt(rotation: FloatArray, axis: int, seen: Combined, towards: tuple[int, ...]) -> tuple[FloatArray, FloatArray]:
    """Whitened equations for the small turn that brings a seen axis to where it belongs, (k, 3) and (k,).

    Only its leaning ``towards`` k of the car's other axes counts.
    """
    length = float(np.linalg.norm(seen.value))
    rows = list(towards)
    body = rotation @ seen.value / length
    covariance = (rotation @ seen.covariance @ rotation.T)[np.ix_(rows, rows)] / length**2
    whiten = np.linalg.inv(np.linalg.cholesky(covariance))
    turn = -np.cross(np.eye(3), np.eye(3)[axis]).T[rows]
    return whiten @ turn, whiten @ body[rows]
