"""Values that depend on the time t: formulas with t, and what they are at one time; whether they ask for the normal."""

from __future__ import annotations

import ast
from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import numpy as np

from kshell.errors import InputError
from kshell.values.expression import NORMAL, PLACE, Expression

TIME = "t"
NO_TIME = (
    't is the time of a motion, analysis = "dynamic" (kshell simulate, ks.simulate): elsewhere leave it out'
)


def depends_on_time(value: Any) -> bool:
    """Whether a value, or a component of it, is a formula with t."""
    return _uses(value, (TIME,))


def depends_on_normal(value: Any) -> bool:
    """Whether a value, or a component of it, is a formula with nx, ny or nz."""
    return _uses(value, NORMAL)


def _uses(value: Any, names: Sequence[str]) -> bool:
    if isinstance(value, tuple | list):
        return any(_uses(part, names) for part in value)
    return isinstance(value, str) and not _names_in(value).isdisjoint(names)


@lru_cache(maxsize=256)
def _names_in(text: str) -> frozenset[str]:
    return frozenset(node.id for node in ast.walk(_tree(text)) if isinstance(node, ast.Name))


def at_time(value: Any, time: float) -> Any:
    """The value at one time: in formulas the number stands for t; formulas of t alone become numbers.

    Parameters
    ----------
    value : number, formula, function, or a tuple of these
        Formulas have been checked.
    """
    if isinstance(value, tuple):
        return tuple(at_time(part, time) for part in value)
    if not depends_on_time(value):
        return value
    text = ast.unparse(_AtTime(time).visit(_tree(value)))
    if _names_in(text).isdisjoint((*PLACE, *NORMAL)):
        number = float(Expression(text, ())())
        if np.isfinite(number):
            return number
    return text


def _tree(text: str) -> ast.expr:
    try:
        return ast.parse(text.strip(), mode="eval").body
    except SyntaxError:
        raise InputError(f'"{text}" is not a formula') from None


class _AtTime(ast.NodeTransformer):
    def __init__(self, time: float) -> None:
        self.time = float(time)

    def visit_Name(self, node: ast.Name) -> ast.expr:
        return ast.Constant(self.time) if node.id == TIME else node

    def visit_Call(self, node: ast.Call) -> ast.expr:
        """Tables are looked up once for all places."""
        if not isinstance(node.func, ast.Name) or node.func.id != "interp":
            return self.generic_visit(node)  # type: ignore[return-value]
        node.args[0] = self.visit(node.args[0])
        if not isinstance(node.args[0], ast.Constant):
            return node
        pairs = [float(ast.literal_eval(part)) for part in node.args[1:]]
        found = np.interp(float(node.args[0].value), pairs[::2], pairs[1::2])  # type: ignore[arg-type]
        return ast.Constant(float(found))
