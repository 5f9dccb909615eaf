"""How much each minute of a trip tells of each state."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from app.figures.numbers import rounded
from app.figures.quantities import quantity
from app.figures.theme import LIGHT, Json, Theme, axis, base_layout, empty_figure, figure
from app.science.arrays import FloatArray

NOTHING = "No minute of this trip was looked at."
ROW_PX = 22
AROUND_PX = 60


def told_figure(
    begin_s: FloatArray,
    window_s: float,
    sd: Mapping[str, FloatArray],
    prior_sd: Mapping[str, float],
    *,
    theme: Theme = LIGHT,
) -> Json:
    """Draw what each window of time leaves of the uncertainty one had of each state: the stronger the colour, the less.

    Parameters
    ----------
    begin_s : array, shape (windows,)
    window_s : float
        Length of a window; between windows further apart a gap is left.
    sd : mapping of str to array, shape (windows,)
        By column of the states table.
    prior_sd : mapping of str to float
        What one knew without any sensor.
    theme : Theme
    """
    if not len(begin_s):
        return empty_figure(theme, "told", NOTHING)
    place = np.round((begin_s - begin_s[0]) / window_s).astype(np.int64)
    left = np.full((len(sd), place[-1] + 1), np.nan)
    words = np.full(left.shape, "", dtype=object)
    for row, (name, values) in enumerate(sd.items()):
        shown = quantity(name)
        left[row, place] = 100.0 * values / prior_sd[name]
        for at, value in zip(place, shown.shown(values), strict=True):
            words[row, at] = f"±{value:.3g} {shown.unit}".rstrip()
    minutes = (begin_s[0] + (np.arange(left.shape[1]) + 0.5) * window_s) / 60.0
    trace: Json = {
        "type": "heatmap",
        "name": "State",
        "x": rounded(minutes, 2),
        "y": [quantity(name).label for name in sd],
        "z": rounded(left, 4),
        "customdata": words.tolist(),
        "hoverongaps": False,
        "colorscale": [[0.0, theme.trace], [0.01, mixed(theme, 0.75)], [0.1, mixed(theme, 0.45)],
                       [0.2, mixed(theme, 0.25)], [1.0, theme.raised]],
        "zmin": 0,
        "zmax": 100,
        "xgap": 1,
        "ygap": 1,
        "showscale": False,
        "colorbar": {"title": {"text": "Left of the uncertainty, %"}},
        "hovertemplate": "%{y}, minute %{x:.0f}: %{customdata}<br>%{z:.3g} % is left<extra></extra>",
    }  # fmt: skip
    layout = base_layout(
        theme,
        "told",
        height=ROW_PX * len(sd) + AROUND_PX,
        margin={"l": 120, "r": 12, "t": 8, "b": 44},
        showlegend=False,
        xaxis=axis(theme, "Minutes since the start", showgrid=False, zeroline=False),
        yaxis=axis(theme, showgrid=False, autorange="reversed", dtick=1),
    )
    return figure([trace], layout)


def mixed(theme: Theme, share: float) -> str:
    """Return the colour of a curve over the background, this strong."""
    curve, ground = (
        np.array([int(colour[i : i + 2], 16) for i in (1, 3, 5)]) for colour in (theme.trace, theme.raised)
    )
    return "#" + "".join(f"{round(c):02x}" for c in share * curve + (1.0 - share) * ground)
