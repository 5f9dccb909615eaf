"""What the methods are called and where they come from; light, so that forms and pages may list them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Named:
    """A method in words.

    Attributes
    ----------
    title : str
    source : str
        Where the thesis describes it.
    """

    title: str
    source: str


NAMES: Mapping[str, Named] = {
    "pontryagin": Named(
        "Pontryagin: the best control at each speed, integrals over speed, a root in the price of time",
        "Sebesta 2010, B.2.5",
    ),
    "single_shooting": Named("Single shooting for the costate", "Sebesta 2010, B.3.1.1"),
    "multiple_shooting": Named(
        "Multiple shooting: nodes along the drive, Newton on the defects between them", "Sebesta 2010, B.3.1.2"
    ),
    "boundary_value": Named("Two-point boundary value problem by collocation over speed", "Sebesta 2010, B.20"),
    "direct_single_shooting": Named(
        "Direct single shooting: controls held over intervals, one integration, a nonlinear programme",
        "Sebesta 2010, B.3.2.1",
    ),
    "direct_multiple_shooting": Named(
        "Direct multiple shooting: speeds at the intervals' starts are unknowns, too", "Sebesta 2010, B.3.2.2"
    ),
    "dp_speed": Named("Dynamic programming over speed and gear", "Sebesta 2010, B.2.3"),
    "dp_speed_time": Named("Dynamic programming over speed and time", "Sebesta 2010, B.2.3"),
    "hjb_upwind": Named(
        "Hamilton–Jacobi–Bellman equation by the explicit upwind scheme, and the drive that follows it",
        "Sebesta 2010, B.3.3",
    ),
    "dp_distance_energy_gear": Named(
        "Dynamic programming over distance, energy and gear, by stages of a road", "Sebesta 2010, B.2.3"
    ),
    "polish": Named(
        "Interior point over distance, from the drive by stages or, where all is smooth, from scratch",
        "Sebesta 2010, B.2.4",
    ),
    "corner": Named("The least fuel power all the way, which the thesis takes for the best", "Sebesta 2010, 4.5"),
    "lqr": Named("Linear quadratic regulator towards the speed; it does not know of fuel", "Sebesta 2010, B.2.2.1"),
    "dlqr": Named("The regulator that acts every half second", "Sebesta 2010, B.2.2.2"),
}
