"""How far formulas without poles and jumps may be from polynomials: proved from them, never sampled.

Sums, products, whole powers, exp, sin, cos, sinh and cosh of the place have no singularities at any complex place. On
a ball of complex places around a real one they are bounded by the radius of a disc that holds their values (circular
arithmetic: Petkovic & Petkovic, Complex interval arithmetic and its applications, Wiley 1998, ch. 1), and so are the
coefficients of their Taylor series (Cauchy's estimate): no peak hides between points of a rule where that is little.
"""

from __future__ import annotations

import ast
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.values.expression import CONSTANTS, PLACE, formula

Floats = NDArray[np.float64]
Disc = tuple[Any, Any]  # real centre and radius

MOST = 64  # powers


def on_balls(value: Any, places: Floats, radius: Floats) -> Floats | None:
    """How far a value goes from that at real places, on complex balls around them.

    Parameters
    ----------
    value : number, str, callable, or a sequence of numbers and strings
        Of x, y and z.
    places : (n, 3) array
    radius : (n,) array

    Returns
    -------
    (n,) array, of vectors the root of the sum of squares; infinite where it is too large. None where the value may
    have singularities: divisions, roots, logarithms, comparisons and functions written in Python are not looked into.
    """
    parts = value if isinstance(value, Sequence | np.ndarray) and not isinstance(value, str) else [value]
    at = {name: (places[:, k], radius) for k, name in enumerate(PLACE)}
    out = np.zeros(len(places))
    with np.errstate(all="ignore"):
        for part in parts:
            if callable(part):
                return None
            if not isinstance(part, str):
                continue
            disc = _disc(formula(part, PLACE).tree, at)
            if disc is None:
                return None
            out = np.hypot(out, disc[1])
    return np.where(np.isfinite(out), out, np.inf)


def _disc(node: ast.expr, at: Mapping[str, Disc]) -> Disc | None:
    if isinstance(node, ast.Constant) and not isinstance(node.value, bool):
        return float(node.value), 0.0  # type: ignore[arg-type]
    if isinstance(node, ast.Name):
        return at[node.id] if node.id in at else (CONSTANTS[node.id], 0.0)
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub | ast.UAdd):
        inner = _disc(node.operand, at)
        return inner if inner is None or isinstance(node.op, ast.UAdd) else (-inner[0], inner[1])
    if isinstance(node, ast.BinOp):
        return _of_two(node, at)
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in ENTIRE:
        inner = _disc(node.args[0], at)
        return None if inner is None else ENTIRE[node.func.id](*inner)
    return None


def _of_two(node: ast.BinOp, at: Mapping[str, Disc]) -> Disc | None:
    left = _disc(node.left, at)
    if left is None:
        return None
    if isinstance(node.op, ast.Pow):
        power = node.right.value if isinstance(node.right, ast.Constant) else None
        if not isinstance(power, int) or not 0 <= power <= MOST:
            return None
        out: Disc = 1.0, 0.0
        for _ in range(power):
            out = _times(out, left)
        return out
    right = _disc(node.right, at)
    if right is None:
        return None
    if isinstance(node.op, ast.Add | ast.Sub):
        other = right[0] if isinstance(node.op, ast.Add) else -right[0]
        return left[0] + other, left[1] + right[1]
    if isinstance(node.op, ast.Mult):
        return _times(left, right)
    if isinstance(node.op, ast.Div) and isinstance(right[1], float) and right[1] == 0.0 and right[0] != 0.0:
        return left[0] / right[0], left[1] / abs(right[0])  # by a constant
    return None


def _times(a: Disc, b: Disc) -> Disc:
    return a[0] * b[0], abs(a[0]) * b[1] + a[1] * (abs(b[0]) + b[1])


def _exp(c: Any, r: Any) -> Disc:
    grown = np.exp(c)
    return grown, grown * np.expm1(r)


def _sin(c: Any, r: Any) -> Disc:
    value = np.sin(c)
    return value, abs(value) * (np.cosh(r) - 1.0) + abs(np.cos(c)) * np.sinh(r)


def _cos(c: Any, r: Any) -> Disc:
    value = np.cos(c)
    return value, abs(value) * (np.cosh(r) - 1.0) + abs(np.sin(c)) * np.sinh(r)


def _sinh(c: Any, r: Any) -> Disc:
    # |cos(i r)| and |sin(i r)| grow along the imaginary axis of sin, here along the real one
    value = np.sinh(c)
    return value, abs(value) * (np.cosh(r) - 1.0) + np.cosh(c) * np.sinh(r)


def _cosh(c: Any, r: Any) -> Disc:
    value = np.cosh(c)
    return value, value * (np.cosh(r) - 1.0) + abs(np.sinh(c)) * np.sinh(r)


ENTIRE = {"exp": _exp, "sin": _sin, "cos": _cos, "sinh": _sinh, "cosh": _cosh}
