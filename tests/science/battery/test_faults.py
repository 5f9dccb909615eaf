"""Records with faults of every kind: what can be mended is mended and said, what can't be is refused in a sentence."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from app.science.battery.answer import BatteryEstimate
from app.science.battery.circuit import Cell, Circuit
from app.science.battery.config_reading import read_config
from app.science.battery.curve import OpenCircuit
from app.science.battery.doubts import refuse_what_is_lost
from app.science.battery.estimate import estimate
from app.science.battery.pack import cell_record
from app.science.battery.record import BatteryRecord
from app.science.battery.simulate import simulate
from app.science.battery.whole_run import run_whole
from app.science.errors import EstimatorDiverged, SignalsError
from app.science.progress import silent
from tests.science.battery.plain_cell import CONFIG, NOISE_V, OCV, TRUTH, driven

ROWS = 20_000
Fault = Callable[[BatteryRecord], BatteryRecord]


def found(record: BatteryRecord, **changes: Any) -> BatteryEstimate:
    return estimate(record, read_config(CONFIG | changes))


def stuck(name: str, begin: int, end: int) -> Fault:
    def fault(record: BatteryRecord) -> BatteryRecord:
        column = getattr(record, name).copy()
        column[begin:end] = column[begin]
        return replace(record, **{name: column})

    return fault


def clipped(name: str, low: float, high: float) -> Fault:
    return lambda record: replace(record, **{name: np.clip(getattr(record, name), low, high)})


GLIDING = {"initial": CONFIG["initial"] | {"resistance_ohm": 0.005, "relaxation_resistance_ohm": 0.011}}


def gliding() -> BatteryRecord:
    """Return hours of driving whose current never steps by more than half an ampere, and a charge in between."""
    rng, t_s = np.random.default_rng(5), np.arange(ROWS, dtype=np.float64)
    amps = 1.5 * np.sin(t_s / 7.0) + 1.2 * np.sin(t_s / 29.0) - 0.25
    amps[9000:10_500] = 2.0
    circuit = Circuit(TRUTH["capacity_ah"], 0.006, TRUTH["relaxation_capacitance_f"], 0.011)
    made = simulate(Cell(OpenCircuit(tuple(OCV)), circuit, TRUTH["soc"]), t_s, amps)
    noise = rng.normal(0.0, 1.0, (2, ROWS))
    return BatteryRecord(t_s, amps + 0.01 * noise[0], made.voltage_v + NOISE_V * noise[1])


def at(name: str, value: float, *rows: int) -> Fault:
    def fault(record: BatteryRecord) -> BatteryRecord:
        column = getattr(record, name).copy()
        column[list(rows)] = value
        return replace(record, **{name: column})

    return fault


MENDED: list[tuple[str, Fault, str]] = [
    ("frozen voltage", stuck("voltage_v", 8000, 10_000), "The voltage stands still in 2000 rows"),
    ("clipped voltage", clipped("voltage_v", 0.0, 3.47), "a frozen or clipped sensor"),
    ("frozen current", stuck("current_a", 8000, 10_000), "what flowed there is not known"),
    ("spikes of current", at("current_a", 400.0, 500, 7000), "2 rows with a current up to 400 A"),
    ("spikes of voltage", at("voltage_v", 65.535, 500, 7000), "2 voltages far outside the open-circuit curve"),
    ("swapped sign", lambda record: replace(record, current_a=-record.current_a), "sign is swapped: at 100%"),
]


@pytest.mark.parametrize(("fault", "words"), [entry[1:] for entry in MENDED], ids=[entry[0] for entry in MENDED])
def test_what_can_be_mended_is_mended_and_said(fault: Fault, words: str) -> None:
    answer = found(fault(driven(ROWS)))
    assert words in " ".join(answer.warnings)
    assert answer.values[0] == pytest.approx(TRUTH["capacity_ah"], rel=0.003)
    assert answer.values[1] == pytest.approx(TRUTH["resistance_ohm"], rel=0.01)


def test_sound_records_are_left_alone() -> None:
    assert found(driven(ROWS)).warnings == ()
    rough = driven(ROWS)
    rounded = replace(rough, voltage_v=np.round(rough.voltage_v, 2), current_a=np.round(rough.current_a, 1))
    assert found(rounded).warnings == ()


def test_a_clipped_current_is_said_to_spoil_the_capacity() -> None:
    said = " ".join(found(clipped("current_a", -3.0, 3.0)(driven(ROWS))).warnings)
    assert "extreme value, -3 A and 3 A" in said
    assert "do not trust the capacity" in said


@pytest.mark.parametrize(
    ("fault", "words"),
    [
        (stuck("voltage_v", 8000, 14_000), "The voltage stands still in 6000 rows"),
        (clipped("voltage_v", 0.0, 3.48), "a frozen or clipped sensor"),
        (stuck("current_a", 8000, 14_000), "what flowed there is not known"),
    ],
)
def test_currents_that_glide_through_a_small_resistance_show_stuck_sensors_too(fault: Fault, words: str) -> None:
    sound = gliding()
    assert found(sound, **GLIDING).warnings == ()
    answer = found(fault(sound), **GLIDING)
    assert words in " ".join(answer.warnings)
    assert answer.values[0] == pytest.approx(TRUTH["capacity_ah"], rel=0.01)


def test_a_charger_that_holds_current_then_voltage_is_no_stuck_sensor() -> None:
    """Constant current to 3.6 V, then constant voltage with a falling current, logged without any noise."""
    soc, rows, t = 0.2, [], 0.0
    ohm, capacity_as = TRUTH["resistance_ohm"], 3600.0 * TRUTH["capacity_ah"]
    for _ in range(4000):
        at_rest = sum(c * soc**power for power, c in enumerate(OCV))
        amps = min(1.5, (3.6 - at_rest) / ohm)
        rows.append((t, amps, at_rest + ohm * amps))
        soc += amps / capacity_as
        t += 1.0
    columns = np.array(rows).T
    record = BatteryRecord(columns[0], np.round(columns[1], 3), np.round(columns[2], 3))
    said = " ".join(found(record).warnings)
    assert "stand" not in said
    assert "sign" not in said


REFUSED: list[tuple[str, Fault, str]] = [
    ("frozen voltage", lambda r: replace(r, voltage_v=np.full(ROWS, 3.3)), "stands still at 3.3 V"),
    ("dead current", lambda r: replace(r, current_a=np.zeros(ROWS)), "current_a stands still at 0 A"),
    ("millivolts", lambda r: replace(r, voltage_v=1e3 * r.voltage_v), "millivolts"),
    ("milliamperes", lambda r: replace(r, current_a=1e3 * r.current_a), "milliamperes"),
    ("milliseconds", lambda r: replace(r, t_s=1e3 * r.t_s), "milliseconds"),
    ("a pack's voltage", lambda r: replace(r, voltage_v=96.0 * r.voltage_v), "is series missing"),
    ("another curve's", lambda r: replace(r, voltage_v=r.voltage_v + 1.0), "another battery's"),
]


@pytest.mark.parametrize(("fault", "words"), [entry[1:] for entry in REFUSED], ids=[entry[0] for entry in REFUSED])
def test_what_cannot_be_used_is_refused_with_what_may_be_the_reason(fault: Fault, words: str) -> None:
    with pytest.raises(SignalsError) as refused:
        found(fault(driven(ROWS)))
    assert words in str(refused.value)


def test_a_cells_voltage_is_not_taken_for_a_packs() -> None:
    with pytest.raises(SignalsError, match=r"like 1\.0 cells in series, not 96"):
        found(driven(ROWS), series=96)


DOUBTED: list[tuple[str, Fault, dict[str, Any], str]] = [
    ("only rest", lambda r: BatteryRecord(r.t_s[:3000], np.zeros(3000), noisy(3000)), {}, "The data say little of"),
    ("a late start", lambda r: r, {"start_after_s": 1e6}, "nothing was learnt"),
    ("a short curve", lambda r: r, {"ocv": [[0.4, 3.211], [0.5, 3.25], [0.6, 3.303]]}, "known from 40% to 60%"),
    ("a wrong voltage", lambda r: replace(r, voltage_v=r.voltage_v + 0.05), {}, "The data contradict the model"),
    ("late voltages", lambda r: replace(r, voltage_v=np.roll(r.voltage_v, 1)), {}, "answers the current 1 row later"),
    ("a slow logger", lambda r: every(r, 120), {}, "The rows are 2 min apart"),
    ("a falling curve", lambda r: r, {"ocv": [3.0, 1.6, -5.0, 5.7, -1.9]}, "The open-circuit curve falls between"),
    ("a wrong rating", lambda r: r, {"rated_capacity_ah": 1.0}, "200% of the rated one"),
]  # fmt: skip


def noisy(rows: int) -> Any:
    return 3.3 + np.random.default_rng(5).normal(0.0, NOISE_V, rows)


def every(record: BatteryRecord, step: int) -> BatteryRecord:
    return BatteryRecord(record.t_s[::step], record.current_a[::step], record.voltage_v[::step])


@pytest.mark.parametrize(("fault", "changes", "words"), [one[1:] for one in DOUBTED], ids=[one[0] for one in DOUBTED])
def test_what_is_to_be_doubted_is_said(fault: Fault, changes: dict[str, Any], words: str) -> None:
    said = found(fault(driven(ROWS)), **changes).warnings
    assert any(words in warning for warning in said), said


def test_what_the_data_do_not_tell_is_named_with_what_would() -> None:
    discharge = np.polynomial.Polynomial(OCV)(0.7 - np.arange(3000) / 7200.0) - TRUTH["resistance_ohm"]
    record = BatteryRecord(np.arange(3000.0), np.full(3000, -1.0), discharge + noisy(3000) - 3.3)
    (said,) = [one for one in found(record).warnings if one.startswith("The data say little")]
    assert "the relaxation's capacitance" in said
    assert "the capacity (" not in said


@pytest.mark.parametrize(
    "changes",
    [
        {"capacity_ah": 6.6},
        {"resistance_ohm": 0.25},
        {"relaxation_capacitance_f": 460.0, "relaxation_resistance_ohm": 0.1},
    ],
)
def test_a_beginning_far_off_is_left_behind_and_said(changes: dict[str, float]) -> None:
    answer = found(driven(ROWS), initial=CONFIG["initial"] | changes)
    assert answer.values[:4] == pytest.approx(list(TRUTH.values())[:4], rel=0.005)
    assert any("came out" in warning or "began with" in warning for warning in answer.warnings)


def test_an_error_of_the_current_far_beyond_what_was_thought_is_found_and_said() -> None:
    record = driven(ROWS)
    answer = found(replace(record, current_a=record.current_a + 0.2))
    assert answer.values[0] == pytest.approx(TRUTH["capacity_ah"], rel=0.003)
    assert answer.current_bias_a == pytest.approx(0.2, abs=0.002)
    (said,) = answer.warnings
    assert said.startswith("The current's sensor seems to be off by 0.2 A")


def test_more_room_for_the_currents_sensor_is_no_excuse_for_a_wrong_curve() -> None:
    """Two curves 60 mV apart in places: with enough freedom a bias would explain it, and a capacity that can't be."""
    record = driven(ROWS)
    bent = replace(record, voltage_v=record.voltage_v + 0.06 * np.sin(record.t_s / 3000.0))
    answer = found(bent)
    assert any("contradict the model" in warning for warning in answer.warnings)
    assert abs(answer.current_bias_a) < 0.1


