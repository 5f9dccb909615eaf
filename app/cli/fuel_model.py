"""``./ponthy fuel-model``: fuel from the power at the wheels, for cars on rollers or without an engine speed."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from app.cli.compare import FuelName
from app.cli.options import AsJson
from app.cli.output import say, table
from app.science.errors import ScienceError

if TYPE_CHECKING:
    from app.science.engine.wheel_fuel import WheelFuelModel
    from app.science.engine.wheel_power import DrivingCycle, RoadLoad
    from app.science.vehicle.fuels import Fuel

TURNING_SHARE = 0.03
"""Of the mass, for wheels and shafts, where no XML tells."""
GRAVITY_MPS2 = 9.80665
AIR_DENSITY_KGPM3 = 1.2

Test = Annotated[list[Path], typer.Argument(metavar="TEST.csv…", exists=True, dir_okay=False)]


def fuel_model(
    tests: Test,
    car: Annotated[Path | None, typer.Option(exists=True, dir_okay=False, help="XML with the road load.")] = None,
    mass: Annotated[float | None, typer.Option(min=100.0, help="Instead: mass on the rollers, kg.")] = None,
    cda: Annotated[float | None, typer.Option(min=0.0, help="Drag area, m²; with --crr.")] = None,
    crr: Annotated[float | None, typer.Option(min=0.0, max=0.1, help="Rolling resistance coefficient.")] = None,
    abc: Annotated[str | None, typer.Option(help="Instead of both: A,B,C in N, N/(m/s), N/(m/s)².")] = None,
    predict: Annotated[
        list[Path] | None, typer.Option(exists=True, dir_okay=False, help="Cycle whose fuel to predict; repeatable.")
    ] = None,
    cold: Annotated[bool, typer.Option("--cold", help="What is predicted starts with a cold engine.")] = False,
    fuel: Annotated[FuelName, typer.Option(help="What the car burns.")] = FuelName.PETROL,
    as_json: AsJson = False,
) -> None:
    """Fit fuel by power at the wheels to tests of speed and fuel, and predict what other cycles burn.

    A prediction looks at the speed alone; where its table has a fuel flow, the two are compared.
    """
    from app.imports.cycle import read_cycle
    from app.science.engine.wheel_fuel_fit import fit_wheel_fuel
    from app.science.vehicle.fuels import FUELS

    load, burnt = road_load(car, mass, cda, crr, abc), FUELS[fuel.value]
    model = fit_wheel_fuel([read_cycle(path.read_bytes(), path.stem, burnt) for path in tests], load)
    cycles = [read_cycle(path.read_bytes(), path.stem, burnt) for path in predict or []]
    answers = [predicted(model, cycle, load, burnt, cold=cold) for cycle in cycles]
    told = told_lines(model)
    for answer in answers:
        told += predicted_lines(answer)
    say({"model": document(model), "predictions": answers}, as_json, table(told))


def road_load(
    car: Path | None, mass_kg: float | None, cda_m2: float | None, crr: float | None, abc: str | None
) -> RoadLoad:
    """Return the road load of a car's file or of numbers; raises `typer.BadParameter` for half of one."""
    from app.science.engine.wheel_power import RoadLoad
    from app.science.vehicle.xml import read_vehicle

    if car is not None:
        if (mass_kg, cda_m2, crr, abc) != (None, None, None, None):
            raise typer.BadParameter("Give the car's file or numbers, not both.", param_hint="--car")
        return RoadLoad.of(read_vehicle(car.read_bytes()))
    if mass_kg is None:
        raise typer.BadParameter("Tell the road load: --car CAR.xml, or --mass with --cda and --crr, or with --abc.")
    accelerated = mass_kg * (1.0 + TURNING_SHARE)
    if abc is not None:
        try:
            a_n, b_npmps, c_npmps2 = (float(word) for word in abc.split(","))
        except ValueError as error:
            raise typer.BadParameter("Three numbers with commas: A,B,C.", param_hint="--abc") from error
        return RoadLoad(accelerated, a_n, b_npmps, c_npmps2)
    if cda_m2 is None or crr is None:
        raise typer.BadParameter("--mass needs --cda and --crr, or --abc.", param_hint="--mass")
    return RoadLoad(accelerated, mass_kg * GRAVITY_MPS2 * crr, 0.0, 0.5 * AIR_DENSITY_KGPM3 * cda_m2)


