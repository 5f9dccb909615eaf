"""One way to compile hot loops, typed so that mypy keeps seeing the Python signature."""

import os
from collections.abc import Callable
from pathlib import Path
from typing import ParamSpec, TypeVar, cast

import numba

from app.science.fingerprint import kernels_fingerprint

P = ParamSpec("P")
R = TypeVar("R")

_base = Path(os.environ.get("NUMBA_CACHE_DIR") or Path(__file__).resolve().parents[2] / ".cache" / "numba")


def kernel(function: Callable[P, R]) -> Callable[P, R]:
    """Compile ``function`` with Numba: cached on disk, GIL released, IEEE arithmetic kept (NaN checks work).

    The plain Python function stays reachable as ``function.py_func``.
    """
    # Numba's own key for a cached kernel is the file it stands in, so a change in a kernel that it calls from another
    # file would go unnoticed and give yesterday's numbers. A folder for each state of all it imports rules that out.
    numba.config.CACHE_DIR = str(_base / kernels_fingerprint(function.__module__))  # type: ignore[attr-defined]  # set by Numba at run time
    return cast(Callable[P, R], numba.njit(cache=True, nogil=True, error_model="numpy")(function))


def inline_kernel(function: Callable[P, R]) -> Callable[P, R]:
    """Compile a small helper of other kernels; it is never cached by itself."""
    return cast(Callable[P, R], numba.njit(nogil=True, error_model="numpy")(function))
