"""How a battery's voltage answers its current from one row to the next, before any model is trusted."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.science.arrays import AnyArray, FloatArray, IntArray
from app.science.battery.record import BatteryRecord

LAGS = (0, 1, -1, 2, -2, 3, -3)
"""Rows by which the voltage may follow the current; it should be the first."""
USUAL_STEPS = 5.0
"""Rows further apart than so many usual steps are not neighbours."""
MOST_STEPS, MOST_ROWS = 5000, 50_000
LEAST_STEPS = 10
GLIDING = 0.8
"""Correlation of a step with the next one from which on the current glides."""
LARGER = 2.0
TELLING = 4.0
"""A step tells its direction where it should move the voltage by so many times the noise."""
ROBUST = 1.4826
"""Makes a median of absolute values a standard deviation."""


@dataclass(frozen=True, slots=True)
class Response:
    """What the largest steps of the current do to the voltage, of the whole pack.

    Attributes
    ----------
    ohm, ohm_sd : float
        Slope of the voltage's steps over the current's; 0 and infinity where there are too few.
    agreement : float
        Share of the steps well above the noise at which both go the same way; a half where there are too few.
    lag : int
        Rows by which the voltage follows.
    steps : int
        Steps this rests on.
    explained : float
        Share of the voltage's steps, squared, that the current's explain.
    noise_v : float
        Of the voltage, from row to row, with the current's part taken out.
    sharp : bool
        Whether the current steps, rather than glides: only then is the slope a resistance, and a lag can be told.
    """

    ohm: float
    ohm_sd: float
    agreement: float
    lag: int
    steps: int
    explained: float
    noise_v: float
    sharp: bool = False

    @property
    def certainty(self) -> float:
        """Slope in its standard deviations, with its sign."""
        return self.ohm / self.ohm_sd if self.ohm_sd > 0.0 else 0.0


def response_of(record: BatteryRecord) -> Response:
    """Return how the voltage answers the current.

    Loggers may write a voltage one row late or early, and then steps of alternating currents seem to be answered the
    wrong way round: the steps before and after are part of the regression.
    """
    known = np.isfinite(record.voltage_v)
    step, volts, amps = (np.diff(column[known]) for column in (record.t_s, record.voltage_v, record.current_a))
    usable = step <= USUAL_STEPS * np.median(step) if len(step) else np.zeros(0, dtype=np.bool_)
    amps = np.where(usable, amps, 0.0)
    rows = np.flatnonzero(usable)
    if len(rows) == 0:
        return Response(0.0, np.inf, 0.5, 0, 0, 0.0, 0.0)
    size = np.abs(amps[rows])
    large = rows[np.argpartition(-size, min(MOST_STEPS, len(rows)) - 1)[:MOST_STEPS]]
    large = large[np.abs(amps[large]) > 0.1 * size.max()]
    large = np.unique(np.clip(large[:, None] + np.array(LAGS), 0, len(usable) - 1))
    large = large[usable[large]]
    some = thinned(rows)
    if len(large) < LEAST_STEPS:
        return Response(0.0, np.inf, 0.5, 0, len(large), 0.0, _noise(volts[some]))
    columns = _lagged(amps, large)
    sharp = _is_sharp(columns)
    columns = columns if sharp else columns[:, :1]
    slopes, sds = _regression(columns, volts[large])
    best = _best_lag(slopes, sds)
    of_best = columns[:, best]
    rest = volts[some] - _lagged(amps, some)[:, : len(slopes)] @ slopes
    noise = _noise(rest)
    telling = np.abs(slopes[best] * of_best) > TELLING * noise
    telling &= volts[large] != 0.0  # a step lost in the sensor's rounding goes neither way
    same = np.sign(of_best[telling]) == np.sign(volts[large][telling])
    agreement = float(same.mean()) if len(same) >= LEAST_STEPS else 0.5
    left = volts[large] - columns @ slopes
    by_chance = max(len(large) - len(slopes), 1) / len(large)
    explained = 1.0 - float(np.sum(left**2) / max(np.sum(volts[large] ** 2), 1e-30)) / by_chance
    steps = int(telling.sum())
    return Response(float(slopes[best]), float(sds[best]), agreement, LAGS[best], steps, explained, noise, sharp)


def quantum(volts: FloatArray) -> float:
    """Return the smallest step of a sensor, volts: the least difference between neighbouring rows that is none."""
    steps = thinned(np.abs(np.diff(volts[np.isfinite(volts)])))
    steps = steps[steps > 1e-9]
    return float(np.quantile(steps, 0.01)) if len(steps) else 0.0


def thinned(values: AnyArray) -> AnyArray:
    """Return some fifty thousand values out of many, evenly spread: enough for how large they usually are."""
    return values[:: max(len(values) // MOST_ROWS, 1)]


def _lagged(amps: FloatArray, rows: IntArray) -> FloatArray:
    """Return the current's steps at the given rows and around them, (n, lags)."""
    room = max(LAGS)
    return np.asarray(np.pad(amps, room)[rows[:, None] + room - np.array(LAGS)])


def _is_sharp(columns: FloatArray) -> bool:
    """Tell whether a step of the current is unlike the one after it."""
    size = float(np.sum(columns[:, 0] ** 2))
    return size > 0.0 and abs(float(np.sum(columns[:, 0] * columns[:, 1]))) < GLIDING * size


def _best_lag(slopes: FloatArray, sds: FloatArray) -> int:
    """Return which slope is the resistance: that of no lag, unless another one is clearly larger.

    What the relaxation does in the rows after a step is a slope of theirs, too.
    """
    clear = np.where(np.abs(slopes) > 3.0 * sds, np.abs(slopes), 0.0)
    best = int(np.argmax(clear))
    return best if clear[best] > LARGER * abs(slopes[0]) else 0


def _regression(columns: FloatArray, volts: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return slopes and their standard deviations, by least squares with far-off steps bounded (Huber)."""
    normal = columns.T @ columns + 1e-12 * np.eye(columns.shape[1])
    slopes = np.linalg.solve(normal, columns.T @ volts)
    rest = volts - columns @ slopes
    bound = 3.0 * ROBUST * float(np.median(np.abs(rest))) + 1e-9
    weights = np.minimum(1.0, bound / np.maximum(np.abs(rest), 1e-12))
    normal = (columns * weights[:, None]).T @ columns + 1e-12 * np.eye(columns.shape[1])
    slopes = np.linalg.solve(normal, columns.T @ (weights * volts))
    variance = float(np.sum(weights * (volts - columns @ slopes) ** 2) / max(len(volts) - len(slopes), 1))
    return np.asarray(slopes), np.sqrt(np.maximum(variance, 1e-12) * np.diag(np.linalg.inv(normal)))


def _noise(differences: FloatArray) -> float:
    """Return the standard deviation of single values from that of differences between two."""
    return float(ROBUST * np.median(np.abs(differences - np.median(differences))) / np.sqrt(2.0))
