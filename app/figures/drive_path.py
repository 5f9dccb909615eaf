"""Where a drive runs its engine: its path over the efficiency that the problem's formula gives."""

from __future__ import annotations

import numpy as np

from app.figures.decimate import even_indices
from app.figures.drive_documents import DrawnDrive
from app.figures.map_lines import power_lines
from app.figures.map_scale import ENGINE_SPEED, TORQUE, MapScale, scale_of
from app.figures.numbers import rounded
from app.figures.theme import Json, Theme, axis, base_layout, colour_bar, empty_figure, figure
from app.science.arrays import FloatArray
from app.science.optimal.costs.weighted import WeightedDrive, WeightedEngine
from app.science.optimal.fuel_checks import fuel_power_w, full_load_nm
from app.science.optimal.problem import RADPS_PER_RPM, BallAndWheel, PolynomialEngine, WillansDrive

COLUMNS, ROWS = 81, 61
AROUND = 0.04
MOST_PIECES, MOST_POINTS = 60, 2500
NO_ENGINE = "There is no engine in this problem."


def path_figure(drive: DrawnDrive, other: DrawnDrive | None, theme: Theme) -> Json:
    """Draw the operating points of a drive over the engine's efficiency, gear by gear.

    Parameters
    ----------
    drive : DrawnDrive
    other : DrawnDrive, optional
        Of the same engine; its path is dashed.
    theme : Theme
    """
    if isinstance(drive.problem, BallAndWheel):
        return empty_figure(theme, "drive-path", NO_ENGINE)
    engine = drive.problem.engine
    if isinstance(engine, WeightedEngine | WeightedDrive):
        engine = engine.fuel
    if isinstance(engine, WillansDrive):
        return _over_power(drive, engine, theme)
    (low, high), (least, most) = engine.speed_rpm, engine.torque_nm
    rpm, nm = np.linspace(low, high, COLUMNS), np.linspace(least, most, ROWS)
    z = 100.0 * _efficiency(engine, rpm, nm)
    scale = scale_of("efficiency", z)
    top, beside = most + AROUND * (most - least), AROUND * (high - low)
    powers = power_lines((low - beside, high + beside), top, theme)
    full = full_load_nm(engine, rpm)
    traces = [
        _contours(rpm, nm, z, scale, theme),
        powers.trace,
        {
            "type": "scatter",
            "mode": "lines",
            "name": "limits of the engine",
            "x": rounded(np.concatenate(([low], rpm, [high, low])), 0),
            "y": rounded(np.concatenate(([least], full, [least, least])), 1),
            "line": {"color": theme.ink, "width": 1.8},
            "hovertemplate": "limit: %{y:.0f} Nm at %{x:.0f} rpm<extra></extra>",
        },
        *_path(drive, theme.highlight, "solid", theme),
    ]
    if other is not None and other.has("torque_nm"):
        traces += _path(other, theme.series[1], "dash", theme)
    layout = base_layout(
        theme,
        "drive-path",
        margin={"l": 52, "r": 46, "t": 52, "b": 92},
        annotations=powers.labels,
        xaxis=axis(theme, ENGINE_SPEED, range=[low - beside, high + beside], showgrid=False),
        yaxis=axis(theme, TORQUE, range=[min(0.0, least), round(top, 1)], showgrid=False, zeroline=False),
    )
    return figure(traces, layout)


def _efficiency(engine: PolynomialEngine, rpm: FloatArray, nm: FloatArray) -> FloatArray:
    """Return efficiency on the grid, shape (rows, columns); NaN above full load and where nothing is given."""
    omega, torque = np.meshgrid(rpm * RADPS_PER_RPM, nm)
    with np.errstate(divide="ignore", invalid="ignore"):
        efficiency = omega * torque / fuel_power_w(engine, omega, torque)
    shown = (torque <= full_load_nm(engine, omega / RADPS_PER_RPM) + 1e-9) & (torque > 0.0)
    return np.where(shown & np.isfinite(efficiency), efficiency, np.nan)


def _contours(rpm: FloatArray, nm: FloatArray, z: FloatArray, scale: MapScale, theme: Theme) -> Json:
    return {
        "type": "contour",
        "name": scale.name,
        "x": rounded(rpm, 0),
        "y": rounded(nm, 1),
        "z": rounded(z, 1),
        "contours": scale.isolines(theme.ink) | {"coloring": "heatmap"},
        "line": {"color": theme.ink, "width": 0.6},
        "colorbar": colour_bar(theme, scale.title, nticks=4, tickangle=0),
        "hovertemplate": "%{z:.1f} %<br>%{x:.0f} rpm, %{y:.0f} Nm<extra></extra>",
    } | scale.colours("zmin", "zmax")


