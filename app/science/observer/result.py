"""What the observer says of a trip."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import nan
from typing import Literal

from app.science.arrays import AnyArray, FloatArray

Verdict = Literal["healthy", "doubtful", "failed"]


@dataclass(frozen=True, slots=True)
class Refusal:
    """A time in which a sensor's measurements were refused.

    Attributes
    ----------
    from_s, to_s : float
        Of the first and the last of them.
    count : int
        Measurements refused, and believed in the end.
    recovered : bool
        Whether the sensor was believed in the end; else its measurements came back by themselves, or stopped.
    """

    from_s: float
    to_s: float
    count: int
    recovered: bool


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
    within_one_sigma : float
        The same inside one; 0.683 is ideal.
    nis_low, nis_high : float
        Where 95 % of all ``nis_mean`` of a right filter lie, for so many independent measurements.
    effective_count : float
        Independent measurements that tell the mean square as well as the accepted ones.
    lag1 : float
        Correlation of neighbouring innovations of the sensor; 0 is ideal.
    portmanteau : float
        Ljung and Box's statistic of ten lags by its degrees of freedom; 1 is ideal.
    bias, bias_sd : float
        Mean of the normalised innovations, and its standard deviation from their own scatter and correlation.
    recovered : int
        Measurements outside the gate that were believed, after others were refused.
    episodes : tuple of Refusal
        The longest times of refusal, in order; ``episode_count`` were there in all.
    longest_refusal_s : float
    """

    sensor: str
    count: int
    rejected: int
    nis_mean: float
    within_two_sigma: float
    within_one_sigma: float = nan
    nis_low: float = nan
    nis_high: float = nan
    effective_count: float = nan
    lag1: float = nan
    portmanteau: float = nan
    bias: float = nan
    bias_sd: float = nan
    recovered: int = 0
    episodes: tuple[Refusal, ...] = ()
    episode_count: int = 0
    longest_refusal_s: float = 0.0


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
        1 where the measurement passed its gate, 2 where it didn't but was believed after many refusals, else 0.
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
