"""The model of `app.science.engine.wheel_fuel` from tests that measured speed and fuel."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import nnls

from app.science.arrays import BoolArray, FloatArray, IntArray
from app.science.engine.wheel_fuel import (
    COLD_SHARE,
    COLD_SHARE_S,
    TERMS,
    Demand,
    WheelFuelModel,
    demand,
    hot_terms,
    warm_up,
)
from app.science.engine.wheel_power import DrivingCycle, RoadLoad, stretches
from app.science.errors import TooLittleData

BLOCK_S = 10
"""Means over so long are fitted, because a meter and its pipe are late and blur."""
CLUSTER = 12
"""Blocks whose residuals belong together: two minutes."""
FOLDS = 10
FEWEST_S = 600
LEAST_TOP_W = 5000.0
CREEPS_MPS = tuple(float(mps) for mps in range(9))
GAINING_SHARES = tuple(0.04 * number for number in range(7))
"""Up to about what engine and converter weigh, seen through the first gear."""
BEGIN = np.array([8e3, 1e3, 8e3, 2.5, 0.0])
UNITS = np.array([1e3, 1e3, 1e3, 1.0, 1e-5])
"""Coefficients are fitted in these, so that none drowns in another."""
START_UNIT_J = 1e6
TERM_COUNT = len(TERMS)


@dataclass(frozen=True, slots=True)
class _Shape:
    """What is chosen before the coefficients are fitted; see `WheelFuelModel`."""

    top_w: float
    creep_mps: float = 4.0
    gaining_share: float = 0.0
    quadratic: bool = False


@dataclass(frozen=True, slots=True)
class _Rows:
    """Means over ten seconds of all tests together: what is fitted, and how.

    ``design`` has the terms and one column for each start, in fitting units; ``cluster`` numbers the two minutes.
    """

    design: FloatArray
    fuel_w: FloatArray
    cluster: IntArray


@dataclass(frozen=True, slots=True)
class _Fitted:
    coefficients: FloatArray
    starts_j: FloatArray
    rows: _Rows
    solution: FloatArray
    shape: _Shape

    @property
    def residual_w(self) -> FloatArray:
        return self.rows.fuel_w - self.rows.design @ self.solution

    @property
    def left(self) -> float:
        return float(np.sum(self.residual_w**2))


@dataclass(frozen=True, slots=True)
class _Tests:
    """The tests that a model is fitted to."""

    cycles: Sequence[DrivingCycle]
    load: RoadLoad

    def asked(self, shape: _Shape) -> list[Demand]:
        return [demand(c, self.load, shape.creep_mps, shape.gaining_share, by_fuel=True) for c in self.cycles]

    def fit(self, shape: _Shape) -> _Fitted:
        asked, coefficients = self.asked(shape), BEGIN
        fuel_w = [np.asarray(cycle.fuel_power_w) for cycle in self.cycles]
        for _ in range(40):  # which seconds burn by which term changes with the coefficients, less and less
            rows = _rows(asked, fuel_w, coefficients, shape)
            solution = _solve(rows, shape.quadratic)
            found = solution[:TERM_COUNT] * UNITS
            if np.allclose(found, coefficients, rtol=1e-6):
                break
            coefficients = 0.5 * (coefficients + found)
        return _Fitted(found, solution[TERM_COUNT:] * START_UNIT_J, rows, solution, shape)

    def best(self, shapes: Iterable[_Shape]) -> _Fitted:
        return min((self.fit(shape) for shape in shapes), key=lambda fitted: fitted.left)


def fit_wheel_fuel(cycles: Sequence[DrivingCycle], load: RoadLoad) -> WheelFuelModel:
    """Fit fuel power by power at the wheels.

    What a start of the engine adds is a coefficient of its own for each start; those that add at least half of what
    a cold one usually does tell what a cold start costs. Creep speed and the share for gaining speed are those
    that leave least. The square is kept only where it predicts left-out minutes better than the straight
    line by more than one standard error.

    Raises
    ------
    TooLittleData
        When there are no ten minutes of driving with measured fuel, or the car never propels itself.
    """
    tests = _Tests(cycles, load)
    begin = _Shape(_check(tests))
    moving = [replace(begin, creep_mps=creep, gaining_share=share) for creep in CREEPS_MPS for share in GAINING_SHARES]
    straight = tests.best(moving)
    curved = tests.fit(replace(straight.shape, quadratic=True))
    return _model(curved if _is_worth_it(straight, curved) else straight, tests)


def _model(fitted: _Fitted, tests: _Tests) -> WheelFuelModel:
    covariance, shape = _covariance(fitted), fitted.shape
    own = covariance[:TERM_COUNT, :TERM_COUNT] * np.outer(UNITS, UNITS)
    starts = np.flatnonzero(_cold_starts(fitted, tests))
    starts_sd_j = np.sqrt(np.diag(covariance)[TERM_COUNT:]) * START_UNIT_J
    sums = np.bincount(fitted.rows.cluster, fitted.residual_w) * BLOCK_S
    idle_w, overrun_w, constant_w, slope, curvature_1pw = (float(value) for value in fitted.coefficients)
    return WheelFuelModel(
        idle_w=idle_w,
        overrun_w=overrun_w,
        constant_w=constant_w,
        slope=slope,
        curvature_1pw=curvature_1pw,
        sd=np.sqrt(np.diag(own)),
        covariance=own,
        creep_mps=shape.creep_mps,
        gaining_share=shape.gaining_share,
        top_w=shape.top_w,
        warm_up_j=float(fitted.starts_j[starts].mean()) if starts.size else None,
        warm_up_sd_j=float(np.sqrt((starts_sd_j[starts] ** 2).sum()) / starts.size) if starts.size else None,
        rms_w=float(np.sqrt(np.mean(fitted.residual_w**2))),
        block_sd_j=float(np.sqrt(np.mean(sums**2))),
        quadratic=shape.quadratic,
        distance_m=sum(cycle.distance_m for cycle in tests.cycles),
        tests=tuple(cycle.name for cycle in tests.cycles),
    )


def _check(tests: _Tests) -> float:
    """Return the power up to which the tests reach."""
    cycles = tests.cycles
    without = [cycle.name for cycle in cycles if cycle.fuel_power_w is None or not (cycle.fuel_power_w > 0.0).any()]
    if without or not cycles:
        raise TooLittleData(
            f"No fuel was measured in {', '.join(without) or 'any test'}; a model needs speed and fuel."
        )
    powers = np.concatenate([asked.power_w[asked.runs] for asked in tests.asked(_Shape(0.0, creep_mps=0.0))])
    if len(powers) < FEWEST_S:
        raise TooLittleData(f"The engine runs for {len(powers)} s in all; a model needs {FEWEST_S} s or more.")
    propelled = powers[powers > 0.0]
    top = float(np.quantile(propelled, 0.99)) if propelled.size else 0.0
    if top < LEAST_TOP_W:
        raise TooLittleData(f"At most {top / 1e3:.1f} kW reach the wheels; drive with {LEAST_TOP_W / 1e3:.0f} kW, too.")
    return top


def _solve(rows: _Rows, quadratic: bool, chosen: FloatArray | None = None) -> FloatArray:
    design = rows.design if quadratic else rows.design * (np.arange(rows.design.shape[1]) != TERMS.index("curvature"))
    weight = np.ones(len(rows.fuel_w)) if chosen is None else chosen
    solution: FloatArray = nnls(design * weight[:, None], rows.fuel_w * weight)[0]
    return solution


def _rows(asked: Sequence[Demand], fuel_w: Sequence[FloatArray], coefficients: FloatArray, shape: _Shape) -> _Rows:
    starts = [warm_up(one) * START_UNIT_J for one in asked]
    designs, clusters, first, cluster = [], [], 0, 0
    for one, columns in zip(asked, starts, strict=True):
        own = np.zeros((len(columns), sum(each.shape[1] for each in starts)))
        own[:, first : first + columns.shape[1]] = columns
        first += columns.shape[1]
        designs.append(_means(np.hstack([hot_terms(one, coefficients, shape.top_w) * UNITS, own])))
        clusters.append(cluster + np.arange(len(designs[-1])) // CLUSTER)
        cluster = int(clusters[-1][-1]) + 1
    return _Rows(np.vstack(designs), np.concatenate([_means(one) for one in fuel_w]), np.concatenate(clusters))


def _means(values: FloatArray) -> FloatArray:
    whole = len(values) // BLOCK_S
    means: FloatArray = values[: whole * BLOCK_S].reshape(whole, BLOCK_S, *values.shape[1:]).mean(axis=1)
    return means


def _cold_starts(fitted: _Fitted, tests: _Tests) -> BoolArray:
    """Whether each start was from cold, by what it added."""
    usual: list[float] = []
    for asked in tests.asked(fitted.shape):
        hot_w = hot_terms(asked, fitted.coefficients, fitted.shape.top_w) @ fitted.coefficients
        beginning = float(hot_w[asked.runs][:COLD_SHARE_S].mean()) * COLD_SHARE_S
        usual += [COLD_SHARE * beginning] * len(stretches(asked.runs))
    return fitted.starts_j > 0.5 * np.array(usual)


def _is_worth_it(straight: _Fitted, curved: _Fitted) -> bool:
    """Whether the square predicts left-out minutes better by more than one standard error of its own error."""
    errors = []
    for fitted, quadratic in ((straight, False), (curved, True)):
        rows, squares = fitted.rows, []
        for fold in range(FOLDS):
            out = rows.cluster % FOLDS == fold
            solution = _solve(rows, quadratic, (~out).astype(np.float64))
            squares.append(float(np.mean((rows.fuel_w[out] - rows.design[out] @ solution) ** 2)))
        errors.append(np.array(squares))
    one_error = float(errors[1].std(ddof=1) / np.sqrt(FOLDS))
    return bool(errors[0].mean() > errors[1].mean() + one_error)


def _covariance(fitted: _Fitted) -> FloatArray:
    """Covariance of the solution; residuals of the same two minutes may depend on each other in any way."""
    design, free = fitted.rows.design, fitted.solution > 0.0
    inverse = np.linalg.pinv(design[:, free].T @ design[:, free])
    scores = design[:, free] * fitted.residual_w[:, None]
    summed = np.stack([np.bincount(fitted.rows.cluster, column) for column in scores.T], axis=1)
    covariance = np.zeros((design.shape[1], design.shape[1]))
    covariance[np.ix_(free, free)] = inverse @ (summed.T @ summed) @ inverse
    return covariance
