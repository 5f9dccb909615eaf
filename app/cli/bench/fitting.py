"""Formulas through a map: time of every class and target, against plain least squares, and what the page gets."""

from __future__ import annotations

import json

import numpy as np

from app.cli.bench.figure import Figure, best_seconds
from app.exports.map_table import map_json
from app.figures.fit_contour import fit_contour_figure
from app.figures.fit_frame import fit_frame
from app.figures.fit_load import fit_load_figure
from app.figures.fit_residuals import fit_residuals_figure
from app.figures.theme import LIGHT
from app.science.engine.efficiency_map import CellGrid, EfficiencyMap
from app.science.engine.fitting.cells import RADPS_PER_RPM, TARGETS, Cells, folds, trusted_cells
from app.science.engine.fitting.family import FitRequest, MapFits, fit_map
from app.science.engine.fitting.polynomial import FEWEST_CELLS
from app.science.engine.fitting.terms import DEGREES, TermSet, classes
from app.science.virtualcar.engine import TABLE_4_1_PHI

SCATTER = 0.006
SEED = 1


def measure() -> list[Figure]:
    """Return the time of all fits and the bytes of the page's figures, for a map of the thesis' engine."""
    whole = engine()
    cells = trusted_cells(whole, fewest=FEWEST_CELLS)
    every = [terms for degree in DEGREES for terms in classes(degree)]
    ours = best_seconds(lambda: [fit_map(whole, FitRequest(target)) for target in TARGETS])
    plain = best_seconds(lambda: [plainly(cells, target, terms) for target in TARGETS for terms in every])
    shown = {degree: fit_map(whole, FitRequest("p_in", degree)) for degree in DEGREES}
    largest = max(payload(fits) for fits in shown.values())
    count = len(TARGETS) * len(every) + 1
    return [
        Figure(
            f"{count} formulas through {len(cells)} cells, judged",
            1e3 * ours,
            "ms",
            1e3 * plain,
            "numpy.linalg.lstsq, anew for each tenth left out",
            goal="at most 200 ms",
        ),
        Figure(
            "figures of a class of P_in on the page",
            largest / 1e3,
            "kB",
            written(whole) / 1e3,
            "the map's cells as JSON",
            goal="at most 300 kB",
        ),
    ]


def engine() -> EfficiencyMap:
    """Return a map of the thesis' engine over a band of loads, with scattered cells."""
    rng = np.random.default_rng(SEED)
    rpm, nm = (a.ravel() for a in np.meshgrid(np.arange(1225.0, 5000.0, 50.0), np.arange(11.0, 100.0, 2.0)))
    inside = np.abs(nm - 20.0 - 0.012 * rpm) < 24.0
    rpm, nm = rpm[inside], nm[inside]
    omega = rpm * RADPS_PER_RPM
    phi = np.column_stack([np.ones_like(omega), omega, nm, omega * nm, omega**2, nm**2]) @ np.array(TABLE_4_1_PHI)
    efficiency = 1.0 / phi + SCATTER * rng.standard_normal(len(rpm))
    n, sd, line = np.full(len(rpm), 40), np.full(len(rpm), 0.02), np.unique(rpm)
    return EfficiencyMap(CellGrid(), rpm, nm, n, efficiency, sd, 84.0 / efficiency, line, np.full(len(line), 100.0))


def plainly(cells: Cells, target: str, terms: TermSet) -> float:
    """Fit one formula in the plainest way, on columns as they are, and judge it by fitting anew without each tenth."""
    y = {"eta": cells.efficiency, "phi": 1.0 / cells.efficiency, "p_in": cells.omega * cells.torque / cells.efficiency}
    columns = np.column_stack([cells.omega**i * cells.torque**j for i, j in terms.terms])
    np.linalg.lstsq(columns, y[target], rcond=None)
    fold, left = folds(cells), np.empty(len(cells))
    for k in np.unique(fold):
        out = fold == k
        without = np.linalg.lstsq(columns[~out], y[target][~out], rcond=None)[0]
        left[out] = y[target][out] - columns[out] @ without
    return float(np.sqrt(np.mean(left**2)))


def payload(fits: MapFits) -> int:
    """Return the bytes of all figures that the page draws of these formulas."""
    frame = fit_frame(fits)
    drawn = [fit_load_figure(fits, fits.proposed, LIGHT)]
    for one in fits.fits:
        drawn += [fit_contour_figure(fits, one, frame, LIGHT), fit_residuals_figure(fits, one, frame, LIGHT)]
    return sum(len(json.dumps(figure, separators=(",", ":")).encode()) for figure in drawn)


def written(whole: EfficiencyMap) -> int:
    """Return the bytes of the map's document."""
    return len(map_json(whole, {}))
