"""The figures of MAUTC-2010-02, part 3, from our own runs."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, Literal, get_args

import numpy as np

from app.figures.battery_curve import curve_layout
from app.figures.battery_documents import AS_PERCENT, as_array
from app.figures.battery_state import PARAMETERS
from app.figures.drive_panels import KMH, Line, Panel, Role
from app.figures.drive_stack import panels_figure
from app.figures.numbers import rounded
from app.figures.theme import COUNT_SCALE, LIGHT, Json, Theme, axis, base_layout, colour_bar, figure
from app.science.arrays import FloatArray

ReportFigure = Literal["25", "26", "27", "28", "30", "31", "32", "33"]
REPORT_FIGURES: tuple[ReportFigure, ...] = get_args(ReportFigure)

DAY_S, HOUR_S = 86_400.0, 3_600.0
MILLI, MICRO = 1e3, 1e6
WITHIN = (0.6, 1.5)
"""Of the truth: what an estimate does beyond, in its first moments, is cut off."""
ROOM = 0.06
NOISE_MV = 2.0
"""Of the virtual pack's voltage (MAUTC-2010-02, part 3, 4.3)."""
Document = Mapping[str, Any]


def report_figure(number: ReportFigure, runs: Document, *, theme: Theme = LIGHT) -> Json:
    """Draw a figure of the report.

    Parameters
    ----------
    number : ReportFigure
        As the report counts its figures; 24 is a photograph, and 23 and 29 are diagrams.
    runs : mapping
        The document of the report's runs.
    theme : Theme
    """
    return MAKERS[number](runs, theme)


def _open_circuit(runs: Document, theme: Theme) -> Json:
    line: Json = {
        "type": "scatter",
        "mode": "lines",
        "name": "Open-circuit voltage",
        "x": rounded(AS_PERCENT * as_array(runs["curve"]["soc"]), 3),
        "y": rounded(as_array(runs["curve"]["voltage_v"]), 5),
        "line": {"color": theme.trace, "width": 1.8},
        "hovertemplate": "%{y:.4f} V at %{x:.1f} %<extra></extra>",
    }
    return figure([line], curve_layout(theme, "battery-report-25"))


def _traces(
    number: str, name: str, divisor: float, across: str, wanted: Sequence[tuple[str, str, str, float, int]]
) -> Callable[[Document, Theme], Json]:
    def draw(runs: Document, theme: Theme) -> Json:
        x = as_array(runs[name]["t_s"]) / divisor
        panels = [
            Panel(label, unit, decimals, (Line(label, x, factor * as_array(runs[name][column])),))
            for column, label, unit, factor, decimals in wanted
        ]
        return panels_figure(panels, theme, f"battery-report-{number}", across, panel_px=130)

    return draw


def _parameters(runs: Document, theme: Theme) -> Json:
    panels = [_tracked(runs["short"], *one) for one in PARAMETERS]
    return panels_figure(panels, theme, "battery-report-30", "Time, days", panel_px=130)


def _health(runs: Document, theme: Theme) -> Json:
    panels = [_tracked(runs["long"], *one) for one in PARAMETERS[:2]]
    return panels_figure(panels, theme, "battery-report-33", "Time, days", panel_px=160)


def _errors(runs: Document, theme: Theme) -> Json:
    """Draw what three terms and the default estimator miss of the charge, and leave of the voltage."""
    shown = [run for run in runs["short"] if run["terms"] != 2]
    charge, voltage = [], []
    for run in shown:
        history, x = run["history"], _days(run)
        charge.append(
            Line(
                f"Error of the charge, {run['label']}",
                x,
                AS_PERCENT * (as_array(history["soc"]) - as_array(history["soc_true"])),
                _role(run),
            )
        )
        left = MILLI * as_array(history["voltage_rms_v"])
        voltage.append(Line(f"Voltage error, {run['label']}", x, left, _role(run)))
    noise = Line("Noise of the voltage", _days(shown[0])[[0, -1]], np.full(2, NOISE_MV), "limit")
    panels = [
        Panel("Estimated less true state of charge", "points", 3, tuple(charge)),
        Panel("Measured less predicted voltage, rms", "mV", 3, (noise, *voltage)),
    ]
    return panels_figure(panels, theme, "battery-report-31", "Time, days", panel_px=160)


def _tracked(runs: Sequence[Document], name: str, label: str, unit: str, factor: float, decimals: int) -> Panel:
    """Return a parameter's panel: the truth, and what each run makes of it."""
    truth = Line(f"{label}, truth", _days(runs[0]), factor * as_array(runs[0]["history"][f"{name}_true"]), "limit")
    made = [
        Line(f"{label}, {run['label']}", _days(run), factor * as_array(run["history"][name]), _role(run))
        for run in sorted(runs, key=lambda run: _role(run) == "drive")
    ]
    every = np.concatenate([line.y for line in (truth, *made)])
    low = max(float(np.nanmin(every)), WITHIN[0] * float(truth.y.min()))
    high = min(float(np.nanmax(every)), WITHIN[1] * float(truth.y.max()))
    margin = ROOM * (high - low)
    return Panel(label, unit, decimals, (truth, *made), span=(low - margin, high + margin))


def _role(run: Document) -> Role:
    """Return how a run is drawn: three terms stand out, two are dashed, the default estimator is thin."""
    return "rival" if run["terms"] is None else "other" if run["terms"] == 2 else "drive"


def _days(run: Document) -> FloatArray:
    return as_array(run["history"]["t_s"]) / DAY_S


def _degradation(runs: Document, theme: Theme) -> Json:
    """Draw the capacity that is lost over current and voltage."""
    table = runs["degradation"]
    over = "voltage_v" if "voltage_v" in table else "soc"
    trace: Json = {
        "type": "contour",
        "name": "Capacity lost, µAh per Ah",
        "x": rounded(as_array(table[over]), 4),
        "y": rounded(as_array(table["current_a"]), 3),
        "z": rounded(MICRO * np.array(table["loss_ah_per_ah"], dtype=np.float64), 3),
        "colorscale": COUNT_SCALE,
        "contours": {"coloring": "heatmap"},
        "line": {"width": 0.5},
        "colorbar": colour_bar(theme, "Capacity lost, µAh per Ah"),
        "hovertemplate": "%{z:.0f} µAh per Ah at %{x:.2f}, %{y:.1f} A<extra></extra>",
    }
    layout = base_layout(
        theme,
        "battery-report-32",
        height=360,
        margin={"l": 52, "r": 12, "t": 64, "b": 44},
        xaxis=axis(theme, "Volts of the cell" if over == "voltage_v" else "State of charge", zeroline=False),
        yaxis=axis(theme, "Current, A", zeroline=False),
    )
    return figure([trace], layout)


_CURRENT = ("current_a", "Current of a cell, charging is positive", "A", 1.0, 3)
_VOLTAGE = ("voltage_v", "Voltage", "V", 1.0, 4)
_SPEED = ("speed_mps", "Speed", "km/h", KMH, 1)
_CHARGE = ("soc", "State of charge", "%", AS_PERCENT, 2)
MAKERS: Mapping[ReportFigure, Callable[[Document, Theme], Json]] = {
    "25": _open_circuit,
    "26": _traces("26", "pulses", 1.0, "Time, s", (_CURRENT, _VOLTAGE)),
    "27": _traces("27", "drive", 1.0, "Time, s", (_SPEED, _CURRENT)),
    "28": _traces("28", "cycling", HOUR_S, "Time, h", (_CURRENT, _CHARGE)),
    "30": _parameters,
    "31": _errors,
    "32": _degradation,
    "33": _health,
}
