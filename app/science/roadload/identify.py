"""Mass, drag area and rolling resistance of a car from how it drove, with what its file says as a prior."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import hypot

import numpy as np

from app.science.arrays import FloatArray
from app.science.roadload.engines import DRAG, DRIVELINE, ROLLING
from app.science.roadload.evidence import KEPT, Model, RoadLoadEvidence, Source
from app.science.roadload.levels import Levels, Resistance, added, levels
from app.science.roadload.priors import PRIORS, Priors
from app.science.roadload.solve import solve
from app.science.roadload.words import reasons_of, warnings_of
from app.science.vehicle.model import Vehicle

IDENTIFIED = 0.5
"""A value is identified when driving leaves at most this share of its prior's standard deviation."""
SHARES = ("prior", "coasting", "gravity", "acceleration", "cruising")


@dataclass(frozen=True, slots=True)
class Share:
    """How much of the information rests on one source, one of `SHARES`."""

    source: str
    share: float


@dataclass(frozen=True, slots=True)
class Identified:
    """One value of the car's file, and what driving makes of it.

    Attributes
    ----------
    file, value, sd : float
        ``sd`` includes the mass's own, which drag shares in.
    prior_sd : float
    identified : bool
    shares : tuple of Share
        They add up to 1.
    """

    file: float
    value: float
    sd: float
    prior_sd: float
    identified: bool
    shares: tuple[Share, ...]


@dataclass(frozen=True, slots=True)
class RoadLoad:
    """What driving says of the road load.

    Attributes
    ----------
    model : {"fuel", "torque"} or None
        What the engine's force was taken from; None where no trip says anything.
    mass_kg, cd_area_m2, crr : Identified
    cd_area_sd_given_mass_m2 : float
        Without the mass's share.
    correlation : float
        Of the errors of drag area and rolling resistance.
    trips, driving_windows, coasting_windows : int
    hours : float
    levels : Levels or None
        The engine's efficiency with the file's road load and with this one.
    reasons : tuple of str
        Why a value isn't identified.
    warnings : tuple of str
    """

    model: Model | None
    mass_kg: Identified
    cd_area_m2: Identified
    crr: Identified
    cd_area_sd_given_mass_m2: float
    correlation: float
    trips: int
    driving_windows: int
    coasting_windows: int
    hours: float
    levels: Levels | None
    reasons: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()


def identify(trips: Sequence[RoadLoadEvidence], vehicle: Vehicle, priors: Priors = PRIORS) -> RoadLoad:
    """Combine trips into one road load.

    Trips with the fuel they burned count before trips that only know the torque, because a smooth function of fuel
    needs no trust in the reported torque. Force over mass tells D/M and C_rr; mass, drag and efficiency scale together,
    so that the mass itself comes from the file alone, unless the engine reports its torque.

    Parameters
    ----------
    trips : sequence of RoadLoadEvidence
        Of the same vehicle; in any order.
    vehicle : Vehicle
        As the trips were observed with.
    priors : Priors, optional
    """
    by_fuel = [trip for trip in trips if trip.model == "fuel"]
    by_torque = [trip for trip in trips if trip.model == "torque"]
    used = by_fuel or by_torque
    mass = _mass(by_torque, vehicle, priors)
    file_area = vehicle.cd * vehicle.frontal_area_m2
    if not used:
        relative, correlation, shares = np.array([[1.0, priors.drag], [1.0, priors.rolling]]), 0.0, _only_prior()
        rolled = 0.0
    else:
        solved = solve(used, vehicle, priors)
        variance = np.diag(solved.covariance)
        relative = np.array([[solved.value[k], np.sqrt(variance[k])] for k in (DRAG, ROLLING)])
        correlation = float(solved.covariance[DRAG, ROLLING] / np.sqrt(variance[DRAG] * variance[ROLLING]))
        shares, rolled = solved.shares, solved.coasting
    scale, scale_sd = mass.value / mass.file, mass.sd / mass.file
    area = file_area * float(relative[0, 0]) * scale
    given_mass = file_area * float(relative[0, 1]) * scale
    drag = _identified(file_area, area, hypot(given_mass, area * scale_sd), priors.drag, shares[0], given_mass)
    rolling = _identified(
        vehicle.crr, vehicle.crr * float(relative[1, 0]), vehicle.crr * float(relative[1, 1]), priors.rolling, shares[1]
    )
    rolling_windows = [trip.kept[:, KEPT.index("source")] == Source.COASTING for trip in used]
    coasting = sum(int(one.sum()) for one in rolling_windows)
    found = RoadLoad(
        model=used[0].model if used else None,
        mass_kg=mass,
        cd_area_m2=drag,
        crr=rolling,
        cd_area_sd_given_mass_m2=given_mass,
        correlation=correlation,
        trips=len(used),
        driving_windows=sum(len(one) for one in rolling_windows) - coasting,
        coasting_windows=round(rolled * coasting),
        hours=sum(trip.seconds for trip in used) / 3600.0,
        levels=_levels(used, vehicle, mass.value, area, rolling.value),
    )
    return replace(found, reasons=reasons_of(found), warnings=warnings_of(used, found.coasting_windows))


def _mass(trips: Sequence[RoadLoadEvidence], vehicle: Vehicle, priors: Priors) -> Identified:
    """Return the mass: the file's, and what reported torque over the force it causes adds to it."""
    file, prior = vehicle.mass_kg, priors.mass
    if not trips:
        return Identified(file, file, file * prior, file * prior, False, _named(_only_prior()[0]))
    solved = solve(trips, vehicle, priors)
    relative = DRIVELINE / float(solved.value[0])
    sd = hypot(relative * float(np.sqrt(solved.covariance[0, 0])) / float(solved.value[0]), relative * priors.torque)
    told, known = 1.0 / sd**2, 1.0 / prior**2
    value = (told * relative + known) / (told + known)
    shares = np.zeros(len(SHARES))
    shares[0], shares[3] = known / (told + known), told / (told + known)
    return _identified(file, file * value, file * (told + known) ** -0.5, prior, shares)


def _identified(
    file: float, value: float, sd: float, prior: float, shares: FloatArray, own_sd: float | None = None
) -> Identified:
    prior_sd = file * prior
    identified = (sd if own_sd is None else own_sd) <= IDENTIFIED * prior_sd
    return Identified(file, value, sd, prior_sd, identified, _named(shares))


def _levels(
    trips: Sequence[RoadLoadEvidence], vehicle: Vehicle, mass_kg: float, area_m2: float, crr: float
) -> Levels | None:
    half_rho = 0.5 * vehicle.air_density_kgpm3
    before = Resistance(vehicle.mass_kg, vehicle.drag_area_kgpm, vehicle.crr)
    return levels(added([trip.levels for trip in trips]), before, Resistance(mass_kg, half_rho * area_m2, crr))


def _only_prior() -> FloatArray:
    only = np.zeros((2, len(SHARES)))
    only[:, 0] = 1.0
    return only


def _named(shares: FloatArray) -> tuple[Share, ...]:
    return tuple(Share(source, share) for source, share in zip(SHARES, shares.tolist(), strict=True))
