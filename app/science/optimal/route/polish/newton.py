"""One Newton step of the interior point: a banded matrix over the energies, with the time as one row beside it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import LinAlgError, cho_solve_banded, cholesky_banded

from app.science.arrays import FloatArray
from app.science.optimal.route.polish.basis import BASIS, DEGREE
from app.science.optimal.route.polish.mesh import Mesh


@dataclass(frozen=True, slots=True)
class Quadratic:
    """A quadratic model over energy E, force F and brakes B at the points, each array of shape (n, points).

    Attributes
    ----------
    e, f, b : array
        Gradient.
    ee, ef, ff, eb, fb, bb : array
        Hessian; ``bb`` is above 0.
    """

    e: FloatArray
    f: FloatArray
    b: FloatArray
    ee: FloatArray
    ef: FloatArray
    ff: FloatArray
    eb: FloatArray
    fb: FloatArray
    bb: FloatArray


class Assembly:
    """Elements to banded matrices: which polynomial is where, with the weights of a quadrature.

    Parameters
    ----------
    mesh : Mesh
    drag_1pm : float
        By how much drag grows with energy.
    """

    def __init__(self, mesh: Mesh, drag_1pm: float) -> None:
        self.n = len(mesh.gear)
        self.size = self.n * DEGREE + 1
        self.weight = BASIS.weights[mesh.kind] * mesh.length_m[:, None]
        self.value = BASIS.value[mesh.kind]
        self.force = BASIS.slope[mesh.kind] / mesh.length_m[:, None, None] + drag_1pm * self.value
        self._to = np.arange(self.n)[:, None] * DEGREE + np.arange(DEGREE + 1)

    def at_points(self, nodes: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return what changes of the energies at nodes do to energy and force at the points."""
        local = nodes[self._to][..., None]
        return (self.value @ local)[..., 0], (self.force @ local)[..., 0]

    def gradient(self, by_e: FloatArray, by_f: FloatArray) -> FloatArray:
        """Return the gradient of an integral over the road by the energies at nodes, shape (size,)."""
        local = ((self.weight * by_e)[:, None, :] @ self.value + (self.weight * by_f)[:, None, :] @ self.force)[:, 0, :]
        return np.asarray(np.bincount(self._to.ravel(), local.ravel(), self.size), dtype=np.float64)

    def banded(self, ee: FloatArray, ef: FloatArray, ff: FloatArray, edges: FloatArray) -> FloatArray:
        """Return the Hessian of an integral in LAPACK's upper banded form; ``edges`` adds to edges' own energies."""
        w = self.weight
        by_e = (w * ee)[..., None] * self.value + (w * ef)[..., None] * self.force
        by_f = (w * ef)[..., None] * self.value + (w * ff)[..., None] * self.force
        local = self.value.transpose(0, 2, 1) @ by_e + self.force.transpose(0, 2, 1) @ by_f
        band = np.zeros((DEGREE + 1, self.size))
        for a in range(DEGREE + 1):
            for b in range(a, DEGREE + 1):
                band[DEGREE + a - b, b : b + DEGREE * (self.n - 1) + 1 : DEGREE] += local[:, a, b]
        band[DEGREE, ::DEGREE] += edges
        return band


def reduced(model: Quadratic) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray, FloatArray]:
    """Return gradient (e, f) and Hessian (ee, ef, ff) once the brakes have taken their best value."""
    share_e, share_f = model.eb / model.bb, model.fb / model.bb
    return (
        model.e - share_e * model.b, model.f - share_f * model.b,
        model.ee - share_e * model.eb, model.ef - share_e * model.fb, model.ff - share_f * model.fb,
    )  # fmt: skip


def solved(band: FloatArray, right: FloatArray, border: FloatArray, weight: float) -> FloatArray | None:
    """Solve (A + weight · border borderᵀ) x = right with both ends held; None where A isn't positive definite."""
    try:
        factor = cholesky_banded(band[:, 1:-1], overwrite_ab=False, check_finite=False)
    except LinAlgError:
        return None  # the caller tries again with a model that is convex
    inner = np.column_stack((right[1:-1], border[1:-1]))
    a, b = cho_solve_banded((factor, False), inner, check_finite=False).T
    step = np.zeros(len(right))
    along = float(border[1:-1] @ b)
    step[1:-1] = a - b * (weight * float(border[1:-1] @ a) / (1.0 + weight * along))
    return step


def clipped(ee: FloatArray, ef: FloatArray, ff: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the nearest Hessians that bend nowhere downwards; energy is scaled so that both count alike."""
    scale = np.sqrt(np.abs(ff).mean() / (np.abs(ee).mean() + 1e-300)) + 1e-300
    matrices = np.stack([np.stack([ee * scale**2, ef * scale], -1), np.stack([ef * scale, ff], -1)], -2)
    values, vectors = np.linalg.eigh(matrices)
    least = 1e-9 * np.abs(values).max()
    kept = np.einsum("...ij,...j,...kj->...ik", vectors, np.maximum(values, least), vectors)
    return kept[..., 0, 0] / scale**2, kept[..., 0, 1] / scale, kept[..., 1, 1]
