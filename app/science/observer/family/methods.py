"""Names and numbers of the filters, and the work space they share."""

from typing import NamedTuple

import numpy as np

from app.science.arrays import AnyArray, BoolArray, FloatArray, IntArray

EKF, RK4, DISCRETE, SQUARE_ROOT, UNSCENTED, UNSCENTED_ROOT, HIGH_GAIN = range(7)

FILTERS: dict[str, int] = {
    "ekf": EKF,
    "rk4-ekf": RK4,
    "dd-ekf": DISCRETE,
    "sr-ekf": SQUARE_ROOT,
    "ukf": UNSCENTED,
    "sr-ukf": UNSCENTED_ROOT,
    "aekf": HIGH_GAIN,
}
"""Method behind each name of the contract; ``rk4-ekf`` is the continuous-discrete EKF as the thesis prints it."""


class SigmaSpread(NamedTuple):
    """Weights of the unscented transform (Sebesta 2010, A.3.2, with λ = α²(n + κ) − n and 1/(2(n + λ))).

    ``distance`` is √(n + λ), ``mean_0`` and ``covariance_0`` weigh the centre, ``other`` every other point.
    """

    distance: float
    mean_0: float
    covariance_0: float
    other: float


class Adaptation(NamedTuple):
    """Numbers of the adaptive high-gain filter (Sebesta 2010, A.4.4): thresholds of the innovation, seconds, gain."""

    upper: float
    lower: float
    window_s: float
    gain_max: float


class Work(NamedTuple):
    """Scratch arrays of one filter over n states."""

    phi: FloatArray
    a: FloatArray
    m1: FloatArray
    m2: FloatArray
    m3: FloatArray
    m4: FloatArray
    m5: FloatArray
    wide: FloatArray
    sigma: FloatArray
    rate: FloatArray
    middle: FloatArray
    q: FloatArray
    v1: FloatArray
    v2: FloatArray


class Events(NamedTuple):
    """Scalar events sorted by time, each array of shape (events,); see `observer.events.MotionEvents`."""

    t: FloatArray
    kind: AnyArray
    y: FloatArray
    r: FloatArray
    gear: AnyArray
    boosted: AnyArray


class Gates(NamedTuple):
    """Per kind of event: squared gate, refusals in a row that are borne, variance added after them."""

    squared: FloatArray
    patience: IntArray
    recovery_variance: FloatArray


class Checkpoints(NamedTuple):
    """State (…, n) and covariance or root (…, n, n) before every ``every``-th event."""

    every: int
    x: FloatArray
    s: FloatArray


class Results(NamedTuple):
    """What the filter says: innovation, its sd, outcome and G of each event; state and variance (…, n) at each node."""

    innovation: AnyArray
    sd: AnyArray
    outcome: AnyArray
    gain: AnyArray
    node_x: FloatArray
    node_variance: FloatArray


class FamilyState(NamedTuple):
    """Where a filter stands between two calls.

    ``x`` (n,), ``s`` (n, n) covariance or root, ``refused`` (kinds,), ``window_x`` (n,) the state at the beginning of
    the innovation's window; the others hold one number each.
    """

    x: FloatArray
    s: FloatArray
    refused: IntArray
    window_x: FloatArray
    now_s: FloatArray
    offset_m: FloatArray
    gain: FloatArray
    window_began_s: FloatArray
    reanchor: BoolArray
    node: IntArray
    window_first: IntArray


def family_start(x0: FloatArray, s0: FloatArray, t0_s: float, kinds: int) -> FamilyState:
    """Return where a filter stands before the first event."""
    return FamilyState(
        x=x0.copy(),
        s=s0.copy(),
        refused=np.zeros(kinds, np.int64),
        window_x=x0.copy(),
        now_s=np.array([t0_s]),
        offset_m=np.zeros(1),
        gain=np.ones(1),
        window_began_s=np.array([t0_s]),
        reanchor=np.zeros(1, np.bool_),
        node=np.zeros(1, np.int64),
        window_first=np.zeros(1, np.int64),
    )


def sigma_spread(n: int, alpha: float, beta: float, kappa: float) -> SigmaSpread:
    """Return the weights for n states."""
    scale = alpha**2 * (n + kappa)
    mean_0 = 1.0 - n / scale
    return SigmaSpread(scale**0.5, mean_0, mean_0 + 1.0 - alpha**2 + beta, 0.5 / scale)


def work_space(n: int) -> Work:
    """Return scratch arrays for n states."""
    shapes = dict.fromkeys(("phi", "a", "m1", "m2", "m3", "m4", "m5"), (n, n))
    shapes |= {"wide": (n, 3 * n), "sigma": (2 * n + 1, n)}
    arrays = {name: np.zeros(shape) for name, shape in shapes.items()}
    return Work(**arrays, **{name: np.zeros(n) for name in ("rate", "middle", "q", "v1", "v2")})
