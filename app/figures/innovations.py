"""Does the observer believe its sensors rightly?"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from app.figures.decimate import even_indices
from app.figures.numbers import rounded, thousands
from app.figures.panels import BELOW_PX, Panels
from app.figures.theme import LIGHT, Json, Theme, axis, base_layout, empty_figure, figure
from app.science.arrays import BoolArray, FloatArray, IntArray
from app.science.observer.result import Innovations, SensorConsistency
from app.science.observer.sensor_words import sensor_words

POINTS_PER_SENSOR = 600
REFUSED_PER_SENSOR = 150
LIMIT = 5.0
PANEL_PX = 84
GAP_PX = 24
IDEAL_SHARE = 95.4
NOTHING = "The observer kept no innovations of this trip."


def innovations_figure(innovations: Innovations, *, theme: Theme = LIGHT) -> Json:
    """Draw measured minus predicted in units of the predicted standard deviation, one panel per sensor.

    A healthy sensor scatters evenly about zero with nineteen of twenty points between the lines at ±2. Beyond ±5 a
    point lies on the edge. Of each sensor a fair sample of the accepted measurements is drawn, since keeping extremes
    would make every sensor look bad, and a sample of the refused ones as crosses.

    Parameters
    ----------
    innovations : Innovations
    theme : Theme
    """
    present = [k for k in range(len(innovations.sensors)) if np.any(innovations.sensor == k)]
    if not present:
        return empty_figure(theme, "innovations", NOTHING)
    panels, shown = Panels(len(present), PANEL_PX, GAP_PX), 0
    layout = base_layout(
        theme,
        "innovations",
        showlegend=False,
        height=panels.height,
        margin={"l": 36, "r": 12, "t": GAP_PX, "b": BELOW_PX},
        annotations=[],
        shapes=[],
        xaxis=axis(theme, "Time since the start, s", **panels.time_axis()),
    )
    traces: list[Json] = []
    for row, sensor in enumerate(present):
        name, y_axis = sensor_words(innovations.sensors[sensor]), panels.y(row)
        mine = innovations.sensor == sensor
        t, accepted = innovations.t_s[mine], innovations.accepted[mine] == 1
        normalised = innovations.innovation[mine] / innovations.sd[mine]
        kept = _fair_sample(accepted)
        shown += len(kept)
        traces.append(_dots(name, t[kept], normalised[kept], accepted[kept], y_axis, theme))
        layout[panels.axis_entry(row)] = axis(
            theme,
            anchor="x",
            domain=panels.domain(row),
            range=[-1.1 * LIMIT, 1.1 * LIMIT],
            tickvals=[-4, -2, 0, 2, 4],
            fixedrange=True,
        )
        layout["shapes"] += [_line(y_axis, level, theme) for level in (-2.0, 2.0)]
        layout["annotations"].append(panels.heading(row, name, "σ", theme))
    total = len(innovations.t_s)
    badge = f"showing {thousands(shown)} of {thousands(total)}" if shown < total else ""
    layout["meta"] = {"badge": badge, "shown": shown, "total": total}
    return figure(traces, layout)


def sensors_figure(sensors: Sequence[SensorConsistency], *, theme: Theme = LIGHT) -> Json:
    """Draw how consistent each sensor is: mean normalised innovation squared, share inside two sigma, share refused.

    Parameters
    ----------
    sensors : sequence of SensorConsistency
    theme : Theme
    """
    if not sensors:
        return empty_figure(theme, "sensors", NOTHING)
    names = [sensor_words(s.sensor) for s in sensors]
    nis = np.array([s.nis_mean for s in sensors])
    inside = np.array([100.0 * s.within_two_sigma for s in sensors])
    refused = np.array([100.0 * s.rejected / max(s.count, 1) for s in sensors])
    counts = [thousands(s.count) for s in sensors]
    panels = (
        (nis, 2, "NIS", "", 1.0, theme.series[0]),
        (inside, 1, "inside 2σ", "%", IDEAL_SHARE, theme.series[2]),
        (refused, 1, "refused", "%", None, theme.series[1]),
    )
    layout = base_layout(
        theme,
        "sensors",
        showlegend=False,
        height=70 + 28 * len(names),
        margin={"l": 150, "r": 12, "t": 12, "b": 48},
        bargap=0.35,
        shapes=[],
        yaxis=axis(theme, autorange="reversed", tickfont={"size": 12, "color": theme.ink}, showgrid=False),
    )
    traces: list[Json] = []
    for column, (value, decimals, label, unit, ideal, colour) in enumerate(panels):
        number = str(column + 1) if column else ""
        title = f"{label}, {unit}" if unit else label
        suffix = f" {unit}" if unit else ""
        traces.append(
            {
                "type": "bar",
                "orientation": "h",
                "name": title,
                "y": names,
                "x": rounded(value, 3),
                "xaxis": f"x{number}",
                "yaxis": "y",
                "marker": {"color": colour},
                "customdata": counts,
                "hovertemplate": f"%{{y}}: {label} %{{x:.{decimals}f}}{suffix}<br>"
                "%{customdata} measurements<extra></extra>",
            }
        )
        start = column * 0.36
        layout[f"xaxis{number}"] = axis(
            theme, title, domain=[round(start, 3), round(start + 0.28, 3)], rangemode="tozero", nticks=4
        )
        if ideal is not None:
            layout["shapes"].append(_ideal(f"x{number}", ideal, theme))
    return figure(traces, layout)


def _fair_sample(accepted: BoolArray) -> IntArray:
    """Choose indices of accepted and of refused measurements, each evenly, in the order of time."""
    taken, refused = np.flatnonzero(accepted), np.flatnonzero(~accepted)
    fair = taken[even_indices(len(taken), POINTS_PER_SENSOR)], refused[even_indices(len(refused), REFUSED_PER_SENSOR)]
    return np.sort(np.concatenate(fair))


def _dots(name: str, t_s: FloatArray, normalised: FloatArray, accepted: BoolArray, y_axis: str, theme: Theme) -> Json:
    return {
        "type": "scatter",
        "mode": "markers",
        "name": name,
        "x": rounded(t_s, 1),
        "y": rounded(np.clip(normalised, -LIMIT, LIMIT), 2),
        "customdata": rounded(normalised, 2),
        "xaxis": "x",
        "yaxis": y_axis,
        "marker": {
            "size": [3 if ok else 7 for ok in accepted.tolist()],
            "symbol": ["circle" if ok else "x-thin" for ok in accepted.tolist()],
            "color": theme.trace,
            "line": {"width": [0 if ok else 1.5 for ok in accepted.tolist()], "color": theme.bad},
        },
        "hovertemplate": f"{name}: %{{customdata:.2f}} σ<br>%{{x:.1f}} s<extra></extra>",
    }


def _line(y_axis: str, level: float, theme: Theme) -> Json:
    line = {"color": theme.doubtful, "width": 1, "dash": "dash"}
    return {"type": "line", "xref": "paper", "x0": 0, "x1": 1, "yref": y_axis, "y0": level, "y1": level, "line": line}


def _ideal(x_axis: str, level: float, theme: Theme) -> Json:
    line = {"color": theme.ink, "width": 1.5, "dash": "dot"}
    return {"type": "line", "yref": "paper", "y0": 0, "y1": 1, "xref": x_axis, "x0": level, "x1": level, "line": line}
