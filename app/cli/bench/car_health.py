"""Benchmark ``health``: virtual cars that stay healthy, and the same cars with something wrong."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from app.cli.bench.figure import Figure
from app.cli.output import note
from app.imports.elevation import read_elevation
from app.science.health.assess import TripLoad, assess
from app.science.health.baseline import BASELINE_TRIPS
from app.science.health.result import HealthAlert, Quantity
from app.science.logger.decode import decode_image
from app.science.observer.carry_over import TRIP_TO_TRIP_SD_MPS2, FinalBias, bias_prior, final_bias
from app.science.observer.observe import observe
from app.science.roadload.windows import windows
from app.science.vehicle.model import Injection, Vehicle
from app.science.virtualcar.engine import EngineModel
from app.science.virtualcar.simulate import simulate
from app.science.virtualcar.specification import DEFAULT_CAR, RouteName, Simulation

DURATION_S = 1800.0
ROUTES: tuple[RouteName, ...] = ("mixed", "mixed", "mixed", "motorway", "town")
HEALTHY_TRIPS = 25
"""Of each car, behind its baseline."""
FAULTY_TRIPS = 5
STEPS_S = 86400.0

SALOON = replace(
    DEFAULT_CAR,
    make="Virtual",
    model="Saloon",
    displacement_l=1.8,
    max_power_w=103e3,
    max_power_rpm=6000.0,
    max_torque_nm=173.0,
    max_torque_rpm=4200.0,
    cylinders=4,
    cd=0.29,
    crr=0.011,
    frontal_area_m2=2.15,
    mass_wet_kg=1320.0,
    gear_ratios=(13.5, 7.6, 5.2, 3.9, 3.1),
    injection=Injection(litres_per_second=0.018),
)
VAN = replace(
    SALOON,
    model="Van",
    max_power_w=110e3,
    max_power_rpm=5500.0,
    max_torque_nm=220.0,
    cd=0.36,
    crr=0.012,
    frontal_area_m2=3.6,
    mass_wet_kg=1850.0,
    gear_ratios=(16.0, 9.2, 6.1, 4.5, 3.6),
    injection=Injection(litres_per_second=0.024),
)


@dataclass(frozen=True, slots=True)
class Subject:
    """A car of the benchmark; ``heights`` says whether altitudes along its roads are known."""

    seed: int
    vehicle: Vehicle | None = None
    heights: bool = True


SUBJECTS = (
    Subject(9601),
    Subject(9602),
    Subject(9603),
    Subject(9604, SALOON),
    Subject(9605, SALOON),
    Subject(9616, VAN),
    Subject(9607, heights=False),
    Subject(9608, SALOON, heights=False),
)


@dataclass(frozen=True, slots=True)
class Fault:
    """Something that happens to a car, and how much it is in the unit of the quantity."""

    name: str
    quantity: Quantity
    change: float
    unit: str
    befall: Callable[[Vehicle, EngineModel], tuple[Vehicle, EngineModel]]


def _weaker(engine: EngineModel, share: float) -> EngineModel:
    phi = tuple(one / share for one in engine.phi)
    return replace(engine, phi=phi, idle_fuel_power_w=engine.idle_fuel_power_w / share)


FAULTS = (
    Fault("C_rr +20 %", "rolling_resistance", 20.0, "%", lambda car, engine: (replace(car, crr=1.2 * car.crr), engine)),
    Fault("+150 kg", "mass", 150.0, "kg", lambda car, engine: (replace(car, load_kg=car.load_kg + 150.0), engine)),
    Fault("drag +25 %", "drag", 25.0, "%", lambda car, engine: (replace(car, cd=1.25 * car.cd), engine)),
    Fault("efficiency −6 %", "efficiency", -6.0, "%", lambda car, engine: (car, _weaker(engine, 0.94))),
)


class Garage:
    """One car that is driven trip after trip; what its trips know of the accelerometer's biases is carried over."""

    def __init__(self, subject: Subject) -> None:
        rng = np.random.default_rng(subject.seed)
        drawn = simulate(Simulation(duration_s=60.0, seed=subject.seed)).vehicle.mounting
        self.subject = subject
        self.vehicle = replace(subject.vehicle or DEFAULT_CAR, mounting=drawn)
        self.engine = EngineModel.for_vehicle(self.vehicle).limited_by_injectors(self.vehicle)
        self.own_bias = rng.uniform(0.05, 0.2, 3) * rng.choice([-1.0, 1.0], 3)
        self.known: list[FinalBias] = []

    def drive(self, number: int, fault: Fault | None = None) -> TripLoad:
        """Drive a trip and observe it with the file of the healthy car; the same number is the same way again."""
        rng = np.random.default_rng([self.subject.seed, number])
        i, j, k = (float(bias) for bias in self.own_bias + TRIP_TO_TRIP_SD_MPS2 * rng.standard_normal(3))
        vehicle, engine = (self.vehicle, self.engine) if fault is None else fault.befall(self.vehicle, self.engine)
        trip = simulate(
            Simulation(
                duration_s=DURATION_S,
                seed=self.subject.seed + 100 * number,
                route=ROUTES[int(rng.integers(len(ROUTES)))],
                vehicle=vehicle,
                engine=engine,
                bias_mps2=(i, j, k),
            )
        )
        seen = observe(
            decode_image(trip.image).recordings[0],
            self.vehicle,
            elevation=read_elevation(trip.elevation_csv) if self.subject.heights else None,
            bias_prior=bias_prior(self.known, self.vehicle.load_kg),
        )
        bias = final_bias(seen, self.vehicle.load_kg)
        self.known += [] if bias is None else [bias]
        return TripLoad(str(number), f"trip {number}", STEPS_S * number, windows(seen, self.vehicle))


