"""Smooth maps of one or two parameters: values with all partial derivatives up to a given order.

Every curve, chart, displacement and one-form stands on such a map. The derivatives are exact: written
by hand, given by the user, derived by sympy, or carried through a composition as Taylor polynomials.

Symbols
-------
(i, j)    index of the partial derivative d^(i+j) / du^i dv^j; (k,) for a map of one parameter
partials  dict from index to the list of components of that partial derivative
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from kshell.errors import InputError
from kshell.geometry.components import Component, Floats, is_zero, total

Index = tuple[int, ...]
Partials = dict[Index, list[Component]]
Taylor = dict[Index, Component]

UNLIMITED = 99


def indices(parameters: int, order: int) -> list[Index]:
    """All derivative indices up to the order, lower orders first, u before v."""
    if parameters == 1:
        return [(k,) for k in range(order + 1)]
    return [(n - j, j) for n in range(order + 1) for j in range(n + 1)]


class SmoothMap(ABC):
    """A map from parameters to components.

    Attributes
    ----------
    parameters : int
        1 or 2.
    components : int
        How many values the map has.
    highest : int
        Order of the highest derivative it can give.
    """

    parameters: int
    components: int
    highest: int = UNLIMITED

    @abstractmethod
    def partials(self, where: Sequence[Floats], order: int) -> Partials:
        """Partial derivatives up to `order` at the parameter arrays `where`, which share one shape."""

    def require(self, order: int, what: str) -> None:
        """Raise InputError unless derivatives up to `order` are there."""
        if order > self.highest:
            raise InputError(
                f"{what} needs derivatives up to order {order}, but only those up to order {self.highest} "
                "were given: add the missing functions to `derivatives`, or describe the map by expressions"
            )


class GivenMap(SmoothMap):
    """A map given as functions.

    Parameters
    ----------
    function : callable
        Of the parameter arrays; returns a sequence of `components` arrays or one array (..., components).
    derivatives : sequence of callables
        First, second, third derivatives. Of a curve each returns a vector as `function` does; of a chart
        the first returns (x_u, x_v), the second (x_uu, x_uv, x_vv), the third (x_uuu, x_uuv, x_uvv, x_vvv).
    """

    def __init__(
        self,
        function: Callable[..., Any],
        derivatives: Sequence[Callable[..., Any]],
        parameters: int,
        components: int,
    ) -> None:
        self.function, self.derivatives = function, tuple(derivatives)
        self.parameters, self.components = parameters, components
        self.highest = len(self.derivatives)

    def partials(self, where: Sequence[Floats], order: int) -> Partials:
        self.require(order, "this quantity")
        shape = where[0].shape
        start = (0,) * self.parameters
        out: Partials = {start: self._vector(self.function(*where), shape, "the function")}
        for n, function in enumerate(self.derivatives[:order], start=1):
            value = function(*where)
            names = [index for index in indices(self.parameters, n) if sum(index) == n]
            if self.parameters == 1:
                value = [value]
            elif not isinstance(value, (tuple, list)) or len(value) != len(names):
                raise InputError(
                    f"the derivatives of order {n} must be a tuple of {len(names)} vectors, not {_describe(value)}"
                )
            for index, vector in zip(names, value, strict=True):
                out[index] = self._vector(vector, shape, f"a derivative of order {n}")
        return out

    def _vector(self, value: Any, shape: tuple[int, ...], what: str) -> list[Component]:
        if isinstance(value, np.ndarray) and value.shape == (*shape, self.components):
            return [value[..., i] for i in range(self.components)]
        # an array (component, ...) is refused: with as many points as components it could not be told apart
        if isinstance(value, (tuple, list)) and len(value) == self.components:
            components = [np.asarray(c, dtype=np.float64)[()] for c in value]
            if all(np.ndim(c) == 0 or np.shape(c) == shape for c in components):
                return components
        raise InputError(
            f"{what} must return {self.components} components of shape {shape} or one array of shape "
            f"{(*shape, self.components)}, not {_describe(value)}"
        )

    def check(self, ranges: Sequence[tuple[float, float]]) -> None:
        """Compare each given derivative with central differences of the one below it, at one inner point.

        Raises
        ------
        InputError
            If they differ by more than 1e-3 of their size: a slip of the pen, not rounding.
        """
        centre = [np.array([a + 0.437 * (b - a)]) for a, b in ranges]
        here = self.partials(centre, self.highest)
        for axis, (a, b) in enumerate(ranges):
            step = 1e-5 * (b - a)
            moved = [self.partials([c + (s * step if k == axis else 0.0) for k, c in enumerate(centre)],
                                   self.highest) for s in (-1.0, 1.0)]  # fmt: skip
            for index in indices(self.parameters, self.highest - 1):
                above = tuple(n + (k == axis) for k, n in enumerate(index))
                given = np.array([float(np.ravel(c)[0]) for c in here[above]])
                low, high = (np.array([float(np.ravel(c)[0]) for c in m[index]]) for m in moved)
                difference = (high - low) / (2 * step)
                size = np.abs(given).max() + np.abs(difference).max() + 1e-6 * np.abs(high).max() / (b - a)
                if np.abs(given - difference).max() > 1e-3 * size:
                    place = ", ".join(f"{float(c[0]):g}" for c in centre)
                    raise InputError(
                        f"the given derivative {above} is {given} at ({place}) but differences of the "
                        f"function below it give {difference}: mend the derivative or let it be derived"
                    )


def _describe(value: Any) -> str:
    if isinstance(value, np.ndarray):
        return f"an array of shape {value.shape}"
    if isinstance(value, (tuple, list)):
        return f"{len(value)} values of shapes {[np.shape(v) for v in value]}"
    return f"a {type(value).__name__}"


class AffineMap(SmoothMap):
    """matrix @ x + shift for a map x: a rigid motion where the matrix is a rotation."""

    def __init__(self, inner: SmoothMap, matrix: ArrayLike, shift: ArrayLike) -> None:
        self.inner, self.matrix, self.shift = inner, np.asarray(matrix, float), np.asarray(shift, float)
        n = inner.components
        if self.matrix.shape != (n, n) or self.shift.shape != (n,):
            raise InputError(f"a motion needs a {n}x{n} matrix and a shift of {n} numbers")
        self.parameters, self.components, self.highest = inner.parameters, n, inner.highest

    def partials(self, where: Sequence[Floats], order: int) -> Partials:
        out = {}
        for index, vector in self.inner.partials(where, order).items():
            out[index] = [total(list(zip(row.tolist(), vector, strict=True))) for row in self.matrix]
            if sum(index) == 0:
                out[index] = [c + s for c, s in zip(out[index], self.shift, strict=True)]
        return out


class ComposedMap(SmoothMap):
    """outer(inner(parameters)), the chain rule carried out on Taylor polynomials."""

    def __init__(self, outer: SmoothMap, inner: SmoothMap) -> None:
        if inner.components < outer.parameters:
            raise InputError(f"the inner map must give the {outer.parameters} parameters of the outer one")
        self.outer, self.inner = outer, inner
        self.parameters, self.components = inner.parameters, outer.components
        self.highest = min(outer.highest, inner.highest)

    def partials(self, where: Sequence[Floats], order: int) -> Partials:
        self.require(order, "a composition")
        inside = self.inner.partials(where, order)
        shape = where[0].shape
        start = (0,) * self.parameters
        place = [np.array(np.broadcast_to(np.asarray(c, float), shape))
                 for c in inside[start][: self.outer.parameters]]  # fmt: skip
        outside = self.outer.partials(place, order)
        return compose(outside, inside, self.outer.parameters, self.parameters, order)


class FieldSum(SmoothMap):
    """first + factor * second: a chart moved by a displacement."""

    def __init__(self, first: SmoothMap, second: SmoothMap, factor: float = 1.0) -> None:
        if first.parameters != second.parameters or first.components != second.components:
            raise InputError("only maps of as many parameters and components can be added")
        self.first, self.second, self.factor = first, second, factor
        self.parameters, self.components = first.parameters, first.components
        self.highest = min(first.highest, second.highest)

    def partials(self, where: Sequence[Floats], order: int) -> Partials:
        a, b = self.first.partials(where, order), self.second.partials(where, order)
        return {index: [p + self.factor * q for p, q in zip(a[index], b[index], strict=True)] for index in a}


def compose(outside: Partials, inside: Partials, outer: int, inner: int, order: int) -> Partials:
    """Partial derivatives of outside(inside(.)), by substituting truncated Taylor polynomials.

    With d_k the Taylor polynomial of the k-th inner component without its constant term,
    x = sum over i, j of  x_(i, j) / (i! j!)  d_0^i d_1^j,  cut at the order.
    """
    start = (0,) * inner
    keys = indices(inner, order)
    powers: list[list[Taylor]] = []  # (outer parameter, exponent)
    for k in range(outer):
        delta = {key: inside[key][k] / _factorial(key) for key in keys if key != start}
        chain: list[Taylor] = [{start: 1.0}]
        for _ in range(order):
            chain.append(_product(chain[-1], delta, order))
        powers.append(chain)

    count = len(outside[(0,) * outer])
    out: Partials = {key: [0.0] * count for key in keys}
    for index in indices(outer, order):
        weight = powers[0][index[0]]
        for k in range(1, outer):
            weight = _product(weight, powers[k][index[k]], order)
        for key, factor in weight.items():
            if is_zero(factor):
                continue
            scale = _factorial(key) / _factorial(index)
            for c, value in enumerate(outside[index]):
                if not is_zero(value):
                    out[key][c] = out[key][c] + value * factor * scale
    return out


def product_partials(a: Taylor, b: Taylor, parameters: int, order: int) -> Taylor:
    """Partial derivatives of a product of two functions from theirs (Leibniz)."""
    scaled = [{index: value / _factorial(index) for index, value in f.items()} for f in (a, b)]
    product = _product(scaled[0], scaled[1], order)
    return {index: product.get(index, 0.0) * _factorial(index) for index in indices(parameters, order)}


def _factorial(index: Index) -> float:
    return float(math.prod(math.factorial(n) for n in index))


def _product(a: Taylor, b: Taylor, order: int) -> Taylor:
    out: Taylor = {}
    for i, p in a.items():
        for j, q in b.items():
            key = tuple(m + n for m, n in zip(i, j, strict=True))
            if sum(key) <= order and not is_zero(p) and not is_zero(q):
                out[key] = out[key] + p * q if key in out else p * q
    return out
