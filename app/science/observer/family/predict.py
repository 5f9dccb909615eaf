"""Time steps of the filters: each moves the state on and its covariance, or the root of it.

Every step also leaves in ``work.phi`` the transition matrix that it stands for, which is what the smoother needs.
"""

import numpy as np

from app.science.arrays import FloatArray
from app.science.jit import inline_kernel
from app.science.observer.family.dense import (
    congruence,
    derivative,
    jacobian,
    midpoint_step,
    process_noise,
    product,
    series_transition,
)
from app.science.observer.family.methods import SigmaSpread, Work
from app.science.observer.family.roots import add_rank_one, cholesky, triangularise
from app.science.observer.motion_kernels import MotionModel


@inline_kernel
def move_by_midpoint(x: FloatArray, dt: float, model: MotionModel, mass_a: float, boosted: int, work: Work) -> None:
    """Move the state as the fast filter does; fills ``work.phi`` and ``work.q``."""
    midpoint_step(x, dt, model, mass_a, work.rate, work.middle)
    jacobian(work.middle, model, mass_a, work.a)
    series_transition(work.a, dt, work.phi)
    process_noise(x, model, boosted, work.q)


@inline_kernel
def carry_covariance(p: FloatArray, dt: float, work: Work) -> None:
    """Replace the covariance by Φ P Φᵀ + Q dt, with Φ and Q as they stand in ``work``."""
    congruence(work.phi, p, work.m1)
    for i in range(p.shape[0]):
        p[i, i] += dt * work.q[i]


@inline_kernel
def predict_ekf(
    x: FloatArray, p: FloatArray, dt: float, model: MotionModel, mass_a: float, boosted: int, work: Work
) -> None:
    """Continuous-discrete EKF by the midpoint rule, the dense twin of the fast kernel."""
    move_by_midpoint(x, dt, model, mass_a, boosted, work)
    carry_covariance(p, dt, work)


@inline_kernel
def predict_discrete(
    x: FloatArray, p: FloatArray, dt: float, model: MotionModel, mass_a: float, boosted: int, work: Work
) -> None:
    """Discrete-discrete EKF (A.14): linearised where the step begins, discretised as (A.7), Q_d = Q_c Δt (A.43)."""
    derivative(x, model, mass_a, work.rate)
    jacobian(x, model, mass_a, work.a)
    series_transition(work.a, dt, work.phi)
    for i in range(len(x)):
        bend = 0.0
        for k in range(len(x)):
            bend += work.a[i, k] * work.rate[k]
        x[i] += dt * work.rate[i] + 0.5 * dt * dt * bend
    process_noise(x, model, boosted, work.q)
    carry_covariance(p, dt, work)


@inline_kernel
def predict_rk4(
    x: FloatArray, p: FloatArray, dt: float, model: MotionModel, mass_a: float, boosted: int, work: Work
) -> None:
    """Continuous-discrete EKF as printed: ẋ = f and Ṗ = A P + P Aᵀ + Q (3.2) by one Runge–Kutta step."""
    n = len(x)
    x0, x_sum = work.v1, work.v2
    p0, p_sum, phi_sum, rate_p, rate_phi = work.m1, work.m2, work.m3, work.m4, work.m5
    process_noise(x, model, boosted, work.q)
    for i in range(n):
        x0[i], x_sum[i] = x[i], x[i]
        for j in range(n):
            p0[i, j], p_sum[i, j] = p[i, j], p[i, j]
            identity = 1.0 if i == j else 0.0
            work.phi[i, j], phi_sum[i, j] = identity, identity
    for stage in range(4):
        weight = dt / 6.0 if stage in (0, 3) else dt / 3.0
        ahead = dt if stage == 2 else 0.5 * dt
        derivative(x, model, mass_a, work.rate)
        jacobian(x, model, mass_a, work.a)
        product(work.a, p, rate_p)
        product(work.a, work.phi, rate_phi)
        for i in range(n):
            x_sum[i] += weight * work.rate[i]
            x[i] = x0[i] + ahead * work.rate[i]
            for j in range(i + 1):
                slope = rate_p[i, j] + rate_p[j, i]
                if i == j:
                    slope += work.q[i]
                p_sum[i, j] += weight * slope
                p[i, j] = p0[i, j] + ahead * slope
                p[j, i] = p[i, j]
            for j in range(n):
                phi_sum[i, j] += weight * rate_phi[i, j]
                work.phi[i, j] = (1.0 if i == j else 0.0) + ahead * rate_phi[i, j]
    for i in range(n):
        x[i] = x_sum[i]
        for j in range(i + 1):
            p[i, j], p[j, i] = p_sum[i, j], p_sum[i, j]
        for j in range(n):
            work.phi[i, j] = phi_sum[i, j]


