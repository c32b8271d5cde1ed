"""The classical study of convergence: one scene on meshes that are halved, rates, and what they tend to.

With v_1, v_2, v_3 on meshes of sizes 4 h, 2 h, h, the observed rate is p = log2((v_1 - v_2) / (v_2 - v_3)) and the
value they tend to v_3 + (v_3 - v_2) / (2^p - 1). Both suppose an error like h^p: near corners p is far from the order
of the element, and where the differences change their sign there is none.

Source: Richardson, Phil. Trans. R. Soc. A 210 (1911) 307-357; Roache, J. Fluids Eng. 116 (1994) 405-413.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from kshell.analysis.clock import Clock
from kshell.analysis.refined_mesh import Refiner, shape_is_known
from kshell.analysis.run import Run
from kshell.analysis.static import answer_once
from kshell.errors import InputError
from kshell.mesh.refine import longest_first
from kshell.scene.options import SolveOptions
from kshell.scene.scene import Scene
from kshell.scene.structure import resolve

LEVELS = 4
ROUNDING = 1e-11  # relative difference of values from which no rate is read


@dataclass
class Series:
    """One element on all meshes.

    Attributes
    ----------
    element : str
    order : int
    unknowns : list of int
    size : list of float
        Square root of the mean area of the triangles, twice.
    seconds : list of float
    values : dict of str to list of float
        "energy", and the largest component of the displacement of each probe, "NAME u_z".
    """

    element: str
    order: int
    unknowns: list[int] = field(default_factory=list)
    size: list[float] = field(default_factory=list)
    seconds: list[float] = field(default_factory=list)
    values: dict[str, list[float]] = field(default_factory=dict)

    def rates(self, name: str) -> list[float | None]:
        """Observed rate at each mesh from the third on; None where the differences change sign or are rounding."""
        v = self.values[name]
        return [None, None, *(_rate(*v[k - 2 : k + 1]) for k in range(2, len(v)))][: len(v)]

    def limit(self, name: str) -> float | None:
        """What the values tend to by Richardson; None where the last three have no rate."""
        v, rate = self.values[name], self.rates(name)[-1]
        if rate is None or rate <= 0.0:
            return None
        return v[-1] + (v[-1] - v[-2]) / (2.0**rate - 1.0)


@dataclass
class Convergence:
    """A study of convergence: what `converge` gives.

    Attributes
    ----------
    title : str
    series : list of Series
    notes : list of str
        What the reader must know.
    """

    title: str
    series: list[Series]
    notes: list[str] = field(default_factory=list)

    def to_dict(self) -> dict[str, Any]:
        """Plain numbers, text, lists and dicts."""
        return {
            "title": self.title,
            "notes": self.notes,
            "series": [
                {
                    "element": s.element,
                    "order": s.order,
                    "unknowns": s.unknowns,
                    "size": s.size,
                    "seconds": s.seconds,
                    "values": {
                        name: {"value": v, "rate": s.rates(name), "limit": s.limit(name)}
                        for name, v in s.values.items()
                    },
                }
                for s in self.series
            ],
        }


def _rate(first: float, second: float, third: float) -> float | None:
    before, after = first - second, second - third
    if min(abs(before), abs(after)) <= ROUNDING * abs(third) or before * after <= 0.0:
        return None
    return float(np.log2(before / after))


def converge(
    scene: Scene,
    levels: int = LEVELS,
    *,
    progress: Callable[[str], None] | None = None,
    allow_system: bool = False,
    **options: Any,
) -> Convergence:
    """One scene on meshes that are halved, with the elements and orders that suit it.

    Parameters
    ----------
    scene : Scene
    levels : int
        How many meshes, at least 3: the first as it is, each further one with four triangles for every one before.
    progress, allow_system, **options :
        As for `solve`; an element or order asked for is the only one.

    Returns
    -------
    Convergence

    Raises
    ------
    InputError
        If the scene or an option is wrong, or the levels are fewer than 3.
    SolveError
        If there is no answer on some mesh.
    """
    if isinstance(levels, bool) or not isinstance(levels, int) or levels < 3:
        raise InputError(f"levels = {levels!r}: rates take 3 meshes at least, give a whole number > 2")
    if scene.cases:
        raise InputError("converge with load cases: take one, converge(scene.of_case(name))")
    chosen = scene.solve.updated(**options).updated(tolerance=None, error="off")
    if chosen.analysis != "static":
        raise InputError(f'converge is for static scenes, this one has analysis = "{chosen.analysis}"')
    structure = resolve(scene, scene.read_mesh(allow_system))
    run = Run(scene, structure, chosen, Clock(progress), progress, allow_system=allow_system)
    first = answer_once(run.model(), run)
    large = bool(first.result.model["large_deflection"])
    kind = first.model.kind
    out = Convergence(scene.title, [])
    for way in _ways(kind, chosen):
        own = run.with_options(model=kind, large_deflection=large, **way)
        out.series.append(_series(own, levels))
    if not shape_is_known(scene) and kind == "shell" and structure.space.midpoints is not None:
        out.notes.append(
            "new nodes lie on the quadratic triangles of the first mesh: the values tend to those of its shape; give "
            "its geometry, or a chart"
        )
    return out


def _ways(kind: str, options: SolveOptions) -> list[dict[str, Any]]:
    if options.element != "auto" or options.order != "auto":
        return [{}]
    if kind == "plate":
        return [{"element": "morley"}, {"element": "argyris"}]
    return [{"element": "koiter", "order": 2}, {"element": "koiter", "order": 3}]


def _series(run: Run, levels: int) -> Series:
    out: Series | None = None
    mesh = longest_first(run.structure.parameters)
    axis: dict[str, int] = {}
    refiner: Refiner | None = None
    for level in range(levels):
        before = time.perf_counter()
        here = run.on_mesh(mesh)
        answered = answer_once(here.model(), here)
        result, model = answered.result, answered.model
        if out is None:
            out = Series(model.element, model.order)
        out.unknowns.append(result.unknowns)
        out.size.append(float(np.sqrt(2.0 * here.structure.space.areas.mean())))
        out.seconds.append(time.perf_counter() - before)
        out.values.setdefault("energy", []).append(float(result.strain_energy))
        for name, probe in result.probes.items():
            along = axis.setdefault(name, int(np.abs(probe["u"]).argmax()))
            out.values.setdefault(f"{name} u_{'xyz'[along]}", []).append(float(probe["u"][along]))
        run.tell(f"{model.element} {model.order}, mesh {level + 1}: {result.unknowns} unknowns")
        if level + 1 < levels:
            refiner = Refiner(run.scene, model, run.allow_system) if refiner is None else refiner
            mesh = refiner.refined(mesh, np.arange(len(mesh.triangles)))
    assert out is not None
    return out
