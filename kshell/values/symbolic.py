"""Checked expressions as sympy formulas, to be differentiated."""

from __future__ import annotations

import ast
import math
from collections.abc import Sequence
from functools import reduce
from itertools import pairwise
from typing import Any

import sympy

from kshell.errors import InputError
from kshell.values.expression import Expression

LARGEST_POWER = 300.0  # decimal digits of a constant power: 9**9**9 is refused before it is computed

FUNCTIONS: dict[str, Any] = {
    "sin": sympy.sin,
    "cos": sympy.cos,
    "tan": sympy.tan,
    "asin": sympy.asin,
    "acos": sympy.acos,
    "atan": sympy.atan,
    "atan2": sympy.atan2,
    "sinh": sympy.sinh,
    "cosh": sympy.cosh,
    "tanh": sympy.tanh,
    "asinh": sympy.asinh,
    "acosh": sympy.acosh,
    "atanh": sympy.atanh,
    "exp": sympy.exp,
    "log": sympy.log,
    "log10": lambda a: sympy.log(a) / sympy.log(10),
    "sqrt": sympy.sqrt,
    "abs": sympy.Abs,
    "sign": sympy.sign,
    "floor": sympy.floor,
    "ceil": sympy.ceiling,
    "hypot": lambda a, b: sympy.sqrt(a**2 + b**2),
    "min": sympy.Min,
    "max": sympy.Max,
}
CONSTANTS = {"pi": sympy.pi, "e": sympy.E}
COMPARISONS: dict[type, Any] = {
    ast.Lt: sympy.Lt,
    ast.LtE: sympy.Le,
    ast.Gt: sympy.Gt,
    ast.GtE: sympy.Ge,
    ast.Eq: sympy.Eq,
    ast.NotEq: sympy.Ne,
}


def symbolic(text: str, names: Sequence[str]) -> Any:
    """A formula in named variables as a sympy expression in real symbols of those names, without `eval`.

    Raises
    ------
    InputError
        As `Expression`, and for constant powers of more than 300 digits.
    """
    expression = Expression(text, tuple(names))
    symbols = {name: sympy.Symbol(name, real=True) for name in expression.names}
    return _number(_convert(expression.tree, symbols, expression.text))


def _number(value: Any) -> Any:
    """A condition used as a number counts as 1 or 0."""
    return sympy.Piecewise((1, value), (0, True)) if _is_condition(value) else value


def _condition(value: Any) -> Any:
    return value if _is_condition(value) else sympy.Ne(value, 0)


def _is_condition(value: Any) -> bool:
    # a symbol is both a Boolean and an Expr to sympy; here it is a number
    return isinstance(value, sympy.logic.boolalg.Boolean) and not isinstance(value, sympy.Expr)


def _power(base: Any, exponent: Any, text: str) -> Any:
    if exponent.is_number:
        digits = abs(float(exponent)) if exponent.is_real else math.inf
        if base.is_number:
            size = abs(complex(base))
            digits *= abs(math.log10(size)) if size else 0.0
        if digits > LARGEST_POWER:
            raise InputError(f'expression "{text}": the power {base}**{exponent} is too large')
    return base**exponent


def _convert(node: ast.expr, symbols: dict[str, Any], text: str) -> Any:
    def number(n: ast.expr) -> Any:
        return _number(_convert(n, symbols, text))

    def condition(n: ast.expr) -> Any:
        return _condition(_convert(n, symbols, text))

    match node:
        case ast.Constant(value=int() as value):
            return sympy.Integer(value)
        case ast.Constant(value=value):
            return sympy.Float(value)
        case ast.Name(id=name):
            return symbols[name] if name in symbols else CONSTANTS[name]
        case ast.BinOp(left=left, op=op, right=right):
            a, b = number(left), number(right)
            match op:
                case ast.Add():
                    return a + b
                case ast.Sub():
                    return a - b
                case ast.Mult():
                    return a * b
                case ast.Div():
                    return a / b
            return _power(a, b, text)
        case ast.UnaryOp(op=ast.Not(), operand=operand):
            return sympy.Not(condition(operand))
        case ast.UnaryOp(op=op, operand=operand):
            return -number(operand) if isinstance(op, ast.USub) else number(operand)
        case ast.Compare(left=left, ops=ops, comparators=others):
            terms = [number(n) for n in (left, *others)]
            pairs = zip(ops, terms, terms[1:], strict=False)
            return sympy.And(*(COMPARISONS[type(op)](a, b) for op, a, b in pairs))
        case ast.BoolOp(op=op, values=values):
            join = sympy.And if isinstance(op, ast.And) else sympy.Or
            return reduce(join, [condition(n) for n in values])
        case ast.IfExp(test=test, body=body, orelse=orelse):
            return sympy.Piecewise((number(body), condition(test)), (number(orelse), True))
        case ast.Call(func=ast.Name(id="where"), args=[test, body, orelse]):
            return sympy.Piecewise((number(body), condition(test)), (number(orelse), True))
        case ast.Call(func=ast.Name(id="interp"), args=[place, *pairs]):
            return _interpolated(number(place), [number(n) for n in pairs])
        case ast.Call(func=ast.Name(id=name), args=arguments):
            return FUNCTIONS[name](*(number(n) for n in arguments))
    raise AssertionError(f"{type(node).__name__} passed the check but has no symbolic form")


def _interpolated(x: Any, pairs: list[Any]) -> Any:
    """Straight between places pairs[::2] with values pairs[1::2], constant beyond."""
    places, values = pairs[::2], pairs[1::2]
    pieces = [(values[0], x <= places[0])]
    for (a, b), (u, v) in zip(pairwise(places), pairwise(values), strict=True):
        pieces.append((u + (x - a) * (v - u) / (b - a), x <= b))
    return sympy.Piecewise(*pieces, (values[-1], True))
