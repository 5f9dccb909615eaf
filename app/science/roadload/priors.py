"""How far a car's file is trusted before its trips have spoken."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.science.arrays import FloatArray
from app.science.roadload.terms import DRAG, ROLLING, Terms


@dataclass(frozen=True, slots=True)
class Priors:
    """Standard deviations of the file's values, in parts of them.

    Attributes
    ----------
    mass : float
        A registration's mass is right to a few per cent; fuel, things and passengers are not known better.
    drag : float
        A brochure's C_d is a wind tunnel's, without mirrors' dirt, roof racks or open windows.
    rolling : float
        Tyre, its pressure and the road's surface each change C_rr by a tenth or two.
    torque : float
        Of the torque an engine control unit reports, and of what the driveline leaves of it, together.
    """

    mass: float = 0.05
    drag: float = 0.20
    rolling: float = 0.30
    torque: float = 0.07

    def of(self, terms: Terms) -> tuple[FloatArray, FloatArray]:
        """Return mean and inverse variance of every coefficient, shape (p,) each."""
        road_sd = np.zeros(2)
        road_sd[DRAG], road_sd[ROLLING] = np.hypot(self.drag, self.mass), self.rolling
        return (
            np.concatenate([terms.mean, np.ones(2)]),
            1.0 / np.concatenate([terms.sd, road_sd]) ** 2,
        )


PRIORS = Priors()
