"""Figures show the numbers they were given."""

from __future__ import annotations

import json
from itertools import pairwise

import numpy as np
import pytest

from app.figures.agreement import coverage_figure, nis_figure, refusals_figure, whiteness_figure
from app.figures.innovations import innovations_figure, sensors_figure
from app.figures.map_contour import contour_figure
from app.figures.map_counts import counts_figure
from app.figures.map_surface import surface_figure
from app.figures.operating_points import operating_points_figure
from app.figures.quantities import QUANTITIES, quantity
from app.figures.stack import stack_figure
from app.figures.theme import SPEED_FULL_SCALE_KMH
from app.figures.track import track_figure, track_plan_figure
from app.science.engine.cells import accumulate, build_map
from app.science.engine.efficiency_map import CellGrid, EfficiencyMap
from app.science.engine.operating import operating_points
from app.science.engine.reading import peak
from app.science.errors import ScienceError
from app.science.logger.recording import Recording
from app.science.observer.states import DERIVED_COLUMNS, STATE_COLUMNS
from app.science.vehicle.model import Vehicle
from tests.synthetic import drive, random_points, table_4_1

OBSERVATION = drive(seconds=1200.0)
POINTS = operating_points(OBSERVATION, Recording({}), Vehicle())


def full_map() -> EfficiencyMap:
    return build_map(accumulate(random_points(60_000), CellGrid()), CellGrid(), Vehicle())


FULL = full_map()


def test_every_column_has_words_a_unit_and_sensible_decimals() -> None:
    assert set(QUANTITIES) == {*STATE_COLUMNS, *DERIVED_COLUMNS}
    assert quantity("speed_mps").shown(np.array([10.0])).tolist() == [36.0]
    assert quantity("engine_speed_radps").shown(np.array([np.pi])) == pytest.approx(30.0)
    assert quantity("maf_gps").title == "maf_gps, g/s"
    assert quantity("gear").title == "Gear"


def test_the_stack_shows_values_bands_and_says_what_it_leaves_out() -> None:
    c = OBSERVATION.columns
    figure = stack_figure(c, ("speed_mps", "efficiency"), points=400)
    two, one, speed, efficiency = figure["data"]
    assert figure["layout"]["meta"]["total"] == 12_000
    assert figure["layout"]["meta"]["badge"] == f"showing {figure['layout']['meta']['shown']} of 12\u202f000"
    assert max(speed["y"]) == pytest.approx(3.6 * c["speed_mps"].max(), abs=0.01)
    highest = 3.6 * float((c["speed_mps"] + 2 * c["speed_mps_sd"]).max())
    assert max(two["y"]) == pytest.approx(highest, abs=0.01)
    assert max(one["y"]) < max(two["y"])
    assert None in efficiency["y"]
    assert np.nanmax(np.array(efficiency["y"], float)) == pytest.approx(100 * np.nanmax(c["efficiency"]), abs=0.06)
    assert len({trace["yaxis"] for trace in figure["data"]}) == 2


def test_a_part_of_the_stack_is_exact() -> None:
    figure = stack_figure(OBSERVATION.columns, ("torque_nm",), from_s=60.0, to_s=70.0)
    trace = figure["data"][-1]
    assert len(figure["data"]) == 1  # torque has no deviation of its own, so no bands
    assert figure["layout"]["meta"] == {"badge": "", "shown": 101, "total": 101, "signals": ["torque_nm"]}
    inside = (OBSERVATION.columns["t_s"] >= 60.0) & (OBSERVATION.columns["t_s"] <= 70.0)
    np.testing.assert_allclose(trace["y"], OBSERVATION.columns["torque_nm"][inside], atol=0.051)


