"""What is answered: a drive, how it was certified, and what a driver is told."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal, Protocol

from app.science.arrays import FloatArray, IntArray

Verdict = Literal["optimal", "extremal", "best found", "rejected"]


class Documented(Protocol):
    """Any answer: it can be told as JSON."""

    def document(self) -> dict[str, Any]:
        """Return the answer with the names others rely on."""
        ...


@dataclass(frozen=True, slots=True)
class Trajectory:
    """A drive over time, each array of shape (n,); where the control jumps, a time comes twice.

    Attributes
    ----------
    t_s, distance_m, speed_mps : array
    gear : int array
        From 1; 0 in neutral, and with a CVT or a Willans drive.
    engine_speed_radps, torque_nm : array
        NaN where the drive is known from the wheels only, or the engine idles.
    fuel_power_w, brake_n : array
    """

    t_s: FloatArray
    distance_m: FloatArray
    speed_mps: FloatArray
    gear: IntArray
    engine_speed_radps: FloatArray
    torque_nm: FloatArray
    fuel_power_w: FloatArray
    brake_n: FloatArray

    def document(self) -> dict[str, Any]:
        """Return the columns as lists."""
        return {name: getattr(self, name).tolist() for name in self.__slots__}


@dataclass(frozen=True, slots=True)
class Independent:
    """Another method's answer to the same problem.

    Attributes
    ----------
    method : str
        In words.
    relative_gap : float
        How much more ours takes than the other's, of ours; below 0 when ours is better.
    """

    method: str
    relative_gap: float


@dataclass(frozen=True, slots=True)
class Certificate:
    """How one knows.

    Attributes
    ----------
    hamiltonian_drift_w : float
        Largest change of H along the drive, with costates integrated by their own equation.
    transversality : float
        By how much the condition at the free end is missed, W.
    max_h_minus_mu_w : float
        Largest H − μ over a dense grid of admissible controls along the drive; above 0 another control beats ours.
    independent : Independent or None
    verdict : {"optimal", "extremal", "best found", "rejected"}
    notes : tuple of str
        What was found on the way: jumps of the costate at limits, a better competitor.
    more : mapping
        Further numbers by name.
    """

    hamiltonian_drift_w: float
    transversality: float
    max_h_minus_mu_w: float
    independent: Independent | None
    verdict: Verdict
    notes: tuple[str, ...] = ()
    more: Mapping[str, Any] = field(default_factory=dict)

    def document(self) -> dict[str, Any]:
        """Return the certificate with the names others rely on."""
        other = self.independent
        return {
            "hamiltonian_drift_w": self.hamiltonian_drift_w,
            "transversality": self.transversality,
            "max_h_minus_mu_w": self.max_h_minus_mu_w,
            "independent": other and {"method": other.method, "relative_gap": other.relative_gap},
            "verdict": self.verdict,
            "notes": list(self.notes),
            **self.more,
        }


@dataclass(frozen=True, slots=True)
class Answer:
    """A drive on the least fuel.

    Attributes
    ----------
    kind : str
        Of the problem.
    fuel_energy_j, time_s, distance_m : float
        Fuel without charges for shifts.
    gears : tuple of int
        One for each phase, neighbours differ, 0 is neutral; empty for a CVT.
    switch_speeds_mps : tuple of float
        One for each change of gear.
    multiplier_w : float
        Price of a second, μ in the running cost P_in + μ.
    trajectory : Trajectory
    costates : mapping
        By name, each array of shape (n,) along the trajectory.
    advice, warnings : tuple of str
    certificate : Certificate
    more : mapping
        Further numbers by name.
    """

    kind: str
    fuel_energy_j: float
    time_s: float
    distance_m: float
    gears: tuple[int, ...]
    switch_speeds_mps: tuple[float, ...]
    multiplier_w: float
    trajectory: Trajectory
    costates: Mapping[str, FloatArray]
    advice: tuple[str, ...]
    warnings: tuple[str, ...]
    certificate: Certificate
    more: Mapping[str, Any] = field(default_factory=dict)

    def document(self) -> dict[str, Any]:
        """Return the answer with the names others rely on."""
        return {
            "kind": self.kind,
            "fuel_energy_j": self.fuel_energy_j,
            "time_s": self.time_s,
            "distance_m": self.distance_m,
            "gears": list(self.gears),
            "switch_speeds_mps": list(self.switch_speeds_mps),
            "multiplier_w": self.multiplier_w,
            "trajectory": self.trajectory.document(),
            "costates": {name: values.tolist() for name, values in self.costates.items()},
            "advice": list(self.advice),
            "warnings": list(self.warnings),
            "certificate": self.certificate.document(),
            **self.more,
        }
