"""Exact derivatives by sympy, of written expressions and of plain Python functions.

A function given without derivatives is called once with tracers in place of numbers: each numpy function
it applies is written down as a sympy expression, which is then differentiated and compiled for arrays.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin

from kshell.errors import InputError
from kshell.geometry.components import Floats
from kshell.geometry.smooth import UNLIMITED, Partials, SmoothMap, indices

# numpy function -> sympy function of the same arguments
TRACEABLE = {
    "sin": "sin", "cos": "cos", "tan": "tan", "arcsin": "asin", "arccos": "acos", "arctan": "atan",
    "arctan2": "atan2", "sinh": "sinh", "cosh": "cosh", "tanh": "tanh", "arcsinh": "asinh",
    "arccosh": "acosh", "arctanh": "atanh", "exp": "exp", "log": "log", "sqrt": "sqrt", "cbrt": "cbrt",
}  # fmt: skip
ARITHMETIC: dict[str, Callable[..., Any]] = {
    "add": lambda a, b: a + b,
    "subtract": lambda a, b: a - b,
    "multiply": lambda a, b: a * b,
    "divide": lambda a, b: a / b,
    "power": lambda a, b: a**b,
    "float_power": lambda a, b: a**b,
    "negative": lambda a: -a,
    "positive": lambda a: a,
    "square": lambda a: a**2,
    "reciprocal": lambda a: 1 / a,
}


class SymbolicMap(SmoothMap):
    """A map given by sympy expressions in symbols; derivatives of any order, compiled when first needed."""

    highest = UNLIMITED

    def __init__(self, expressions: Sequence[Any], symbols: Sequence[Any]) -> None:
        import sympy

        self.symbols = tuple(symbols)
        self.expressions = tuple(_all_digits(sympy.sympify(e)) for e in expressions)
        self.parameters, self.components = len(self.symbols), len(self.expressions)
        self._compiled: dict[int, Callable[..., Any]] = {}

    @classmethod
    def from_texts(
        cls, texts: Sequence[str | float], names: Sequence[str], constants: Mapping[str, float] | None = None
    ) -> SymbolicMap:
        """From formulas such as "R*cos(u)" in the named parameters and constants."""
        import sympy

        from kshell.values.symbolic import symbolic

        constants = dict(constants or {})
        taken = sorted(set(constants) & set(names))
        if taken:
            raise InputError(f'"{taken[0]}" is both a parameter and a constant: rename one')
        expressions = [symbolic(str(text), (*names, *constants)) for text in texts]
        values = {sympy.Symbol(name, real=True): sympy.Float(value, 17) for name, value in constants.items()}
        return cls([e.subs(values) for e in expressions], [sympy.Symbol(name, real=True) for name in names])

    def partials(self, where: Sequence[Floats], order: int) -> Partials:
        if order not in self._compiled:
            self._compiled[order] = self._compile(order)
        with np.errstate(all="ignore"):  # a value that is not finite is reported with its place by the caller
            flat = self._compiled[order](*where)
        values = iter(flat)
        return {
            index: [next(values) for _ in range(self.components)] for index in indices(self.parameters, order)
        }

    def _compile(self, order: int) -> Callable[..., Any]:
        import sympy

        flat = []
        for index in indices(self.parameters, order):
            for expression in self.expressions:
                for symbol, times in zip(self.symbols, index, strict=True):
                    expression = expression.diff(symbol, times) if times else expression
                if expression.has(sympy.Derivative, sympy.DiracDelta, sympy.Subs):
                    raise InputError(
                        f"{self.expressions} has no derivative {index} everywhere: use smooth functions "
                        "only, not abs, floor, min or the like, or supply the derivatives"
                    )
                flat.append(expression)
        return sympy.lambdify(self.symbols, flat, modules="numpy", cse=True)


def _all_digits(expression: Any) -> Any:
    """The same with all 17 digits kept in each number when the expression is printed as code."""
    import sympy

    return expression.xreplace({n: sympy.Float(n, 17) for n in expression.atoms(sympy.Float)})


class Tracer(NDArrayOperatorsMixin):
    """Stands for a number while a function is traced; knows the sympy expression it has become."""

    def __init__(self, expression: Any) -> None:
        self.expression = expression

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **options: Any) -> Any:
        import sympy

        name = ufunc.__name__
        if method != "__call__" or options or (name not in TRACEABLE and name not in ARITHMETIC):
            return NotImplemented
        if any(isinstance(i, np.ndarray) and i.ndim for i in inputs):
            # numpy then applies the function to every entry, and so comes back here with single tracers
            boxed = [_boxed(i) for i in inputs]
            return np.frompyfunc(lambda *entries: ufunc(*entries), len(boxed), 1)(*boxed)
        function = ARITHMETIC.get(name) or getattr(sympy, TRACEABLE[name])
        return Tracer(function(*(_expression(i) for i in inputs)))

    def __bool__(self) -> bool:
        raise InputError("the function branches on its parameter")

    def __float__(self) -> float:
        raise InputError(
            "the function turns its parameter into a plain number (use numpy functions, not math)"
        )


def _boxed(value: Any) -> Any:
    if not isinstance(value, Tracer):
        return value
    box = np.empty((), dtype=object)
    box[()] = value
    return box


def _expression(value: Any) -> Any:
    import sympy

    if isinstance(value, np.ndarray):
        value = value.item()
    if isinstance(value, Tracer):
        return value.expression
    number = float(value)
    return (
        sympy.Integer(int(number)) if number.is_integer() and abs(number) < 2**53 else sympy.Float(number, 17)
    )


def traced(function: Callable[..., Any], names: Sequence[str], components: int) -> SymbolicMap:
    """The map of a plain function, its derivatives found by tracing it.

    Raises
    ------
    InputError
        If the function does something that has no formula: branches, loops over values, tables, math.sin.
    """
    import sympy

    symbols = [sympy.Symbol(name, real=True) for name in names]
    try:
        value = function(*(Tracer(s) for s in symbols))
        flat = list(value) if isinstance(value, (tuple, list, np.ndarray)) else [value]
        expressions = [_expression(c) for c in flat]
    except (InputError, TypeError, ValueError, AttributeError) as error:
        raise InputError(
            f"the derivatives of this function cannot be derived ({error}): pass derivatives=(first, "
            "second), or write the components as expressions with from_expressions"
        ) from error
    if len(expressions) != components:
        raise InputError(f"the function must return {components} components, not {len(expressions)}")
    return SymbolicMap(expressions, symbols)
