"""The observer: a trip's measurement streams in, its 17 states with uncertainty out."""

from __future__ import annotations

import numpy as np

from app.science.errors import TooLittleData, TuningError
from app.science.logger.recording import ACCELEROMETER, Recording
from app.science.observer.carry_over import BiasPrior
from app.science.observer.columns import state_columns
from app.science.observer.consistency import consistency
from app.science.observer.disagreement import distance_disagreement
from app.science.observer.engine_events import engine_speed_events, fuel_events
from app.science.observer.events import motion_events
from app.science.observer.family.methods import FILTERS
from app.science.observer.family.run import observe_motion_with
from app.science.observer.motion import MotionResult, motion_model, observe_motion, start_state
from app.science.observer.pair import observe_pair
from app.science.observer.receiver_speed import in_time
from app.science.observer.result import Innovations, Observation
from app.science.observer.timeline import Timeline, build_timeline
from app.science.observer.tuning import DEFAULT, Tuning
from app.science.observer.verdict import verdict_of
from app.science.observer.wheel_scale import wheel_scale
from app.science.progress import Progress, between, silent
from app.science.roads.elevation import RoadElevation
from app.science.roads.projection import LocalPlane
from app.science.vehicle.model import Vehicle

SENSOR_SIGNALS: dict[str, frozenset[str]] = {
    "gps": frozenset({"lat_deg", "lon_deg", "alt_m", "hdop", "heading_deg", "gnss_speed_mps", "satellites"}),
    "dem": frozenset({"road_alt_m", "road_heading_deg", "road_curvature_radpm"}),
    "acc": frozenset(ACCELEROMETER),
    "vss": frozenset({"vss_tick", "speed_mps"}),
    "inj": frozenset({"injector_pulse_s", "fuel_rate_lph", "engine_speed_rpm", "maf_gps", "engine_torque_nm"}),
}
"""What each name of ``without`` leaves out."""