@pytest.mark.parametrize("capacity_ah", [np.nan, 66.0, 0.05])
def test_numbers_that_ran_away_are_refused(capacity_ah: float) -> None:
    record, config = driven(100), read_config(CONFIG)
    whole = run_whole(cell_record(record, config), config, (), None, silent)
    refuse_what_is_lost(record, config, whole.run)
    values = whole.run.values.copy()
    values[50:, 0] = capacity_ah
    with pytest.raises(EstimatorDiverged, match="ran away near 50 s") as refused:
        refuse_what_is_lost(record, config, replace(whole.run, values=values))
    assert refused.value.t_s == pytest.approx(49.5)


def test_a_logger_that_hung_is_a_hole() -> None:
    record = stuck("current_a", 8000, 10_000)(stuck("voltage_v", 8000, 10_000)(driven(ROWS)))
    answer = found(record)
    assert answer.values[0] == pytest.approx(TRUTH["capacity_ah"], rel=0.003)
    repeated, gap = answer.warnings
    assert repeated.startswith("The same row is repeated at")
    assert gap.startswith("1 gap of 33.3 min from 8000 s on, during which an unknown current flowed")


def test_a_constant_current_that_is_logged_now_and_then_goes_on() -> None:
    """A discharge at 1 A in which rows lie a second apart, then ten minutes."""
    t_s = np.concatenate([np.arange(0.0, 300.0), np.arange(300.0, 3900.0, 600.0), np.arange(3900.0, 4200.0)])
    soc = 0.8 - t_s / (3600.0 * TRUTH["capacity_ah"])
    dropped = TRUTH["resistance_ohm"] + TRUTH["relaxation_resistance_ohm"] * (1.0 - np.exp(-t_s / 30.0))
    record = BatteryRecord(t_s, np.full(len(t_s), -1.0), np.polynomial.Polynomial(OCV)(soc) - dropped)
    answer = found(record)
    assert any("6 gaps, the longest 10 min" in one and "have flowed on" in one for one in answer.warnings)
    elsewhere = replace(record, voltage_v=record.voltage_v + np.where(t_s > 3000.0, 0.15, 0.0))
    assert any("an unknown current flowed" in warning for warning in found(elsewhere).warnings)