@inline_kernel
def predict_square_root(
    x: FloatArray, root: FloatArray, dt: float, model: MotionModel, mass_a: float, boosted: int, work: Work
) -> None:
    """Square-root continuous-discrete EKF (A.21)–(A.23): the triangular factor of [Φ S, √(Q Δt)]."""
    n = len(x)
    move_by_midpoint(x, dt, model, mass_a, boosted, work)
    product(work.phi, root, work.m1)
    pre = work.wide[:, : 2 * n]
    for i in range(n):
        for j in range(n):
            pre[i, j] = work.m1[i, j]
            pre[i, n + j] = 0.0
        pre[i, n + i] = np.sqrt(dt * work.q[i])
    triangularise(pre, root)


@inline_kernel
def carry_sigma_points(
    x: FloatArray, root: FloatArray, dt: float, model: MotionModel, mass_a: float, spread: SigmaSpread, work: Work
) -> None:
    """Draw sigma points, carry each along the flow; the mean goes to ``x``, the deviations stay in ``work.sigma``.

    Over one step this is how the Kalman–Bucy equations (A.29) are integrated: the points follow ẋ = f, the noise is
    added at the end.
    """
    n = len(x)
    for k in range(2 * n + 1):
        point = work.sigma[k]
        for i in range(n):
            point[i] = x[i]
            if 1 <= k <= n:
                point[i] += spread.distance * root[i, k - 1]
            elif k > n:
                point[i] -= spread.distance * root[i, k - 1 - n]
        midpoint_step(point, dt, model, mass_a, work.rate, work.middle)
    for i in range(n):
        total = 0.0
        for k in range(1, 2 * n + 1):
            total += work.sigma[k, i]
        x[i] = spread.mean_0 * work.sigma[0, i] + spread.other * total
    for k in range(2 * n + 1):
        for i in range(n):
            work.sigma[k, i] -= x[i]


@inline_kernel
def sigma_transition(root: FloatArray, spread: SigmaSpread, work: Work) -> None:
    """Fill ``work.phi`` with the statistically linearised transition, cross covariance over covariance."""
    n = root.shape[0]
    for i in range(n):
        for c in range(n - 1, -1, -1):
            value = spread.other * spread.distance * (work.sigma[1 + c, i] - work.sigma[1 + n + c, i])
            for k in range(c + 1, n):
                value -= work.phi[i, k] * root[k, c]
            work.phi[i, c] = value / root[c, c]


@inline_kernel
def predict_unscented(
    x: FloatArray,
    p: FloatArray,
    dt: float,
    model: MotionModel,
    mass_a: float,
    boosted: int,
    spread: SigmaSpread,
    work: Work,
) -> bool:
    """Unscented Kalman–Bucy step; False when the covariance has lost its positive definiteness."""
    n = len(x)
    if not cholesky(p, work.m1):
        return False
    carry_sigma_points(x, work.m1, dt, model, mass_a, spread, work)
    sigma_transition(work.m1, spread, work)
    process_noise(x, model, boosted, work.q)
    for i in range(n):
        for j in range(i + 1):
            total = 0.0
            for k in range(1, 2 * n + 1):
                total += work.sigma[k, i] * work.sigma[k, j]
            p[i, j] = spread.other * total + spread.covariance_0 * work.sigma[0, i] * work.sigma[0, j]
            p[j, i] = p[i, j]
        p[i, i] += dt * work.q[i]
    return True


@inline_kernel
def predict_unscented_root(
    x: FloatArray,
    root: FloatArray,
    dt: float,
    model: MotionModel,
    mass_a: float,
    boosted: int,
    spread: SigmaSpread,
    work: Work,
) -> bool:
    """Square-root form of the same; False when taking the centre's weight away leaves nothing positive."""
    n = len(x)
    carry_sigma_points(x, root, dt, model, mass_a, spread, work)
    sigma_transition(root, spread, work)
    process_noise(x, model, boosted, work.q)
    weight = np.sqrt(spread.other)
    for i in range(n):
        for k in range(2 * n):
            work.wide[i, k] = weight * work.sigma[k + 1, i]
        for k in range(n):
            work.wide[i, 2 * n + k] = 0.0
        work.wide[i, 2 * n + i] = np.sqrt(dt * work.q[i])
    triangularise(work.wide, root)
    weight = np.sqrt(abs(spread.covariance_0))
    for i in range(n):
        work.v1[i] = weight * work.sigma[0, i]
    return add_rank_one(root, work.v1, 1.0 if spread.covariance_0 > 0.0 else -1.0)
