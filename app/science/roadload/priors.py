"""How far a car's file is trusted before its trips have spoken."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.science.arrays import FloatArray


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

    @property
    def road_precision(self) -> FloatArray:
        """Inverse variance of drag per mass and of rolling resistance, shape (2,)."""
        return 1.0 / np.array([np.hypot(self.drag, self.mass), self.rolling]) ** 2


PRIORS = Priors()
