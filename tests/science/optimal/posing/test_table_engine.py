"""Tables of real engines as engines of problems."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from app.science.engine.reference import ReferenceMap, read_reference
from app.science.fields import Fields
from app.science.optimal.fuel_checks import fuel_power_w, full_load_nm
from app.science.optimal.posing.car import misfit
from app.science.optimal.posing.errors import PoseError
from app.science.optimal.posing.table_engine import engine_of_table, map_of_table
from app.science.optimal.problem import PolynomialEngine
from app.science.optimal.reading import read_engine

PETROL_JPG, DIESEL_JPG = 42_600.0, 42_940.0


@pytest.mark.parametrize(
    ("name", "heat", "rms"),
    [
        ("geo_1.0L_SI_41kW", PETROL_JPG, 0.06),
        ("prius_jpn_1.5L_43kW", PETROL_JPG, 0.01),
        ("vw_1.9L_TDI_ORNL", DIESEL_JPG, 0.02),
    ],
)
def test_a_measured_engine_is_followed(shared_data: Callable[[str], Path], name: str, heat: float, rms: float) -> None:
    table = read_reference((shared_data("engine-maps-nrel") / f"{name}.csv").read_bytes(), heat)
    engine = read_engine(Fields(engine_of_table(table)))
    assert isinstance(engine, PolynomialEngine)
    omega = table.rpm * np.pi / 30.0
    inside = (table.nm >= engine.torque_nm[0]) & (table.nm <= full_load_nm(engine, table.rpm) + 1e-9)
    assert inside.mean() > 0.95
    off = fuel_power_w(engine, omega, table.nm) * table.efficiency / (omega * table.nm) - 1.0
    assert np.sqrt(np.mean(off[inside] ** 2)) < rms


def test_a_table_of_willans_lines_is_found_exactly() -> None:
    rpm, nm = (
        x.ravel() for x in np.meshgrid(np.linspace(1000.0, 5000.0, 9), np.linspace(10.0, 120.0, 12), indexing="ij")
    )
    omega = rpm * np.pi / 30.0
    fuel = 20.0 * omega + 2.4 * omega * nm
    table = ReferenceMap(rpm, nm, omega * nm / fuel)
    document = engine_of_table(table, 4000.0)
    engine = read_engine(Fields(document))
    assert isinstance(engine, PolynomialEngine)
    middle = (np.array([250.0]), np.array([63.0]))
    exact = 20.0 * 250.0 + 2.4 * 250.0 * 63.0
    assert fuel_power_w(engine, *middle)[0] == pytest.approx(
        exact, rel=5e-3
    )  # the table's efficiency is linear between
    assert document["idle_fuel_power_w"] == 4000.0
    assert document["torque_nm"] == [10.0, 120.0]
    assert misfit(document, map_of_table(table)).startswith("The engine's formula misses the fuel power of")


def test_a_table_without_a_common_torque_is_refused() -> None:
    rpm = np.repeat([1000.0, 2000.0, 3000.0], 4)
    nm = np.concatenate((np.linspace(10.0, 40.0, 4), np.linspace(20.0, 90.0, 4), np.linspace(50.0, 90.0, 4)))
    with pytest.raises(PoseError, match="it begins at 50 Nm, at another it ends at 40 Nm"):
        engine_of_table(ReferenceMap(rpm, nm, np.full(12, 0.3)))
