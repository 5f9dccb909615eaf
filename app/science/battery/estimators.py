"""The estimators by name; each is imported when it is first asked for, because its kernels are heavy."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from app.science.battery.config import BatteryConfig, EstimatorName
from app.science.battery.run import Carry, CellRecord, Estimator, Run
from app.science.progress import Progress

__all__ = ["ESTIMATOR_OF"]


def _gpc(record: CellRecord, config: BatteryConfig, carry: Carry | None, progress: Progress) -> Run:
    from app.science.battery.gpc import run_gpc

    return run_gpc(record, config, carry, progress)


def _rls(record: CellRecord, config: BatteryConfig, carry: Carry | None, progress: Progress) -> Run:
    from app.science.battery.rls import run_rls

    return run_rls(record, config, carry, progress)


def _ekf(record: CellRecord, config: BatteryConfig, carry: Carry | None, progress: Progress) -> Run:
    from app.science.battery.kalman.running import run_ekf

    return run_ekf(record, config, carry, progress)


def _ekf_bias(record: CellRecord, config: BatteryConfig, carry: Carry | None, progress: Progress) -> Run:
    from app.science.battery.kalman.running import run_ekf_bias

    return run_ekf_bias(record, config, carry, progress)


def _ukf(record: CellRecord, config: BatteryConfig, carry: Carry | None, progress: Progress) -> Run:
    from app.science.battery.kalman.running import run_ukf

    return run_ukf(record, config, carry, progress)


ESTIMATOR_OF: Mapping[EstimatorName, Estimator] = MappingProxyType(
    {"ekf_bias": _ekf_bias, "ekf": _ekf, "ukf": _ukf, "gpc": _gpc, "rls": _rls}
)
