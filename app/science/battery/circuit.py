"""What a cell is made of: the second-order equivalent circuit, and what temperature and direction do to it."""

from __future__ import annotations

from dataclasses import dataclass

from app.science.battery.curve import OpenCircuit

AS_PER_AH = 3600.0


@dataclass(frozen=True, slots=True)
class Circuit:
    """The four parameters of MAUTC-2010-02, eqs 55 and 56, at the reference temperature.

    Attributes
    ----------
    capacity_ah : float
        Charge between empty and full, Q.
    resistance_ohm : float
        In series, R.
    relaxation_capacitance_f, relaxation_resistance_ohm : float
        In parallel to each other, C_r and R_r.
    """

    capacity_ah: float
    resistance_ohm: float
    relaxation_capacitance_f: float
    relaxation_resistance_ohm: float

    @property
    def capacity_as(self) -> float:
        """Capacity, ampere-seconds."""
        return AS_PER_AH * self.capacity_ah

    @property
    def time_constant_s(self) -> float:
        """Of the relaxation, 1/σ, seconds."""
        return self.relaxation_capacitance_f * self.relaxation_resistance_ohm


@dataclass(frozen=True, slots=True)
class Warmth:
    """How a cell depends on its temperature.

    Attributes
    ----------
    reference_c : float
        Temperature at which the circuit's parameters hold, °C.
    resistance_k, relaxation_k : float
        B of R(T) = R · exp(B (1/T − 1/T_ref)) for R and for R_r, kelvin; the relaxation's time constant stays.
    capacity_per_k : float
        Share of the capacity that is gained per kelvin.
    """

    reference_c: float = 25.0
    resistance_k: float = 0.0
    relaxation_k: float = 0.0
    capacity_per_k: float = 0.0


@dataclass(frozen=True, slots=True)
class Hysteresis:
    """How the voltage at rest depends on the direction the charge came from.

    A state h from −1 to 1 follows the current, dh/ds = rate · (sign(I) − h) per whole capacity s moved, and adds
    ``voltage_v`` · h to the open-circuit voltage.
    """

    voltage_v: float
    rate: float


@dataclass(frozen=True, slots=True)
class Cell:
    """One cell of a pack, and how many there are.

    Attributes
    ----------
    curve : OpenCircuit
    circuit : Circuit
        What it is thought to be.
    soc : float
        State of charge to begin with, 0 to 1.
    series, parallel : int
        Cells in series, and how many of such strings stand side by side.
    warmth, hysteresis : optional
    """

    curve: OpenCircuit
    circuit: Circuit
    soc: float
    series: int = 1
    parallel: int = 1
    warmth: Warmth | None = None
    hysteresis: Hysteresis | None = None
