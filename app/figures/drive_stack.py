"""Panels above each other: of a drive over time or over distance, of a battery over time."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from app.figures.bands import sigma_bands
from app.figures.decimate import minmax_indices
from app.figures.drive_panels import Line, Panel, Role
from app.figures.numbers import rounded
from app.figures.panels import BELOW_PX, Panels
from app.figures.theme import Json, Theme, axis, base_layout, empty_figure, figure
from app.science.arrays import FloatArray

MOST_POINTS = 4000
GAP_PX = 28
MARGIN = 0.06
LEAST_SPAN = 0.1
"""Of the largest value: what hardly changes is drawn as what hardly changes."""
NOTHING = "This kind of drive has nothing to show here."


def panels_figure(panels: Sequence[Panel], theme: Theme, revision: str, across: str, panel_px: int = 112) -> Json:
    """Draw panels.

    Parameters
    ----------
    panels : sequence of Panel
        From top to bottom.
    theme : Theme
    revision : str
        What a reader's zoom belongs to.
    across : str
        Title of the axis they share.
    panel_px : int
        Height of each.
    """
    if not panels:
        return empty_figure(theme, revision, NOTHING)
    rows = Panels(len(panels), panel_px, GAP_PX)
    traces: list[Json] = []
    layout = base_layout(
        theme,
        revision,
        hovermode="x unified",
        hoversubplots="axis",
        hoverdistance=8,
        showlegend=False,
        height=rows.height,
        margin={"l": 52, "r": 12, "t": GAP_PX, "b": BELOW_PX},
        meta={"panels": [panel.label for panel in panels]},
        annotations=[],
        xaxis=axis(
            theme,
            across,
            **rows.time_axis(),
            range=_ends(panels),
            showspikes=True,
            spikemode="across",
            spikethickness=1,
            spikedash="solid",
            spikecolor=theme.quiet,
        ),
    )
    for row, panel in enumerate(panels):
        for line in panel.lines:
            if line.sd is not None:
                traces += sigma_bands(line.name, line.x, line.y, line.sd, panel.decimals, theme, rows.y(row))
            traces.append(_trace(line, panel, rows.y(row), theme))
        layout[rows.axis_entry(row)] = axis(
            theme, anchor="x", domain=rows.domain(row), zeroline=False, range=_span(panel), **_ticks(panel)
        )
        layout["annotations"].append(rows.heading(row, panel.label, panel.unit, theme))
    return figure(traces, layout)


def _trace(line: Line, panel: Panel, y_axis: str, theme: Theme) -> Json:
    kept = minmax_indices(line.y, MOST_POINTS)
    unit = f" {panel.unit}" if panel.unit else ""
    return {
        "type": "scatter",
        "mode": "lines",
        "name": f"{line.name}, {panel.unit}" if panel.unit else line.name,
        "x": rounded(line.x[kept], 4),
        "y": rounded(line.y[kept], panel.decimals),
        "xaxis": "x",
        "yaxis": y_axis,
        "meta": {"panel": panel.label, "unit": panel.unit, "decimals": panel.decimals, "role": line.role},
        "line": drawn_as(line.role, theme) | ({"shape": "hv"} if panel.stepped else {}),
        "hovertemplate": f"{line.name} %{{y:.{panel.decimals}f}}{unit}<extra></extra>",
    }


def drawn_as(role: Role, theme: Theme) -> Json:
    """Return how a line of a role is drawn: told apart by more than its colour."""
    return {
        "drive": {"color": theme.trace, "width": 1.8},
        "other": {"color": theme.series[1], "width": 1.8, "dash": "dash"},
        "limit": {"color": theme.quiet, "width": 1.2, "dash": "dot"},
        "rival": {"color": theme.quiet, "width": 1},
    }[role]


def _ends(panels: Sequence[Panel]) -> list[float]:
    every = [line.x for panel in panels for line in panel.lines if len(line.x)]
    return [round(min(float(x[0]) for x in every), 4), round(max(float(x[-1]) for x in every), 4)]


def _span(panel: Panel) -> list[float] | None:
    """Return a panel's range: all of the drives; a limit far above them doesn't press them down."""
    if panel.span is not None:
        return list(panel.span)
    drives = _known([line.y for line in panel.lines if line.role in ("drive", "other")])
    if not len(drives):
        return None
    if panel.stepped:
        return [float(drives.min()) - 0.5, float(drives.max()) + 0.5]
    low, high = float(drives.min()), float(drives.max())
    reach = high - low
    for limit in _known([line.y for line in panel.lines if line.role == "limit"]):
        if high < limit <= high + reach:
            high = float(limit)
    flat = max(LEAST_SPAN * max(abs(low), abs(high)) - (high - low), 0.0) / 2.0
    margin = flat + MARGIN * (high - low) or 0.5
    return [low - margin, high + margin]


def _known(lines: list[FloatArray]) -> FloatArray:
    together = np.concatenate([*lines, np.empty(0)])
    return np.unique(together[np.isfinite(together)])


def _ticks(panel: Panel) -> Json:
    if not panel.stepped:
        return {"nticks": 5}
    whole = np.unique(np.concatenate([line.y[np.isfinite(line.y)] for line in panel.lines])).astype(int)
    values = list(range(int(whole.min()), int(whole.max()) + 1))
    return {"tickmode": "array", "tickvals": values, "ticktext": ["N" if v == 0 else str(v) for v in values]}
