"""One way to compile hot loops, typed so that mypy keeps seeing the Python signature."""

from collections.abc import Callable
from typing import ParamSpec, TypeVar, cast

import numba

P = ParamSpec("P")
R = TypeVar("R")


def kernel(function: Callable[P, R]) -> Callable[P, R]:
    """Compile ``function`` with Numba: cached on disk, GIL released, IEEE arithmetic kept (NaN checks work).

    The plain Python function stays reachable as ``function.py_func``.
    """
    return cast(Callable[P, R], numba.njit(cache=True, nogil=True, error_model="numpy")(function))
