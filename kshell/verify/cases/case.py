"""A case: a scene whose answer is known, the numbers to compare, and how close they must come.

References are data: references.json has, for each case, the values, their source and their relative
uncertainty; allowed.json has the largest relative error of each quantity on each mesh with each element,
about twice what was measured when the case was made, and the number of unknowns it took: a change that loses
digits or needs more unknowns fails. The meshes are structured, so the errors repeat.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

import kshell as ks
from kshell.verify.cases.quantities import Quantity

HERE = Path(__file__).parent
TRUE_SURFACE = 0
ON_MESH = {TRUE_SURFACE: "-chart", 1: "", 2: "-order2"}


@dataclass(frozen=True)
class Run:
    """One way to solve a case.

    Attributes
    ----------
    element : "argyris", "morley" or "koiter"
    refinement : int
        Passed to the case's mesh.
    order : 1, 2 or TRUE_SURFACE
        Of the mesh; the true surface has its mesh in the parameter plane of a chart.
    degree : 1, 2 or 3
        Of the Koiter element; 0 for elements of one degree only.
    """

    element: str
    refinement: int
    order: int = 1
    degree: int = 0

    @classmethod
    def of(cls, method: str, refinement: int, order: int = 1) -> Run:
        """From the name of a method, such as koiter3."""
        element = method.rstrip("123")
        return cls(element, refinement, order, int(method[len(element) :] or 0))

    @property
    def method(self) -> str:
        """The element with its degree: argyris, morley, koiter1, koiter2, koiter3."""
        return self.element + (str(self.degree) if self.degree else "")

    @property
    def name(self) -> str:
        """Such as argyris-8, argyris-8-order2, or koiter3-8-chart."""
        return f"{self.method}-{self.refinement}{ON_MESH[self.order]}"

    @property
    def options(self) -> dict[str, Any]:
        """For `kshell.solve`: the reference tells the error, so that none is estimated."""
        return {"element": self.element, "error": "off", **({"order": self.degree} if self.degree else {})}


def method_of(run: str) -> str:
    """The method in the name of a run."""
    return run.partition("-")[0]


@dataclass(frozen=True)
class Reference:
    """A known value.

    Attributes
    ----------
    value : float
    uncertainty : float
        Relative to the scale.
    scale : float
        What errors are relative to: the size of the value, or of others like it where it is zero.
    """

    value: float
    uncertainty: float
    scale: float

    def error(self, value: float) -> float:
        """Relative difference of a value from this one."""
        return abs(value - self.value) / self.scale


@dataclass(frozen=True)
class Outcome:
    """One number compared.

    Attributes
    ----------
    error, allowed : float
        Relative to the reference; nothing is allowed where none is recorded.
    most_unknowns : int
        As many as were recorded.
    """

    case: str
    run: str
    quantity: str
    unknowns: int
    value: float
    reference: float
    error: float
    allowed: float
    most_unknowns: int

    @property
    def passed(self) -> bool:
        """Whether the error is no more than allowed (a NaN is), with no more unknowns than recorded."""
        return self.error <= self.allowed and self.unknowns <= self.most_unknowns

    @property
    def used(self) -> float:
        """How much of the allowed error there is: above 1 it failed; infinite where nothing is recorded."""
        if not np.isfinite(self.error) or self.allowed == 0.0:
            return np.inf
        return self.error / self.allowed


@dataclass(frozen=True)
class Case:
    """A scene whose answer is known.

    Attributes
    ----------
    id : str
        family.what
    description : str
    build : function
        (refinement, order of the mesh) to the scene, with the options of its solve but element and degree.
    quantities : dict of str to Quantity
    runs : tuple of Run
    like : str
        The entry of the references: the id, but for half and quarter models.
    source : str
        Where the references come from.
    references : dict of str to Reference
        One for each quantity.
    allowed : dict of str to dict of str to float
        Largest relative error per run and quantity.
    most_unknowns : dict of str to int
        Per run.
    quick : tuple of str, optional
        Methods that the quick suite runs: none of a case that takes long, all where nothing is said.
    estimated : bool
        Whether errors are estimated, for quantities that are estimates.
    """

    id: str
    description: str
    build: Callable[[int, int], ks.Scene]
    quantities: Mapping[str, Quantity]
    runs: tuple[Run, ...]
    like: str
    source: str
    references: Mapping[str, Reference]
    allowed: Mapping[str, Mapping[str, float]]
    most_unknowns: Mapping[str, int]
    quick: tuple[str, ...] | None = None
    estimated: bool = False

    @property
    def family(self) -> str:
        """The first word of the id."""
        return self.id.partition(".")[0]

    @property
    def quick_runs(self) -> tuple[Run, ...]:
        """The first run of each method that is quick."""
        first: dict[str, Run] = {}
        for run in self.runs:
            if self.quick is None or run.method in self.quick:
                first.setdefault(run.method, run)
        return tuple(first.values())

    def solve(self, run: Run) -> ks.Result:
        """The result on one mesh with one element."""
        options = {**run.options, "error": "auto"} if self.estimated else run.options
        return ks.solve(self.build(run.refinement, run.order), **options)

    def compare(self, run: Run, result: ks.Result) -> list[Outcome]:
        """Each quantity the element gives, beside its reference."""
        allowed, most = self.allowed.get(run.name, {}), self.most_unknowns.get(run.name, 0)
        out = []
        for name, quantity in self.quantities.items():
            if run.element in quantity.elements:
                value, known, room = quantity.of(result), self.references[name], allowed.get(name, 0.0)
                numbers = (value, known.value, known.error(value), room, most)
                out.append(Outcome(self.id, run.name, name, result.unknowns, *numbers))
        return out


def case(
    id: str,
    description: str,
    build: Callable[[int, int], ks.Scene],
    quantities: Mapping[str, Quantity],
    runs: tuple[Run, ...],
    reference: str | None = None,
    quick: tuple[str, ...] | None = None,
    estimated: bool = False,
) -> Case:
    """A case with its references from references.json and its allowed errors from allowed.json.

    ``reference`` is the entry of the references where it is not the id, as for half and quarter models.
    """
    entry = _data("references.json")[reference or id]
    uncertainty, scales = entry["uncertainty"], entry.get("scales", {})
    references = {
        name: Reference(
            entry["values"][name],
            uncertainty[name] if isinstance(uncertainty, dict) else uncertainty,
            scales.get(name, abs(entry["values"][name])),
        )
        for name in quantities
    }
    recorded = _data("allowed.json").get(id, {})
    allowed = {run: entry["errors"] for run, entry in recorded.items()}
    most = {run: entry["unknowns"] for run, entry in recorded.items()}
    return Case(
        id, description, build, quantities, runs, reference or id, entry["source"], references, allowed, most,
        quick, estimated,
    )  # fmt: skip


def reference_names(id: str) -> dict[str, float]:
    """The values in an entry of the references, by name."""
    return dict(_data("references.json")[id]["values"])


@cache
def _data(name: str) -> dict[str, Any]:
    return json.loads((HERE / name).read_text(encoding="utf-8"))
