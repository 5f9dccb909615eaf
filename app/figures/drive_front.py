"""A Pareto front: fuel against an emission or against time, with the drive it was drawn for."""

from __future__ import annotations

from app.figures.drive_documents import DrawnDrive
from app.figures.theme import Json, Theme, axis, base_layout, empty_figure, figure

NOT_DRAWN = "No front has been drawn yet."
SUBSTANCES = {"co2": "CO₂", "nox": "NOₓ", "hc": "HC", "co": "CO", "pm": "particles"}


def front_figure(drive: DrawnDrive, theme: Theme) -> Json:
    """Draw the front's points, dashed where no weights lead to a drive between two of them.

    Parameters
    ----------
    drive : DrawnDrive
        With a front.
    theme : Theme
    """
    points = [] if drive.front is None else drive.front["points"]
    if drive.front is None or not points:
        return empty_figure(theme, "drive-front", NOT_DRAWN)
    (x_title, x_factor), (y_title, y_factor) = _shown(drive.front["x_axis"]), _shown(drive.front["y_axis"])
    x = [round(x_factor * float(one["x"]), 4) for one in points]
    y = [round(y_factor * float(one["y"]), 5) for one in points]
    straight = {tuple(edge) for edge in drive.front.get("edges", [])}
    traces: list[Json] = []
    for k in range(len(points) - 1):
        dash = "dash" if (k, k + 1) in straight else "solid"
        traces.append(
            {
                "type": "scatter",
                "mode": "lines",
                "name": "between",
                "x": x[k : k + 2],
                "y": y[k : k + 2],
                "line": {"color": theme.trace, "width": 1.6, "dash": dash},
                "hoverinfo": "skip",
                "showlegend": False,
            }
        )
    traces.append(
        {
            "type": "scatter",
            "mode": "markers",
            "name": "drives of the front",
            "x": x,
            "y": y,
            "customdata": [[round(float(one["time_s"]), 2), one["verdict"]] for one in points],
            "marker": {"size": 9, "color": theme.trace},
            "hovertemplate": f"{x_title} %{{x}}<br>{y_title} %{{y}}<br>%{{customdata[0]}} s, %{{customdata[1]}}"
            "<extra></extra>",
        }
    )
    layout = base_layout(
        theme,
        f"drive-front-{drive.front['y_axis']}",
        showlegend=False,
        margin={"l": 60, "r": 16, "t": 16, "b": 48},
        xaxis=axis(theme, x_title),
        yaxis=axis(theme, y_title),
    )
    return figure(traces, layout)


def _shown(name: str) -> tuple[str, float]:
    """Return an axis' title and the factor from the document's unit."""
    if name == "time_s":
        return "Time, s", 1.0
    if name.endswith("_energy_j"):
        return ("Fuel, kJ" if name == "fuel_energy_j" else "Weighted energy, kJ"), 1e-3
    emission = name.removesuffix("_g")
    return f"{SUBSTANCES.get(emission, emission)}, g", 1.0
