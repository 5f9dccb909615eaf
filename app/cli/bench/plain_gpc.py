"""The report's recursive estimator as one would write it down first, with NumPy, equation by equation.

It exists to be compared with, in speed and in its numbers (MAUTC-2010-02, part 3).
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import expm

from app.science.arrays import FloatArray
from app.science.battery.config import BatteryConfig
from app.science.battery.curve import slope_at, voltage_at
from app.science.battery.run import CellRecord
from app.science.chaos.galerkin import multiplication, projected_one
from app.science.chaos.legendre import legendre, legendre_slopes


def written_out(record: CellRecord, setup: BatteryConfig) -> FloatArray:
    """Return α, R, β, ξ, x₁₀ after each row, (n, 5), from eqs 77 and 81 to 85; all rows are learnt from."""
    terms, gains, circuit, pieces = setup.gpc.terms, setup.gpc.gains, setup.cell.circuit, setup.cell.curve.pieces
    low, high = setup.gpc.sigma_range_1ps
    middle, half = (high + low) / 2, (high - low) / 2
    a = -middle * np.eye(terms) - half * multiplication(terms)
    b = projected_one(terms)
    alpha, r, beta = 1 / circuit.capacity_as, circuit.resistance_ohm, 1 / circuit.relaxation_capacitance_f
    xi, x10 = (1 / circuit.time_constant_s - middle) / half, circuit.capacity_as * setup.cell.soc
    x1, q, told = 0.0, np.zeros(terms), []
    last_dt, step = -1.0, np.eye(terms + 1)
    one = dict.fromkeys(("vcx", "vc", "ccxx", "ccx", "cc", "icx", "ic", "vi", "ii"), 0.0)
    many = {name: np.zeros(terms) for name in ("qcx", "qc", "qi", "qv")}
    qq = np.zeros((terms, terms))
    for k, (current, measured) in enumerate(zip(record.current_a, record.voltage_v, strict=True)):
        dt = record.t_s[min(k + 1, len(record.t_s) - 1)] - record.t_s[min(k, len(record.t_s) - 2)]
        soc = np.array([alpha * (x10 + x1)])
        c0 = slope_at(pieces, soc)[0]
        v = voltage_at(pieces, soc)[0] - c0 * soc[0] - measured
        now = {"vcx": v * c0 * x1, "vc": v * c0, "ccxx": (c0 * x1) ** 2, "ccx": c0**2 * x1, "cc": c0**2}
        now |= {"icx": current * c0 * x1, "ic": current * c0, "vi": v * current, "ii": current**2}
        for name in one:
            one[name] += dt * now[name]
        for name, scale in {"qcx": c0 * x1, "qc": c0, "qi": current, "qv": v}.items():
            many[name] += dt * q * scale
        qq += dt * np.outer(q, q)
        phi, slopes = legendre(xi, terms), legendre_slopes(xi, terms)
        d_alpha = one["vcx"] + x10 * one["vc"] + alpha * one["ccxx"] + 2 * alpha * x10 * one["ccx"]
        d_alpha += alpha * x10**2 * one["cc"] + beta * float(phi @ many["qcx"] + x10 * phi @ many["qc"])
        d_alpha += r * one["icx"] + r * x10 * one["ic"]
        d_r = one["vi"] + alpha * x10 * one["ic"] + alpha * one["icx"] + beta * float(phi @ many["qi"]) + r * one["ii"]
        seen = many["qv"] + alpha * many["qcx"] + alpha * x10 * many["qc"] + beta * qq @ phi + r * many["qi"]
        d_beta, d_xi = phi @ seen, beta * slopes @ seen
        d_x10 = alpha * one["vc"] + alpha**2 * x10 * one["cc"] + alpha**2 * one["ccx"]
        d_x10 += alpha * beta * float(phi @ many["qc"]) + alpha * r * one["ic"]
        alpha -= dt * gains.alpha * d_alpha
        r -= dt * gains.r * d_r
        beta -= dt * gains.beta * d_beta
        xi = np.clip(xi - dt * gains.xi * d_xi, -1.0, 1.0)
        x10 -= dt * gains.x10 * d_x10
        told.append([alpha, r, beta, xi, x10])
        forget = setup.gpc.forgetting**dt
        one = {name: value * forget for name, value in one.items()}
        many = {name: value * forget for name, value in many.items()}
        qq *= forget
        x1 += current * dt
        if dt != last_dt:
            last_dt, step = dt, expm(dt * np.block([[a, b[:, None]], [np.zeros((1, terms + 1))]]))
        q = step[:-1, :-1] @ q + step[:-1, -1] * current
    return np.array(told)
