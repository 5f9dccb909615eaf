"""How well each sensor agrees with the filter's own uncertainty: a figure for each question, a row for each sensor."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from app.figures.numbers import rounded, thousands
from app.figures.theme import LIGHT, Json, Theme, axis, base_layout, empty_figure, figure
from app.science.observer.result import SensorConsistency
from app.science.observer.sensor_words import sensor_words

ROW_PX = 44
BELOW_PX = 52
ABOVE_PX = 26
NIS_RANGE = (1e-3, 100.0)
INSIDE_ONE, INSIDE_TWO = 68.3, 95.4
WHITE_SIGMAS = 2.0
NOTHING = "The observer kept nothing about the sensors of this trip; run it again."
NOTHING_REFUSED = "No measurement of this trip was refused."


def nis_figure(sensors: Sequence[SensorConsistency], *, theme: Theme = LIGHT) -> Json:
    """Draw the mean normalised innovation squared of each sensor beside the band in which 95 % of right filters lie.

    Left of the band a sensor is trusted less than it deserves, right of it more.
    """
    known = [one for one in sensors if np.isfinite(one.nis_mean)]
    if not known:
        return empty_figure(theme, "nis", NOTHING)
    rows = _Rows(known, "nis", theme)
    low, high = NIS_RANGE
    ticks = [0.001, 0.01, 0.1, 1, 10, 100]
    rows.layout["xaxis"] = axis(
        theme,
        "NIS",
        type="log",
        range=[np.log10(low), np.log10(high)],
        tickvals=ticks,
        ticktext=[f"{t:g}" for t in ticks],
    )
    rows.ideal(1.0)
    band = [(max(one.nis_low, low), min(one.nis_high, high)) for one in known]
    rows.bands(band, "95 % of right filters")
    rows.dots(
        "NIS",
        rounded(np.clip([one.nis_mean for one in known], low, high), 4),
        [f"{one.nis_mean:.3g}, expected {one.nis_low:.2f} to {one.nis_high:.2f}" for one in known],
        "NIS",
    )
    return rows.figure()


def whiteness_figure(sensors: Sequence[SensorConsistency], *, theme: Theme = LIGHT) -> Json:
    """Draw how each sensor's neighbouring innovations are correlated, beside the band of a white sequence."""
    known = [one for one in sensors if np.isfinite(one.lag1)]
    if not known:
        return empty_figure(theme, "whiteness", NOTHING)
    rows = _Rows(known, "whiteness", theme)
    rows.layout["xaxis"] = axis(theme, "Correlation of neighbours", range=[-1.05, 1.05], tickvals=[-1, -0.5, 0, 0.5, 1])
    rows.ideal(0.0)
    noise = [WHITE_SIGMAS / np.sqrt(max(one.count - one.rejected, 1)) for one in known]
    rows.bands([(-width, width) for width in noise], "white")
    rows.dots(
        "Correlation of neighbours",
        rounded(np.array([one.lag1 for one in known]), 3),
        [f"{one.lag1:.2f}, portmanteau {one.portmanteau:.3g} (1 is white)" for one in known],
        "correlation 1",
    )
    return rows.figure()


def coverage_figure(sensors: Sequence[SensorConsistency], *, theme: Theme = LIGHT) -> Json:
    """Draw the share of each sensor's innovations inside one and two predicted standard deviations."""
    known = [one for one in sensors if np.isfinite(one.within_two_sigma)]
    if not known:
        return empty_figure(theme, "coverage", NOTHING)
    rows = _Rows(known, "coverage", theme)
    rows.layout["xaxis"] = axis(theme, "Share inside, %", range=[0, 103], tickvals=[0, 25, 50, 68.3, 95.4])
    rows.ideal(INSIDE_ONE)
    rows.ideal(INSIDE_TWO)
    shares = (
        ("inside 1σ", [one.within_one_sigma for one in known], theme.series[1], "diamond"),
        ("inside 2σ", [one.within_two_sigma for one in known], theme.trace, "circle"),
    )
    for name, share, colour, symbol in shares:
        percent = 100.0 * np.array(share)
        rows.dots(name, rounded(percent, 1), [f"{p:.1f} %" for p in percent], name, colour, symbol)
    rows.layout["showlegend"] = True
    rows.layout["legend"] |= {"y": 1.0, "yanchor": "bottom", "x": 1, "xanchor": "right"}
    return rows.figure()


