"""What differs between two results: numbers at probes, extremes, reactions, energies, and fields on the same mesh."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from kshell.result.result import Result

# entries of result.json that are compared, by their key
NUMBERS = ("probes", "extremes", "strain_energy", "external_work", "reactions", "eigen", "critical")
# what is no answer: places, axes, and what every run has of its own
SKIPPED = ("x", "at", "frame", "axis_1", "normal", "distance")
ROUNDING = (
    1e-9  # of a quantity, and of the largest of its kind, up to which differences are those of rounding
)


@dataclass(frozen=True)
class Difference:
    """One quantity of two results.

    Attributes
    ----------
    what : str
        Dotted, as in result.json.
    first, second : number, list or text; None where it is missing
    relative : float
        Largest difference of a component over the largest size; infinite where one is missing.
    size : float, optional
        That size, of numbers.
    """

    what: str
    first: Any
    second: Any
    relative: float
    size: float | None = None


def differences(a: Result, b: Result, rounding: float = ROUNDING) -> list[Difference]:
    """All quantities that differ, the largest difference first.

    Parameters
    ----------
    rounding : float
        Of a quantity, and of the largest one of its kind (all moments of reactions, say): up to there it is the same.
    """
    first, second = a.to_dict(), b.to_dict()
    out = list(_of_documents(first, second))
    for name in {**first.get("cases", {}), **second.get("cases", {})}:
        one, other = first.get("cases", {}).get(name), second.get("cases", {}).get(name)
        if one is None or other is None:
            out.append(Difference(f"case {name}", _there(one), _there(other), np.inf))
        elif name not in (first.get("case"), second.get("case")):  # which the top level is
            out += _of_documents(one, other, f"case {name}: ")
    if np.array_equal(a.mesh.triangles, b.mesh.triangles) and np.array_equal(a.mesh.points, b.mesh.points):
        out += _of_fields(a, b)
    largest: dict[str, float] = {}
    for found in out:
        if found.size is not None:
            kind = _kind(found.what)
            largest[kind] = max(largest.get(kind, 0.0), found.size)

    def differs(d: Difference) -> bool:
        if d.size is None:
            return d.relative > 0.0
        return d.relative > rounding and d.relative * d.size > rounding * largest[_kind(d.what)]

    return sorted(filter(differs, out), key=lambda d: -d.relative)


def _kind(what: str) -> str:
    """What quantities of one unit have in common: the first and the last word of "reactions.left.moment"."""
    parts = what.rpartition(": ")[2].split(".")
    return f"{parts[0]}.{parts[-1]}"


def _there(value: Any) -> str | None:
    return None if value is None else "there"


def _of_documents(
    first: Mapping[str, Any], second: Mapping[str, Any], prefix: str = ""
) -> Iterator[Difference]:
    kinds = [
        f"{d['model']['kind']}, {d['model']['element']}, order {d['model']['order']}" for d in (first, second)
    ]
    if kinds[0] != kinds[1]:
        yield Difference(f"{prefix}model", kinds[0], kinds[1], np.inf)
    for key in NUMBERS:
        yield from _compared(f"{prefix}{key}", first.get(key), second.get(key))


def _compared(what: str, a: Any, b: Any) -> Iterator[Difference]:
    if isinstance(a, Mapping) and isinstance(b, Mapping):
        for key in {**a, **b}:
            if key not in SKIPPED:
                yield from _compared(f"{what}.{key}", a.get(key), b.get(key))
    elif _numeric(a) and _numeric(b) and np.shape(a) == np.shape(b):
        yield Difference(what, a, b, relative(a, b), _size(a, b))
    elif isinstance(a, list) and isinstance(b, list):
        for number in range(max(len(a), len(b))):
            pair = [part[number] if number < len(part) else None for part in (a, b)]
            yield from _compared(f"{what}.{number}", *pair)
    elif a != b:
        yield Difference(what, a, b, np.inf)


def _numeric(value: Any) -> bool:
    if isinstance(value, list):
        return bool(value) and all(map(_numeric, value))
    return isinstance(value, int | float) and not isinstance(value, bool)


def _size(a: Any, b: Any) -> float:
    """Of the largest component of two quantities."""
    return float(max(np.abs(np.asarray(part, dtype=float)).max(initial=0.0) for part in (a, b)))


def relative(a: Any, b: Any) -> float:
    """Largest difference of components over the largest size."""
    x, y = np.asarray(a, dtype=float), np.asarray(b, dtype=float)
    size = _size(x, y)
    return float(np.abs(x - y).max(initial=0.0) / size) if size > 0.0 else 0.0


def _of_fields(a: Result, b: Result) -> Iterator[Difference]:
    """Fields, each by its largest value."""
    for name in a.fields:
        if name in b.fields and a.fields[name].shape == b.fields[name].shape:
            one, other = a.fields[name], b.fields[name]
            largest = [float(np.abs(values).max(initial=0.0)) for values in (one, other)]
            share, size = relative(one, other), max(largest)
            yield Difference(f"field {name}, largest", largest[0], largest[1], share, size)
