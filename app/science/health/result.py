"""What is known of a car's health: what changed on each trip, trends, and alerts in words."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from typing import Any, Literal

Quantity = Literal["rolling_resistance", "mass", "drag", "efficiency"]
Role = Literal["baseline", "watched", "before", "left_out"]


@dataclass(frozen=True, slots=True)
class TripChange:
    """How far one quantity was from the car's usual on one trip, as if nothing else had changed.

    Attributes
    ----------
    quantity : str
    change, sd : float
        In the unit of the quantity's trend; the standard deviation counts what healthy trips differ by.
    """

    quantity: Quantity
    change: float
    sd: float


@dataclass(frozen=True, slots=True)
class TripHealth:
    """One trip's part in the car's health.

    Attributes
    ----------
    trip_id, name : str
    started_at : float or None
        UTC, seconds since 1970-01-01.
    role : {"baseline", "watched", "before", "left_out"}
        ``baseline`` trips say what is usual; ``watched`` ones are compared with it; ``before`` ones were driven before
        what is usual was set anew; ``left_out`` ones say too little, for the ``reason`` given.
    reason : str
    changes : tuple of TripChange
        Empty where the trip was left out, or while there is no usual yet.
    """

    trip_id: str
    name: str
    started_at: float | None
    role: Role
    reason: str = ""
    changes: tuple[TripChange, ...] = ()


@dataclass(frozen=True, slots=True)
class Trend:
    """One quantity over the trips, every tuple one entry per trip that has an estimate, in driving order.

    Attributes
    ----------
    quantity : str
    title : str
        For people, such as "Rolling resistance".
    unit : str
        ``%`` of the usual, or ``kg``.
    trip_ids, names : tuple of str
    started_at : tuple of float or None
    estimate, sd : tuple of float
        Change from the usual on each trip by itself, and its standard deviation, in the unit.
    usual, usual_sd : float
        0, and how well the baseline knows it, in the unit.
    band : float
        Two standard deviations of a healthy trip of usual length about the usual, in the unit.
    change_points : tuple of str
        Trips at which the quantity went away from its usual or came back to it.
    words : str
        One sentence on how it stands.
    """

    quantity: Quantity
    title: str
    unit: str
    trip_ids: tuple[str, ...]
    names: tuple[str, ...]
    started_at: tuple[float | None, ...]
    estimate: tuple[float, ...]
    sd: tuple[float, ...]
    usual: float
    usual_sd: float
    band: float
    change_points: tuple[str, ...]
    words: str


@dataclass(frozen=True, slots=True)
class HealthAlert:
    """A change that is more than chance.

    Attributes
    ----------
    quantity : str
        What changed most probably.
    since_trip_id, last_trip_id : str
        First and last trip of the change; the last is the newest trip while the alert is open.
    raised_trip_id : str
        Trip at which it was sure enough.
    cleared_trip_id : str or None
        Trip at which the car was found back at its usual; None while the alert is open.
    trips : int
        Trips since the change, both ends included.
    change, change_sd : float
        In ``unit``, over all these trips.
    unit : str
    chance : float
        Probability that this cause, and none of the others, is it; from 0 to 1.
    other : str
        Quantity that explains it second best where it can't be ruled out; else empty.
    words : str
        "Rolling resistance 18 % above its usual, since 3 trips".
    advice : str
        What to look at.
    """

    quantity: Quantity
    since_trip_id: str
    raised_trip_id: str
    last_trip_id: str
    cleared_trip_id: str | None
    trips: int
    change: float
    change_sd: float
    unit: str
    chance: float
    other: str
    words: str
    advice: str

    @property
    def is_open(self) -> bool:
        """Whether the car has not come back to its usual."""
        return self.cleared_trip_id is None


@dataclass(frozen=True, slots=True)
class CarHealth:
    """A car's health as its trips tell it.

    Attributes
    ----------
    trips : tuple of TripHealth
        All trips given, in driving order.
    trends : tuple of Trend
        One per quantity; empty while there is no usual yet.
    alerts : tuple of HealthAlert
        Open and cleared ones, oldest first.
    words : str
        How the car stands, in a sentence.
    false_alarms_per_200_trips : float
        Alarms to be expected by chance in 200 healthy trips, all quantities together.
    baseline_trips : int
        Trips that say what is usual.
    baseline_needed : int
        Trips needed for that.
    reason : str
        Why nothing can be said yet and what to do; empty where something can.
    """

    trips: tuple[TripHealth, ...]
    trends: tuple[Trend, ...]
    alerts: tuple[HealthAlert, ...]
    words: str
    false_alarms_per_200_trips: float
    baseline_trips: int
    baseline_needed: int
    reason: str = ""

    @property
    def open_alerts(self) -> tuple[HealthAlert, ...]:
        """Alerts that have not been cleared."""
        return tuple(alert for alert in self.alerts if alert.is_open)

    def to_dict(self) -> dict[str, Any]:
        """Return plain mappings, lists, texts and finite numbers, ready for JSON."""
        return asdict(self)

    @classmethod
    def from_dict(cls, document: Mapping[str, Any]) -> CarHealth:
        """Return what `to_dict` wrote, possibly after a way through JSON.

        Raises
        ------
        TypeError
            When the document has other fields than this version writes.
        """
        plain = cls(**document)
        trips = (TripHealth(**trip) for trip in plain.trips)  # type: ignore[arg-type]  # mappings until here
        return replace(
            plain,
            trips=tuple(replace(trip, changes=_made(TripChange, trip.changes)) for trip in trips),
            trends=_made(Trend, plain.trends),
            alerts=_made(HealthAlert, plain.alerts),
        )


def _made(kind: type[Any], parts: Any) -> tuple[Any, ...]:
    """Build one dataclass from each mapping, its lists again as tuples."""
    return tuple(kind(**{key: tuple(v) if isinstance(v, list) else v for key, v in part.items()}) for part in parts)
