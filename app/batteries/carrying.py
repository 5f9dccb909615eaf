"""What one estimate hands over to the next: aged by the time between them, and only where the cell is the same."""

from __future__ import annotations

from typing import Any

from app.batteries.configuring import cell_key
from app.batteries.models import BatteryEstimate
from app.batteries.sources import Span
from app.science.battery.carry_reading import carry_document, read_carry
from app.science.battery.carrying import between, open_soc
from app.science.battery.config import BatteryConfig
from app.science.battery.run import Carry


def kept_carry(carry: Carry, config: BatteryConfig) -> dict[str, Any]:
    """Return what is handed over as JSON, with the name of the cell that it is about."""
    return {"cell": cell_key(config), "carry": carry_document(carry)}


def carried(earlier: BatteryEstimate | None, span: Span, config: BatteryConfig) -> Carry | None:
    """Return what an estimate takes over from the one before it; None where nothing fits.

    Of a cell that was configured otherwise nothing is taken over: what it is thought to be has been said anew. Where
    the time between the two isn't known, or they overlap, nothing is known of the charge that flowed between them.
    """
    if earlier is None or earlier.carry is None or earlier.carry["cell"] != cell_key(config):
        return None
    gap_s = (span.began_at - earlier.ended_at).total_seconds()
    aged = between(read_carry(earlier.carry["carry"]), max(gap_s, 0.0), config)
    is_sure = span.is_known and earlier.provenance.get("time_known") and gap_s >= 0.0
    return aged if is_sure else open_soc(aged)
