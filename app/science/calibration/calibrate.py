"""Calibration from driving: what a trip says, and what several trips together propose for the car's file."""

from __future__ import annotations

import numpy as np

from app.science.calibration.axes import axes_seen
from app.science.calibration.evidence import Estimate, TripEvidence
from app.science.calibration.fuel import pulses_seen
from app.science.calibration.motion import read_motion, speed_source
from app.science.calibration.proposal import Proposal
from app.science.calibration.propose import proposals
from app.science.calibration.receiver import clock_seen, wheels_seen
from app.science.logger.recording import ACCELEROMETER, Recording
from app.science.observer.result import Observation
from app.science.vehicle.model import Vehicle

__all__ = ["Proposal", "TripEvidence", "proposals", "trip_evidence"]

SHORTEST_CLOCK_MIN = 6


def trip_evidence(recording: Recording, vehicle: Vehicle, observation: Observation | None = None) -> TripEvidence:
    """Gather what one trip says about the car's calibration.

    Parameters
    ----------
    recording : Recording
    vehicle : Vehicle
        As the file has it; the evidence does not depend on what is looked for.
    observation : Observation, optional
        What the observer made of the trip; its biases are taken from it.
    """
    estimates: dict[str, Estimate] = {}
    missing: dict[str, str] = {}
    axes = [name for name in ACCELEROMETER if name in recording and len(recording[name]) > 2]
    if len(axes) == len(ACCELEROMETER):
        estimates |= axes_seen(read_motion(recording, vehicle))
    missing |= _mounting_missing(recording, len(axes), estimates)
    estimates |= wheels_seen(recording, vehicle)
    missing |= _wheels_missing(recording, estimates)
    clock = clock_seen(recording)
    if clock is None:
        missing["clock_skew"] = f"needs a receiver that tells UTC for {SHORTEST_CLOCK_MIN} minutes"
    else:
        estimates["clock_skew"] = clock
    pulses = pulses_seen(recording)
    if not pulses:
        missing["injector_lag"] = missing["injector_flow"] = "needs injector pulses"
    bias = None if observation is None else _bias(observation)
    if bias is not None:
        estimates["bias"] = bias
    distance = {} if observation is None else {"distance_m": observation.distance_m}
    return TripEvidence(estimates, {"duration_s": recording.duration_s} | distance | pulses, missing)


def _mounting_missing(recording: Recording, axes: int, estimates: dict[str, Estimate]) -> dict[str, str]:
    if axes == 0:
        why = "needs an accelerometer"
    elif axes < len(ACCELEROMETER):
        why = f"needs an accelerometer with three axes, this one has {axes}"
    elif not speed_source(recording):
        why = "needs a speed: wheel ticks, a speed signal or a receiver"
    elif "gravity" not in estimates:
        why = "needs two minutes with a known speed"
    elif "forward" not in estimates:
        why = "needs more braking and accelerating: the speed changed too seldom, or the sensor did not follow it"
    else:
        return {}
    return {"mounting": why} | ({} if "gravity" in estimates else {"accelerometer_scale": why})


def _wheels_missing(recording: Recording, estimates: dict[str, Estimate]) -> dict[str, str]:
    why = ""
    if "vss_tick" not in recording and "speed_mps" not in recording:
        why = "needs wheel ticks or a measured speed"
    elif "gnss_speed_mps" not in recording and "lat_deg" not in recording:
        why = "needs a receiver"
    elif not {"metres_per_tick", "speed_scale"} & estimates.keys():
        why = "needs a speed that is measured every few seconds beside the receiver's, for half a minute above 15 km/h"
    missing = {"vss_m_per_tick": why} if why else {}
    if "gps_latency" not in estimates:
        missing["gps_latency"] = why or "needs a speed that changes"
    return missing


def _bias(observation: Observation) -> Estimate | None:
    names = [f"bias_{axis}_mps2" for axis in "ijk"]
    value = np.array([observation.columns[name][-1] for name in names])
    sd = np.array([observation.columns[f"{name}_sd"][-1] for name in names])
    known = bool(np.isfinite(value).all() and np.isfinite(sd).all() and (sd > 0.0).all())
    return Estimate.of(value, np.diag(sd**2)) if known else None
