"""One look for all figures: colours of the pages' tokens, axes, hover labels."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

Json = dict[str, Any]

FONT = 'system-ui, -apple-system, "Segoe UI", Roboto, "Noto Sans", "Liberation Sans", sans-serif'
TRANSPARENT = "rgba(0,0,0,0)"
SPEED_FULL_SCALE_KMH = 180.0
"""Speed colours are the same in every figure: the top is 180 km/h (Sebesta 2010, App. F)."""


@dataclass(frozen=True, slots=True)
class Theme:
    """Colours of one theme; every text colour has a contrast of at least 4.5 to ``raised``.

    Attributes
    ----------
    raised : str
        What figures lie on.
    ink, quiet, line : str
        Text, secondary text, grid.
    trace : str
        A single curve; ``trace_rgb`` is the same as ``r,g,b`` for bands.
    highlight : str
        A curve that must stand out on the colours of efficiency.
    good, doubtful, bad : str
    series : tuple of str
        Curves side by side, told apart by the colour-blind too (Okabe and Ito's set, tuned to the background).
    """

    name: str
    raised: str
    ink: str
    quiet: str
    line: str
    accent: str
    trace: str
    trace_rgb: str
    highlight: str
    good: str
    doubtful: str
    bad: str
    series: tuple[str, ...]


LIGHT = Theme(
    name="light",
    raised="#ffffff",
    ink="#1b1f24",
    quiet="#5c6670",
    line="#e3e5e1",
    accent="#0b6e6e",
    trace="#1f5f99",
    trace_rgb="31,95,153",
    highlight="#d6336c",
    good="#2e7d32",
    doubtful="#995400",
    bad="#b3261e",
    series=("#0072b2", "#b85c00", "#00805f", "#a3477f", "#806600", "#3b6ea8"),
)
DARK = Theme(
    name="dark",
    raised="#1a1e22",
    ink="#e8eaed",
    quiet="#9aa4ad",
    line="#2a2f34",
    accent="#4fc3b8",
    trace="#7cb7ee",
    trace_rgb="124,183,238",
    highlight="#ff7fab",
    good="#81c784",
    doubtful="#e8ac55",
    bad="#f29389",
    series=("#56b4e9", "#e69f00", "#2fc39a", "#dd8fbd", "#d8c94a", "#8fb6ea"),
)
EFFICIENCY_SCALE = "Viridis"
COUNT_SCALE = "Cividis"
SPEED_SCALE = [
    [0.0, "#0d0887"],
    [0.14, "#5302a3"],
    [0.29, "#8b0aa5"],
    [0.43, "#b83289"],
    [0.57, "#db5c68"],
    [0.71, "#f48849"],
    [0.86, "#febd2a"],
    [1.0, "#f0f921"],
]
"""Plasma: rises evenly in lightness, so that it can be read without seeing colour."""


def theme_named(name: str) -> Theme:
    """Return the theme of that name; anything but ``dark`` is light."""
    return DARK if name == "dark" else LIGHT


def figure(traces: list[Json], layout: Json) -> Json:
    """Put a Plotly figure together."""
    return {"data": traces, "layout": layout}


def base_layout(theme: Theme, revision: str, title: str = "", **more: Any) -> Json:
    """Return the layout every figure starts from.

    Parameters
    ----------
    theme : Theme
    revision : str
        What the person's zoom belongs to: it is kept as long as this stays the same.
    title : str
        One line of small print above the plot; short enough for 390 px.
    more : Any
        Further entries of the layout.
    """
    layout: Json = {
        "uirevision": revision,
        "font": {"family": FONT, "size": 12, "color": theme.ink},
        "paper_bgcolor": TRANSPARENT,
        "plot_bgcolor": TRANSPARENT,
        "margin": {"l": 48, "r": 12, "t": 34 if title else 12, "b": 44},
        "hovermode": "closest",
        "hoverlabel": {
            "bgcolor": theme.raised,
            "bordercolor": theme.quiet,
            "font": {"family": FONT, "size": 12, "color": theme.ink},
            "align": "left",
        },
        "legend": {
            "orientation": "h",
            "x": 0,
            "xanchor": "left",
            "y": -0.16,
            "yanchor": "top",
            "font": {"size": 12, "color": theme.ink},
            "bgcolor": TRANSPARENT,
        },
        "modebar": {"bgcolor": TRANSPARENT, "color": theme.quiet, "activecolor": theme.accent},
    }
    if title:
        layout["title"] = {
            "text": title,
            "x": 0,
            "xref": "paper",
            "xanchor": "left",
            "y": 1,
            "yref": "container",
            "yanchor": "top",
            "pad": {"t": 10},
            "font": {"size": 12, "color": theme.quiet},
        }
    return layout | more


def axis(theme: Theme, title: str = "", **more: Any) -> Json:
    """Return an axis with quiet grid and labels."""
    drawn: Json = {
        "gridcolor": theme.line,
        "zerolinecolor": theme.line,
        "linecolor": theme.line,
        "tickfont": {"size": 12, "color": theme.quiet},
        "automargin": True,
    }
    if title:
        drawn["title"] = {"text": title, "font": {"size": 12, "color": theme.quiet}, "standoff": 8}
    return drawn | more


def colour_bar(theme: Theme, title: str, **more: Any) -> Json:
    """Return a flat colour bar above the plot, at the right: it takes no width from a phone."""
    bar: Json = {
        "orientation": "h",
        "title": {"text": title, "side": "top", "font": {"size": 12, "color": theme.quiet}},
        "tickfont": {"size": 12, "color": theme.quiet},
        "thickness": 8,
        "len": 0.5,
        "x": 1,
        "xanchor": "right",
        "y": 1.0,
        "yanchor": "bottom",
        "ypad": 4,
        "outlinewidth": 0,
    }
    return bar | more


def remark(theme: Theme, text: str) -> Json:
    """Return small print above the plot's top left corner, beside the colour bar."""
    return {
        "text": text,
        "xref": "paper",
        "yref": "paper",
        "x": 0,
        "y": 1,
        "xanchor": "left",
        "yanchor": "bottom",
        "align": "left",
        "showarrow": False,
        "font": {"size": 12, "color": theme.quiet},
    }


def note(theme: Theme, text: str) -> Json:
    """Return an annotation in the middle of an empty plot: why it is empty."""
    return {
        "text": text,
        "xref": "paper",
        "yref": "paper",
        "x": 0.5,
        "y": 0.5,
        "showarrow": False,
        "font": {"size": 12, "color": theme.quiet},
    }


def empty_figure(theme: Theme, revision: str, text: str) -> Json:
    """Return a figure that says why there is nothing to draw."""
    hidden = {"visible": False}
    return figure([], base_layout(theme, revision, annotations=[note(theme, text)], xaxis=hidden, yaxis=hidden))
