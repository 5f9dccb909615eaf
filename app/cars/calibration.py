"""A car's calibration from its own trips: what they propose, and a new car file when somebody wants it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import floor, log10

from sqlalchemy.orm import Session

from app.cars import service
from app.errors import Conflict, Invalid
from app.jobs.service import JobView
from app.science.calibration.evidence import TripEvidence
from app.science.calibration.proposal import Change, Name, Proposal
from app.science.calibration.propose import proposals
from app.science.roadload.identify import RoadLoad, identify
from app.science.roadload.propose import road_load_proposal
from app.storage.blobs import Blobs
from app.storage.keys import stage_key
from app.trips import service as trips

TITLES: dict[Name, str] = {
    "mounting": "How the accelerometer is mounted",
    "accelerometer_scale": "Scale of the accelerometer",
    "vss_m_per_tick": "Metres per wheel tick",
    "injector_lag": "Injector lag",
    "injector_flow": "Injector flow",
    "accelerometer_bias": "Biases of the accelerometer",
    "gps_latency": "Delay of the position fixes",
    "clock_skew": "Clock of the logger",
    "road_load": "Air drag and rolling resistance",
}
PULSES = ("pulse_count", "pulse_s")
MOST_DIGITS = 8


@dataclass(frozen=True, slots=True)
class Calibration:
    """What a car's trips say of the file in force.

    Attributes
    ----------
    config : CarConfig
    says : list of TripSays
        In the order the trips were driven.
    proposals : tuple of Proposal
    road_load : RoadLoad or None
        None where no trip tells of it.
    key : str
        Names file and proposals; other trips or another file have another key.
    """

    config: service.CarConfig
    says: list[trips.TripSays]
    proposals: tuple[Proposal, ...]
    road_load: RoadLoad | None
    key: str


@dataclass(frozen=True, slots=True)
class Applied:
    """What came of applying proposals."""

    revision: int
    note: str
    jobs: list[JobView]


def calibration(session: Session, blobs: Blobs, car_id: str, *, lock: bool = False) -> Calibration:
    """Return what the trips observed with a car's file in force propose; raises `NotFound`."""
    config = service.config(session, car_id, lock=lock)
    says = trips.evidence_of_car(session, blobs, config)
    evidences, litres = tanks(says)
    found = proposals(evidences, config.vehicle, litres) if evidences else ()
    road_load, resisting = _road_load(says, config)
    found = (*found, *resisting)
    told = [[one.name, *[[change.field, change.after] for change in one.changes]] for one in found]
    return Calibration(config, says, found, road_load, stage_key("calibration", car=config.key, proposals=told))


def _road_load(
    says: Sequence[trips.TripSays], config: service.CarConfig
) -> tuple[RoadLoad | None, tuple[Proposal, ...]]:
    """Return the road load that the trips show, and what it proposes; nothing where no trip kept what it needs."""
    evidences = [evidence for one in says for evidence in one.road_load]
    if not evidences:
        return None, ()
    found = identify(evidences, config.vehicle)
    proposal = road_load_proposal(found, config.vehicle)
    return found, () if proposal is None else (proposal,)


def tanks(says: Sequence[trips.TripSays]) -> tuple[list[TripEvidence], list[float | None]]:
    """Return the trips' evidence, and per trip what filled the tank up after it.

    A filling pays for everything since the one before. The first one only makes the tank full, and one that pays for
    a trip of which nothing is known says nothing: the trips it pays for are given without their pulses.
    """
    evidences: list[TripEvidence] = []
    litres: list[float | None] = []
    since, known = 0, False
    for one in says:
        if one.evidence is None:
            known = False
        else:
            evidences.append(one.evidence)
            litres.append(one.refuelled_l if known else None)
        if one.refuelled_l is not None:
            if not known:
                evidences[since:] = [_without_pulses(evidence) for evidence in evidences[since:]]
            since, known = len(evidences), True
    return evidences, litres


def _without_pulses(evidence: TripEvidence) -> TripEvidence:
    numbers = {name: number for name, number in evidence.numbers.items() if name not in PULSES}
    return replace(evidence, numbers=numbers)


def apply(session: Session, blobs: Blobs, car_id: str, names: Sequence[str], key: str | None) -> Applied:
    """Write proposals into the car's file as a new revision, and run all its trips again.

    Parameters
    ----------
    session : Session
    blobs : Blobs
    car_id : str
    names : sequence of str
        Of the proposals; nothing else is changed.
    key : str, optional
        Of the calibration that was looked at.

    Raises
    ------
    NotFound
        When there is no such car.
    Conflict
        When the calibration has changed since it was looked at.
    Invalid
        When one of the names is not proposed, or not sure enough to be applied.
    """
    now = calibration(session, blobs, car_id, lock=True)
    if key is not None and key != now.key:
        raise Conflict("calibration-changed", "The trips say something else by now. Look at the proposals again.")
    proposed = {one.name: one for one in now.proposals if one.is_applicable}
    unknown = [name for name in names if name not in proposed]
    if unknown:
        message = f"Not proposed for this car: {', '.join(unknown)}. Proposed: {', '.join(proposed) or 'nothing'}."
        raise Invalid("not-proposed", message, field="body.names")
    chosen = [one for name, one in proposed.items() if name in names]
    values = {field: value for one in chosen for field, value in one.form_values().items()}
    car = service.fill_form(session, car_id, values, note_of(chosen))
    return Applied(car.revision, note_of(chosen), trips.reprocess_car(session, car_id))


def note_of(chosen: Sequence[Proposal]) -> str:
    """Return where a file made of proposals came from, in words and numbers."""
    changes = [_words(change) for one in chosen for change in one.changes if change.field]
    most = max(one.trips for one in chosen)
    return f"Calibrated from {most} trip{'s' if most > 1 else ''}: {'; '.join(changes)}"


def _words(change: Change) -> str:
    """Return a change in words, with two digits of its standard deviation."""
    digits = min(max(1 - floor(log10(change.sd)), 0), MOST_DIGITS) if change.sd > 0.0 else MOST_DIGITS
    before = "not said" if change.before is None else f"{change.before:.{digits}f}"
    after = f"{change.after:.{digits}f} ± {change.sd:.{digits}f} {change.unit}".rstrip()
    return f"{change.label} {before} → {after}".replace("-", "−")
