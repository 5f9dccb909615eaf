"""Files of one trip on one axis of time."""

from __future__ import annotations

import numpy as np
import pytest

from app.imports.combine import combine
from app.imports.signals import read_signals
from app.science.errors import SignalsError
from app.science.logger.recording import Recording


def table(signal: str, times: list[float], value: float = 1.0) -> Recording:
    rows = "".join(f"{t!r},{value}\n" for t in times)
    return read_signals(f"t_s,{signal}\n{rows}".encode(), filename="part.csv")


def test_one_file_stays_as_it_is() -> None:
    one = table("speed_mps", [3.0, 4.0])
    both = combine([one])
    assert both["speed_mps"].t_s.tolist() == [3.0, 4.0]
    assert both.warnings == ()


def test_files_of_one_logger_share_its_clock() -> None:
    both = combine([table("speed_mps", [2.0, 9.0]), table("hdop", [1.5, 10.5])])
    assert both["speed_mps"].t_s.tolist() == [2.0, 9.0]
    assert both["hdop"].t_s.tolist() == [1.5, 10.5]


def test_a_clock_that_began_long_ago_is_shared_too() -> None:
    both = combine([table("speed_mps", [90_000.0, 90_010.0]), table("hdop", [90_000.5, 90_009.0])])
    assert both["speed_mps"].t_s.tolist() == [0.0, 10.0]
    assert both["hdop"].t_s.tolist() == [0.5, 9.0]
    earlier = combine([table("speed_mps", [90_010.0, 90_020.0]), table("hdop", [90_000.0, 90_015.0])])
    assert earlier["hdop"].t_s.tolist() == [0.0, 15.0]
    assert earlier["speed_mps"].t_s.tolist() == [10.0, 20.0]
    assert earlier.texts["clock_zero_s"] == "90000.0"


def test_times_since_1970_are_placed_by_utc() -> None:
    both = combine([table("speed_mps", [1.7e9, 1.7e9 + 5]), table("hdop", [1.7e9 + 0.5, 1.7e9 + 6])])
    np.testing.assert_allclose(both["hdop"].t_s, [0.5, 6.0], atol=1e-6)
    assert both.started_at_utc_s == 1.7e9


def receiver(zero_utc_s: float, times: list[float]) -> Recording:
    rows = "".join(f"{t!r},{zero_utc_s + t!r},1.0\n" for t in times)
    return read_signals(f"t_s,utc_s,hdop\n{rows}".encode(), filename="gnss.csv")


def test_two_loggers_with_receivers_are_placed_by_utc() -> None:
    first = receiver(1.7e9, [0.0, 100.0])
    other = receiver(1.7e9 + 40.0, [0.0, 50.0])
    both = combine([first.without({"hdop"}), other.without({"utc_s"})])
    np.testing.assert_allclose(both["hdop"].t_s, [40.0, 90.0], atol=1e-6)


def test_stamps_that_come_a_little_late_do_not_move_a_file() -> None:
    both = combine([receiver(1.7e9, [0.0, 100.0]).without({"hdop"}), receiver(1.7e9 + 0.6, [0.0, 50.0])])
    assert both["hdop"].t_s.tolist() == [0.0, 50.0]


def test_a_logger_joins_utc_through_its_receiver() -> None:
    both = combine([table("speed_mps", [1.7e9, 1.7e9 + 100]), receiver(1.7e9 + 10.0, [0.0, 20.0])])
    np.testing.assert_allclose(both["hdop"].t_s, [10.0, 30.0], atol=1e-6)
    with pytest.raises(SignalsError, match="no clock in common"):
        combine([table("speed_mps", [1.7e9, 1.7e9 + 100]), table("hdop", [0.0, 20.0])])


def test_what_two_files_have_is_taken_from_the_first() -> None:
    both = combine([table("speed_mps", [0.0, 1.0], 5.0), table("speed_mps", [0.0, 1.0], 6.0)])
    assert both["speed_mps"].value.tolist() == [5.0, 5.0]
    assert both.warnings == ("File 2: speed_mps left out, because an earlier file has it.",)


def test_files_that_do_not_meet_in_time_are_doubted() -> None:
    both = combine([table("speed_mps", [0.0, 1.0]), table("hdop", [100.0, 101.0])])
    assert "doesn't overlap" in both.warnings[0]
    with pytest.raises(SignalsError, match="no file"):
        combine([])