def _path(drive: DrawnDrive, colour: str, dash: str, theme: Theme) -> list[Json]:
    """Draw one line on a light casing, broken where the control jumps, with the gears' numbers beside it.

    A drive of very many pieces is drawn as points.
    """
    t, rpm, nm = drive.column("t_s"), drive.column("engine_speed_radps") / RADPS_PER_RPM, drive.column("torque_nm")
    gear, fuel = drive.column("gear"), drive.column("fuel_power_w")
    breaks = np.flatnonzero((np.diff(gear) != 0.0) | (np.diff(t) == 0.0)) + 1
    percent = 100.0 * rpm * RADPS_PER_RPM * nm / np.where(fuel > 0.0, fuel, np.nan)
    columns = [rpm, nm, t, 3.6 * drive.column("speed_mps"), percent]
    dotted = len(breaks) > MOST_PIECES
    if dotted:
        pulling = np.flatnonzero(np.isfinite(nm))
        columns = [one[pulling[even_indices(len(pulling), MOST_POINTS)]] for one in columns]
    else:
        columns = [np.insert(one, breaks, np.nan) for one in columns]
    place: Json = {"type": "scatter", "x": rounded(columns[0], 0), "y": rounded(columns[1], 1), "mode": "lines"}
    casing = {"line": {"color": theme.raised, "width": 6}, "hoverinfo": "skip", "showlegend": False}
    hover = [rounded(one, 1) for one in columns[2:]]
    drawn = place | {
        "name": drive.name,
        "mode": "markers" if dotted else "lines+markers",
        "marker": {"color": colour, "size": 5, "opacity": 0.6 if dotted else 1.0},
        "line": {"color": colour, "width": 3, "dash": dash},
        "customdata": [list(row) for row in zip(*hover, strict=True)],
        "hovertemplate": "%{customdata[2]} %<br>%{x:.0f} rpm, %{y:.1f} Nm<br>"
        "%{customdata[0]} s, %{customdata[1]} km/h<extra></extra>",
    }
    if dotted:
        return [drawn]
    lines = [place | casing | {"name": f"around {drive.name}"}, drawn]
    return [*lines, _gear_numbers(drive, rpm, nm, gear, theme)] if (gear > 0).any() else lines


def _gear_numbers(drive: DrawnDrive, rpm: FloatArray, nm: FloatArray, gear: FloatArray, theme: Theme) -> Json:
    """Write each gear once, at the middle of where it is used."""
    spots = []
    for one in np.unique(gear[np.isfinite(nm) & (gear > 0)]):
        rows = np.flatnonzero((gear == one) & np.isfinite(nm))
        spots.append((rows[len(rows) // 2], int(one)))
    at = np.array([row for row, _ in spots])
    return {
        "type": "scatter",
        "mode": "markers+text",
        "name": f"gears of {drive.name}",
        "x": rounded(rpm[at], 0),
        "y": rounded(nm[at], 1),
        "text": [str(one) for _, one in spots],
        "marker": {"size": 17, "color": theme.raised, "line": {"color": theme.ink, "width": 1}},
        "textfont": {"size": 11, "color": theme.ink},
        "textposition": "middle center",
        "showlegend": False,
        "hovertemplate": "gear %{text}<br>%{x:.0f} rpm, %{y:.1f} Nm<extra></extra>",
    }


def _over_power(drive: DrawnDrive, willans: WillansDrive, theme: Theme) -> Json:
    """Draw the fuel that the line gives over power at the wheels, and where the drive is on it."""
    c0, c1, c2 = willans.willans
    power = np.linspace(*willans.power_w, COLUMNS)
    line = (c0 + c1 * power + c2 * power**2) / 1000.0
    fuel = np.unique(drive.column("fuel_power_w")) / 1000.0
    traces: list[Json] = [
        {
            "type": "scatter",
            "mode": "lines",
            "name": "fuel by the Willans line",
            "x": rounded(power / 1000.0, 3),
            "y": rounded(line, 3),
            "line": {"color": theme.ink, "width": 1.6},
            "hovertemplate": "%{x:.1f} kW at the wheels take %{y:.1f} kW of fuel<extra></extra>",
        },
        {
            "type": "scatter",
            "mode": "markers",
            "name": drive.name,
            "x": rounded(np.interp(fuel, line, power / 1000.0), 3),
            "y": rounded(fuel, 3),
            "marker": {"size": 6, "color": theme.highlight},
            "hovertemplate": "%{x:.1f} kW at the wheels, %{y:.1f} kW of fuel<extra></extra>",
        },
    ]
    layout = base_layout(
        theme,
        "drive-path",
        margin={"l": 52, "r": 12, "t": 12, "b": 92},
        xaxis=axis(theme, "Power at the wheels, kW"),
        yaxis=axis(theme, "Fuel power, kW", rangemode="tozero"),
    )
    return figure(traces, layout)
