"""Whether a value is a polynomial of the place, and of what degree: proved from its formula, never sampled."""

from __future__ import annotations

import ast
from collections.abc import Sequence
from typing import Any

import numpy as np

from kshell.values.expression import CONSTANTS, NORMAL, PLACE, Expression

COORDINATES = {"x": 1, "y": 1, "z": 0, **dict.fromkeys(NORMAL, 0)}  # in a plane of constant z


def polynomial_degree(value: Any) -> int | None:
    """The degree in x and y of a number, formula or vector of them; None where it is no polynomial, or not known to be.

    Functions written in Python are not looked into.
    """
    if isinstance(value, str):
        return _degree(Expression(value, (*PLACE, *NORMAL)).tree)
    if callable(value):
        return None
    if isinstance(value, Sequence | np.ndarray):
        parts = [polynomial_degree(part) for part in value]
        known = [part for part in parts if part is not None]
        return max(known, default=0) if len(known) == len(parts) else None
    return 0


def _degree(node: ast.expr) -> int | None:
    if isinstance(node, ast.Constant):
        return 0
    if isinstance(node, ast.Name):
        return 0 if node.id in CONSTANTS else COORDINATES.get(node.id)
    if isinstance(node, ast.UnaryOp):
        return _degree(node.operand)
    if isinstance(node, ast.BinOp):
        return _of_two(node)
    if isinstance(node, ast.Call):  # of constants alone
        return 0 if all(_degree(argument) == 0 for argument in node.args) else None
    return None


def _of_two(node: ast.BinOp) -> int | None:
    left, right = _degree(node.left), _degree(node.right)
    if left is None or right is None:
        return None
    if isinstance(node.op, ast.Mult):
        return left + right
    if isinstance(node.op, ast.Div):
        return left if right == 0 else None
    if isinstance(node.op, ast.Pow):
        if left == 0 and right == 0:
            return 0
        whole = isinstance(node.right, ast.Constant) and isinstance(node.right.value, int)
        return left * node.right.value if whole and node.right.value >= 0 else None  # type: ignore[attr-defined]
    return max(left, right)
