"""Every stage of every kind of job, and which slice does it."""

from __future__ import annotations

from collections.abc import Mapping

from app.batteries import service as batteries
from app.drives import service as drives
from app.eco import service as eco
from app.health import service as health
from app.jobs import service as jobs
from app.maps import service as maps
from app.trips import service as trips
from workers.demo import DEMO
from workers.running import Stage, StageWork


def decode(work: StageWork) -> jobs.Store:
    """From the upload's bytes to measurements."""
    return trips.decode(work.resources, work.fleet_id, _known(work.claim.trip_id), work.progress)


def observe(work: StageWork) -> jobs.Store:
    """From measurements to states, operating points and a verdict."""
    return trips.observe(work.resources, work.fleet_id, _known(work.claim.trip_id), work.progress)


def update_map(work: StageWork) -> jobs.Store:
    """From operating points to a new version of the car's map."""
    return maps.update(work.resources, work.fleet_id, _known(work.claim.car_id), work.progress)


def assess_health(work: StageWork) -> jobs.Store:
    """From the road load of the car's trips to what has changed about it."""
    return health.assess(work.resources, work.fleet_id, _known(work.claim.car_id), work.progress)


def estimate_battery(work: StageWork) -> jobs.Store:
    """From the battery's current and voltage on a trip to what is in it, and what is left of it."""
    return batteries.estimate_trip(work.resources, work.fleet_id, _known(work.claim.trip_id), work.progress)


def score(work: StageWork) -> jobs.Store:
    """From a trip's states and the car's map to what the best drive would have taken."""
    return eco.score(work.resources, work.fleet_id, _known(work.claim.trip_id), work.progress)


def work_on_drive(work: StageWork) -> jobs.Store:
    """From a drive problem to what its job asks about it: the answer, methods compared, a front."""
    drive_id = _known(work.claim.drive_id)
    return drives.run(work.resources, work.fleet_id, drive_id, work.claim.job_id, work.progress)


def work_on_battery(work: StageWork) -> jobs.Store:
    """From measurements of a battery to what its job asks: an estimate, all of them again, a curve; or the report."""
    return batteries.run(work.resources, work.fleet_id, work.claim.battery_id, work.claim.job_id, work.progress)


def _known(identifier: str | None) -> str:
    if identifier is None:
        raise ValueError("this kind of job belongs to a trip, a car or a drive, and the row names none")
    return identifier


STAGES: Mapping[tuple[str, str], Stage] = {
    ("trip", "decode"): decode,
    ("trip", "observe"): observe,
    ("trip", "map"): update_map,
    ("trip", "health"): assess_health,
    ("trip", "battery"): estimate_battery,
    ("trip", "score"): score,
    ("map", "map"): update_map,
    ("map", "health"): assess_health,
    ("score", "score"): score,
    **{("drive", name): work_on_drive for name in drives.WORKS},
    **{("battery", name): work_on_battery for name in batteries.WORKS},
    **{("demo", name): stage for name, stage in DEMO.items()},
}
