"""Checks of parameters and values that name the place where something is wrong."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from kshell.errors import InputError
from kshell.geometry.components import Floats

Range = tuple[float, float]


def parameter_arrays(names: Sequence[str], values: Sequence[ArrayLike]) -> list[Floats]:
    """The parameters as float arrays of one common shape.

    Raises
    ------
    InputError
        If they cannot be broadcast, are not numbers, or are NaN or infinite somewhere.
    """
    try:
        arrays = [np.asarray(v, dtype=np.float64) for v in values]
    except (TypeError, ValueError) as error:
        raise InputError(f"the parameters {', '.join(names)} must be numbers: {error}") from None
    try:
        shape = np.broadcast_shapes(*(a.shape for a in arrays))
    except ValueError:
        shapes = " and ".join(str(a.shape) for a in arrays)
        raise InputError(
            f"the parameters {', '.join(names)} of shapes {shapes} do not fit together"
        ) from None
    arrays = [np.ascontiguousarray(np.broadcast_to(a, shape)).reshape(shape) for a in arrays]
    for name, a in zip(names, arrays, strict=True):
        finite = np.isfinite(a)
        if not finite.all():
            first = tuple(int(i) for i in np.argwhere(~finite)[0])
            where = f" at index {first[0] if len(first) == 1 else first}" if first else ""
            raise InputError(f"parameter {name} is {a[first]}{where}: give finite numbers")
    return arrays


def interval(name: str, given: Sequence[float]) -> Range:
    """A parameter range (a, b) with a < b, both finite."""
    try:
        a, b = (float(x) for x in given)
    except (TypeError, ValueError):
        raise InputError(f"{name} must be two numbers (from, to), not {given!r}") from None
    if not (np.isfinite(a) and np.isfinite(b)):
        raise InputError(f"{name} = ({a:g}, {b:g}) must be finite")
    if a >= b:
        raise InputError(f"{name} = ({a:g}, {b:g}) is empty: the first number must be less than the second")
    return a, b


def refuse_where(
    bad: ArrayLike, names: Sequence[str], arrays: Sequence[Floats], what: str, mend: str
) -> None:
    """Raise InputError naming the first parameters at which `bad` holds, and how many there are."""
    bad = np.broadcast_to(np.asarray(bad), arrays[0].shape)
    if not bad.any():
        return
    first = tuple(np.argwhere(bad)[0]) if bad.ndim else ()
    place = ", ".join(f"{name} = {a[first]:.9g}" for name, a in zip(names, arrays, strict=True))
    count = int(np.count_nonzero(bad))
    others = f" (and at {count - 1} other points)" if count > 1 else ""
    raise InputError(f"{what} at {place}{others}: {mend}")
