"""The thesis' own counter-example (Note 18): outputs sampled in turn can tell less than outputs sampled together."""

from __future__ import annotations

import numpy as np
import pytest

from app.science.observer.observability.rank import balanced, lie_derivatives, ranked
from app.science.observer.observability.sampling import sampled_derivatives

START = np.array([0.4, 2.0, 1.5])
"""Angle on the circle, x₃ (the size of both outputs), x₄ (the turning rate)."""
COUNT = 12


def turned(x, t):
    """The solution of the footnote: x₁ = cos(x₄t + C₁), x₂ = sin(x₄t + C₁)."""
    return np.array([x[0] + x[2] * t, x[1], x[2]])


OUTPUTS = (lambda x: x[1] * np.cos(x[0]), lambda x: x[1] * np.sin(x[0]), lambda x: x[2])


def told(samples) -> list[bool]:
    return ranked(sampled_derivatives(turned, OUTPUTS, START, samples)).told.tolist()


def in_turn(step: float):
    """y₁, y₂, y₁, … one step apart, and y₃ beside each."""
    return [sample for k in range(COUNT) for sample in ((k * step, k % 2), (k * step, 2))]


def together(step: float):
    return [(k * step, which) for k in range(COUNT) for which in range(3)]


@pytest.mark.parametrize("turns", [0, 1, 5])
def test_a_quarter_turn_between_samples_in_turn_loses_size_and_angle(turns: int) -> None:
    step = (np.pi / 2 + 2 * np.pi * turns) / START[2]
    assert told(in_turn(step)) == [False, False, True]
    assert told(together(step)) == [True, True, True]


def test_the_samples_themselves_can_not_tell_two_starts_apart() -> None:
    step = np.pi / 2 / START[2]
    other = np.array([0.0, START[1] * np.cos(START[0]), START[2]])
    values = [[OUTPUTS[which](turned(x, t)) for t, which in in_turn(step)] for x in (START, other)]
    np.testing.assert_allclose(values[0], values[1], atol=1e-12)
    together_values = [[OUTPUTS[which](turned(x, t)) for t, which in together(step)] for x in (START, other)]
    assert np.abs(np.subtract(*together_values)).max() > 0.5


@pytest.mark.parametrize("share", [0.5, 0.9, 1.1, 1.7])
def test_any_other_step_tells_everything(share: float) -> None:
    assert told(in_turn(share * np.pi / 2 / START[2])) == [True, True, True]


def test_continuous_outputs_tell_everything() -> None:
    """The footnote's system itself, on the plane: x₁, x₂, x₃ follow from y but for x₁² + x₂² = 1, which is known."""
    x0 = np.array([np.cos(0.4), np.sin(0.4), 2.0, 1.5])
    field = lambda x: [-(x[1] * x[3]), x[0] * x[3], x[2] * 0.0, x[3] * 0.0]  # noqa: E731
    outputs = {
        "y1": lambda x: x[0] * x[2], "y2": lambda x: x[1] * x[2], "y3": lambda x: x[3],
        "circle": lambda x: x[0] * x[0] + x[1] * x[1],
    }  # fmt: skip
    found = lie_derivatives(field, outputs, x0, np.ones(4), 1.0)
    assert ranked(balanced(list(found.values()))).rank == 4
    del found["circle"]
    assert ranked(balanced(list(found.values()))).told.tolist() == [False, False, False, True]
