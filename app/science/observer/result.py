"""What the observer says of a trip."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from app.science.arrays import AnyArray, FloatArray

Verdict = Literal["healthy", "doubtful", "failed"]


@dataclass(frozen=True, slots=True)
class SensorConsistency:
    """How well one sensor's measurements agree with the filter's own uncertainty.

    Attributes
    ----------
    sensor : str
        ``vss``, ``acc_i``, ``acc_j``, ``acc_k``, ``gps_north``, … as in `Innovations`.
    count : int
        Measurements offered to the filter.
    rejected : int
        Of these, refused by the gate.
    nis_mean : float
        Mean of the normalised innovation squared of the accepted ones; 1 is ideal.
    within_two_sigma : float
        Share of accepted innovations inside two standard deviations; 0.954 is ideal.
    """

    sensor: str
    count: int
    rejected: int
    nis_mean: float
    within_two_sigma: float


@dataclass(frozen=True, slots=True)
class Innovations:
    """Innovation of every measurement, in the order it was processed.

    Attributes
    ----------
    t_s : array, shape (n,)
    sensor : integer array, shape (n,)
        Index into ``sensors``.
    innovation, sd : array, shape (n,)
        Measured minus predicted, and its predicted standard deviation, in the sensor's unit.
    accepted : integer array, shape (n,)
        1 where the measurement passed its gate.
    sensors : tuple of str
    """

    t_s: FloatArray
    sensor: AnyArray
    innovation: AnyArray
    sd: AnyArray
    accepted: AnyArray
    sensors: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Observation:
    """States of a trip over time, with uncertainty and a verdict.

    Attributes
    ----------
    columns : mapping of str to array, shape (n,)
        ``t_s``, the 17 `STATE_COLUMNS`, each of these again with ``_sd``, and the `DERIVED_COLUMNS`. A quantity that
        is not known at a time is NaN there. ``efficiency`` is NaN where the engine does not propel the car
        (thrust times speed at most 2 kW). ``gear`` is 0 in neutral, with an open clutch, or where it is unknown.
    innovations : Innovations
    sensors : tuple of SensorConsistency
    verdict : {"healthy", "doubtful", "failed"}
    reasons : tuple of str
        Why, in words.
    warnings : tuple of str
    events : int
        Measurement events processed.
    duration_s, distance_m, fuel_energy_j, fuel_l : float
        Totals of the trip; NaN where the sensors can't tell.
    filter, tuning : str
        Names of what produced this.
    smoothed : bool
    """

    columns: Mapping[str, FloatArray]
    innovations: Innovations
    sensors: tuple[SensorConsistency, ...]
    verdict: Verdict
    reasons: tuple[str, ...]
    warnings: tuple[str, ...]
    events: int
    duration_s: float
    distance_m: float
    fuel_energy_j: float
    fuel_l: float
    filter: str
    tuning: str
    smoothed: bool
