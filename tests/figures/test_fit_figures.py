"""Figures of formulas: comparable, valid for Plotly, and of the numbers they were given."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import plotly.graph_objects as go
import pytest

from app.figures.fit_contour import fit_contour_figure
from app.figures.fit_frame import fit_frame
from app.figures.fit_load import fit_load_figure
from app.figures.fit_residuals import fit_residuals_figure
from app.figures.theme import DARK, LIGHT, Json, Theme
from app.science.engine.fitting.family import FitRequest, fit_map
from tests.science.engine.fitting.engines import IDLE, engine, part_of

WHOLE = engine(0.004)
FEWER = part_of(WHOLE, (WHOLE.rpm < 4000.0) & (WHOLE.nm < 70.0))
FITS = fit_map(FEWER, FitRequest("eta", 4, remedy="cut"))
FUEL = fit_map(replace(WHOLE, idle=IDLE), FitRequest("p_in", 2))


def trace(figure: Json, name: str) -> Json:
    (found,) = [one for one in figure["data"] if one["name"] == name]
    return dict(found)


@pytest.mark.parametrize("theme", [LIGHT, DARK], ids=lambda theme: theme.name)
def test_plotly_accepts_them(theme: Theme) -> None:
    frame = fit_frame(FITS)
    for one in FITS.fits:
        for figure in (
            fit_contour_figure(FITS, one, frame, theme),
            fit_residuals_figure(FITS, one, frame, theme),
            fit_load_figure(FUEL, FUEL.proposed, theme),
        ):
            go.Figure(json.loads(json.dumps(figure, allow_nan=False)))
            assert figure["layout"]["uirevision"]


def test_all_formulas_share_axes_and_colours() -> None:
    frame = fit_frame(FITS)
    drawn = [fit_contour_figure(FITS, one, frame, LIGHT) for one in FITS.fits]
    left = [fit_residuals_figure(FITS, one, frame, LIGHT) for one in FITS.fits]
    assert len({(one["data"][0]["zmin"], one["data"][0]["zmax"]) for one in drawn}) == 1
    assert len({str(one["layout"]["xaxis"]["range"]) for one in [*drawn, *left]}) == 1
    assert len({(one["data"][0]["zmin"], one["data"][0]["zmax"]) for one in left}) == 1


def test_contours_are_the_formulas_efficiency_and_faint_beyond_the_cells() -> None:
    plain = fit_map(FEWER, FitRequest("phi", 2))
    one, frame = plain.named("table 4.1"), fit_frame(plain)
    figure = fit_contour_figure(plain, one, frame, LIGHT)
    z = np.array(trace(figure, "table 4.1")["z"], dtype=float)
    i, j = int(np.argmin(np.abs(frame.rpm - 3000.0))), int(np.argmin(np.abs(frame.nm - 50.0)))
    expected = one.formula.efficiency(frame.rpm[[i]] * np.pi / 30.0, frame.nm[[j]])[0]
    assert z[j, i] == pytest.approx(100.0 * expected, abs=0.06)
    veil = np.array(trace(figure, "beyond what was driven")["z"])
    assert (veil[j, i], veil[-1, -1]) == (0, 1)


def test_what_is_cut_off_is_blank() -> None:
    wild, frame = FITS.fits[-1], fit_frame(FITS)
    cut = np.array(fit_contour_figure(FITS, wild, frame, LIGHT)["data"][0]["z"], dtype=float)
    free = fit_map(FEWER, FitRequest("eta", 4))
    left = np.array(fit_contour_figure(free, free.fits[-1], frame, LIGHT)["data"][0]["z"], dtype=float)
    assert np.isnan(cut).sum() > np.isnan(left).sum()
    near = np.isfinite(cut)
    np.testing.assert_allclose(cut[near], left[near])


def test_residuals_are_cells_minus_formula() -> None:
    fits = fit_map(WHOLE, FitRequest("phi", 2))
    one = fits.named("table 4.1")
    (drawn,) = fit_residuals_figure(fits, one, fit_frame(fits), LIGHT)["data"]
    z = np.array(drawn["z"], dtype=float)
    assert np.nanstd(z) == pytest.approx(0.4, rel=0.05)
    assert np.isfinite(z).sum() == len(WHOLE.rpm)
    assert drawn["zmin"] == -drawn["zmax"]


def test_the_load_lines_show_cells_formula_and_idle() -> None:
    figure = fit_load_figure(FUEL, FUEL.named("Willans"), LIGHT)
    idle = trace(figure, "idle, 850 rpm")
    assert (idle["x"], idle["y"]) == ([0.0], [7.0])
    lines = [one for one in figure["data"] if one["mode"] == "lines" and one["line"]["dash"] == "solid"]
    assert len(lines) == 4
    for line in lines:
        rpm = float(line["name"].split()[0])
        omega = np.full(len(line["x"]), rpm * np.pi / 30.0)
        fuel = FUEL.named("Willans").formula.values(omega, np.array(line["x"])) / 1000.0
        np.testing.assert_allclose(line["y"], fuel, atol=0.2)
