"""``./ponthy simulate-battery``: days of a hybrid's battery with known truth."""

from __future__ import annotations

from dataclasses import asdict, replace
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from app.cli.drive import read_document
from app.cli.options import AsJson
from app.cli.output import note, say, write_json

if TYPE_CHECKING:
    from app.science.arrays import FloatArray
    from app.science.battery.circuit import Cell
    from app.science.battery.virtual.ageing import DegradationMap
    from app.science.battery.virtual.pack import VirtualData, VirtualPack

USUAL_SOC = 0.7
SECONDS_PER_DAY = 86400.0
OFF_SHARE = 0.1
"""Of the time, for which the estimator is off at first: a day of ten, ten days of a hundred, as in the report."""


class TableForm(StrEnum):
    """How the measurements are written."""

    CSV = "csv"
    PARQUET = "parquet"


def simulate_battery(
    out: Annotated[Path, typer.Argument(file_okay=False, help="Folder to write to; made when it is missing.")],
    days: Annotated[float, typer.Option(min=0.01, max=400.0, help="Length, one row a second.")] = 10.0,
    seed: Annotated[int, typer.Option(min=0, help="Of the sensors' noise; the same seed gives the same files.")] = 1,
    fade: Annotated[bool, typer.Option("--fade", help="Let the capacity shrink.")] = False,
    degradation: Annotated[
        Path | None,
        typer.Option(exists=True, dir_okay=False, help="Map of how fast it shrinks (JSON); implies --fade."),
    ] = None,
    cell: Annotated[
        Path | None,
        typer.Option(exists=True, dir_okay=False, help="Configuration whose cell is the truth; else the report's."),
    ] = None,
    cycle: Annotated[
        Path | None, typer.Option(exists=True, dir_okay=False, help="Table of time and speed to drive; else FTP-72.")
    ] = None,
    bias_a: Annotated[float, typer.Option(help="What the current's sensor shows too much, A.")] = 0.0,
    current_noise_a: Annotated[float, typer.Option(min=0.0, help="Standard deviation, A.")] = 0.010,
    voltage_noise_v: Annotated[float, typer.Option(min=0.0, help="Standard deviation, V.")] = 0.002,
    temperature: Annotated[
        tuple[float, float] | None, typer.Option(metavar="MEAN SWING", help="Of each day, °C; else none is measured.")
    ] = None,
    form: Annotated[TableForm, typer.Option("--format", help="Of the measurements.")] = TableForm.CSV,
    as_json: AsJson = False,
) -> None:
    """Drive a plug-in hybrid's battery down and charge it up for days, and write what its sensors say.

    Writes data.csv (or data.parquet), config.json with a wrong first guess, truth.parquet and truth.json.
    """
    from app.science.battery.virtual.pack import virtual_pack

    pack = replace(
        asked_pack(cell, days),
        seed=seed,
        fade=loss_map(degradation, fade=fade),
        current_bias_a=bias_a,
        current_noise_a=current_noise_a,
        voltage_noise_v=voltage_noise_v,
        temperature_c=temperature,
    )
    note(f"simulating {days:g} days with seed {seed}")
    data = virtual_pack(pack, None if cycle is None else speed_table(cycle))
    told = told_truth(pack, data)
    off_s = OFF_SHARE * days * SECONDS_PER_DAY
    write_all(out, data, told, form, off_s)
    text = (
        f"{out}: {days:g} days, {told['cycles_per_day']:.1f} cycles a day, {told['current_min_a']:.1f} to "
        f"{told['current_max_a']:.1f} A; {told['soc']:.0%} full and {told['capacity_ah']:.4f} Ah left at the end"
    )
    say(told, as_json, text)


def asked_pack(config: Path | None, days: float) -> VirtualPack:
    """Return the report's cell in its car, or that of a configuration; one without a charge begins at the report's."""
    from app.science.battery.config_reading import read_config
    from app.science.battery.virtual.pack import VirtualPack, pack_of

    if config is None:
        return VirtualPack(days)
    cell = read_config(read_document(config)).cell
    return pack_of(cell if cell.soc == cell.soc else replace(cell, soc=USUAL_SOC), days)


def loss_map(file: Path | None, *, fade: bool) -> DegradationMap | None:
    """Return how the capacity fades: by a file's map, by ours, or not at all."""
    from app.science.battery.virtual.ageing import DEFAULT_MAP, read_degradation

    if file is None:
        return DEFAULT_MAP if fade else None
    return read_degradation(read_document(file))


def speed_table(file: Path) -> tuple[FloatArray, FloatArray]:
    """Return time and speed of a driving cycle, once a second."""
    import numpy as np

    from app.imports.cycle import read_cycle
    from app.science.vehicle.fuels import FUELS

    speed = read_cycle(file.read_bytes(), file.stem, FUELS["petrol"]).speed_mps
    return np.arange(len(speed), dtype=np.float64), speed


def told_truth(pack: VirtualPack, data: VirtualData) -> dict[str, Any]:
    """Return what was so: the cell's values, where the charge and the capacity ended, and what the current was like."""
    import numpy as np

    current, charging = data.current_a, data.current_a == pack.charge_a
    cell: Cell = data.cell
    return {
        **asdict(cell.circuit),
        "soc": float(data.soc[-1]),
        "capacity_ah": float(data.capacity_ah[-1]),
        "initial_soc": cell.soc,
        "initial_capacity_ah": cell.circuit.capacity_ah,
        "soh": float(data.capacity_ah[-1] / cell.circuit.capacity_ah),
        "current_bias_a": pack.current_bias_a,
        "current_noise_a": pack.current_noise_a,
        "voltage_noise_v": pack.voltage_noise_v,
        "days": pack.days,
        "seed": pack.seed,
        "cycles_per_day": float(np.count_nonzero(charging[1:] & ~charging[:-1]) / pack.days),
        "moved_ah_per_day": float(np.abs(current).mean() * 24.0),
        "current_rms_a": float(np.sqrt((current**2).mean())),
        "current_min_a": float(current.min()),
        "current_max_a": float(current.max()),
        "degradation": None if pack.fade is None else pack.fade.document(),
    }


def write_all(out: Path, data: VirtualData, told: dict[str, Any], form: TableForm, off_s: float) -> None:
    """Write measurements, first guess and truth into a folder."""
    from app.cli.tables import write_columns, write_csv
    from app.science.battery.config_reading import config_document
    from app.science.battery.virtual.a123 import first_guess

    out.mkdir(parents=True, exist_ok=True)
    record = data.record
    measured = {"t_s": record.t_s, "current_a": record.current_a, "voltage_v": record.voltage_v}
    if record.temperature_c is not None:
        measured["temperature_c"] = record.temperature_c
    write = write_csv if form is TableForm.CSV else write_columns
    write(out / f"data.{form.value}", measured)
    truth = {"t_s": record.t_s, "soc": data.soc, "capacity_ah": data.capacity_ah, "current_a": data.current_a}
    write_columns(out / "truth.parquet", truth)
    write_json(out / "config.json", config_document(first_guess(data.cell, off_s)))
    write_json(out / "truth.json", told)
