"""From files to states and a map, without a server: what ``process`` and the benchmark of the whole pipeline run."""

from __future__ import annotations

import time
from collections import defaultdict
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from io import BytesIO
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

from app import __version__
from app.cli.inputs import InputFormat, fingerprint, recordings
from app.cli.output import note, write_json
from app.cli.summary import total_summary
from app.exports.parquet import operating_points_parquet, states_parquet
from app.exports.summary import observation_summary
from app.imports.elevation import read_elevation
from app.science.engine.cells import accumulate, build_map, merge
from app.science.engine.document import map_document
from app.science.engine.doubts import engine_doubts
from app.science.engine.efficiency_map import CellGrid, CellSums
from app.science.engine.full_load import full_load_curve
from app.science.engine.idle import IdleSums, idle_of, idling
from app.science.engine.moments import MomentSums, merge_moments, moments_of
from app.science.engine.operating import operating_points
from app.science.engine.resolution import resolve
from app.science.errors import EstimatorDiverged, TooLittleData
from app.science.fingerprint import science_fingerprint
from app.science.logger.recording import Recording
from app.science.observer.observe import observe
from app.science.observer.tuning import DEFAULT, Tuning
from app.science.roads.elevation import RoadElevation
from app.science.vehicle.model import Vehicle
from app.science.vehicle.xml import read_vehicle


@dataclass(frozen=True, slots=True)
class Choices:
    """How files are to be processed; the names are those of the command's options."""

    car: Path
    filter: str = "ekf"
    smooth: bool = True
    tuning: Tuning = DEFAULT
    without: frozenset[str] = frozenset()
    form: InputFormat = InputFormat.AUTO
    elevation: Path | None = None
    mapping: Path | None = None
    load_kg: float = 75.0


@dataclass(slots=True)
class Stopwatch:
    """Wall time of named stages, seconds."""

    seconds: dict[str, float] = field(default_factory=lambda: defaultdict(float))

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Add the time spent inside to a stage."""
        began = time.perf_counter()
        try:
            yield
        finally:
            self.seconds[name] += time.perf_counter() - began


class Processing:
    """One call of `run`: the trips' results are written as they come, so that one trip is held at a time."""

    def __init__(self, choices: Choices, out: Path) -> None:
        self.choices = choices
        self.out = out
        self.watch = Stopwatch()
        self.grid = CellGrid()
        self.vehicle: Vehicle = read_vehicle(choices.car.read_bytes(), load_kg=choices.load_kg)
        self.elevation = self._elevation()
        self.trips: list[Mapping[str, Any]] = []
        self.warnings: list[str] = []
        self.sums: list[CellSums] = []
        self.moments: list[MomentSums] = []
        self.idle: list[IdleSums] = []
        self.points: list[pa.Table] = []

    def _elevation(self) -> RoadElevation | None:
        if self.choices.elevation is None or "dem" in self.choices.without:
            return None
        note(f"altitudes along the road from {self.choices.elevation}")
        return read_elevation(self.choices.elevation.read_bytes())

    def files(self, paths: list[Path]) -> None:
        """Process all trips of the files; one that says too little or breaks the filter is left out with a warning."""
        trips = recordings(paths, self.choices.form, self.choices.mapping)
        while True:
            with self.watch.stage("decode"):
                trip = next(trips, None)
            if trip is None:
                break
            try:
                self.trip(trip.name, trip.recording)
            except (TooLittleData, EstimatorDiverged) as error:
                self.warnings.append(f"{trip.name}: a trip of {trip.recording.duration_s:.0f} s was left out: {error}")
                note(self.warnings[-1])

    def trip(self, name: str, recording: Recording) -> None:
        """Process one trip and write its states."""
        choices = self.choices
        with self.watch.stage("observe"):
            observation = observe(
                recording,
                self.vehicle,
                elevation=self.elevation,
                tuning=choices.tuning,
                filter=choices.filter,
                smooth=choices.smooth,
                without=choices.without,
            )
        with self.watch.stage("map"):
            points = operating_points(observation, recording, self.vehicle)
            doubts = engine_doubts(observation, points, recording, self.vehicle)
            observation = replace(observation, warnings=(*observation.warnings, *doubts))
            self.sums.append(accumulate(points, self.grid))
            self.moments.append(moments_of(points))
            self.idle.append(idling(observation, recording, self.vehicle))
        number = len(self.trips) + 1
        states = self.out / ("states.parquet" if number == 1 else f"states-{number}.parquet")
        with self.watch.stage("write"):
            states.write_bytes(states_parquet(observation))
            table = pq.read_table(BytesIO(operating_points_parquet(points)))
            self.points.append(table.append_column("trip", pa.array([number] * len(table), pa.int32())))
        names = {"file": name, "states": states.name}
        self.trips.append(names | observation_summary(observation, points=len(points)))
        note(f"{name}: {observation.distance_m / 1000:.1f} km, {len(points)} operating points, {states.name}")

    def finish(self, files: list[Path]) -> dict[str, Any]:
        """Write the map, the operating points and the summary of all trips; return the summary."""
        if not self.trips:
            raise TooLittleData(" ".join(self.warnings))
        with self.watch.stage("map"):
            resolved = resolve(merge(self.sums), self.grid)
            efficiency_map = build_map(
                resolved.sums,
                resolved.grid,
                self.vehicle,
                full_load_curve(merge_moments(self.moments)),
                idle_of(self.idle, self.vehicle),
            )
            self.warnings += efficiency_map.warnings
            document = map_document(efficiency_map, self.provenance(files))
        with self.watch.stage("write"):
            write_json(self.out / "map.json", document)
            pq.write_table(pa.concat_tables(self.points), self.out / "operating_points.parquet")
        summary = total_summary(self.trips, self.warnings, dict(self.watch.seconds))
        write_json(self.out / "summary.json", summary)
        return summary

    def provenance(self, files: list[Path]) -> Mapping[str, Any]:
        """Return what the map was made from, so that it can be made again."""
        choices = self.choices
        return {
            "code_version": f"{__version__}+{science_fingerprint()}",
            "files": [{"name": path.name, "sha256": fingerprint(path)} for path in files],
            "car_sha256": fingerprint(choices.car),
            "elevation_sha256": fingerprint(choices.elevation) if self.elevation and choices.elevation else None,
            "filter": choices.filter,
            "tuning": choices.tuning.name,
            "smoothed": choices.smooth,
            "without": sorted(choices.without),
            "load_kg": choices.load_kg,
            "trips": len(self.trips),
        }


def run(files: list[Path], choices: Choices, out: Path) -> dict[str, Any]:
    """Process files into ``out``: states of each trip, operating points, the map of all trips, and a summary.

    Returns
    -------
    dict
        Content of ``summary.json``.

    Raises
    ------
    ScienceError
        When the car's XML or a file can't be used, or no trip says anything.
    """
    out.mkdir(parents=True, exist_ok=True)
    processing = Processing(choices, out)
    processing.files(files)
    return processing.finish(files)