def document(model: WheelFuelModel) -> dict[str, Any]:
    """Return a model as JSON."""
    from app.science.engine.wheel_fuel import TERMS

    units = ("w", "w", "w", "", "1pw")
    names = [f"{term}_{unit}".rstrip("_") for term, unit in zip(TERMS, units, strict=True)]
    values = dict(zip(names, model.coefficients.tolist(), strict=True))
    deviations = {f"{name}_sd": sd for name, sd in zip(names, model.sd.tolist(), strict=True)}
    others = ("creep_mps", "gaining_share", "top_w", "warm_up_j", "warm_up_sd_j", "rms_w", "quadratic", "distance_m")
    return values | deviations | {name: getattr(model, name) for name in others} | {"tests": list(model.tests)}


def told_lines(model: WheelFuelModel) -> list[list[str]]:
    """Return a model in words."""
    idle, overrun, constant, slope, curvature = zip(model.coefficients, model.sd, strict=True)
    lines = [
        ["idle", f"{idle[0] / 1e3:.2f} ± {idle[1] / 1e3:.2f} kW"],
        ["overrun", f"{overrun[0] / 1e3:.2f} ± {overrun[1] / 1e3:.2f} kW"],
        ["driving, c0", f"{constant[0] / 1e3:.2f} ± {constant[1] / 1e3:.2f} kW"],
        ["per watt at the wheels, c1", f"{slope[0]:.3f} ± {slope[1]:.3f}"],
        ["creeps below", f"{model.creep_mps * 3.6:.0f} km/h"],
        ["gaining speed, beyond the mass", f"{100 * model.gaining_share:.0f} %"],
        ["fitted up to", f"{model.top_w / 1e3:.1f} kW"],
        ["residual over 10 s, RMS", f"{model.rms_w / 1e3:.2f} kW"],
    ]
    if model.quadratic:
        lines.insert(4, ["per kW squared, c2", f"{curvature[0] * 1e6:.1f} ± {curvature[1] * 1e6:.1f} W"])
    if model.warm_up_j is not None and model.warm_up_sd_j is not None:
        lines.append(["a start from cold", f"{model.warm_up_j / 1e6:.2f} ± {model.warm_up_sd_j / 1e6:.2f} MJ"])
    return lines


def predicted(model: WheelFuelModel, cycle: DrivingCycle, load: RoadLoad, fuel: Fuel, *, cold: bool) -> dict[str, Any]:
    """Predict a cycle's fuel; beside it stands what was measured, where it was."""
    from app.science.engine.wheel_fuel import predict

    if cycle.distance_m < 1.0:
        raise ScienceError(f"The car does not move in {cycle.name}; there is nothing to predict.")
    found = predict(model, cycle, load, cold=cold)
    litres = found.energy_j / fuel.energy_j_per_l
    answer: dict[str, Any] = {
        "name": cycle.name,
        "distance_m": cycle.distance_m,
        "fuel_energy_j": found.energy_j,
        "fuel_energy_sd_j": found.energy_sd_j,
        "fuel_l": litres,
        "litres_per_100km": litres / cycle.distance_m * 1e5,
        "warm_up_j": found.warm_up_j,
        "beyond_top": found.beyond_top,
        "measured_fuel_energy_j": None,
        "difference": None,
    }
    if cycle.fuel_power_w is not None and cycle.fuel_power_w.sum() > 0.0:
        measured = float(cycle.fuel_power_w.sum())
        answer |= {"measured_fuel_energy_j": measured, "difference": found.energy_j / measured - 1.0}
    return answer


def predicted_lines(answer: dict[str, Any]) -> list[list[str]]:
    """Return a prediction in words."""
    sd = answer["fuel_energy_sd_j"] / answer["fuel_energy_j"]
    lines = [[answer["name"], f"{answer['litres_per_100km']:.2f} l/100 km ± {100 * sd:.1f} %"]]
    if answer["difference"] is not None:
        lines.append(["  over what was measured", f"{100 * answer['difference']:+.2f} %"])
    if answer["beyond_top"] > 0.25:
        lines.append(["  asked for at more power than was fitted", f"{100 * answer['beyond_top']:.0f} %"])
    return lines
