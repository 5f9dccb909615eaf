"""Giving memory back: a server whose threads each read columns for a moment would otherwise keep the most of each."""

from __future__ import annotations

import ctypes
import os

M_TRIM_THRESHOLD, M_MMAP_THRESHOLD, M_ARENA_MAX = -1, -3, -8
ARENAS = 2
KEPT_BYTES = 256 * 1024
"""Free memory that stays with the process, and the least size of what gets pages of its own, which are given back."""
ARROW_POOL = "ARROW_DEFAULT_MEMORY_POOL"


def give_back_memory() -> None:
    """Have this process return the memory of large arrays to the system as soon as they are gone.

    Threads share few arenas, and Arrow takes its buffers from the same allocator instead of one that keeps them. To be
    called before Arrow is loaded and threads start. Only glibc can be told so; elsewhere the allocator's habits stay.
    """
    os.environ.setdefault(ARROW_POOL, "system")
    tune = getattr(ctypes.CDLL(None), "mallopt", None)
    if tune is not None:
        tune(M_ARENA_MAX, ARENAS)
        tune(M_TRIM_THRESHOLD, KEPT_BYTES)
        tune(M_MMAP_THRESHOLD, KEPT_BYTES)
