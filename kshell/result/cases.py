"""Results of several load cases in one: warnings said once, and the envelope with the case that governs.

The envelope is over all cases and combinations. Of every field, and of every value at a probe, it holds component by
component the smallest and the largest value, and the case each comes from.
"""

from __future__ import annotations

import copy
from collections.abc import Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from kshell.result.deferred import Deferred

if TYPE_CHECKING:
    from kshell.result.result import Result

Floats = NDArray[np.float64]

# what an envelope means nothing of: places and axes
NO_EXTREMES = ("x", "axis_1", "frame_axis_1", "normal", "distance")


def gathered(found: Mapping[str, Result], combinations: Mapping[str, Mapping[str, float]]) -> Result:
    """A result with those of all cases: the first of them, with the others under `cases`.

    Parameters
    ----------
    found : dict of str to Result
        In their order, at least one.
    combinations : dict of str to dict
        Factors of the cases in those that are combinations.
    """
    names = list(found)
    top = copy.copy(found[names[0]])
    top.case, top.cases = names[0], dict(found)
    top.combinations = {name: dict(factors) for name, factors in combinations.items()}
    top.warnings = _said_once({name: result.warnings for name, result in found.items()})
    return top


def _said_once(warnings: Mapping[str, Sequence[str]]) -> list[str]:
    """Warnings of all cases; those that not all cases have with the names of those that do."""
    out = []
    for words in dict.fromkeys(words for each in warnings.values() for words in each):
        having = [name for name, each in warnings.items() if words in each]
        if len(having) == len(warnings):
            out.append(words)
        else:
            cases = ", ".join(f'"{name}"' for name in having)
            out.append(f"{'case' if len(having) == 1 else 'cases'} {cases}: {words}")
    return out


def _is_quantity(name: str) -> bool:
    """Whether one value of it can be more than another."""
    return name not in NO_EXTREMES and not name.startswith("principal_directions")


def envelope_of(values: Sequence[Any], names: Sequence[str]) -> dict[str, Any]:
    """Smallest and largest of one value, number or array, in each case, with the names of the cases."""
    stack = np.array([np.asarray(value, dtype=float) for value in values])
    low, high = stack.argmin(axis=0), stack.argmax(axis=0)
    label = np.array(names, dtype=object)
    return {
        "min": stack.min(axis=0),
        "max": stack.max(axis=0),
        "min_case": label[low].tolist() if low.ndim else names[int(low)],
        "max_case": label[high].tolist() if high.ndim else names[int(high)],
    }


class Envelope:
    """Smallest and largest values of all cases.

    Parameters
    ----------
    cases : dict of str to Result
        On the same mesh.

    Attributes
    ----------
    names : list of str
        Of the cases, by their numbers.
    fields : dict of str to dict
        Of every field that all cases have on the same rows: "min" and "max", like the field, and "min_case" and
        "max_case", numbers of cases.
    """

    def __init__(self, cases: Mapping[str, Result]) -> None:
        self._cases, self.names = cases, list(cases)
        results = list(cases.values())
        alike = all(np.array_equal(other.vertex, results[0].vertex) for other in results)
        shared = [
            name
            for name in results[0].fields
            if alike and _is_quantity(name) and all(name in r.fields for r in results)
        ]
        self.fields: Deferred[dict[str, NDArray[Any]]] = Deferred(
            {name: partial(self._field, name) for name in shared}
        )

    def _field(self, name: str) -> dict[str, NDArray[Any]]:
        first, *others = (result.fields[name] for result in self._cases.values())
        low, high = first.copy(), first.copy()
        low_case, high_case = np.zeros(first.shape, np.int32), np.zeros(first.shape, np.int32)
        for number, values in enumerate(others, 1):
            below, above = values < low, values > high
            low[below], low_case[below] = values[below], number
            high[above], high_case[above] = values[above], number
        return {"min": low, "max": high, "min_case": low_case, "max_case": high_case}

    @property
    def probes(self) -> dict[str, dict[str, Any]]:
        """Per probe and quantity min, max, min_case and max_case, component by component."""
        results = list(self._cases.values())
        out: dict[str, dict[str, Any]] = {}
        for probe, quantities in results[0].probes.items():
            out[probe] = {}
            for key in quantities:
                values = [r.probes[probe].get(key) for r in results]
                if _is_quantity(key) and all(_numbers(value) for value in values):
                    out[probe][key] = envelope_of(values, self.names)
        return out

    @property
    def extremes(self) -> dict[str, dict[str, Any]]:
        """The largest in size of the extremes of all cases, with the case."""
        out: dict[str, dict[str, Any]] = {}
        for name, result in self._cases.items():
            for key, extreme in result.extremes.items():
                if key not in out or abs(extreme["value"]) > abs(out[key]["value"]):
                    out[key] = {**extreme, "case": name}
        return out

    @property
    def reactions(self) -> dict[str, dict[str, Any]]:
        """Per support group and of force and moment min, max, min_case and max_case, component by component."""
        results = list(self._cases.values())
        shared = [group for group in results[0].reactions if all(group in r.reactions for r in results)]
        return {
            group: {
                key: envelope_of([r.reactions[group][key] for r in results], self.names)
                for key in ("force", "moment")
            }
            for group in shared
        }

    def to_dict(self) -> dict[str, Any]:
        """The entry "envelope" of result.json."""
        return {"probes": self.probes, "extremes": self.extremes, "reactions": self.reactions}

    def as_result(self) -> Result:
        """Fields min_NAME, max_NAME, min_case_NAME and max_case_NAME of every field, for files and pictures."""

        def values(name: str, which: str) -> NDArray[Any]:
            return self.fields[name][which]

        fields = {
            f"{which}_{name}": partial(values, name, which)
            for name in self.fields
            for which in ("min", "max", "min_case", "max_case")
        }
        first = copy.copy(next(iter(self._cases.values())))
        first.fields, first.edge_fields, first.cell_fields = Deferred(fields), {}, {}
        return first


def _numbers(value: Any) -> bool:
    if isinstance(value, bool | str) or value is None or isinstance(value, Mapping):
        return False
    return np.asarray(value).dtype.kind in "if"
