"""Turns about three axes as vectors and matrices, in a few lines: the web server has no room for a library of them."""

from __future__ import annotations

import numpy as np

from app.science.arrays import FloatArray


def turn_matrix(vector: FloatArray) -> FloatArray:
    """Return the rotation by a vector's length, rad, about its direction, shape (3, 3) (Rodrigues' formula)."""
    angle = float(np.linalg.norm(vector))
    x, y, z = vector
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    half = 0.5 * angle
    return np.asarray(np.eye(3) + np.sinc(angle / np.pi) * cross + 0.5 * np.sinc(half / np.pi) ** 2 * cross @ cross)


def turn_vector(matrix: FloatArray) -> FloatArray:
    """Return axis times angle of a rotation, rad, shape (3,); the inverse of `turn_matrix` up to half a turn.

    By the quaternion that is an eigenvector of a symmetric matrix (Bar-Itzhack 2000), which holds at half a turn, too.
    """
    m = matrix
    skew = np.array([m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]])
    whole = np.empty((4, 4))
    whole[:3, :3] = m + m.T - np.trace(m) * np.eye(3)
    whole[:3, 3] = whole[3, :3] = skew
    whole[3, 3] = np.trace(m)
    quaternion = np.linalg.eigh(whole)[1][:, -1]
    quaternion = quaternion if quaternion[3] >= 0.0 else -quaternion
    sine = float(np.linalg.norm(quaternion[:3]))
    if sine == 0.0:
        return np.zeros(3)
    return np.asarray(2.0 * np.arctan2(sine, quaternion[3]) / sine * quaternion[:3])
