"""The report's estimator against eqs 81 to 85 written out, and on its own virtual cell (MAUTC-2010-02, Table 7)."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.signal import lfilter

from app.science.arrays import FloatArray
from app.science.battery.circuit import Cell, Circuit
from app.science.battery.config import BatteryConfig, GpcSettings
from app.science.battery.curve import OpenCircuit, slope_at, voltage_at
from app.science.battery.gpc import run_gpc
from app.science.battery.run import CellRecord
from app.science.chaos.galerkin import multiplication, projected_one
from app.science.chaos.legendre import legendre, legendre_slopes

CURVE = OpenCircuit((3.12, 1.35, -5.4, 11.2, -11.5, 5.1, -0.42))
TRUE = Circuit(2.0, 0.008, 2700.0, 0.011)
GUESS = Circuit(2.2, 0.010, 3000.0, 0.010)
DAY = 86_400


def load(days: float, rng: np.random.Generator) -> FloatArray:
    """Return a current, A, of a 2 Ah cell that is driven from 80 to 20 % and charged with 2 A, again and again."""
    drive = np.repeat(rng.normal(-1.4, 2.0, 60), 20)
    current, soc = np.empty(round(days * DAY)), 0.7
    charging = False
    for k in range(len(current)):
        current[k] = 2.0 if charging else drive[k % len(drive)]
        soc += current[k] / TRUE.capacity_as
        charging = soc < 0.8 if charging else soc < 0.2
    return current


def record_of(current: FloatArray, rng: np.random.Generator, *, bias_a: float = 0.0) -> CellRecord:
    """Return what sensors with 10 mA and 2 mV of noise see of the report's cell, once a second."""
    charge = np.concatenate([[0.0], np.cumsum(current)[:-1]])
    kept = np.exp(-1.0 / TRUE.time_constant_s)
    relaxation = lfilter([0.0, TRUE.relaxation_resistance_ohm * (1.0 - kept)], [1.0, -kept], current)
    voltage = voltage_at(CURVE.pieces, 0.7 + charge / TRUE.capacity_as) + relaxation + TRUE.resistance_ohm * current
    n = len(current)
    return CellRecord(
        np.arange(n, dtype=np.float64),
        current + rng.normal(bias_a, 0.01, n),
        voltage + rng.normal(0.0, 0.002, n),
        *(np.ones(1) for _ in range(3)),
        np.unique(np.linspace(0, n - 1, 400).astype(np.int64)),
    )


def config(terms: int = 3, start_after_s: float = 0.0, **settings: object) -> BatteryConfig:
    return BatteryConfig(Cell(CURVE, GUESS, 0.5), "gpc", GpcSettings(terms=terms, **settings), start_after_s)  # type: ignore[arg-type]  # settings by name


