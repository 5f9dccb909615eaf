"""What a trip takes over from the car's earlier ones: the biases of its accelerometer."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import timedelta
from typing import Any

from sqlalchemy.orm import Session

from app.cars.service import CarConfig
from app.science.observer.carry_over import BiasPrior, FinalBias, bias_prior, final_bias
from app.science.observer.result import Observation
from app.science.observer.tuning import tuning_to_dict
from app.trips import repository
from app.trips.models import Trip
from app.trips.tunings import tuning_of

SUMMARY = "final_bias_mps2"
"""Where a trip's summary says what was known of the biases at its end."""
MOST_TRIPS = 20
LOOKED_AT = 200


@dataclass(frozen=True, slots=True)
class CarriedOver:
    """A prior and the trips it comes from.

    Attributes
    ----------
    prior : BiasPrior or None
    trips : tuple of (trip_id, observe_key)
    """

    prior: BiasPrior | None
    trips: tuple[tuple[str, str], ...]

    def numbers(self) -> dict[str, list[float]] | None:
        """Return the prior as plain numbers; None without one."""
        if self.prior is None:
            return None
        return {"mean_mps2": list(self.prior.mean), "sd_mps2": list(self.prior.sd)}

    def provenance(self) -> dict[str, Any] | None:
        """Return the prior and where it comes from; None without one."""
        numbers = self.numbers()
        if numbers is None:
            return None
        return {**numbers, "trips": [{"trip_id": trip, "observe_key": key} for trip, key in self.trips]}


NOTHING = CarriedOver(None, ())


def carried_over(session: Session, trip: Trip, car: CarConfig, options: dict[str, Any]) -> CarriedOver:
    """Return what a trip takes over: from healthy trips of the same car file and tuning that were over before.

    When a trip began never changes, so no trip takes over what it gave itself, by however many others.
    """
    if not options["carry_over"] or "acc" in options["without"]:
        return NOTHING
    tuning = tuning_to_dict(tuning_of(options["tuning"]))
    found: list[tuple[Trip, FinalBias]] = []
    for earlier in repository.healthy_before(session, trip, LOOKED_AT):
        said = earlier.provenance
        bias = said_bias(earlier)
        same = said.get("config_sha256") == car.sha256 and said.get("tuning") == tuning
        if bias is not None and same and _is_over(earlier, trip):
            found.append((earlier, bias))
    found = found[:MOST_TRIPS]
    prior = bias_prior([bias for _, bias in found], car.vehicle.load_kg)
    if prior is None:
        return NOTHING
    return CarriedOver(prior, tuple((earlier.id, earlier.observe_key or "") for earlier, _ in found))


def _is_over(earlier: Trip, trip: Trip) -> bool:
    """Whether a trip had ended when another began, as far as their clocks tell: a car drives one at a time."""
    if earlier.started_at is None or trip.started_at is None:
        return True
    return earlier.started_at + timedelta(seconds=earlier.duration_s or 0.0) <= trip.started_at


def said_bias(trip: Trip) -> FinalBias | None:
    """Return what an observed trip's end knew of the biases, if it is known."""
    said = trip.summary.get(SUMMARY)
    if said is None:
        return None
    (i, j, k), (sd_i, sd_j, sd_k) = said["mean"], said["sd"]
    return FinalBias((i, j, k), (sd_i, sd_j, sd_k), trip.provenance["load_kg"])


def bias_summary(observation: Observation, without: list[str]) -> dict[str, Any] | None:
    """Return what stands in the summary under `SUMMARY`; None where the accelerometer said nothing."""
    said = None if "acc" in without else final_bias(observation, 0.0)
    return None if said is None else {"mean": list(said.mean), "sd": list(said.sd)}
