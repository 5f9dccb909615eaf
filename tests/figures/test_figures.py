"""Every figure is small, valid for Plotly, readable in both themes, and shows the numbers it was given."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import plotly.graph_objects as go
import pytest

from app.figures.agreement import coverage_figure, nis_figure, refusals_figure, whiteness_figure
from app.figures.innovations import innovations_figure, sensors_figure
from app.figures.map_contour import contour_figure
from app.figures.map_counts import counts_figure
from app.figures.map_surface import surface_figure
from app.figures.operating_points import operating_points_figure
from app.figures.quantities import QUANTITIES
from app.figures.stack import stack_figure
from app.figures.theme import DARK, LIGHT, Theme, theme_named
from app.figures.track import Tiles, track_figure, track_plan_figure
from app.science.engine.cells import EMPTY, accumulate, build_map
from app.science.engine.efficiency_map import CellGrid, EfficiencyMap
from app.science.engine.operating import operating_points
from app.science.logger.recording import Recording
from app.science.observer.result import Innovations, SensorConsistency
from app.science.vehicle.model import Vehicle
from tests.synthetic import drive, points_at, random_points, with_columns

Json = dict[str, Any]
OBSERVATION = drive(seconds=1200.0)
POINTS = operating_points(OBSERVATION, Recording({}), Vehicle())


def map_of(count: int) -> EfficiencyMap:
    grid = CellGrid()
    sums = accumulate(random_points(count), grid) if count else EMPTY
    return build_map(sums, grid, Vehicle())


FULL, NO_MAP = map_of(60_000), map_of(0)
LONE = build_map(accumulate(points_at(np.full(20, 2025.0), np.full(20, 41.0)), CellGrid()), CellGrid(), Vehicle())
NO_INNOVATIONS = Innovations(np.empty(0), np.empty(0, int), np.empty(0), np.empty(0), np.empty(0, int), ())
EARLIER = tuple(SensorConsistency(s.sensor, s.count, s.rejected, s.nis_mean, 0.95) for s in OBSERVATION.sensors)
NOWHERE = with_columns(
    OBSERVATION, **{k: np.full(len(OBSERVATION.columns["t_s"]), np.nan) for k in ("lat_deg", "north_m")}
)

FIGURES: dict[str, Callable[[Theme], Json]] = {
    "track": lambda theme: track_figure(OBSERVATION.columns, theme=theme),
    "track on tiles": lambda theme: track_figure(OBSERVATION.columns, theme=theme, tiles=Tiles("/t/{z}/{x}/{y}", "us")),
    "plan": lambda theme: track_plan_figure(OBSERVATION.columns, theme=theme),
    "stack": lambda theme: stack_figure(OBSERVATION.columns, theme=theme),
    "stack of all": lambda theme: stack_figure(OBSERVATION.columns, tuple(QUANTITIES), theme=theme, points=500),
    "innovations": lambda theme: innovations_figure(OBSERVATION.innovations, theme=theme),
    "sensors": lambda theme: sensors_figure(OBSERVATION.sensors, theme=theme),
    "nis": lambda theme: nis_figure(OBSERVATION.sensors, theme=theme),
    "whiteness": lambda theme: whiteness_figure(OBSERVATION.sensors, theme=theme),
    "coverage": lambda theme: coverage_figure(OBSERVATION.sensors, theme=theme),
    "refusals": lambda theme: refusals_figure(OBSERVATION.sensors, 300.0, theme=theme),
    "points": lambda theme: operating_points_figure(POINTS, theme=theme),
    "contour": lambda theme: contour_figure(FULL, last_trip=POINTS, theme=theme),
    "contour in g/kWh": lambda theme: contour_figure(FULL, shown="bsfc", theme=theme),
    "surface": lambda theme: surface_figure(FULL, theme=theme),
    "counts": lambda theme: counts_figure(FULL, theme=theme),
    "no map": lambda theme: contour_figure(NO_MAP, theme=theme),
    "no surface": lambda theme: surface_figure(NO_MAP, theme=theme),
    "a single cell": lambda theme: contour_figure(LONE, theme=theme),
    "no surface of a single cell": lambda theme: surface_figure(LONE, theme=theme),
    "no counts": lambda theme: counts_figure(NO_MAP, theme=theme),
    "no innovations": lambda theme: innovations_figure(NO_INNOVATIONS, theme=theme),
    "no sensors": lambda theme: sensors_figure((), theme=theme),
    "no nis": lambda theme: nis_figure((), theme=theme),
    "no whiteness": lambda theme: whiteness_figure(EARLIER, theme=theme),
    "no coverage": lambda theme: coverage_figure((), theme=theme),
    "no refusals": lambda theme: refusals_figure(EARLIER, 300.0, theme=theme),
    "no signals": lambda theme: stack_figure(OBSERVATION.columns, (), theme=theme),
    "no position": lambda theme: track_figure(NOWHERE.columns, theme=theme),
    "no plan": lambda theme: track_plan_figure(NOWHERE.columns, theme=theme),
}
SMALL = 300_000


def texts_of(part: Any, key: str) -> Iterator[str]:
    """Every string under that key, at any depth."""
    if isinstance(part, dict):
        for name, value in part.items():
            if name == key and isinstance(value, str):
                yield value
            yield from texts_of(value, key)
    elif isinstance(part, list):
        for value in part:
            yield from texts_of(value, key)


@pytest.mark.parametrize("theme", [LIGHT, DARK], ids=lambda theme: theme.name)
@pytest.mark.parametrize("name", FIGURES)
def test_plotly_accepts_the_figure_and_it_is_plain_json(name: str, theme: Theme) -> None:
    figure = FIGURES[name](theme)
    text = json.dumps(figure, allow_nan=False)
    go.Figure(json.loads(text))  # raises on any property Plotly does not know
    assert figure["layout"]["uirevision"]
    assert "template" not in figure["layout"]
    assert not any(kind.endswith("gl") for kind in texts_of(figure["data"], "type"))
    if name.startswith("no "):
        assert not figure["data"]
        assert len(figure["layout"]["annotations"][0]["text"]) > 20
    elif name != "stack of all":
        assert len(text) < SMALL * (2 if name == "stack" else 1)


@pytest.mark.parametrize("name", [name for name in FIGURES if not name.startswith("no ")])
def test_what_a_pointer_tells_has_a_unit(name: str) -> None:
    units = (
        "km/h",
        "rpm",
        "%",
        "g/kWh",
        "kN",
        "kW",
        "Nm",
        " s",
        "°",
        "σ",
        "NIS",
        "correlation",
        "refused",
        "points",
        "MJ",
        "turns",
        "/km",
        "m",
        "Gear",
    )
    for trace in FIGURES[name](LIGHT)["data"]:
        if trace.get("hoverinfo") != "skip":
            assert any(unit in trace["hovertemplate"] for unit in units), trace["name"]


@pytest.mark.parametrize("theme", [LIGHT, DARK], ids=lambda theme: theme.name)
def test_colours_of_text_and_curves_stand_out(theme: Theme) -> None:
    """Contrast by WCAG 2: 4.5 for text, 3 for curves."""

    def luminance(colour: str) -> float:
        parts = np.array([int(colour[at : at + 2], 16) / 255.0 for at in (1, 3, 5)])
        linear = np.where(parts <= 0.04045, parts / 12.92, ((parts + 0.055) / 1.055) ** 2.4)
        return float(linear @ np.array([0.2126, 0.7152, 0.0722]))

    def contrast(colour: str) -> float:
        a, b = sorted((luminance(colour), luminance(theme.raised)))
        return (b + 0.05) / (a + 0.05)

    for colour in (theme.ink, theme.quiet, theme.accent, theme.good, theme.doubtful, theme.bad):
        assert contrast(colour) >= 4.5, colour
    for colour in (theme.trace, theme.highlight, *theme.series):
        assert contrast(colour) >= 3.0, colour


def test_themes_are_found_by_name() -> None:
    assert theme_named("dark") is DARK
    assert theme_named("light") is LIGHT
    assert theme_named("whatever") is LIGHT
