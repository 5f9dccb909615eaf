"""The logger's clock: from 32-bit time stamps in either byte order to milliseconds since power-on."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from app.science.arrays import AnyArray
from app.science.logger import clock_kernels as k
from app.science.logger.kernels import INJECTOR
from app.science.logger.packets import Packets, in_byte_order, join, no_packets
from app.science.logger.report import MOST_LISTED, ClockCounts, Gap
from app.science.logger.stretch import NO_SENTENCES, Stretch, Text, Timed

ENOUGH_STAMPS = 64
"""Time stamps to see before the byte order is decided, unless the image ends earlier."""
MOST_HELD_TEXT = 1 << 20
ADVANCE_MS = 10_000
COUNTS_PER_MS = 4_000


def is_big_endian(raw_ms: AnyArray) -> bool | None:
    """Tell in which byte order time stamps advance from one to the next by small steps.

    Parameters
    ----------
    raw_ms : array of uint32, shape (n,)
        Time stamps in the order of the image, read as little-endian.

    Returns
    -------
    bool or None
        None when both orders do equally well.
    """

    def advances(stamps: AnyArray) -> int:
        step = np.diff(stamps)  # modulo 2³², as the clock itself wraps
        return int(np.count_nonzero((step <= ADVANCE_MS) | (step >= 0x100000000 - k.STEP_MS)))

    little, big = advances(raw_ms), advances(raw_ms.byteswap())
    return None if little == big else big > little


def injection_ms(kind: AnyArray, counts: AnyArray) -> AnyArray:
    """Tell how long after its time stamp a packet is written: a pulse is stamped at its beginning only."""
    return np.where(kind == INJECTOR, counts // COUNTS_PER_MS + 1, 0)


class LoggerClock:
    """Times packets block by block.

    A time stamp out of order is believed when the following ones agree with it: then it is a gap, the 32-bit wrap after
    49.7 days, a clock set back by a little (time stands still) or a restart. Else it is left out.
    """

    def __init__(self) -> None:
        self._held = no_packets()
        self._state = np.zeros(k.CLOCK_STATE, np.int64)
        self.big_endian: bool | None = None
        self.gaps: list[Gap] = []
        self.gap_count = 0
        self.rejected: list[int] = []
        """Offsets of packets left out because the ones behind contradict their time stamp, the first ones."""
        self.untimed_text_bytes = 0
        """Receiver text without a single time stamp around it."""

    def time(self, packets: Packets, *, final: bool = False) -> Iterator[Stretch]:
        """Return the packets that can be timed by now, one stretch per power-on.

        Parameters
        ----------
        packets : Packets
            The next ones, as read in little-endian order.
        final : bool
            No more will come.

        Yields
        ------
        Stretch
            Without sentences as yet.
        """
        now = final or len(self._held.text) > MOST_HELD_TEXT
        held = join(self._held, packets)
        if self.big_endian is None:
            if len(held) < ENOUGH_STAMPS and not now:
                self._held = held
                return
            self.big_endian = is_big_endian(held.raw_ms)
        count = len(held) if now else max(len(held) - k.FOLLOWERS, 0)
        texts = len(held.text_row) if now else int(np.searchsorted(held.text_row, count))
        self._held = held.behind(count, texts)
        yield from self._decide(in_byte_order(held, big_endian=bool(self.big_endian)), count, texts)

    def _decide(self, packets: Packets, count: int, texts: int) -> Iterator[Stretch]:
        was_running, last_ms, last_run = (bool(self._state[k.IN_RUN]), self._state[k.LAST_MS], self._state[k.RUN])
        t_ms, run, keep = np.empty(count, np.int64), np.empty(count, np.int64), np.empty(count, np.bool_)
        gap_rows = np.empty((count, 3), np.int64)
        gap_count = k.follow_clock(packets.raw_ms, count, self._state, t_ms, run, keep, gap_rows)
        rows = np.flatnonzero(keep)
        if count == 0 and texts == 0:
            return
        if not was_running and len(rows) == 0:
            self.untimed_text_bytes += int(packets.text_end[texts - 1]) if texts else 0
            return
        self.rejected += packets.offset[:count][~keep][: MOST_LISTED - len(self.rejected)].tolist()
        if len(rows) < count:
            t_ms, run = t_ms[rows], run[rows]
        behind = np.searchsorted(rows, packets.text_row[:texts])
        known_ms = np.concatenate(([last_ms if was_running else t_ms[0]], t_ms))
        known_run = np.concatenate(([last_run if was_running else run[0]], run))
        before_ms, text_run = known_ms[behind], known_run[behind]
        following = np.minimum(behind + 1, len(rows))
        written_ms = np.concatenate((known_ms[:1], t_ms + injection_ms(packets.kind[rows], packets.words[rows, 0])))
        after_ms = np.where(known_run[following] == text_run, written_ms[following], before_ms)
        self.gap_count += gap_count
        for row, from_ms, to_ms in gap_rows[: min(gap_count, MOST_LISTED - len(self.gaps))].tolist():
            self.gaps.append(Gap(int(packets.offset[row]), from_ms / 1e3, to_ms / 1e3))
        text_end = np.concatenate(([0], packets.text_end[:texts]))
        runs = np.concatenate((run[:1], run[-1:], text_run[:1], text_run[-1:]))
        for number in range(int(runs.min()), int(runs.max()) + 1):
            a, b = np.searchsorted(run, (number, number + 1))
            c, d = np.searchsorted(text_run, (number, number + 1))
            mine = slice(a, b) if len(rows) == count else rows[a:b]
            yield Stretch(
                number,
                Timed(t_ms[a:b], packets.kind[mine], packets.words[mine], packets.offset[mine]),
                Text(
                    packets.text[text_end[c] : text_end[d]].copy(),
                    text_end[c + 1 : d + 1] - text_end[c],
                    before_ms[c:d],
                    after_ms[c:d],
                ),
                NO_SENTENCES,
            )

    @property
    def counts(self) -> ClockCounts:
        """What has happened to the clock so far."""
        return ClockCounts(
            *(int(self._state[entry]) for entry in (k.RESTARTS, k.WRAPS, k.REJECTED, k.BACKWARD)),
        )