def refusals_figure(sensors: Sequence[SensorConsistency], duration_s: float, *, theme: Theme = LIGHT) -> Json:
    """Draw when each sensor's measurements were refused, and where it was believed in the end.

    Parameters
    ----------
    sensors : sequence of SensorConsistency
    duration_s : float
        Length of the trip.
    """
    known = [one for one in sensors if one.episodes]
    if not known:
        return empty_figure(theme, "refusals", NOTHING_REFUSED)
    rows = _Rows(known, "refusals", theme)
    last = max([duration_s, *(episode.to_s for one in known for episode in one.episodes)])
    rows.layout["xaxis"] = axis(theme, "Time since the start, s", range=[0, 1.01 * last])
    for one in known:
        rows.episodes(one)
    shown, total = (sum(counts) for counts in zip(*((len(s.episodes), s.episode_count) for s in known), strict=True))
    badge = f"showing the {thousands(shown)} longest of {thousands(total)}" if shown < total else ""
    rows.layout["meta"] = {"badge": badge, "shown": shown, "total": total}
    return rows.figure()


class _Rows:
    """A figure with one row for each sensor, whose name stands above its row, where a phone has room for it."""

    def __init__(self, sensors: Sequence[SensorConsistency], name: str, theme: Theme) -> None:
        self.theme = theme
        self.names = [sensor_words(one.sensor) for one in sensors]
        self.traces: list[Json] = []
        order = {"categoryorder": "array", "categoryarray": self.names, "range": [len(sensors) - 0.35, -0.75]}
        self.layout = base_layout(
            theme,
            name,
            showlegend=False,
            height=ABOVE_PX + BELOW_PX + ROW_PX * len(sensors),
            margin={"l": 12, "r": 12, "t": ABOVE_PX, "b": BELOW_PX},
            shapes=[],
            annotations=[self._heading(sensor) for sensor in self.names],
            yaxis=axis(theme, "Sensor", visible=False, type="category", fixedrange=True, **order),
        )

    def figure(self) -> Json:
        """Return the whole."""
        return figure(self.traces, self.layout)

    def ideal(self, at: float) -> None:
        """Mark where a right filter's sensors lie."""
        line = {"color": self.theme.ink, "width": 1.5, "dash": "dot"}
        self.layout["shapes"].append(
            {"type": "line", "yref": "paper", "y0": 0, "y1": 1, "xref": "x", "x0": at, "x1": at, "line": line}
        )

    def bands(self, bands: Sequence[tuple[float, float]], label: str) -> None:
        """Draw a band on each row; one that is not known is left out."""
        for name, (low, high) in zip(self.names, bands, strict=True):
            if np.isfinite(low) and np.isfinite(high):
                self.traces.append(
                    {
                        "type": "scatter",
                        "mode": "lines",
                        "name": label,
                        "x": rounded(np.array([low, high]), 4),
                        "y": [name, name],
                        "line": {"color": f"rgba({self.theme.trace_rgb},0.35)", "width": 12},
                        "hoverinfo": "skip",
                        "showlegend": False,
                    }
                )

    def dots(
        self, name: str, x: list[Any], said: Sequence[str], unit: str, colour: str = "", symbol: str = "circle"
    ) -> None:
        """Draw a number on each row."""
        self.traces.append(
            {
                "type": "scatter",
                "mode": "markers",
                "name": name,
                "x": x,
                "y": self.names,
                "cliponaxis": False,
                "customdata": list(said),
                "marker": {"size": 10, "symbol": symbol, "color": colour or self.theme.trace},
                "hovertemplate": f"%{{y}}: {unit} %{{customdata}}<extra></extra>",
            }
        )

    def episodes(self, sensor: SensorConsistency) -> None:
        """Draw the times of refusal of one sensor as bars from begin to end, apart whether it was believed then."""
        for believed, word, colour, symbol in (
            (False, "refused", self.theme.bad, "line-ns-open"),
            (True, "refused, then believed", self.theme.doubtful, "diamond-open"),
        ):
            mine = [one for one in sensor.episodes if one.recovered == believed]
            if mine:
                x = [at for one in mine for at in (round(one.from_s, 1), round(one.to_s, 1), None)]
                said = [f"{one.count} {word}" for one in mine for _ in range(3)]
                name = sensor_words(sensor.sensor)
                self.traces.append(
                    {
                        "type": "scatter",
                        "mode": "lines+markers",
                        "name": f"{name}: {word}",
                        "x": x,
                        "y": [name] * len(x),
                        "customdata": said,
                        "line": {"color": colour, "width": 6},
                        "marker": {
                            "color": colour,
                            "size": 8,
                            "symbol": symbol,
                            "line": {"color": colour, "width": 2},
                        },
                        "hovertemplate": "%{y}: %{customdata}<br>%{x:.1f} s<extra></extra>",
                    }
                )

    def _heading(self, name: str) -> Json:
        return {
            "text": name,
            "xref": "paper",
            "x": 0,
            "xanchor": "left",
            "yref": "y",
            "y": name,
            "yanchor": "bottom",
            "yshift": 9,
            "showarrow": False,
            "font": {"size": 12, "color": self.theme.ink},
        }