def test_bands_of_a_part_are_the_deviations_themselves() -> None:
    two, one, speed = stack_figure(OBSERVATION.columns, ("speed_mps",), from_s=60.0, to_s=70.0)["data"]
    sd = 3.6 * OBSERVATION.columns["speed_mps_sd"][600:701]
    for trace, deviations in ((one, 1), (two, 2)):
        upper, lower = np.array(trace["y"][:101]), np.array(trace["y"][101:][::-1])
        np.testing.assert_allclose(upper - np.array(speed["y"]), deviations * sd, atol=0.011)
        np.testing.assert_allclose(np.array(speed["y"]) - lower, deviations * sd, atol=0.011)


def test_panels_lie_inside_the_plot_and_do_not_overlap() -> None:
    layout = stack_figure(OBSERVATION.columns, tuple(QUANTITIES)[:5])["layout"]
    domains = [layout[key]["domain"] for key in sorted(layout) if key.startswith("yaxis")]
    for upper, lower in pairwise(domains):
        assert 0.0 <= lower[0] < lower[1] < upper[0] < upper[1] <= 1.0
    assert layout["xaxis"]["anchor"] == "y5"


def test_an_unknown_signal_is_named() -> None:
    with pytest.raises(ScienceError, match=r"'wheel_angle'.*speed_mps"):
        stack_figure(OBSERVATION.columns, ("wheel_angle",))


def test_the_track_asks_no_other_host_and_is_coloured_by_speed() -> None:
    figure = track_figure(OBSERVATION.columns)
    style = figure["layout"]["map"]["style"]
    assert style["sources"] == {}
    assert not {"glyphs", "sprite"} & set(style)
    assert "http" not in json.dumps(figure)
    marker = figure["data"][1]["marker"]
    assert (marker["cmin"], marker["cmax"]) == (0, SPEED_FULL_SCALE_KMH)
    assert max(marker["color"]) == pytest.approx(3.6 * OBSERVATION.columns["speed_mps"].max(), abs=0.5)
    start, stop = figure["data"][3], figure["data"][5]
    assert (start["name"], stop["name"]) == ("start", "stop")
    assert start["lat"][0] == pytest.approx(OBSERVATION.columns["lat_deg"][0], abs=1e-6)
    assert stop["lon"][0] == pytest.approx(OBSERVATION.columns["lon_deg"][-1], abs=1e-6)


def test_the_plan_has_equal_axes() -> None:
    layout = track_plan_figure(OBSERVATION.columns)["layout"]
    assert layout["yaxis"]["scaleanchor"] == "x"
    assert layout["yaxis"]["scaleratio"] == 1


def test_the_map_view_contains_the_track() -> None:
    figure = track_figure(OBSERVATION.columns)
    view, lat = figure["layout"]["map"], OBSERVATION.columns["lat_deg"]
    degrees_shown = 360.0 * 300.0 / (512.0 * 2.0 ** view["zoom"]) * np.cos(np.radians(view["center"]["lat"]))
    assert abs(lat - view["center"]["lat"]).max() <= degrees_shown / 2 * 1.01


def test_the_contour_shows_each_trusted_cell_and_blank_elsewhere() -> None:
    figure = contour_figure(FULL)
    heat = figure["data"][0]
    z = np.array(heat["z"], dtype=float)
    assert np.isfinite(z).sum() == np.isfinite(FULL.efficiency).sum()
    rpm, nm = np.meshgrid(heat["x"], heat["y"])
    known = np.isfinite(z)
    np.testing.assert_allclose(z[known], 100 * table_4_1(rpm[known], nm[known]), atol=0.4)
    veil = np.array(figure["data"][1]["z"], dtype=float)
    assert np.all((veil[known] > 0) & (veil[known] < 1))
    best = peak(FULL)
    assert best is not None
    star = figure["data"][-1]
    assert (star["x"][0], star["y"][0]) == (best.rpm, best.nm)
    assert f"{100 * best.efficiency:.1f} %" in star["name"]


def test_consumption_is_the_other_side_of_efficiency() -> None:
    efficiency = np.array(contour_figure(FULL)["data"][0]["z"], dtype=float)
    consumption = np.array(contour_figure(FULL, shown="bsfc")["data"][0]["z"], dtype=float)
    known = np.isfinite(efficiency)
    np.testing.assert_allclose((efficiency * consumption)[known], 100 * 3.6e9 * 0.745 / 32.0e6, rtol=6e-3)


