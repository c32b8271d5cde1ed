"""Values that may be numbers, formulas or functions of the place, evaluated at points.

A value is a number, an expression string in x, y, z (of loads on surfaces also in nx, ny, nz, the normal), or a Python
function f(x, y, z) of arrays. A vector
is a list that may mix numbers and expression strings, or a function that returns its components in turn.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kshell.errors import InputError
from kshell.mesh.words import shown
from kshell.values.expression import NORMAL, PLACE, formula
from kshell.values.time import NO_TIME, depends_on_normal, depends_on_time

Floats = NDArray[np.float64]
Scalar = float | str | Callable[..., Any]
Vector = Sequence[float | str] | Callable[..., Any]

NO_NORMAL = (
    "nx, ny, nz are the normal of the surface, which pressures and tractions know: elsewhere leave them out"
)


def values_at(value: Any, points: ArrayLike, components: int | None = None, what: str = "value") -> Floats:
    """Evaluate a value at points.

    Parameters
    ----------
    value : number, str, callable, or a sequence of `components` numbers and strings
    points : (..., 3) or (..., 6) array
        Places, or places with normals.
    components : int, optional
        Length of the vector; None for a scalar value.
    what : str
        Named in messages, for example "load 2 (pressure)".

    Returns
    -------
    (...) or (..., components) float array.

    Raises
    ------
    InputError
        If the value has the wrong shape, or is NaN or infinite at one of the points (the place is named).
    """
    points = np.asarray(points, dtype=np.float64)
    shape = points.shape[:-1]
    flat = points.reshape(-1, points.shape[-1])
    if components is None:
        result = _scalar(value, flat, what)
    elif callable(value):
        result = _vector_of_function(value, flat, components, what)
    else:
        parts = list(value) if isinstance(value, Sequence | np.ndarray) and not isinstance(value, str) else []
        if len(parts) != components:
            raise InputError(f"{what}: needs {components} components, got {shown(value)}")
        result = np.stack([_scalar(part, flat, what) for part in parts], axis=-1)
    _require_finite(result, flat, value, what)
    return result.reshape(shape if components is None else (*shape, components))


def is_constant(value: Any) -> bool:
    """Whether a value is the same everywhere: a number, or a sequence of numbers."""
    if isinstance(value, Sequence | np.ndarray) and not isinstance(value, str):
        return all(is_constant(part) for part in value)
    return not isinstance(value, str) and not callable(value)


def show(value: Any) -> str:
    """A value for messages and tables: formulas in quotes, functions by name."""
    if callable(value):
        return f"{getattr(value, '__name__', type(value).__name__)}(x, y, z)"
    if isinstance(value, str):
        return f'"{value}"'
    if isinstance(value, Sequence | np.ndarray):
        return "[" + ", ".join(show(part) for part in value) + "]"
    return f"{value:g}"


def _scalar(value: Any, points: Floats, what: str) -> Floats:
    if isinstance(value, str):
        try:
            names = PLACE if points.shape[1] == len(PLACE) else (*PLACE, *NORMAL)
            return formula(value, names)(*points.T)
        except InputError as error:
            words = NO_TIME if depends_on_time(value) else NO_NORMAL if depends_on_normal(value) else error
            raise InputError(f"{what}: {words}") from None
    if callable(value):
        return _call(value, points, (len(points),), what)
    return np.full(len(points), float(value))


def _vector_of_function(value: Callable[..., Any], points: Floats, components: int, what: str) -> Floats:
    # as many points as components would make (component, point) and (point, component) look alike
    ambiguous = len(points) == components
    asked = np.concatenate([points, points[:1]]) if ambiguous else points
    result = _call(value, asked, (components, len(asked)), what)
    return result.T[: len(points)]


def _call(function: Callable[..., Any], points: Floats, shape: tuple[int, ...], what: str) -> Floats:
    name = show(function)
    advice = f"it is called with three arrays of shape {shape[-1:]} and must return " + (
        "one array of that shape" if len(shape) == 1 else f"its {shape[0]} components, each of that shape"
    )
    try:
        with np.errstate(all="ignore"):
            result = function(*points[:, :3].T.copy())
        if len(shape) == 2:
            result = np.stack([np.broadcast_to(np.asarray(part, float), shape[1:]) for part in result])
        return np.array(np.broadcast_to(np.asarray(result, dtype=float), shape))
    except (TypeError, ValueError) as error:
        raise InputError(
            f"{what}: the function {name} failed ({error}); {advice}; use np.where for cases"
        ) from error


def _require_finite(result: Floats, points: Floats, value: Any, what: str) -> None:
    finite = np.isfinite(result)
    if finite.all():
        return
    bad = np.flatnonzero(~finite.reshape(len(points), -1).all(axis=1))[0]
    x, y, z = points[bad, :3]
    shown = np.atleast_1d(result[bad])
    raise InputError(
        f"{what}: {show(value)} is {shown[~np.isfinite(shown)][0]:g} at ({x:.6g}, {y:.6g}, {z:.6g}): "
        "it must be a finite number at every point of the mesh"
    )
