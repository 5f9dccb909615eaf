"""Torque and efficiency by what the engine reports and by what the car's motion tells, in one figure."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from app.figures.numbers import rounded
from app.figures.panels import Panels
from app.figures.theme import LIGHT, Json, Theme, axis, base_layout, figure
from app.science.arrays import BoolArray, FloatArray

RADPS_PER_RPM = np.pi / 30.0
PANELS = Panels(rows=3, panel_px=190, gap_px=34)
HEADINGS = (
    ("Torque by the car's motion", "Nm"),
    ("Efficiency", "%"),
    ("Motion over report", "median and quartiles"),
)
GROUPS = 6
FEWEST_IN_GEAR = 8
HIGHEST_PERCENT = 60.0


def torque_sources_figure(document: Mapping[str, Any], *, theme: Theme = LIGHT) -> Json:
    """Draw the torque of the car's motion over the reported one, the efficiency by each, and the ratio by gear.

    Parameters
    ----------
    document : mapping
        Of `app.science.engine.torque_sources.TorqueSources`.
    theme : Theme
    """
    c = {name: np.array(document[name], dtype=np.float64) for name in SAMPLES}
    steady = np.array(document["steady"], dtype=np.bool_)
    turning = c["engine_speed_rpm"] * RADPS_PER_RPM
    top = float(c["reported_nm"].max()) * 1.05
    by_report, by_motion = (100.0 * c[name] * turning / c["fuel_power_w"] for name in ("reported_nm", "observed_nm"))
    traces = [
        _line([0.0, top], [0.0, top], 0, "equal", theme),
        *(
            _dots(c["reported_nm"][kind], c["observed_nm"][kind], 0, name, colour, "Nm")
            | {"error_y": _bars(c["observed_sd_nm"][kind])}
            for kind, name, colour in (
                (steady, "power steady", theme.series[2]), (~steady, "power changing", theme.series[1]),
            )
        ),
        _dots(c["reported_nm"], by_report, 1, "by the reported torque", theme.series[0], "%"),
        _dots(c["reported_nm"], by_motion, 1, "by the car's motion", theme.series[3], "%") | {"marker": {
            "symbol": "diamond-open", "size": 6, "color": theme.series[3]}},
        _line([0.0, top], [1.0, 1.0], 2, "equal", theme),
        *_ratios(c, theme),
    ]  # fmt: skip
    layout = base_layout(
        theme,
        "torque-sources",
        height=PANELS.height + 60,
        margin={"l": 52, "r": 12, "t": 30, "b": 84},
        annotations=[PANELS.heading(row, label, unit, theme) for row, (label, unit) in enumerate(HEADINGS)],
        xaxis=axis(theme, "Reported torque, Nm", range=[0, round(top, 1)]) | PANELS.time_axis(),
    )
    ranges: tuple[Json, ...] = ({"rangemode": "tozero"}, {"range": [0, HIGHEST_PERCENT]}, {"range": [0, 2]})
    for row, extra in enumerate(ranges):
        layout[PANELS.axis_entry(row)] = axis(theme, domain=PANELS.domain(row), anchor="x", **extra)
    layout["legend"] |= {"y": -0.1}
    return figure(traces, layout)


SAMPLES = ("engine_speed_rpm", "gear", "reported_nm", "observed_nm", "observed_sd_nm", "fuel_power_w")


def _ratios(c: Mapping[str, FloatArray], theme: Theme) -> list[Json]:
    """Return the ratio over the torque, apart by gear where gears are known."""
    gears, counts = np.unique(c["gear"][c["gear"] >= 1.0], return_counts=True)
    known = gears[counts >= FEWEST_IN_GEAR]
    if not len(known):
        return [_ratio(c, np.ones(len(c["gear"]), np.bool_), "all moments", theme.series[0])]
    return [
        _ratio(c, c["gear"] == gear, f"gear {gear:.0f}", theme.series[number % len(theme.series)])
        for number, gear in enumerate(known)
    ]


def _ratio(c: Mapping[str, FloatArray], chosen: BoolArray, name: str, colour: str) -> Json:
    reported = c["reported_nm"][chosen]
    ratio = c["observed_nm"][chosen] / reported
    groups = np.array_split(np.argsort(reported), max(1, min(GROUPS, len(reported) // FEWEST_IN_GEAR)))
    low, middle, high = np.array([np.quantile(ratio[group], [0.25, 0.5, 0.75]) for group in groups]).T
    return _dots(np.array([reported[group].mean() for group in groups]), middle, 2, name, colour, "") | {
        "mode": "lines+markers",
        "line": {"color": colour, "width": 1.5},
        "error_y": {
            "type": "data",
            "symmetric": False,
            "array": rounded(high - middle, 3),
            "arrayminus": rounded(middle - low, 3),
            "width": 3,
            "thickness": 1.2,
        },
    }


def _dots(x: FloatArray, y: FloatArray, row: int, name: str, colour: str, unit: str) -> Json:
    decimals = 3 if row == 2 else 1
    return {
        "type": "scatter",
        "mode": "markers",
        "name": name,
        "x": rounded(x, 1),
        "y": rounded(y, decimals),
        "yaxis": PANELS.y(row),
        "marker": {"size": 6, "color": colour},
        "hovertemplate": f"{name}: %{{y:.{decimals - 1}f}} {unit}<br>reported %{{x:.0f}} Nm<extra></extra>",
    }


def _bars(sd: FloatArray) -> Json:
    return {"type": "data", "array": rounded(sd, 1), "width": 0, "thickness": 0.7}


def _line(x: list[float], y: list[float], row: int, name: str, theme: Theme) -> Json:
    return {
        "type": "scatter",
        "mode": "lines",
        "name": name,
        "x": x,
        "y": y,
        "yaxis": PANELS.y(row),
        "line": {"color": theme.quiet, "width": 1, "dash": "dot"},
        "hoverinfo": "skip",
        "showlegend": False,
    }
