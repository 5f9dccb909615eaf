"""From combined evidence to proposals: what differs significantly from the car's file, and by enough to matter."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from app.science.calibration.evidence import TripEvidence
from app.science.calibration.mounting import Turned, angle_between, find_mounting
from app.science.calibration.proposal import NAMES, Change, Name, Proposal
from app.science.calibration.propose_injectors import injectors
from app.science.calibration.question import SIGNIFICANT_SDS, Question, change, graded
from app.science.vehicle.model import Vehicle

LEAST_TURN_RAD = np.radians(1.0)
SURE_TURN_RAD, LIKELY_TURN_RAD = np.radians(0.5), np.radians(2.0)
LEAST_SCALE = 0.03
LEAST_WHEEL = 0.001
RECEIVER_SHARE = 2e-4
"""Slopes and the receiver itself keep a perfect comparison from being better than this."""
SURE_WHEEL, LIKELY_WHEEL = 5e-4, 5e-3
LEAST_BIAS_MPS2 = 0.05
LEAST_LATENCY_S = 0.03
LEAST_SKEW_PPM = 20.0


def found_mounting(question: Question) -> tuple[Turned, int] | None:
    """Return the mounting that all trips together show, and how many they are."""
    seen = {name: question.combined(name) for name in ("forward", "right", "level", "gravity")}
    forward, level, gravity = seen["forward"], seen["level"], seen["gravity"]
    if forward is None or level is None or gravity is None:
        return None
    return find_mounting(forward, seen["right"], level, gravity, question.vehicle.gravity_mps2), forward.trips


def is_turned(question: Question, found: Turned) -> bool:
    """Whether the sensor lies otherwise than the file says."""
    turn = angle_between(question.vehicle.mounting, found.mounting)
    surprise = float(turn @ np.linalg.solve(found.covariance_rad2, turn))
    return surprise > SIGNIFICANT_SDS**2 + 3.0 and float(np.linalg.norm(turn)) > LEAST_TURN_RAD


def sensor_axis(found: Turned, body_axis: int) -> str:
    """Name the sensor's axis that points most nearly along one of the car's: ``+x``, ``−y``, ….

    Parameters
    ----------
    found : Turned
    body_axis : int
        0, 1, 2: forward, right, down.
    """
    row = found.mounting.matrix[body_axis]
    largest = int(np.argmax(np.abs(row)))
    return f"{'+' if row[largest] > 0.0 else '−'}{'xyz'[largest]}"


def mounting(question: Question) -> list[Proposal]:
    """Propose roll, pitch and yaw."""
    whole = found_mounting(question)
    if whole is None:
        return question.unknown("mounting")
    found, trips = whole
    confidence = graded(found.sd_rad, SURE_TURN_RAD, LIKELY_TURN_RAD)
    if confidence == "weak":
        return question.unknown(
            "mounting",
            f"is known to {np.degrees(found.sd_rad):.1f}° only; it needs more braking, accelerating and bends",
        )
    if not is_turned(question, found):
        return []
    turn = np.degrees(np.linalg.norm(angle_between(question.vehicle.mounting, found.mounting)))
    sds = np.sqrt(np.diag(found.angle_covariance))
    symbols = {"roll": "phi", "pitch": "theta", "yaw": "psi"}
    changes = tuple(
        change(
            f"accelerometer/calibration/{axis}@{symbol}",
            question.vehicle,
            getattr(found.mounting, f"{axis}_rad"),
            float(sd),
            5,
        )
        for (axis, symbol), sd in zip(symbols.items(), sds, strict=True)
    )
    evidence = [
        f"The sensor lies {turn:.1f}° away from what the file says; the new mounting is known to "
        f"{np.degrees(found.sd_rad):.2f}° (one standard deviation of the total angle).",
        f"Most nearly its {sensor_axis(found, 0)} axis points forward, its {sensor_axis(found, 1)} axis right and its "
        f"{sensor_axis(found, 2)} axis down.",
        f"Forward was found from the wheels' acceleration over {trips} {'trips' if trips > 1 else 'trip'}, "
        + ("right from bends, " if found.with_bends else "")
        + "down from gravity and from what neither of them moves.",
        f"These directions and gravity agree within {found.disagreement:.1f} of their standard deviations.",
    ]
    if abs(np.cos(found.mounting.pitch_rad)) < 0.2:
        evidence.append(
            "With this pitch roll and yaw turn about nearly the same axis: only together do they mean anything."
        )
    return [Proposal("mounting", changes, tuple(evidence), confidence, trips)]


def accelerometer_scale(question: Question) -> list[Proposal]:
    """Propose the factor that makes the mean reading gravity."""
    whole = found_mounting(question)
    if whole is None:
        return question.unknown("accelerometer_scale")
    found, trips = whole
    scale, before = found.mounting.scale, question.vehicle.mounting.scale
    if abs(scale / before - 1.0) < max(SIGNIFICANT_SDS * found.scale_sd / scale, LEAST_SCALE):
        return []
    evidence = (
        f"The sensor's mean reading is {question.vehicle.gravity_mps2 / scale:.3f} m/s² where gravity is "
        f"{question.vehicle.gravity_mps2:.3f} m/s²; a bias of the usual size makes the scale uncertain by "
        f"{found.scale_sd:.3f}.",
    )
    changed = change("accelerometer/calibration/scale@scale", question.vehicle, scale, found.scale_sd, 4)
    return [Proposal("accelerometer_scale", (changed,), evidence, "likely", trips)]


def wheels(question: Question) -> list[Proposal]:
    """Propose metres per tick, or the scale of a measured speed."""
    for name, path, what in (
        ("metres_per_tick", "vss/calibration@metersPerTick", "a tick is {after:.6f} m, the file says {before:.6f} m"),
        (
            "speed_scale",
            "vss/calibration@speedScale",
            "true speed is {after:.4f} of the measured one, the file says {before:g}",
        ),
    ):
        seen = question.combined(name)
        if seen is None:
            continue
        after = float(seen.value[0])
        sd = float(np.hypot(seen.sd[0], RECEIVER_SHARE * after))
        changed = change(path, question.vehicle, after, sd, 7)
        before = changed.before or 1.0
        confidence = graded(sd / after, SURE_WHEEL, LIKELY_WHEEL)
        apart = abs(after / before - 1.0)
        if confidence == "weak":
            return question.unknown(
                "vss_m_per_tick", f"is known to {100 * sd / after:.1f} % only; it needs a longer drive"
            )
        if apart < max(SIGNIFICANT_SDS * sd / after, LEAST_WHEEL):
            return []
        evidence = (
            f"By the receiver {what.format(after=after, before=before)}: {100 * (after / before - 1.0):+.2f} % "
            f"± {100 * sd / after:.2f} %.",
        )
        return [Proposal("vss_m_per_tick", (changed,), evidence, confidence, seen.trips)]
    return question.unknown("vss_m_per_tick")


def bias(question: Question) -> list[Proposal]:
    """Tell the mean of the trips' biases, if the mounting is known to be right: else they mean nothing."""
    seen, whole = question.combined("bias"), found_mounting(question)
    if seen is None or whole is None or is_turned(question, whole[0]):
        return []
    if not np.any((np.abs(seen.value) > SIGNIFICANT_SDS * seen.sd) & (np.abs(seen.value) > LEAST_BIAS_MPS2)):
        return []
    changes = tuple(
        Change("", f"Bias {axis}", "m/s²", None, round(float(value), 4), float(sd))
        for axis, value, sd in zip(("forward", "right", "down"), seen.value, seen.sd, strict=True)
    )
    trips = f"{seen.trips} trips" if seen.trips > 1 else "one trip"
    evidence = (f"At the end of {trips} the observer's biases are these; the next trip begins with them.",)
    return [Proposal("accelerometer_bias", changes, evidence, "sure" if seen.trips > 2 else "likely", seen.trips)]


