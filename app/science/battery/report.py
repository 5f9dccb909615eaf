"""The runs of MAUTC-2010-02, part 3, 4.2 to 4.4, made again on our virtual pack."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from app.science.arrays import FloatArray
from app.science.battery.config import VALUES, EstimatorName
from app.science.battery.virtual.ageing import DegradationMap, read_degradation

DIGITS = 7
"""Significant digits that are kept: a page shows fewer."""


@dataclass(frozen=True, slots=True)
class Traces:
    """Columns over time.

    Attributes
    ----------
    t_s : ndarray (n,)
    columns : mapping of str to ndarray (n,)
        By names that carry units.
    """

    t_s: FloatArray
    columns: Mapping[str, FloatArray]

    def document(self) -> dict[str, list[float]]:
        """Return the columns as lists."""
        return {"t_s": short(self.t_s), **{name: short(column) for name, column in self.columns.items()}}

    @classmethod
    def from_document(cls, document: Mapping[str, Any]) -> Self:
        """Return traces as they were stored."""
        columns = {name: np.array(values, dtype=np.float64) for name, values in document.items()}
        return cls(columns.pop("t_s"), columns)


@dataclass(frozen=True, slots=True)
class ReportRun:
    """One estimator over one record.

    Attributes
    ----------
    estimator : EstimatorName
    terms : int or None
        N of the expansion, for the report's estimator.
    start_after_s : float
        For so long its laws were off.
    history : Traces
        For each of `VALUES` the estimate, its deviation (``_sd``) and the truth (``_true``); ``voltage_rms_v``, the
        root mean square of measured less predicted voltage from then to the next time.
    """

    estimator: EstimatorName
    terms: int | None
    start_after_s: float
    history: Traces

    @property
    def label(self) -> str:
        """Return what the run is called in a legend."""
        return self.estimator if self.terms is None else f"{self.estimator}, N = {self.terms}"

    def misses(self) -> dict[str, float]:
        """Return by how much the last estimates are off: shares of the truth, for the state of charge absolute."""
        columns = self.history.columns
        off = {name: float(columns[name][-1] - columns[f"{name}_true"][-1]) for name in VALUES}
        return {name: off[name] / (1.0 if name == "soc" else float(columns[f"{name}_true"][-1])) for name in VALUES}

    def document(self) -> dict[str, Any]:
        """Return the run as it is stored and served."""
        return {
            "estimator": self.estimator,
            "terms": self.terms,
            "label": self.label,
            "start_after_s": self.start_after_s,
            "misses": {name: float(f"{miss:.4g}") for name, miss in self.misses().items()},
            "history": self.history.document(),
        }

    @classmethod
    def from_document(cls, document: Mapping[str, Any]) -> Self:
        """Return a run as it was stored."""
        history = Traces.from_document(document["history"])
        return cls(document["estimator"], document["terms"], document["start_after_s"], history)


@dataclass(frozen=True, slots=True)
class ReportRuns:
    """What the report's figures show, from our own runs.

    Attributes
    ----------
    curve : Traces
        Fig. 25 (b): ``soc`` and ``voltage_v``; its ``t_s`` counts the points.
    pulses : Traces
        Fig. 26: ``current_a`` and ``voltage_v`` of the cell under pulses.
    drive : Traces
        Fig. 27: ``speed_mps`` and ``current_a`` of one cell.
    cycling : Traces
        Fig. 28: ``current_a`` and ``soc`` over ten hours.
    short : tuple of ReportRun
        Figs 30 and 31: ten days, two and three terms and the default estimator.
    degradation : DegradationMap
        Fig. 32.
    long : tuple of ReportRun
        Fig. 33: a hundred days with fading capacity, three terms and the default estimator.
    """

    curve: Traces
    pulses: Traces
    drive: Traces
    cycling: Traces
    short: tuple[ReportRun, ...]
    degradation: DegradationMap
    long: tuple[ReportRun, ...]

    def document(self) -> dict[str, Any]:
        """Return everything as it is stored and served."""
        return {
            **{name: getattr(self, name).document() for name in ("curve", "pulses", "drive", "cycling")},
            "short": [run.document() for run in self.short],
            "degradation": self.degradation.document(),
            "long": [run.document() for run in self.long],
        }

    @classmethod
    def from_document(cls, document: Mapping[str, Any]) -> Self:
        """Return the runs as they were stored."""
        traces = {name: Traces.from_document(document[name]) for name in ("curve", "pulses", "drive", "cycling")}
        return cls(
            **traces,
            short=tuple(ReportRun.from_document(run) for run in document["short"]),
            degradation=read_degradation(document["degradation"]),
            long=tuple(ReportRun.from_document(run) for run in document["long"]),
        )


def short(values: FloatArray) -> list[float]:
    """Return numbers with as many digits as are worth keeping."""
    return [float(f"{value:.{DIGITS}g}") for value in values]