def written_out(record: CellRecord, setup: BatteryConfig) -> FloatArray:
    """Return α, R, β, ξ, x₁₀ after each row, from eqs 77 and 81 to 85 term by term."""
    terms, gains, circuit = setup.gpc.terms, setup.gpc.gains, setup.cell.circuit
    low, high = setup.gpc.sigma_range_1ps
    middle, half = (high + low) / 2, (high - low) / 2
    a = -middle * np.eye(terms) - half * multiplication(terms)
    b = projected_one(terms)
    alpha, r, beta = 1 / circuit.capacity_as, circuit.resistance_ohm, 1 / circuit.relaxation_capacitance_f
    xi, x10 = (1 / circuit.time_constant_s - middle) / half, circuit.capacity_as * setup.cell.soc
    x1, q, told = 0.0, np.zeros(terms), []
    one = dict.fromkeys(("vcx", "vc", "ccxx", "ccx", "cc", "icx", "ic", "vi", "ii"), 0.0)
    many = {name: np.zeros(terms) for name in ("qcx", "qc", "qi", "qv")}
    qq = np.zeros((terms, terms))
    for k, (current, measured) in enumerate(zip(record.current_a, record.voltage_v, strict=True)):
        dt = record.t_s[min(k + 1, len(record.t_s) - 1)] - record.t_s[min(k, len(record.t_s) - 2)]
        soc = np.array([alpha * (x10 + x1)])
        c0 = slope_at(CURVE.pieces, soc)[0]
        v = voltage_at(CURVE.pieces, soc)[0] - c0 * soc[0] - measured
        now = {"vcx": v * c0 * x1, "vc": v * c0, "ccxx": (c0 * x1) ** 2, "ccx": c0**2 * x1, "cc": c0**2}
        now |= {"icx": current * c0 * x1, "ic": current * c0, "vi": v * current, "ii": current**2}
        for name in one:
            one[name] += dt * now[name]
        for name, scale in {"qcx": c0 * x1, "qc": c0, "qi": current, "qv": v}.items():
            many[name] += dt * q * scale
        qq += dt * np.outer(q, q)
        phi, slopes = legendre(xi, terms), legendre_slopes(xi, terms)
        d_alpha = one["vcx"] + x10 * one["vc"] + alpha * one["ccxx"] + 2 * alpha * x10 * one["ccx"]
        d_alpha += alpha * x10**2 * one["cc"] + beta * phi @ many["qcx"] + beta * x10 * phi @ many["qc"]
        d_alpha += r * one["icx"] + r * x10 * one["ic"]
        d_r = one["vi"] + alpha * x10 * one["ic"] + alpha * one["icx"] + beta * phi @ many["qi"] + r * one["ii"]
        seen = many["qv"] + alpha * many["qcx"] + alpha * x10 * many["qc"] + beta * qq @ phi + r * many["qi"]
        d_beta, d_xi = phi @ seen, beta * slopes @ seen
        d_x10 = alpha * one["vc"] + alpha**2 * x10 * one["cc"] + alpha**2 * one["ccx"]
        d_x10 += alpha * beta * phi @ many["qc"] + alpha * r * one["ic"]
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
        step = expm(dt * np.block([[a, b[:, None]], [np.zeros((1, terms + 1))]]))
        q = step[:-1, :-1] @ q + step[:-1, -1] * current
    return np.array(told)


@pytest.mark.parametrize("terms", [1, 2, 3, 5])
def test_the_kernel_is_the_law_written_out(terms: int) -> None:
    rng = np.random.default_rng(terms)
    record = record_of(load(0.03, rng), rng)
    told = written_out(record, setup := config(terms))[record.keep]
    values = run_gpc(record, setup).values
    np.testing.assert_allclose(values[:, 0], 1 / (3600 * told[:, 0]), rtol=1e-9)
    np.testing.assert_allclose(values[:, 1], told[:, 1], rtol=1e-9)
    np.testing.assert_allclose(values[:, 2], 1 / told[:, 2], rtol=1e-9)
    np.testing.assert_allclose(values[:, 3], told[:, 2] / (0.035 + 0.015 * told[:, 3]), rtol=1e-9)


def test_the_reports_cell_is_found_with_three_terms_and_missed_with_two() -> None:
    rng = np.random.default_rng(7)
    record = record_of(load(10.0, rng), rng)
    truth = np.array([2.0, 0.008, 2700.0, 0.011])
    three, two = (run_gpc(record, config(terms, float(DAY))) for terms in (3, 2))
    error = np.abs(three.values[-1, :4] / truth - 1.0)
    assert np.all(error < [0.002, 0.005, 0.01, 0.01])
    assert np.abs(two.values[-1, 3] / truth[3] - 1.0) > 0.02
    assert np.all(np.abs(three.values[-1, :4] - truth) < 4.0 * three.sds[-1, :4])
    assert np.all(np.abs(two.values[-1, :4] - truth) < 4.0 * two.sds[-1, :4])
    assert three.voltage_noise_v == pytest.approx(0.002, rel=0.01)
    assert np.all(three.values[record.keep < DAY, :4] == three.values[0, :4])
