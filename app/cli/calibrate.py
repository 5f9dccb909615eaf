"""``./ponthy calibrate``: what driving says about a car's file, and a new file with it where that is wanted."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from app.cli.inputs import InputFormat, recordings
from app.cli.options import AsJson
from app.cli.output import note, say, table

if TYPE_CHECKING:
    from app.science.calibration.evidence import TripEvidence
    from app.science.calibration.proposal import Change, Proposal
    from app.science.logger.recording import Recording
    from app.science.vehicle.model import Vehicle


def calibrate(
    files: Annotated[list[Path], typer.Argument(exists=True, dir_okay=False, help="Logger images or signals tables.")],
    car: Annotated[Path, typer.Option(exists=True, dir_okay=False, help="XML of the car.")],
    refuelled_l: Annotated[
        str,
        typer.Option(
            help="Litres that all trips used; or the litres filled in after each trip, 0 for none: 0,38.2,0,41.",
        ),
    ] = "",
    write: Annotated[
        Path | None, typer.Option(dir_okay=False, help="Write a new XML with every change that is not weak.")
    ] = None,
    form: Annotated[InputFormat, typer.Option("--format", help="What the files hold.")] = InputFormat.AUTO,
    mapping: Annotated[
        Path | None, typer.Option(exists=True, dir_okay=False, help="Names and scales of foreign columns (JSON).")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Propose changes of a car's file from how it drove.

    Mounting and scale of the accelerometer, metres per tick or the scale of a measured speed, injector lag and flow
    where litres are given, biases, the receiver's latency and the clock's skew. The car's own file stays as it is.
    """
    from app.science.calibration.calibrate import proposals
    from app.science.vehicle.fields import apply_form
    from app.science.vehicle.xml import read_vehicle

    xml = car.read_bytes()
    vehicle = read_vehicle(xml)
    evidences = [evidence_of(trip.name, trip.recording, vehicle) for trip in recordings(files, form, mapping)]
    found = proposals(evidences, vehicle, litres(refuelled_l, len(evidences)))
    values = {path: value for proposal in found for path, value in proposal.form_values().items()}
    document: dict[str, Any] = {
        "trips": len(evidences),
        "proposals": [asdict(proposal) | {"applicable": proposal.is_applicable} for proposal in found],
        "written": None,
    }
    if write is not None:
        write.write_bytes(apply_form(xml, values))
        document["written"] = str(write)
    say(document, as_json, text_of(found, write))


def litres(text: str, trips: int) -> float | list[float | None] | None:
    """Read ``--refuelled-l``: nothing, one number for all trips, or one per trip."""
    if not text:
        return None
    try:
        amounts = [float(part) for part in text.split(",")]
    except ValueError:
        raise typer.BadParameter(f"{text!r} are not litres such as 38.2 or 0,38.2,0,41") from None
    if len(amounts) == 1 and 0.0 < amounts[0] < inf:
        return amounts[0]
    if len(amounts) != trips or not all(0.0 <= amount < inf for amount in amounts):
        raise typer.BadParameter(f"{text!r} needs one number for all trips, or one for each of the {trips}")
    return [amount or None for amount in amounts]


def evidence_of(name: str, recording: Recording, vehicle: Vehicle) -> TripEvidence:
    """Return what one trip says, its biases by the observer included where that can run."""
    from app.science.calibration.calibrate import trip_evidence
    from app.science.errors import ScienceError
    from app.science.observer.observe import observe

    note(f"{name}: {recording.duration_s / 60.0:.0f} min")
    try:
        observation = observe(recording, vehicle)
    except ScienceError as error:
        note(f"{name}: {error}")
        observation = None
    return trip_evidence(recording, vehicle, observation)


def text_of(found: Sequence[Proposal], written: Path | None) -> str:
    """Say what was found to people."""
    lines: list[str] = []
    for proposal in found:
        lines.append(f"{proposal.name}: {proposal.confidence}")
        if proposal.changes:
            lines.append(table([["", "file", "driving", "sd", "unit"], *(_row(one) for one in proposal.changes)]))
        lines += [f"  {sentence}" for sentence in proposal.evidence]
    if not any(proposal.is_applicable for proposal in found):
        lines.append("Nothing of the car's file needs a change, as far as these trips tell.")
    if written is not None:
        lines.append(f"written to {written}")
    return "\n".join(lines)


def _row(one: Change) -> list[str]:
    before = "-" if one.before is None else f"{one.before:.6g}"
    return [f"  {one.label}", before, f"{one.after:.6g}", f"{one.sd:.2g}", one.unit]
