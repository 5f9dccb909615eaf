"""Numbers with units, ratings, tyre codes and cylinder counts, as people write them."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.science.vehicle import quantities as q


@pytest.mark.parametrize(
    ("quantity", "text", "expected"),
    [
        (q.VOLUME, "698cc", 0.698),
        (q.VOLUME, "1.4 L", 1.4),
        (q.VOLUME, "1,25", 1.25),
        (q.VOLUME, "1390 cm³", 1.39),
        (q.MASS, "844 kg", 844.0),
        (q.MASS, "0,844 t", 844.0),
        (q.RATIO, "9:1", 9.0),
        (q.RATIO, "13.25", 13.25),
        (q.TIME, "-0.4 ms", -0.0004),
        (q.FLOW, "480 cc/min", 0.008),
        (q.INERTIA, "0.061 kg·m²", 0.061),
        (q.INERTIA, "0.061 kg m^2", 0.061),
        (q.ANGLE, "180°", 3.141592653589793),
        (q.POWER, "82 PS", 60.3108975),
        (q.COUNT, ".39", 0.39),
        (q.COUNT, "1e-2", 0.01),
    ],
)
def test_a_number_is_read_with_its_unit(quantity: q.Quantity, text: str, expected: float) -> None:
    assert quantity.parse(text) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("text", ["", "kg", "1.234,5", "12 34", "--3", "nan", "inf", "5 bananas", "1,2,3"])
def test_what_is_not_one_number_of_that_kind_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match=r"isn't"):
        q.MASS.parse(text)


def test_a_changed_number_keeps_the_unit_it_was_written_in() -> None:
    assert q.VOLUME.render(0.7, like="698cc") == "700cc"
    assert q.MASS.render(900.0, like="844 kg") == "900 kg"
    assert q.MASS.render(900.0, like="844") == "900"


@given(st.floats(1e-6, 1e6), st.sampled_from(["698cc", "1 l", "3", "", "2.5 dm3", "nonsense"]))
def test_a_written_number_reads_back_exactly(value: float, like: str) -> None:
    assert q.VOLUME.parse(q.VOLUME.render(value, like)) == value


def test_a_rating_has_a_value_and_an_engine_speed() -> None:
    assert q.parse_rating("60kW @5250rpm", q.POWER) == q.Rating(60.0, 5250.0)
    assert q.parse_rating("110Nm", q.TORQUE) == q.Rating(110.0, None)
    with pytest.raises(ValueError, match="isn't a number"):
        q.parse_rating("60kW @", q.POWER)


@pytest.mark.parametrize(
    ("code", "radius_m"),
    [
        ("205/45 R16", 0.29545),  # the thesis' car
        ("205/45R16 83V", 0.29545),
        ("P205/45ZR16", 0.29545),
        ("175/65 R 14", 0.29155),
        ("225/40-18", 0.3186),
        ("195/75R16C", 0.34945),
    ],
)
def test_the_wheel_radius_follows_from_the_tyre_code(code: str, radius_m: float) -> None:
    assert q.tyre_radius_m(code) == pytest.approx(radius_m, abs=5.1e-5)
    assert q.tyre_radius_m("205/45 R16") == 0.2954


@pytest.mark.parametrize("code", ["", "R16", "205/45", "205/45 R99", "999/45 R16", "winter tyres"])
def test_what_is_not_a_tyre_code_is_refused(code: str) -> None:
    with pytest.raises(ValueError, match="tyre"):
        q.tyre_radius_m(code)


@pytest.mark.parametrize(
    ("engine", "cylinders"),
    [
        ("698cc Inline 3 Turbo Suprex", 3),
        ("V6", 6),
        ("4 cyl", 4),
        ("i4", 4),
        ("1.4L 16V 4-cylinder", 4),
        ("flat-4 boxer", 4),
        ("6.0 W12", 12),
        ("straight 6 24V", 6),
        ("turbo diesel 16V", None),
        ("", None),
    ],
)
def test_the_cylinders_are_read_from_the_engines_description(engine: str, cylinders: int | None) -> None:
    assert q.cylinder_count(engine) == cylinders
