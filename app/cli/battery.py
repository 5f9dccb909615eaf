"""``./ponthy battery``: what is in a battery, and what is left of it."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from app.cli.drive import read_document
from app.cli.options import AsJson
from app.cli.output import note, say, table, write_json

if TYPE_CHECKING:
    from app.science.battery.answer import BatteryEstimate
    from app.science.battery.config import BatteryConfig
    from app.science.battery.record import BatteryRecord
    from app.science.battery.run import Carry
    from app.science.progress import Progress


def battery(
    data: Annotated[Path, typer.Argument(metavar="DATA", exists=True, dir_okay=False, help="Current and voltage.")],
    config_file: Annotated[
        Path,
        typer.Option("--config", metavar="C.json", exists=True, dir_okay=False, help="The cell and the estimator."),
    ],
    estimator: Annotated[str | None, typer.Option(help="Another estimator than the configuration's.")] = None,
    carry: Annotated[
        Path | None, typer.Option(exists=True, dir_okay=False, help="carry.json of the record before this one.")
    ] = None,
    out: Annotated[
        Path | None, typer.Option(file_okay=False, help="Folder for answer.json, history.parquet and carry.json.")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Estimate state of charge, state of health and the circuit's parameters.

    Columns and configuration stand in docs/battery.md.
    """
    from app.imports.battery import read_battery
    from app.science.battery.config import ESTIMATORS
    from app.science.battery.config_reading import read_config
    from app.science.battery.estimate import estimate

    if estimator is not None and estimator not in ESTIMATORS:
        raise typer.BadParameter(f"--estimator {estimator} is none of {', '.join(ESTIMATORS)}")
    document = read_document(config_file)
    if estimator is not None and isinstance(document, dict):
        document = document | {"estimator": estimator}
    config = read_config(document)
    record = read_battery(data.read_bytes(), data.name)
    begun = None if carry is None else carried(read_document(carry), record, config)
    found = estimate(record, config, begun, telling())
    if out is not None:
        write(found, out)
    answer = found.document()
    say(answer, as_json, words(answer))


def carried(document: object, record: BatteryRecord, config: BatteryConfig) -> Carry:
    """Return what the record before left, less sure by the pause between; one that isn't known is taken as a day."""
    from app.science.battery.carry_reading import read_carry
    from app.science.battery.carrying import DAY_S, between

    before = read_carry(document)
    started = document.get("started_at_utc_s") if isinstance(document, dict) else None
    if isinstance(started, int | float) != (record.started_at_utc_s is not None):
        gap_s = -1.0
    else:
        gap_s = float(record.t_s[0] + (record.started_at_utc_s or 0.0) - before.t_s - (started or 0.0))
    if gap_s < 0.0:
        note("The times don't tell how long the pause since the record before was; a day is taken.")
        gap_s = DAY_S
    return between(before, gap_s, config)


def telling() -> Progress:
    """Return a progress that is told on standard error every tenth."""
    told = 0

    def tell(share: float) -> None:
        nonlocal told
        if int(10.0 * share) > told:
            told = int(10.0 * share)
            note(f"{10 * told} % of the rows")

    return tell


def write(found: BatteryEstimate, out: Path) -> None:
    """Write the answer, its history and what the next record begins with."""
    from app.exports.parquet import table_parquet
    from app.science.battery.carry_reading import carry_document

    out.mkdir(parents=True, exist_ok=True)
    answer = found.document()
    history = answer.pop("history")
    write_json(out / "answer.json", answer | {"history": history})
    write_json(out / "carry.json", carry_document(found.carry) | {"started_at_utc_s": found.started_at_utc_s})
    (out / "history.parquet").write_bytes(table_parquet(found.history, answer))


def words(answer: Mapping[str, Any]) -> str:
    """Return an answer as a table and its warnings."""
    rows = [["", "value", "±", "unit"]]
    for name, (label, unit, scale, digits) in SHOWN.items():
        value, sd = answer[name], answer.get(f"{name}_sd")
        cells = ["-" if number is None else f"{scale * number:.{digits}f}" for number in (value, sd)]
        rows.append([label, *cells, unit])
    cell = answer["cell"]
    lines = [table(rows)]
    if cell["series"] > 1 or cell["parallel"] > 1:
        lines.append(f"of one cell; {cell['series']} in series, {cell['parallel']} in parallel")
    lines.append(f"{answer['rows_learnt']} of {answer['rows']} rows learnt from by {answer['estimator']}")
    return "\n".join([*lines, *(f"warning: {warning}" for warning in answer["warnings"])])


SHOWN = {
    "soc": ("state of charge", "%", 100.0, 2),
    "initial_soc": ("  at the first row", "%", 100.0, 2),
    "soh": ("state of health", "%", 100.0, 2),
    "capacity_ah": ("capacity", "Ah", 1.0, 4),
    "resistance_ohm": ("resistance", "mΩ", 1e3, 4),
    "relaxation_resistance_ohm": ("relaxation resistance", "mΩ", 1e3, 4),
    "relaxation_capacitance_f": ("relaxation capacitance", "F", 1.0, 1),
    "current_bias_a": ("current sensor's error", "mA", 1e3, 2),
    "voltage_rms_v": ("voltage residual", "mV", 1e3, 3),
    "voltage_noise_v": ("voltage noise", "mV", 1e3, 3),
}
