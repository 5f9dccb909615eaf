"""What a current is apart from its noise, as far as its own past tells."""

from __future__ import annotations

from app.science.jit import inline_kernel

SAME = 4.0
"""Currents within so many standard deviations of each other may be the same current."""
LONGEST = 100.0
"""Rows over which a steady current is averaged at most."""


@inline_kernel
def steadied(amps: float, before: float, rows: float, variance: float) -> tuple[float, float, float]:
    """Return a row's current without its own noise, the mean to go on with, and over how many rows that is.

    Where a current goes on as before, the mean of the rows before is as good a guess of it, and its error has nothing
    to do with the noise in this row. Used for what a change of the resistance would do to the voltage, it keeps noise
    that the battery never saw from being taken for a current that moved no voltage, which would draw the resistance
    down: the method of instrumental variables. A current that jumps stands for itself.

    Parameters
    ----------
    amps : float
        As measured.
    before, rows : float
        Mean of the steady current so far, and over how many rows; none: 0.
    variance : float
        Of the noise of one row.

    Returns
    -------
    tuple of float
    """
    apart = amps - before
    if rows == 0.0 or apart * apart > SAME * SAME * variance * (1.0 + 1.0 / rows):
        return amps, amps, 1.0
    more = min(rows + 1.0, LONGEST)
    return before, before + apart / more, more
