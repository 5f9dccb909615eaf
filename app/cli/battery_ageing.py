"""``./ponthy battery-ageing``: how a battery ages, and how long it still serves."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from app.cli.options import AsJson
from app.cli.output import say, table

if TYPE_CHECKING:
    from app.science.battery.ageing_result import Aged, Ageing


def battery_ageing(
    history: Annotated[
        Path, typer.Argument(metavar="HISTORY", exists=True, dir_okay=False, help="Capacities over time, a row each.")
    ],
    rated_ah: Annotated[
        float | None,
        typer.Option("--rated-ah", min=1e-4, help="Of one cell when new; else what the trend begins with."),
    ] = None,
    threshold: Annotated[
        float | None, typer.Option(help="Share of the rated capacity that ends its life: 0.8.")
    ] = None,
    tests: Annotated[
        Path | None, typer.Option(exists=True, dir_okay=False, help="Capacities measured in a laboratory.")
    ] = None,
    use_tests: Annotated[bool, typer.Option("--use-tests", help="Let these take part in the trend.")] = False,
    as_json: AsJson = False,
) -> None:
    """Fit trends of capacity and resistance, and say how long the battery lasts.

    HISTORY is an exported history, or any table as docs/battery.md tells.
    """
    from app.imports.battery_history import read_history, read_tests
    from app.science.battery.ageing import ageing
    from app.science.vehicle.battery import END_OF_LIFE

    found = ageing(
        read_history(history.read_bytes()),
        END_OF_LIFE if threshold is None else threshold,
        () if tests is None else read_tests(tests.read_bytes()),
        rated_ah=rated_ah,
        use_tests=use_tests,
    )
    say(found.document(), as_json, words(found))


def words(found: Ageing) -> str:
    """Return trends, what remains and tests as text, and warnings."""
    rows = [["", "now", "±", "% per year", "±", "% per 100 cycles", "±", "limit", "days left", "from", "to", "verdict"]]
    rows += [
        row("capacity, Ah", found.capacity, found.rated_ah, 1.0),
        row("resistance, mΩ", found.resistance, found.first_ohm, 1e3),
    ]
    lines = [table(rows)]
    for one in found.tests:
        beside = "" if one.sigmas is None else f", {one.sigmas:+.1f} standard deviations from the estimates"
        lines.append(f"test at day {one.test.at:.1f}: {one.test.capacity_ah:.4g} ± {one.test.sd_ah:.2g} Ah{beside}")
    return "\n".join([*lines, *(f"warning: {warning}" for warning in found.warnings)])


def row(label: str, aged: Aged, whole: float, scale: float) -> list[str]:
    """Return a value's history as a row of the table; what isn't known is a dash."""
    told, left = aged.document(whole), aged.remaining
    trend = told["trend"]
    if trend is None or left is None:
        return [label, *(["-"] * 10), "no trend"]
    shares = [trend["slope_share_per_year"], trend["slope_share_per_year_sd"]]
    shares += [told["slope_share_per_100_cycles"], told["slope_share_per_100_cycles_sd"]]
    return [
        label,
        *(f"{scale * trend[name]:.4f}" for name in ("value", "value_sd")),
        *("-" if share is None else f"{100.0 * share:.2f}" for share in shares),
        f"{scale * left.limit:.4g}",
        *("-" if days is None else f"{days:.0f}" for days in (left.ahead, left.low, left.high)),
        left.verdict,
    ]
