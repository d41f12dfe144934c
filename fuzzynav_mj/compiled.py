"""Compiles the few functions that loop over many points; the compiled code is kept on disk."""

from collections.abc import Callable
from typing import ParamSpec, TypeVar, cast

import numba

P = ParamSpec("P")
R = TypeVar("R")


def compiled(function: Callable[P, R]) -> Callable[P, R]:
    """The function in machine code, made at its first call and kept for later processes.

    It computes in the order written (no fast-math): the same input gives the same bits.
    """
    return cast(Callable[P, R], numba.njit(cache=True)(function))
