"""What is usual for a car: its force over fuel and speed, its road load, and how much its healthy trips differ."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from app.science.arrays import FloatArray
from app.science.health.domain import Domain, domain_of
from app.science.health.evidence import BIAS, COLUMNS, DRAG, ENGINE, FORCE, INERTIA, POWERS, ROLLING, TERMS, TripDesign
from app.science.health.result import Quantity

QUANTITIES: tuple[Quantity, ...] = ("rolling_resistance", "mass", "drag", "efficiency")
COUNT = len(QUANTITIES)
EXPECTED_TRIP_SD = (2.0, 10.0, 2.0, 0.5)
"""How much healthy trips are expected to differ, in %, kg, %, %: warm tyres, a bag, wind, a cold engine."""
EXPECTED_TRIPS = 5.0
"""That expectation counts like so many trips."""
LEAST_BIAS_SD_MPS2 = 0.001
ROUNDS = 12
LAGS = 10
RIDGE = 1e-6

_TERMS = slice(0, TERMS)
_EFFECTS = slice(TERMS, TERMS + COUNT + 1)
"""Effects of the four quantities and, last, of the accelerometer's bias."""


@dataclass(frozen=True, slots=True)
class Usual:
    """The usual of a car.

    Attributes
    ----------
    coefficients : array, shape (TERMS,)
        Of the engine's force, and of what drag and rolling resistance add to it beyond the car file's.
    information : array, shape (TERMS, TERMS)
        Inverse covariance of these.
    noise : float
        What the windows' variances are multiplied with, so that they may be taken for independent.
    trip_sd : array, shape (4,)
        By how much each quantity differs between healthy trips, in its unit.
    drag_area_kgpm, crr : float
        What a percent is a percent of.
    domain : Domain
        Where the engine's force is known.
    """

    coefficients: FloatArray
    information: FloatArray
    noise: float
    trip_sd: FloatArray
    drag_area_kgpm: float
    crr: float
    domain: Domain


@dataclass(frozen=True, slots=True)
class Score:
    """What a trip says of the usual's coefficients and of changes, the trip's own differences taken into account.

    Attributes
    ----------
    usual, usual_information : array, shape (TERMS,), (TERMS, TERMS)
        Gradient of the log-likelihood at the usual, and its curvature.
    change, change_information : array, shape (4,), (4, 4)
    cross : array, shape (4, TERMS)
    effect_n : array, shape (4,)
        Root mean square of the force that one unit of each change makes.
    """

    usual: FloatArray
    usual_information: FloatArray
    change: FloatArray
    change_information: FloatArray
    cross: FloatArray
    effect_n: FloatArray


def score(design: TripDesign, usual: Usual) -> Score:
    """Return what a trip says of changes from the usual, see `_score`."""
    return _score(design.gram(usual.domain.holds(design)), design, usual)


def _score(gram: FloatArray, design: TripDesign, usual: Usual) -> Score:
    """Return what a trip with these sums says of changes from the usual.

    Its residual force is what changes of C_rr, M, D and efficiency would do, plus the same four drawn anew for each
    trip with the usual's ``trip_sd``, plus the accelerometer's bias with the observer's uncertainty.
    """
    sums = _turned(gram, design, usual)
    weighted = sums - sums[:, _EFFECTS] @ np.linalg.solve(_inner(sums, design, usual), sums[_EFFECTS, :])
    causes = slice(TERMS, TERMS + COUNT)
    return Score(
        usual=weighted[_TERMS, -1],
        usual_information=weighted[_TERMS, _TERMS],
        change=weighted[causes, -1],
        change_information=weighted[causes, causes],
        cross=weighted[causes, _TERMS],
        effect_n=design.mass_kg * np.sqrt(np.diag(sums)[causes] / sums[TERMS + COUNT, TERMS + COUNT]),
    )