def test_isolines_and_surface_are_smoothed_and_close_small_holes() -> None:
    holed = full_map()
    lost = np.flatnonzero(np.isfinite(holed.efficiency))[1000]
    holed.efficiency[lost] = np.nan
    z = np.array(surface_figure(holed)["data"][0]["z"], dtype=float)
    x, y = surface_figure(holed)["data"][0]["x"], surface_figure(holed)["data"][0]["y"]
    value = z[y.index(holed.nm[lost]), x.index(holed.rpm[lost])]
    assert value == pytest.approx(100 * table_4_1(holed.rpm[lost], holed.nm[lost]), abs=0.3)


def test_counts_are_told_as_they_are() -> None:
    trace = counts_figure(FULL)["data"][0]
    assert np.nansum(np.array(trace["customdata"], dtype=float)) == 60_000


def test_innovations_are_a_fair_sample_with_refused_ones_marked() -> None:
    figure = innovations_figure(OBSERVATION.innovations)
    assert [trace["name"] for trace in figure["data"]] == ["Wheels", "Accelerometer, forward", "Position, north"]
    every = np.concatenate([trace["customdata"] for trace in figure["data"]])
    symbols = np.concatenate([trace["marker"]["symbol"] for trace in figure["data"]])
    assert np.mean(np.abs(every[symbols == "circle"]) < 2.0) == pytest.approx(0.954, abs=0.02)
    i = OBSERVATION.innovations
    assert (symbols == "x-thin").sum() == (i.accepted == 0).sum()
    assert all(abs(y) <= 5.0 for trace in figure["data"] for y in trace["y"])
    assert np.abs(every).max() > 5.0


def test_sensor_bars_tell_the_numbers_of_the_consistency() -> None:
    figure = sensors_figure(OBSERVATION.sensors)
    nis, inside, refused = figure["data"]
    assert nis["x"] == [1.02, 0.9, 2.4]
    assert inside["x"] == [95.1, 96.2, 81.0]
    assert refused["x"][2] == pytest.approx(100 * 12 / OBSERVATION.sensors[2].count, abs=1e-3)


def test_agreement_figures_tell_the_numbers_of_the_consistency() -> None:
    names = ["Wheels", "Accelerometer, forward", "Position, north"]
    *bands, dots = nis_figure(OBSERVATION.sensors)["data"]
    assert [band["x"] for band in bands] == [[0.94, 1.07]] * 3
    assert dict(zip(dots["y"], dots["x"], strict=True)) == dict(zip(names, (1.02, 0.9, 2.4), strict=True))
    *_, dots = whiteness_figure(OBSERVATION.sensors)["data"]
    assert dots["x"] == [0.01, -0.02, 0.6]
    assert "portmanteau 6.4" in dots["customdata"][2]
    one, two = coverage_figure(OBSERVATION.sensors)["data"]
    assert two["x"] == [95.1, 96.2, 81.0]
    assert one["x"][0] == pytest.approx(0.71 * 95.1, abs=0.05)
    figure = refusals_figure(OBSERVATION.sensors, 300.0)
    believed = next(trace for trace in figure["data"] if trace["name"] == "Position, north: refused, then believed")
    assert believed["x"] == [10.0, 12.0, None, 90.5, 93.5, None]
    assert figure["layout"]["xaxis"]["range"] == [0, pytest.approx(303.0)]


def test_operating_points_are_thinned_with_a_badge() -> None:
    figure = operating_points_figure(POINTS)
    trace, meta = figure["data"][0], figure["layout"]["meta"]
    assert len(trace["x"]) == meta["shown"] == 3000
    assert meta["total"] == len(POINTS)
    assert meta["badge"].startswith("showing 3\u202f000 of ")
    assert trace["x"][0] == pytest.approx(POINTS.engine_speed_rpm[0], abs=0.5)
