"""Formulas written by users, such as "1 - x/2", parsed safely.

The text is parsed by Python's own parser and then only what stands on the lists below is let through:
numbers, the given variables, pi and e, arithmetic, comparisons, `a if condition else b`, and calls of the
listed functions. Nothing is ever handed to `eval`; there are no attributes, subscripts or strings.
`kshell.values.symbolic` makes sympy formulas of the same text.
"""

from __future__ import annotations

import ast
import math
import operator
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import lru_cache, reduce
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kshell.errors import InputError
from kshell.values.naming import listing, suggestion

LONGEST_TEXT = 200_000
DEEPEST_NESTING = 150

PLACE = ("x", "y", "z")
NORMAL = ("nx", "ny", "nz")
CONSTANTS = {"pi": math.pi, "e": math.e}

# name: (fewest arguments, most arguments, numpy function); None: any number of arguments
FUNCTIONS: dict[str, tuple[int, int | None, Callable[..., Any]]] = {
    "sin": (1, 1, np.sin),
    "cos": (1, 1, np.cos),
    "tan": (1, 1, np.tan),
    "asin": (1, 1, np.arcsin),
    "acos": (1, 1, np.arccos),
    "atan": (1, 1, np.arctan),
    "atan2": (2, 2, np.arctan2),
    "sinh": (1, 1, np.sinh),
    "cosh": (1, 1, np.cosh),
    "tanh": (1, 1, np.tanh),
    "asinh": (1, 1, np.arcsinh),
    "acosh": (1, 1, np.arccosh),
    "atanh": (1, 1, np.arctanh),
    "exp": (1, 1, np.exp),
    "log": (1, 1, np.log),
    "log10": (1, 1, np.log10),
    "sqrt": (1, 1, np.sqrt),
    "abs": (1, 1, np.abs),
    "sign": (1, 1, np.sign),
    "floor": (1, 1, np.floor),
    "ceil": (1, 1, np.ceil),
    "hypot": (2, 2, np.hypot),
    "min": (2, None, lambda *a: reduce(np.minimum, a)),
    "max": (2, None, lambda *a: reduce(np.maximum, a)),
    "where": (3, 3, np.where),
    "interp": (5, None, lambda x, *pairs: np.interp(x, pairs[::2], pairs[1::2])),
}

ARITHMETIC: dict[type, Callable[[Any, Any], Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: operator.pow,
}
COMPARISONS: dict[type, Callable[[Any, Any], Any]] = {
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
    ast.Eq: operator.eq,
    ast.NotEq: operator.ne,
}
HINTS: dict[type, str] = {
    ast.BitXor: 'write "**" for a power, "^" is not one',
    ast.FloorDiv: 'write floor(a / b) instead of "//"',
    ast.Mod: 'write a - b*floor(a/b) instead of "%"',
    ast.Attribute: "there are no attributes: write sin(x), not np.sin(x) or math.sin(x)",
    ast.Subscript: "there is no indexing",
    ast.Constant: "only numbers are constants",
    ast.Lambda: "there are no functions to define",
}


Program = Callable[[dict[str, Any]], Any]  # from the values of the variables to that of a formula


@dataclass(frozen=True)
class Expression:
    """A formula in named variables that has been checked and can be evaluated on arrays.

    Parameters
    ----------
    text : str
        For example "1 - x/2" or "1000 if hypot(x, y) < 0.1 else 0".
    names : sequence of str
        The variables, in the order in which `__call__` takes their values.

    Raises
    ------
    InputError
        If the text is not a formula or uses anything that is not allowed; the message shows the part.
    """

    text: str
    names: tuple[str, ...] = PLACE
    tree: ast.expr = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "names", tuple(self.names))
        if not isinstance(self.text, str):
            _parse(self.text)
        object.__setattr__(self, "tree", _checked(self.text, self.names))

    def __call__(self, *values: ArrayLike) -> NDArray[np.float64]:
        """Values of the formula, broadcast over the values of the variables.

        Where the formula has no value the result is NaN or infinite; the caller says where that is.
        """
        arrays = [np.asarray(v, dtype=np.float64) for v in values]
        variables = dict(zip(self.names, arrays, strict=True))
        with np.errstate(all="ignore"):
            result = np.array(_program(self.text, self.names)(variables), float)
        shapes = {array.shape for array in arrays}
        shape = shapes.pop() if len(shapes) == 1 else np.broadcast_shapes(*shapes)
        return result if result.shape == shape else np.array(np.broadcast_to(result, shape))