@dataclass(frozen=True, slots=True)
class Found:
    """What became of a fault: trips until the alarm, and the alert at the end; None where there was none."""

    delay: int | None
    alert: HealthAlert | None


def healthy_and_faulty(subject: Subject, healthy: int, faulty: int) -> tuple[int, dict[str, Found]]:
    """Return the false alarms of a car's healthy trips, and what became of each fault right behind its baseline."""
    garage = Garage(subject)
    baseline = [garage.drive(number) for number in range(BASELINE_TRIPS)]
    known = list(garage.known)
    found = {}
    for fault in FAULTS:
        garage.known = list(known)
        trips = [garage.drive(BASELINE_TRIPS + number, fault) for number in range(faulty)]
        found[fault.name] = _found(garage.vehicle, baseline, trips)
    garage.known = known
    watched = [garage.drive(BASELINE_TRIPS + number) for number in range(healthy)]
    return len(assess([*baseline, *watched], garage.vehicle).alerts), found


def _found(vehicle: Vehicle, baseline: list[TripLoad], trips: list[TripLoad]) -> Found:
    alerts = assess([*baseline, *trips], vehicle).alerts
    if not alerts:
        return Found(None, None)
    raised = [trip.trip_id for trip in trips].index(alerts[0].raised_trip_id)
    return Found(raised + 1, alerts[0])


def measure() -> list[Figure]:
    """Return false alarms, and per fault how soon it is found, how often named rightly, and how well measured."""
    false_alarms = 0
    found: dict[str, list[Found]] = {fault.name: [] for fault in FAULTS}
    for subject in SUBJECTS:
        alarms, faults = healthy_and_faulty(subject, HEALTHY_TRIPS, FAULTY_TRIPS)
        false_alarms += alarms
        for name, one in faults.items():
            found[name].append(one)
        note(f"car {subject.seed}: {alarms} false alarms; {'; '.join(map(_told, faults.values()))}")
    trips = HEALTHY_TRIPS * len(SUBJECTS)
    quiet = Figure("healthy trips without a false alarm", trips - false_alarms, "trips", trips, "all", "higher", "all")
    return [quiet, *(figure for fault in FAULTS for figure in _figures(fault, found[fault.name]))]


def _told(one: Found) -> str:
    if one.alert is None:
        return "nothing found"
    return f"{one.alert.words}, ± {one.alert.change_sd:.1f}, at trip {one.delay}"


def _figures(fault: Fault, found: list[Found]) -> list[Figure]:
    named = [one.alert for one in found if one.alert is not None and one.alert.quantity == fault.quantity]
    delays = [one.delay for one in found if one.delay is not None]
    figures = [
        Figure(f"{fault.name}: found and named rightly", len(named), "cars", len(found), "all", "higher", "all"),
        Figure(
            f"{fault.name}: slowest alarm", max(delays, default=np.inf), "trips", FAULTY_TRIPS, "driven", goal="≤ 5"
        ),
    ]
    if not named:
        return figures
    changes, sds = np.array([(one.change, one.change_sd) for one in named]).T
    errors = np.abs(changes - fault.change)
    inside = int(np.count_nonzero(errors <= 2.0 * sds))
    return [
        *figures,
        Figure(f"{fault.name}: mean found", float(changes.mean()), fault.unit, fault.change, "true", "higher"),
        Figure(f"{fault.name}: largest error", float(errors.max()), fault.unit, abs(fault.change), "true"),
        Figure(f"{fault.name}: true inside 2 sd", inside, "cars", len(named), "named rightly", "higher"),
    ]
