"""Degradation maps: read, written, interpolated as SciPy does it, and refused by path."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.interpolate import RegularGridInterpolator

from app.science.battery.virtual.ageing import DEFAULT_MAP, loss_at, read_degradation
from app.science.battery.virtual.cycling_kernels import LossTable, loss_per_ah
from app.science.fields import ProblemError

DOCUMENT: dict[str, Any] = {
    "current_a": [-2.0, 0.0, 3.0],
    "voltage_v": [3.0, 3.6],
    "loss_ah_per_ah": [[1e-5, 2e-5], [3e-5, 5e-5], [4e-5, 9e-5]],
}


def test_map_comes_back_as_it_was_written() -> None:
    assert read_degradation(DOCUMENT).document() == DOCUMENT
    assert read_degradation(DEFAULT_MAP.document()) == DEFAULT_MAP


def test_between_the_points_it_is_bilinear_and_outside_the_edge() -> None:
    told, rng = DEFAULT_MAP, np.random.default_rng(1)
    current, volts = rng.uniform(-15.0, 12.0, 400), rng.uniform(2.5, 4.2, 400)
    axes = (np.array(told.current_a), np.array(told.at))
    peer = RegularGridInterpolator(axes, np.array(told.loss_ah_per_ah))
    inside = np.column_stack([np.clip(current, -10.0, 8.0), np.clip(volts, 2.8, 3.8)])
    np.testing.assert_allclose(loss_at(told, current, volts), peer(inside), rtol=1e-12)
    table = LossTable(*axes[:1], False, axes[1], np.array(told.loss_ah_per_ah))
    by_kernel = [loss_per_ah(table, i, v) for i, v in zip(current, volts, strict=True)]
    np.testing.assert_allclose(by_kernel, peer(inside), rtol=1e-12)


def test_one_point_is_a_constant() -> None:
    told = read_degradation({"current_a": [0.0], "soc": [0.5], "loss_ah_per_ah": [[4e-5]]})
    np.testing.assert_array_equal(loss_at(told, np.array([-3.0, 3.0]), np.array([0.1, 0.9])), 4e-5)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"current_a": [0.0, -2.0, 3.0]}, r"degradation\.current_a\[1\]: -2 is not above 0"),
        ({"voltage_v": []}, r"degradation\.voltage_v: is empty"),
        ({"soc": [0.2, 0.8]}, r"degradation\.soc: stands beside voltage_v"),
        ({"loss_ah_per_ah": [[1e-5, 2e-5]]}, r"degradation\.loss_ah_per_ah: has 1 rows; 3 are needed"),
        ({"loss_ah_per_ah": [[1e-5, 2e-5], [1e-5], [1e-5, 2e-5]]}, r"loss_ah_per_ah\.1: has 1 numbers; 2 are needed"),
        ({"loss_ah_per_ah": [[1e-5, 2e-5], [1e-5, -1.0], [0.0, 0.0]]}, r"loss_ah_per_ah\.1\[1\]: -1 is out of range"),
        ({"volts": 1}, r"degradation\.volts: is not a field of this degradation map"),
        ({"voltage_v": None}, r"degradation\.voltage_v: null is not a list"),
    ],
)
def test_what_is_wrong_is_named_by_its_path(change: dict[str, object], words: str) -> None:
    with pytest.raises(ProblemError, match=words):
        read_degradation(DOCUMENT | change)