@lru_cache(maxsize=256)
def formula(text: str, names: tuple[str, ...]) -> Expression:
    """The `Expression` of a text, made once: loads ask for theirs many times."""
    return Expression(text, names)


@lru_cache(maxsize=256)
def _checked(text: str, names: tuple[str, ...]) -> ast.expr:
    """The formula of a text, which is not to be changed: loads ask for theirs many times."""
    tree = _parse(text)
    _Checker(text, names).check(tree, 0)
    return tree


@lru_cache(maxsize=256)
def _program(text: str, names: tuple[str, ...]) -> Program:
    """What evaluates a text that is a formula."""
    return _compiled(_checked(text, names))


def _parse(text: str) -> ast.expr:
    if not isinstance(text, str) or not text.strip():
        raise InputError("an empty text is not an expression: write a number or a formula in x, y, z")
    if len(text) > LONGEST_TEXT:
        raise InputError(
            f'expression "{text[:40]}..." is {len(text)} characters long, more than {LONGEST_TEXT}: '
            "give a Python function instead"
        )
    try:
        return ast.parse(text.strip(), mode="eval").body
    except SyntaxError as error:
        place = f" at character {error.offset}" if error.offset else ""
        raise InputError(f'expression "{_shortened(text)}": not a formula{place} ({error.msg})') from None
    except (ValueError, MemoryError, RecursionError):
        raise InputError(
            f'expression "{text[:40]}...": not a formula (unreadable or nested too deeply)'
        ) from None


class _Checker:
    """Walks the parsed text once and refuses all that is not on the lists above."""

    def __init__(self, text: str, names: tuple[str, ...]) -> None:
        self.text, self.names = text.strip(), names

    def refuse(self, node: ast.AST, why: str) -> InputError:
        part = ast.get_source_segment(self.text, node) or ""
        place = f', at "{_shortened(part)}"' if part and part != self.text else ""
        return InputError(f'expression "{_shortened(self.text)}"{place}: {why}')

    def check(self, node: ast.AST, depth: int) -> None:
        if depth > DEEPEST_NESTING:
            raise self.refuse(node, f"nested more than {DEEPEST_NESTING} deep")
        match node:
            case ast.Constant(value=int() | float() as value) if not isinstance(value, bool):
                if not _is_finite(value):
                    raise self.refuse(node, "the number is too large")
            case ast.Name(id=name):
                self.check_name(node, name)
            case ast.BinOp(op=op) if type(op) in ARITHMETIC:
                pass
            case ast.UnaryOp(op=ast.UAdd() | ast.USub() | ast.Not()):
                pass
            case ast.Compare(ops=ops) if all(type(op) in COMPARISONS for op in ops):
                pass
            case ast.BoolOp() | ast.IfExp():
                pass
            case ast.Call(func=ast.Name(id=name), args=arguments, keywords=[]):
                self.check_call(node, name, arguments)
            case _:
                inner = getattr(node, "op", node)
                func = getattr(node, "func", None)
                kind = type(func) if func is not None else type(inner)
                raise self.refuse(
                    node, HINTS.get(kind, "only arithmetic and the usual functions are allowed")
                )
        for child in _operands(node):
            self.check(child, depth + 1)

    def check_name(self, node: ast.AST, name: str) -> None:
        known = [*self.names, *CONSTANTS]
        if name in FUNCTIONS and name not in known:
            raise self.refuse(node, f'"{name}" is a function: write {name}(...)')
        if name not in known:
            hint = suggestion(name, [*known, *FUNCTIONS])
            raise self.refuse(node, f'unknown name "{name}": {hint}the names are {listing(known)}')

    def check_call(self, node: ast.AST, name: str, arguments: list[ast.expr]) -> None:
        if name not in FUNCTIONS:
            hint = suggestion(name, FUNCTIONS)
            raise self.refuse(
                node, f'unknown function "{name}": {hint}the functions are {listing(FUNCTIONS, 30)}'
            )
        fewest, most, _ = FUNCTIONS[name]
        if len(arguments) < fewest or (most is not None and len(arguments) > most):
            wanted = f"{fewest}" if fewest == most else f"at least {fewest}"
            noun = "argument" if wanted == "1" else "arguments"
            raise self.refuse(node, f"{name} takes {wanted} {noun}, not {len(arguments)}")
        if name == "interp":
            self.check_interp(node, arguments)

    def check_interp(self, node: ast.AST, arguments: list[ast.expr]) -> None:
        try:
            places = [float(ast.literal_eval(place)) for place in arguments[1::2]]
            [float(ast.literal_eval(value)) for value in arguments[2::2]]
        except (ValueError, TypeError):
            raise self.refuse(node, "interp takes numbers after its first argument") from None
        if len(arguments) % 2 == 0:
            raise self.refuse(node, "interp takes a place and pairs: interp(t, t0, value0, t1, value1, ...)")
        if any(after <= before for before, after in pairwise(places)):
            raise self.refuse(node, "interp: its places must rise")