def fit_usual(designs: Sequence[TripDesign], drag_area_kgpm: float, crr: float) -> Usual:
    """Learn a car's usual from its baseline trips.

    The engine's force, a polynomial of degree `DEGREE` in fuel power and engine speed over v, and the road load are
    fitted by generalised least squares; the variances of what differs between trips follow by expectation
    maximisation, drawn towards `EXPECTED_TRIP_SD`.

    Parameters
    ----------
    designs : sequence of TripDesign
        Of healthy trips.
    drag_area_kgpm, crr : float
        With which the designs were made.
    """
    domain = domain_of(designs)
    grams = [design.gram(domain.holds(design)) for design in designs]
    total = np.sum(grams, axis=0)
    ridge = RIDGE * np.diag(np.diag(total)[_TERMS])
    start = np.linalg.solve(total[_TERMS, _TERMS] + ridge, total[_TERMS, FORCE])
    usual = Usual(start, ridge, 1.0, np.array(EXPECTED_TRIP_SD), drag_area_kgpm, crr, domain)
    for _ in range(ROUNDS):
        usual = _better(grams, designs, ridge, usual)
    return usual


def _better(grams: Sequence[FloatArray], designs: Sequence[TripDesign], ridge: FloatArray, usual: Usual) -> Usual:
    """Do one step of expectation maximisation."""
    scores = [_score(gram, design, usual) for gram, design in zip(grams, designs, strict=True)]
    information = np.sum([one.usual_information for one in scores], axis=0) + ridge / usual.noise
    step = np.linalg.solve(information, np.sum([one.usual for one in scores], axis=0))
    moved = replace(usual, coefficients=usual.coefficients + step, information=information)
    squares = EXPECTED_TRIPS * np.array(EXPECTED_TRIP_SD) ** 2
    for gram, design in zip(grams, designs, strict=True):
        sums = _turned(gram, design, moved)
        covariance = np.linalg.inv(_inner(sums, design, moved))
        squares += ((covariance @ sums[_EFFECTS, -1]) ** 2 + np.diag(covariance))[:COUNT]
    trip_sd = np.sqrt(squares / (EXPECTED_TRIPS + len(designs)))
    return replace(moved, trip_sd=trip_sd, noise=_noise(designs, moved))


def _turned(gram: FloatArray, design: TripDesign, usual: Usual) -> FloatArray:
    """Turn a design's sums into those of the terms, the effects and the residual, over the noise."""
    turn = np.zeros((COLUMNS, TERMS + COUNT + 2))
    turn[_TERMS, _TERMS] = np.eye(TERMS)
    rolling, mass, drag, efficiency, bias = range(TERMS, TERMS + COUNT + 1)
    turn[ROLLING, rolling] = -0.01 * usual.crr
    engine = usual.coefficients[:ENGINE]
    turn[:ENGINE, mass] = -engine / design.mass_kg
    turn[DRAG, mass] = (usual.drag_area_kgpm - usual.coefficients[DRAG]) / design.mass_kg
    turn[INERTIA, mass] = 1.0
    turn[DRAG, drag] = -0.01 * usual.drag_area_kgpm
    turn[:ENGINE, efficiency] = 0.01 * engine * np.array([i for i, _ in POWERS])
    turn[BIAS, bias] = 1.0
    turn[_TERMS, -1] = -usual.coefficients
    turn[FORCE, -1] = 1.0
    return np.asarray(turn.T @ gram @ turn) / usual.noise


def _inner(sums: FloatArray, design: TripDesign, usual: Usual) -> FloatArray:
    """Return the inverse covariance of a trip's own differences once its windows are known."""
    bias_sd = np.fmax(design.bias_sd_mps2, LEAST_BIAS_SD_MPS2)
    return np.asarray(sums[_EFFECTS, _EFFECTS] + np.diag(1.0 / np.append(usual.trip_sd, bias_sd) ** 2))


def _noise(designs: Sequence[TripDesign], usual: Usual) -> float:
    """Return the mean square of the normalised residuals times how many neighbours say the same."""
    square, count, lagged = 0.0, 0, np.zeros(LAGS)
    for design in designs:
        held = usual.domain.holds(design)
        force_n = design.rows[held, FORCE] - design.rows[held, :TERMS] @ usual.coefficients
        residual = force_n / np.sqrt(design.variance[held])
        residual -= residual.mean()
        square += float(residual @ residual)
        count += len(residual)
        lagged += [float(residual[lag:] @ residual[:-lag]) for lag in range(1, LAGS + 1)]
    return square / count * max(1.0 + 2.0 * float(np.sum(lagged)) / square, 1.0)
