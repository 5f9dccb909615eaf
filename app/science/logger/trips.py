"""Where one trip ends and the next begins."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from app.science.arrays import IntArray
from app.science.logger import kernels as k
from app.science.logger.nmea_kernels import QUALITY, RMC, SPEED
from app.science.logger.report import MOST_LISTED, LeftOut
from app.science.logger.stretch import Stretch

MOVING_MPS = 3.0
"""GPS speed that shows a drive in an image without a single tick or pulse; standing receivers show up to one or two."""

FEWEST_PACKETS = 2
"""A single packet that nothing around confirms may be an accident of the 8-bit sum in a file of another kind."""


@dataclass(frozen=True, slots=True)
class Trip:
    """Everything between the car's waking and its going to sleep.

    Attributes
    ----------
    pieces : tuple of Stretch
        In the order of the image, all of one power-on.
    is_first : bool
        It is the power-on's first trip.
    is_cut : bool
        The drive goes on in the next trip; it was too long for one.
    """

    pieces: tuple[Stretch, ...]
    is_first: bool
    is_cut: bool


class TripSplitter:
    """Splits what the logger recorded into trips.

    The car is off where the logger was (its clock restarts), and where for longer than ``off_after_s`` no wheel ticked
    and no injector opened: an engine that idles at a barrier keeps the trip, a logger that runs on in a parked car
    doesn't. In images without any tick or pulse a moving GPS takes their place. A trip keeps ``margin_s`` of standstill
    on either side.

    Parameters
    ----------
    off_after_s : float
    margin_s : float
        At most half of ``off_after_s`` is used.
    longest_bytes : int
        A drive whose packets take more memory is cut.
    """

    def __init__(self, off_after_s: float, margin_s: float, longest_bytes: int) -> None:
        self._off_ms = round(1e3 * off_after_s)
        self._margin_ms = min(round(1e3 * margin_s), self._off_ms // 2)
        self._longest_bytes = longest_bytes
        self._has_sensors = False
        self._run: int | None = None
        self._wake_up()
        self.left_out: list[LeftOut] = []
        self.left_out_count = 0

    def _wake_up(self) -> None:
        """Begin a power-on."""
        self._open: list[Stretch] = []
        self._active_ms: int | None = None
        self._is_parked = False
        self._is_first = True
        self._dropped: LeftOut | None = None

    def add(self, stretch: Stretch) -> Iterator[Trip]:
        """Take the next stretch and return the trips that have ended by its end."""
        if stretch.run != self._run:
            yield from self.finish()
            self._run = stretch.run
        self._open.append(stretch)
        active = self._activity(stretch)
        if len(active):
            first = int(active[0])
            if self._active_ms is None:
                if self._is_parked or first - self._begin_ms() > self._off_ms:
                    self._drop_before(first - self._margin_ms)
                self._active_ms = first
            points = np.concatenate(([self._active_ms], active))
            for i in np.flatnonzero(np.diff(points) > self._off_ms):
                yield self._end_trip(int(points[i]))
                self._drop_before(int(points[i + 1]) - self._margin_ms)
            self._active_ms = int(active[-1])
            self._is_parked = False
        if len(stretch.timed):
            yield from self._watch(stretch.last_ms)
        if self._active_ms is not None and sum(piece.size for piece in self._open) > self._longest_bytes:
            yield self._all_open(is_cut=True)

    def finish(self) -> Iterator[Trip]:
        """Return the open trip: the logger lost power, or the image ends."""
        if self._active_ms is not None and sum(len(piece.timed) for piece in self._open) >= FEWEST_PACKETS:
            yield self._all_open()
        elif any(len(piece.timed) for piece in self._open):
            self._drop_before(1 + max(piece.last_ms for piece in self._open if len(piece.timed)))
        self._note_dropped()
        self._wake_up()

    def _watch(self, now_ms: int) -> Iterator[Trip]:
        """End the trip, or forget the standstill, when nothing has stirred for too long."""
        if self._active_ms is not None and now_ms - self._active_ms > self._off_ms:
            yield self._end_trip(self._active_ms)
            self._active_ms, self._is_parked = None, True
        if self._active_ms is None and (self._is_parked or now_ms - self._begin_ms() > self._off_ms):
            self._drop_before(now_ms - self._margin_ms)
            self._is_parked = True

    def _activity(self, stretch: Stretch) -> IntArray:
        """Return the sorted times at which the car did something."""
        kind = stretch.timed.kind
        times = stretch.timed.t_ms[(kind == k.VSS) | (kind == k.INJECTOR)]
        self._has_sensors |= len(times) > 0
        if not self._has_sensors:
            said = stretch.told.sentences
            moving = (said.kind == RMC) & (said.values[:, QUALITY] > 0) & (said.values[:, SPEED] >= MOVING_MPS)
            times = stretch.told.before_ms[moving]
        return np.sort(times)

    def _begin_ms(self) -> int:
        return min((piece.first_ms for piece in self._open if len(piece.timed)), default=0)

    def _trip(self, pieces: list[Stretch], *, is_cut: bool = False) -> Trip:
        self._note_dropped()
        trip = Trip(tuple(pieces), self._is_first, is_cut)
        self._is_first = False
        return trip

    def _all_open(self, *, is_cut: bool = False) -> Trip:
        """Return everything open as a trip and keep nothing of it, for whoever takes it may need the memory."""
        pieces, self._open = self._open, []
        return self._trip(pieces, is_cut=is_cut)

    def _end_trip(self, active_ms: int) -> Trip:
        end_ms = active_ms + self._margin_ms
        trip = self._trip([piece.between(-np.inf, end_ms) for piece in self._open])
        self._open = [piece.between(end_ms + 1, np.inf) for piece in self._open]
        return trip

    def _drop_before(self, from_ms: int) -> None:
        """Forget what lies before a time."""
        for piece in self._open:
            gone = piece.timed.t_ms < from_ms
            if gone.any():
                begin = self._dropped or LeftOut(
                    int(piece.timed.offset[gone][0]), float(piece.timed.t_ms[gone].min()) / 1e3, 0.0
                )
                self._dropped = replace(begin, to_s=float(piece.timed.t_ms[gone].max()) / 1e3)
        kept = (piece.between(from_ms, np.inf) for piece in self._open)
        self._open = [piece for piece in kept if len(piece.timed) or len(piece.text.end)]

    def _note_dropped(self) -> None:
        if self._dropped is not None:
            self.left_out_count += 1
            if len(self.left_out) < MOST_LISTED:
                self.left_out.append(self._dropped)
            self._dropped = None