def _shortened(text: str) -> str:
    return text if len(text) <= 80 else text[:60] + "..."


def _is_finite(value: int | float) -> bool:
    try:
        return math.isfinite(float(value))
    except OverflowError:
        return False


def _operands(node: ast.AST) -> list[ast.expr]:
    """The sub-formulas of a checked node; operators and the names of functions are not among them."""
    if isinstance(node, ast.Call):
        return node.args
    return [child for child in ast.iter_child_nodes(node) if isinstance(child, ast.expr)]


def _compiled(node: ast.expr) -> Program:
    """A checked formula as functions of its variables, so that its tree is walked once."""
    match node:
        case ast.Constant(value=int() | float() as constant):
            return _always(np.float64(constant))
        case ast.Name(id=name):
            if name in CONSTANTS:
                known = np.float64(CONSTANTS[name])
                return lambda variables: variables.get(name, known)
            return operator.itemgetter(name)
        case ast.BinOp(left=left, op=op, right=right):
            work, a, b = ARITHMETIC[type(op)], _number(left), _number(right)
            return lambda variables: work(a(variables), b(variables))
        case ast.UnaryOp(op=op, operand=operand):
            if isinstance(op, ast.Not):
                truth = _compiled(operand)
                return lambda variables: np.logical_not(truth(variables))
            inner = _number(operand)
            return (lambda variables: -inner(variables)) if isinstance(op, ast.USub) else inner
        case ast.Compare(left=left, ops=ops, comparators=others):
            terms = [_compiled(n) for n in (left, *others)]
            tests = [COMPARISONS[type(op)] for op in ops]
            return lambda variables: _compared(tests, [term(variables) for term in terms])
        case ast.BoolOp(op=op, values=values):
            join = np.logical_and if isinstance(op, ast.And) else np.logical_or
            parts = [_compiled(n) for n in values]
            return lambda variables: reduce(join, [part(variables) for part in parts])
        case ast.IfExp(test=test, body=body, orelse=orelse):
            choice = [_compiled(n) for n in (test, body, orelse)]
            return lambda variables: np.where(*(part(variables) for part in choice))
        case ast.Call(func=ast.Name(id=name), args=arguments):
            function, given = FUNCTIONS[name][2], [_number(n) for n in arguments]
            if len(given) == 1:
                only = given[0]
                return lambda variables: function(only(variables))
            return lambda variables: function(*[part(variables) for part in given])
    raise AssertionError(f"{type(node).__name__} passed the check but cannot be evaluated")


def _number(node: ast.expr) -> Program:
    """The same where numbers are wanted: booleans count as 0 and 1, as in (x > 0.5) * 1000."""
    found = _compiled(node)
    if isinstance(node, ast.Compare | ast.BoolOp | ast.IfExp) or (
        isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not)
    ):
        return lambda variables: np.asarray(found(variables), float)
    return found


def _compared(tests: list[Callable[[Any, Any], Any]], terms: list[Any]) -> Any:
    """Whether every two neighbours compare as they should."""
    return reduce(np.logical_and, [test(a, b) for test, (a, b) in zip(tests, pairwise(terms), strict=True)])


def _always(value: Any) -> Program:
    return lambda variables: value