def observe(
    recording: Recording,
    vehicle: Vehicle,
    *,
    elevation: RoadElevation | None = None,
    tuning: Tuning = DEFAULT,
    filter: str = "ekf",  # noqa: A002 - the name the contract gives it
    smooth: bool = True,
    without: frozenset[str] = frozenset(),
    bias_prior: BiasPrior | None = None,
    progress: Progress = silent,
) -> Observation:
    """Estimate the states of Sebesta 2010, (1.15), over a whole trip.

    Parameters
    ----------
    recording : Recording
        Measurement streams, raw sensor axes.
    vehicle : Vehicle
    elevation : RoadElevation, optional
        Altitudes along roads; looked up at each position fix.
    tuning : Tuning
    filter : str
        One of `family.methods.FILTERS`: ``ekf`` (the default, sparse and fast), ``rk4-ekf`` as the thesis prints it,
        ``dd-ekf``, ``sr-ekf``, ``ukf``, ``sr-ukf`` and ``aekf``.
    smooth : bool
        Whether a fixed-interval smoother follows, so that every state knows the whole trip.
    without : set of {"gps", "dem", "acc", "vss", "inj"}
        Sensors to leave out.
    bias_prior : BiasPrior, optional
        What earlier trips of the same car and mounting say of the accelerometer's biases.
    progress : callable, optional
        Told the share that is done every tenth of a second or so. What it raises ends the work and is passed on.

    Raises
    ------
    TooLittleData
        When nothing tells how the car moved, or not what the chosen filter needs.
    TuningError
        For an unknown filter, or a tuning that doesn't fit it.
    EstimatorDiverged
        When the filter's numbers stop being finite.
    """
    if filter not in FILTERS:
        raise TuningError(f"There is no filter called {filter!r}; use {', '.join(FILTERS)}.")
    unknown = without - SENSOR_SIGNALS.keys()
    if unknown:
        raise TooLittleData(f"There is no sensor called {sorted(unknown)[0]!r}; use {', '.join(SENSOR_SIGNALS)}.")
    recording = recording.without({name for sensor in without for name in SENSOR_SIGNALS[sensor]})
    if "dem" in without:
        elevation = None
    if not any(name in recording for name in ("vss_tick", "speed_mps", "gnss_speed_mps", "lat_deg")):
        held = ", ".join(sorted(recording)) or "no signal at all"
        battery = "battery_current_a" in recording and "battery_voltage_v" in recording
        hint = "What tells of a battery alone is no trip: send it as data of that battery. " if battery else ""
        raise TooLittleData(
            "Nothing in this recording tells how the car moved: it has no wheel ticks, no speed and no positions. "
            f"It holds {held}. {hint}{' '.join(recording.warnings)}".rstrip()
        )
    recording = in_time(recording, vehicle)
    timeline = build_timeline(recording, vehicle)
    if len(timeline.node_t_s) < 2:
        raise TooLittleData("The recording is shorter than a tenth of a second.")
    plane = None
    if "lat_deg" in recording and "lon_deg" in recording:
        plane = LocalPlane(float(recording["lat_deg"].value[0]), float(recording["lon_deg"].value[0]))
    moved = _motion(
        recording, vehicle, timeline, tuning, plane, elevation, filter, smooth, bias_prior,
        between(progress, 0.05, 0.85),
    )  # fmt: skip
    progress(0.85)
    nodes = timeline.node_t_s
    fuel = observe_pair(
        fuel_events(recording, vehicle, tuning, nodes),
        nodes, tuning.fuel_noise, ("fuel_energy", "fuel_power"), smooth=smooth,
    )  # fmt: skip
    progress(0.9)
    engine = observe_pair(
        engine_speed_events(recording, vehicle, tuning, timeline),
        nodes, tuning.engine_noise, ("engine_angle", "engine_speed"), smooth=smooth,
    )  # fmt: skip
    progress(0.95)
    innovations = _joined(moved.innovations, fuel.innovations, engine.innovations)
    columns = state_columns(timeline, moved, fuel, engine, plane)
    sensors = consistency(innovations)
    verdict, reasons = verdict_of(sensors, columns, wheel_scale(recording, columns, plane))
    fuel_energy = columns["fuel_energy_j"]
    fuel_j = float(fuel_energy[-1] - fuel_energy[0]) if np.isfinite(fuel_energy).all() else float("nan")
    distance_m = float(columns["distance_m"][-1] - columns["distance_m"][0])
    return Observation(
        columns=columns,
        innovations=innovations,
        sensors=sensors,
        verdict=verdict,
        reasons=reasons,
        warnings=(*recording.warnings, *distance_disagreement(recording, vehicle, distance_m)),
        events=len(np.unique(innovations.t_s)),
        duration_s=float(timeline.node_t_s[-1] - timeline.node_t_s[0]),
        distance_m=distance_m,
        fuel_energy_j=fuel_j,
        fuel_l=fuel_j / vehicle.fuel_energy_j_per_l,
        filter=filter,
        tuning=tuning.name,
        smoothed=smooth,
    )


def _motion(
    recording: Recording,
    vehicle: Vehicle,
    timeline: Timeline,
    tuning: Tuning,
    plane: LocalPlane | None,
    elevation: RoadElevation | None,
    filter: str,  # noqa: A002 - as the caller's
    smooth: bool,
    bias_prior: BiasPrior | None,
    progress: Progress,
) -> MotionResult:
    progress(0.0)
    events = motion_events(recording, vehicle, timeline, tuning, plane, elevation)
    x0, variance0 = start_state(recording, vehicle, timeline, plane, bias_prior)
    model, nodes = motion_model(vehicle, tuning), len(timeline.node_t_s)
    rest = between(progress, 0.1, 1.0)
    if filter == "ekf" and tuning.thrust_order == 1:
        return observe_motion(events, model, x0, variance0, nodes, smooth=smooth, progress=rest)
    return observe_motion_with(filter, events, model, tuning, x0, variance0, nodes, smooth=smooth, progress=rest)


def _joined(*parts: Innovations | None) -> Innovations:
    present = [part for part in parts if part is not None]
    names: list[str] = []
    sensor = []
    for part in present:
        sensor.append(part.sensor + len(names))
        names.extend(part.sensors)
    return Innovations(
        np.concatenate([part.t_s for part in present]),
        np.concatenate(sensor),
        np.concatenate([part.innovation for part in present]),
        np.concatenate([part.sd for part in present]),
        np.concatenate([part.accepted for part in present]),
        tuple(names),
    )
