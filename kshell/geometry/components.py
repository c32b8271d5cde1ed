"""Vector algebra on component lists: a vector field is a list of three arrays (or plain numbers).

Keeping the components apart leaves every array contiguous and lets constant components stay numbers,
which is what makes a million second forms take well under a second.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Component = Any  # a float or an array of the common shape
Vector = Sequence[Component]


def is_zero(a: Component) -> bool:
    """Whether the component is the plain number zero, so that products with it may be left out."""
    return np.ndim(a) == 0 and a == 0


def total(terms: Sequence[tuple[Component, Component]]) -> Component:
    """Sum of products, leaving out those that are identically zero."""
    result: Component = 0.0
    for a, b in terms:
        if not is_zero(a) and not is_zero(b):
            result = a * b if is_zero(result) else result + a * b
    return result


def dot(a: Vector, b: Vector) -> Component:
    """Scalar product."""
    return total(list(zip(a, b, strict=True)))


def cross(a: Vector, b: Vector) -> list[Component]:
    """Vector product."""
    return [total([(a[i], b[j]), (-a[j], b[i])]) for i, j in ((1, 2), (2, 0), (0, 1))]


def scaled(a: Vector, factor: Component) -> list[Component]:
    """The vector times a number."""
    return [c if is_zero(c) else c * factor for c in a]


def combined(*terms: tuple[Component, Vector]) -> list[Component]:
    """Linear combination: sum of factor * vector."""
    return [total([(factor, vector[i]) for factor, vector in terms]) for i in range(len(terms[0][1]))]


def norm(a: Vector) -> Component:
    """Euclidean length."""
    return np.sqrt(dot(a, a))


def stacked(a: Vector, shape: tuple[int, ...]) -> Floats:
    """The components as one array (*shape, component)."""
    out = np.empty((*shape, len(a)))
    for i, component in enumerate(a):
        out[..., i] = component
    return out


def full(a: Component, shape: tuple[int, ...]) -> Floats:
    """A component as an array of the common shape (a numpy number for the shape ())."""
    return np.array(np.broadcast_to(np.asarray(a, dtype=np.float64), shape))[()]


def symmetric(form: Vector, shape: tuple[int, ...]) -> Floats:
    """The symmetric 2x2 matrices (*shape, 2, 2) of a form kept as its entries (11, 12, 22)."""
    out = np.empty((*shape, 2, 2))
    out[..., 0, 0], out[..., 1, 1] = form[0], form[2]
    out[..., 0, 1] = out[..., 1, 0] = form[1]
    return out
