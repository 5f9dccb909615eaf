"""``./ponthy battery-curve``: a cell's open-circuit curve and circuit from laboratory data."""

from __future__ import annotations

from math import isnan
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from app.cli.options import AsJson
from app.cli.output import note, say, table, write_json

if TYPE_CHECKING:
    from app.science.battery.characterise import Characterised

SHOWN_ROWS = 12


def battery_curve(
    data: Annotated[
        list[Path], typer.Argument(metavar="DATA…", exists=True, dir_okay=False, help="Slow sweeps, pulses with rests.")
    ],
    capacity_ah: Annotated[
        float | None, typer.Option("--capacity-ah", min=1e-3, help="Of one cell, where no full discharge is there.")
    ] = None,
    series: Annotated[int, typer.Option(min=1, help="Cells in series.")] = 1,
    parallel: Annotated[int, typer.Option(min=1, help="Cells side by side.")] = 1,
    limits: Annotated[
        tuple[float, float] | None, typer.Option("--limits", metavar="EMPTY FULL", help="One cell's end voltages.")
    ] = None,
    ends: Annotated[
        tuple[float, float], typer.Option("--ends", metavar="EMPTY FULL", help="States of charge that the ends are.")
    ] = (0.0, 1.0),
    polynomial: Annotated[
        int | None, typer.Option(min=1, max=12, help="Degree of a polynomial over 10 to 90 % instead of a table.")
    ] = None,
    out: Annotated[Path | None, typer.Option(dir_okay=False, help="Configuration for `battery` to write.")] = None,
    as_json: AsJson = False,
) -> None:
    """Fit the open-circuit curve, identify the circuit, and list measured capacities."""
    from app.imports.battery import read_battery
    from app.science.battery.characterise import characterise

    if limits is not None and not limits[0] < limits[1]:
        raise typer.BadParameter("--limits wants the empty cell's voltage first, below the full one's")
    if not 0.0 <= ends[0] < ends[1] <= 1.0:
        raise typer.BadParameter("--ends wants two states of charge between 0 and 1, the empty end's first")
    records = [read_battery(path.read_bytes(), path.name) for path in data]
    found = characterise(records, capacity_ah, series, parallel, limits, polynomial, ends)
    if out is not None:
        write_json(out, found.configuration())
        note(f"{out} written")
    say(document(found, data), as_json, words(found, data))


def document(found: Characterised, data: list[Path]) -> dict[str, Any]:
    """Return all that was found, with the configuration inside."""
    fitted, polynomial = found.fitted, found.polynomial
    return {
        "configuration": found.configuration(),
        "curve": {name: getattr(fitted, name).tolist() for name in ("soc", "volts", "spread_v", "resistance_ohm")},
        "capacity_ah": fitted.capacity_ah,
        "misfit_v": fitted.misfit_v,
        "polynomial": None
        if polynomial is None
        else {"rms_v": polynomial.rms_v, "worst_v": polynomial.worst_v, "falls": polynomial.falls},
        "circuits": [{"data": path.name} | one.document() for path, one in zip(data, found.circuits, strict=True)],
        "tests": [{name: getattr(test, name) for name in test.__dataclass_fields__} for test in found.tests],
        "warnings": list(fitted.warnings),
    }


def words(found: Characterised, data: list[Path]) -> str:
    """Return curve, circuits and capacities as tables, and warnings."""
    fitted, polynomial = found.fitted, found.polynomial
    lines = [table(curve_rows(found)), f"capacity {fitted.capacity_ah:.4g} Ah, misfit {millis(fitted.misfit_v)} mV rms"]
    if polynomial is not None:
        off = f"{millis(polynomial.rms_v)} mV rms and {millis(polynomial.worst_v)} mV at most off the table"
        lines.append(f"polynomial: {off}")
    lines += ["", table(circuit_rows(found, data))]
    if found.tests:
        lines += ["", table(test_rows(found))]
    lines += [f"warning: {one}" for one in fitted.warnings]
    named = zip(data, found.circuits, strict=True)
    return "\n".join([*lines, *(f"warning: {path.name}: {one}" for path, made in named for one in made.warnings)])


def curve_rows(found: Characterised) -> list[list[str]]:
    """Return every few rows of the curve."""
    fitted = found.fitted
    rows = [["SOC %", "volts", "charge over discharge, mV", "taken off, mΩ"]]
    for k in range(0, len(fitted.soc), max(1, len(fitted.soc) // SHOWN_ROWS)):
        numbers = f"{fitted.volts[k]:.4f}", millis(fitted.spread_v[k]), millis(fitted.resistance_ohm[k])
        rows.append([f"{100.0 * fitted.soc[k]:.1f}", *numbers])
    return rows


def circuit_rows(found: Characterised, data: list[Path]) -> list[list[str]]:
    """Return the circuit that each file tells."""
    rows = [["circuit", "Q, Ah", "R, mΩ", "C_r, F", "R_r, mΩ", "τ, s", "rms, mV"]]
    for path, one in zip(data, found.circuits, strict=True):
        triples = zip(one.values[:4], one.sds[:4], (1.0, 1e3, 1.0, 1e3), strict=True)
        told = [f"{scale * value:.4g} ± {scale * sd:.1g}" for value, sd, scale in triples]
        rows.append([path.name, *told, f"{one.circuit.time_constant_s:.3g}", millis(one.voltage_rms_v)])
    return rows


def test_rows(found: Characterised) -> list[list[str]]:
    """Return the capacities that were measured outright."""
    rows = [["capacity test", "Ah", "±", "at A"]]
    for test in found.tests:
        numbers = f"{test.capacity_ah:.3f}", f"{test.sd_ah:.3f}", f"{test.current_a:.3g}"
        rows.append([f"{test.direction} until {test.t_s:.0f} s", *numbers])
    return rows


def millis(value: float) -> str:
    """Return thousandths with three digits; a dash for what is not known."""
    return "-" if isnan(value) else f"{1e3 * value:.3g}"