def latency(question: Question) -> list[Proposal]:
    """Tell how late the receiver's fixes are on the logger's clock."""
    return _told(
        question, "gps_latency", ("GPS latency", "s"), least=LEAST_LATENCY_S, sure_below=0.02, digits=4,
        words=lambda late, sd: f"The receiver's speed follows the wheels' {late:.3f} s later, ± {sd:.3f} s.",
    )  # fmt: skip


def skew(question: Question) -> list[Proposal]:
    """Tell how fast the logger's clock runs against UTC."""
    return _told(
        question, "clock_skew", ("Clock skew", "ppm"), least=LEAST_SKEW_PPM, sure_below=10.0, digits=2,
        words=lambda gained, sd: (
            f"The logger's clock gains {gained:.1f} µs on UTC each second, ± {sd:.1f}; a tick's length allows for it."
        ),
    )  # fmt: skip


def _told(
    question: Question,
    name: Name,
    shown: tuple[str, str],
    *,
    least: float,
    sure_below: float,
    digits: int,
    words: Callable[[float, float], str],
) -> list[Proposal]:
    """Tell one number that the car's file has no place for, by its label and unit, when it is more than nothing."""
    seen = question.combined(name)
    if seen is None:
        return question.unknown(name)
    value, sd = float(seen.value[0]), float(seen.sd[0])
    if abs(value) < max(SIGNIFICANT_SDS * sd, least):
        return []
    changed = Change("", *shown, None, round(value, digits), sd)
    return [Proposal(name, (changed,), (words(value, sd),), "sure" if sd < sure_below else "likely", seen.trips)]


PROPOSERS: tuple[Callable[[Question], list[Proposal]], ...] = (
    mounting,
    accelerometer_scale,
    wheels,
    injectors,
    bias,
    latency,
    skew,
)


def proposals(
    evidences: Sequence[TripEvidence],
    vehicle: Vehicle,
    refuelled_l: float | Sequence[float | None] | None = None,
) -> tuple[Proposal, ...]:
    """Propose changes of the car's file, and say what could not be found out.

    Parameters
    ----------
    evidences : sequence of TripEvidence
        In the order of the trips.
    vehicle : Vehicle
        The car as its file has it now.
    refuelled_l : float or sequence, optional
        Litres that all trips together used; or, per trip, the litres filled in after it, None where the car was not
        refuelled then.

    Returns
    -------
    tuple of Proposal
        What differs significantly from the file (``sure``, ``likely``), and what is not known well enough (``weak``,
        never to be applied). What agrees with the file is not mentioned.
    """
    if not evidences:
        return ()
    question = Question(tuple(evidences), vehicle, refuelled_l)
    found = [proposal for propose in PROPOSERS for proposal in propose(question)]
    return tuple(sorted(found, key=lambda proposal: NAMES.index(proposal.name)))
