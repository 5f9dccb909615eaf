"""The road load as a proposal for the car's file, with its evidence in words."""

from __future__ import annotations

from app.science.calibration.proposal import Change, Proposal
from app.science.calibration.question import SIGNIFICANT_SDS, change
from app.science.roadload.identify import Identified, RoadLoad
from app.science.vehicle.model import Vehicle

LEAST = 0.03
"""Below this share a change would move efficiencies by less than they are known."""
DRAG_FIELD, ROLLING_FIELD, MASS_FIELD = "drag/aero@Cd", "drag/rolling@Crr", "mass@wet"


def road_load_proposal(found: RoadLoad, vehicle: Vehicle) -> Proposal | None:
    """Propose another C_d (the frontal area stays), C_rr, and the mass where it is known from driving.

    Drag and rolling resistance are estimated together, so that they are proposed together as soon as either differs by
    more than three standard deviations and 3 %. It is never more than likely: wind and the mass can't be seen.

    Returns
    -------
    Proposal or None
        None where nothing differs, or nothing can be told; the road load itself says why.
    """
    if found.model is None or not (found.cd_area_m2.identified or found.crr.identified) or _is_absurd(found):
        return None
    changes = _changes(found, vehicle)
    if not changes:
        return None
    return Proposal("road_load", changes, (*_basis(found), *_effect(found)), "likely", found.trips)


def _is_absurd(found: RoadLoad) -> bool:
    """A resistance that pushes is a sign of wrong gears, fuel or slopes, not of a road load."""
    return found.cd_area_m2.value <= 0.0 or found.crr.value <= 0.0


def _changes(found: RoadLoad, vehicle: Vehicle) -> tuple[Change, ...]:
    area, own = found.cd_area_m2, found.cd_area_sd_given_mass_m2
    drag = change(DRAG_FIELD, vehicle, area.value / vehicle.frontal_area_m2, own / vehicle.frontal_area_m2, 4)
    rolling = change(ROLLING_FIELD, vehicle, found.crr.value, found.crr.sd, 5)
    mass = change(MASS_FIELD, vehicle, found.mass_kg.value - vehicle.load_kg, found.mass_kg.sd, 1)
    together = [one for one, of in ((drag, area), (rolling, found.crr)) if of.identified]
    road = together if _differs(area, own) or _differs(found.crr, found.crr.sd) else []
    heavier = found.mass_kg.identified and _differs(found.mass_kg, found.mass_kg.sd)
    return (*road, *([mass] if heavier else []))


def _differs(one: Identified, sd: float) -> bool:
    apart = abs(one.value - one.file)
    return one.identified and apart > SIGNIFICANT_SDS * sd and apart > LEAST * one.file


def _basis(found: RoadLoad) -> tuple[str, ...]:
    area, by = found.cd_area_m2, "the fuel burned" if found.model == "fuel" else "the torque the engine reports"
    return (
        f"{found.hours:.1f} h of steady driving in {found.trips} trip{'s' if found.trips > 1 else ''}, "
        f"{found.driving_windows} windows in gear and {found.coasting_windows} rolling with an open clutch; the "
        f"engine's force from {by}.",
        f"C_d·A is {area.value:.3f} m² ± {found.cd_area_sd_given_mass_m2:.3f} for a mass of "
        f"{found.mass_kg.value:.0f} kg; with the mass' own uncertainty ± {area.sd:.3f}.",
        f"Where it comes from, C_d·A: {_shares(area)}; C_rr: {_shares(found.crr)}.",
    )


def _shares(one: Identified) -> str:
    named = {"prior": "the car file", "gravity": "slopes", "acceleration": "accelerating"}
    return ", ".join(
        f"{named.get(of.source, of.source)} {100.0 * of.share:.0f} %" for of in one.shares if of.share >= 0.005
    )


def _effect(found: RoadLoad) -> tuple[str, ...]:
    levels = found.levels
    if levels is None:
        return ("What it does to the efficiency can't be told without the fuel burned.",)
    told = [
        f"The efficiency over all that was driven goes from {100.0 * levels.before:.1f} % to "
        f"{100.0 * levels.after:.1f} %."
    ]
    if levels.best is not None:
        best = levels.best
        told.append(
            f"At the best point, near {best.rpm:.0f} rpm and {best.nm_before:.0f} Nm, it goes from "
            f"{100.0 * best.before:.1f} % to {100.0 * best.after:.1f} %."
        )
    return tuple(told)
