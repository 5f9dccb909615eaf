"""What a trip took beyond its best drive, part by part."""

from __future__ import annotations

from app.figures.theme import LIGHT, Json, Theme, axis, base_layout, empty_figure, figure
from app.science.eco.result import PARTS, Loss, TripScore

NOTHING = "There is nothing to tell apart."
ROW_PX = 52
LABEL_PX = 20
AROUND_PX = 76


def parts_figure(score: TripScore, *, theme: Theme = LIGHT) -> Json:
    """Draw the parts as bars that add up to the last one.

    Parameters
    ----------
    score : TripScore
    theme : Theme
    """
    if not score.parts:
        return empty_figure(theme, "score-parts", NOTHING)
    whole = sum(part.litres for part in score.parts)
    names = [*(_named(part) for part in score.parts), "Together"]
    starts, at = [], 0.0
    for part in score.parts:
        starts.append(at)
        at += part.litres
    litres = [*(part.litres for part in score.parts), whole]
    percent = [*(part.percent for part in score.parts), sum(part.percent for part in score.parts)]
    trace: Json = {
        "type": "bar",
        "orientation": "h",
        "name": "More than the best drive, L",
        "y": names,
        "x": [round(value, 4) for value in litres],
        "base": [round(value, 4) for value in (*starts, 0.0)],
        "customdata": [round(value, 2) for value in percent],
        "width": 0.4,
        "marker": {"color": [*(theme.trace if v >= 0.0 else theme.good for v in litres[:-1]), theme.quiet]},
        "hovertemplate": "%{y}: %{x:.3f} L, %{customdata:.1f} %<extra></extra>",
    }
    told = [f"{_signed(value, 3)} L, {_signed(share, 1)} %" for value, share in zip(litres, percent, strict=True)]
    above: Json = {"xref": "paper", "yshift": LABEL_PX, "showarrow": False}
    labels = [
        above | {"y": name, "text": text, "x": x, "xanchor": side}
        for name, value in zip(names, told, strict=True)
        for text, x, side in ((name, 0.0, "left"), (value, 1.0, "right"))
    ]
    layout = base_layout(
        theme,
        "score-parts",
        height=ROW_PX * len(names) + AROUND_PX,
        margin={"l": 12, "r": 12, "t": 20, "b": 48},
        showlegend=False,
        annotations=labels,
        xaxis=axis(theme, "More than the best drive, L", zeroline=True),
        yaxis=axis(theme, autorange="reversed", showgrid=False, showticklabels=False),
    )
    return figure([trace], layout)


def _named(part: Loss) -> str:
    return next((words for name, words in PARTS.items() if name == part.name), part.name)


def _signed(value: float, decimals: int) -> str:
    text = f"{abs(value):.{decimals}f}"
    return f"−{text}" if value < 0.0 and text.strip("0.") else text
