"""Compiled loop over time stamps: following the logger's clock."""

from __future__ import annotations

from app.science.arrays import AnyArray, BoolArray, IntArray
from app.science.jit import kernel

STEP_MS = 250
"""Time stamps within this distance of the one before are in order: sources interleave a little out of turn."""
FOLLOWERS = 16
"""How many later time stamps vote on one that is not in order."""
FOLLOW_MS = 60_000
"""A follower supports a time stamp when it lies at most this much after it."""
GAP_MS = 1_000
WRAP_GAP_MS = 3_600_000
"""Longest silence across the 32-bit wrap that isn't taken for a restart."""
BACK_MS = 10_000
"""A clock set back by no more than this, and not to near zero, goes on in the same trip; else it is a restart."""
NEAR_ZERO_MS = 5_000

IN_RUN, LAST_RAW, LAST_MS, RUN, RESTARTS, WRAPS, REJECTED, BACKWARD = range(8)
CLOCK_STATE = 8


@kernel
def step_between(from_raw: int, to_raw: int) -> int:
    """Return the signed number of milliseconds between two 32-bit time stamps, the shorter way round."""
    return (to_raw - from_raw + 0x80000000) % 0x100000000 - 0x80000000


@kernel
def is_believed(raw_ms: AnyArray, k: int, last_raw: int, in_run: bool) -> bool:
    """Let the following time stamps vote whether the one at ``k`` or the one before it shows the time."""
    candidate = int(raw_ms[k])
    stop = min(k + 1 + FOLLOWERS, len(raw_ms))
    if stop == k + 1:
        return not in_run or 0 < step_between(last_raw, candidate) <= FOLLOW_MS
    new, old = 0, 0
    for j in range(k + 1, stop):
        follower = int(raw_ms[j])
        from_new = step_between(candidate, follower)
        from_old = step_between(last_raw, follower)
        is_new = -STEP_MS <= from_new <= FOLLOW_MS
        is_old = in_run and -STEP_MS <= from_old <= FOLLOW_MS
        if is_new and (not is_old or abs(from_new) <= abs(from_old)):
            new += 1
        elif is_old:
            old += 1
    return new > old


@kernel
def follow_clock(
    raw_ms: AnyArray,
    count: int,
    state: IntArray,
    t_ms: IntArray,
    run: IntArray,
    keep: BoolArray,
    gaps: IntArray,
) -> int:
    """Unwrap time stamps, reject the ones their followers contradict, and notice restarts.

    Parameters
    ----------
    raw_ms : array of uint32, shape (n,)
        Time stamps in the order of the image.
    count : int
        How many of them to decide on; those behind only vote.
    state : array, shape (CLOCK_STATE,)
        Carried from call to call; updated.
    t_ms, run, keep : arrays, shape (count,)
        Filled: unwrapped milliseconds since power-on, number of the power-on, whether the time stamp is believed.
    gaps : array, shape (count, 3)
        Filled: row behind a silence, and the milliseconds before and after it.

    Returns
    -------
    int
        Number of gaps.
    """
    gap_count = 0
    for k in range(count):
        raw = int(raw_ms[k])
        last_raw, last_ms = state[LAST_RAW], state[LAST_MS]
        in_run = state[IN_RUN] == 1
        step = step_between(last_raw, raw)
        keep[k] = (in_run and -STEP_MS <= step <= STEP_MS) or is_believed(raw_ms, k, last_raw, in_run)
        if not keep[k]:
            state[REJECTED] += 1
            continue
        if not in_run:
            t_ms[k] = raw
            state[IN_RUN] = 1
        elif -STEP_MS <= step <= STEP_MS or (step > 0 and raw < last_raw and step <= WRAP_GAP_MS):
            t_ms[k] = last_ms + step
            state[WRAPS] += (raw < last_raw and step > 0) - (raw > last_raw and step < 0)
        elif raw > last_raw:
            t_ms[k] = last_ms + raw - last_raw
        elif step >= -BACK_MS and raw >= NEAR_ZERO_MS:
            t_ms[k] = last_ms
            state[BACKWARD] += 1
        else:
            t_ms[k] = raw
            state[RESTARTS] += 1
            state[RUN] += 1
            last_ms = raw
        if in_run and t_ms[k] - last_ms > GAP_MS:
            gaps[gap_count, 0] = k
            gaps[gap_count, 1] = last_ms
            gaps[gap_count, 2] = t_ms[k]
            gap_count += 1
        run[k] = state[RUN]
        state[LAST_RAW], state[LAST_MS] = raw, t_ms[k]
    return gap_count
