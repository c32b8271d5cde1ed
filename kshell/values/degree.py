"""Whether a value is a polynomial of the place, and of what degree: proved from its formula, never sampled."""

from __future__ import annotations

import ast
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from kshell.values.expression import CONSTANTS, NORMAL, PLACE, formula

IN_PLANE = {"x": 1, "y": 1, "z": 0, **dict.fromkeys(NORMAL, 0)}  # of constant z
IN_SPACE = {"x": 1, "y": 1, "z": 1}


def polynomial_degree(value: Any, of: Mapping[str, int] = IN_PLANE) -> int | None:
    """The degree of a number, formula or vector of them; None where it is no polynomial, or not known to be.

    Functions written in Python are not looked into. ``of`` has the degrees of the variables: in a plane of constant z
    that in x and y is meant, `IN_SPACE` that in x, y and z.
    """
    if isinstance(value, str):
        return _degree(formula(value, (*PLACE, *NORMAL)).tree, of)
    if callable(value):
        return None
    if isinstance(value, Sequence | np.ndarray):
        parts = [polynomial_degree(part, of) for part in value]
        known = [part for part in parts if part is not None]
        return max(known, default=0) if len(known) == len(parts) else None
    return 0


def _degree(node: ast.expr, of: Mapping[str, int]) -> int | None:
    if isinstance(node, ast.Constant):
        return 0
    if isinstance(node, ast.Name):
        return 0 if node.id in CONSTANTS else of.get(node.id)
    if isinstance(node, ast.UnaryOp):
        return _degree(node.operand, of)
    if isinstance(node, ast.BinOp):
        return _of_two(node, of)
    if isinstance(node, ast.Call):  # of constants alone
        return 0 if all(_degree(argument, of) == 0 for argument in node.args) else None
    return None


def _of_two(node: ast.BinOp, of: Mapping[str, int]) -> int | None:
    left, right = _degree(node.left, of), _degree(node.right, of)
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
