"""Element and order of plates to a tolerance, where none is named.

Measured on the plates of `kshell verify` with known deflections, CPU time of the whole refinement, to 1e-4, 1e-6 and
1e-8. Straight edges: Argyris elements, since guaranteed bounds rest on them. Curved edges, where both elements have
estimates alone: HHJ elements of order 6 take 75, 134 and 249 ms for a clamped annulus, Argyris 186, 591 ms and not
reached. Orders 4 and 8 take 84 and 129, 306 and 113, 522 (not reached) and 256 ms; the graded meshes of corners make
order 6 the cheapest to 1e-8, too.
"""

from __future__ import annotations

from typing import Any

from kshell.analysis.run import Run
from kshell.equilibrium.model import Model
from kshell.errors import InputError
from kshell.plate.corner_exponents import corner_exponents
from kshell.plate.domain import Domain
from kshell.plate.hhj.model import HHJModel
from kshell.plate.model import PlateModel

# order by the tolerance: of smooth deflections, and of those with corners where moments grow without bound
SMOOTH = ((1e-4, 5), (1e-8, 6), (0.0, 8))
SINGULAR = ((1e-4, 5), (0.0, 6))
MOST = 2000  # triangles of the first mesh up to which high orders cost little


def has_curved_edges(model: PlateModel | HHJModel) -> bool:
    """Whether edges of the plate are curved; a mesh of order 2 may have straight ones."""
    problem = model.problem
    return bool(Domain(problem.mesh, True, problem.domain.bent).curves.curved.any())


def chosen(model: Model, run: Run) -> tuple[Model, tuple[str, ...]]:
    """The model that a tolerance is reached with, and why; the same, and nothing, where the user has named one."""
    options, tolerance = run.options, float(run.options.tolerance)
    if options.order != "auto" or not isinstance(model, PlateModel | HHJModel):
        return model, ()
    named = options.element in ("hhj", "koiter")
    if not named and not (
        options.element == "auto" and model.element == "argyris" and has_curved_edges(model)
    ):
        return model, ()
    if len(model.structure.space.triangles) > MOST and named:
        return model, ()
    smooth = not corner_exponents(model.problem)
    order = next(order for least, order in (SMOOTH if smooth else SINGULAR) if tolerance >= least)
    held: dict[str, Any] = {"model": "plate", "element": "hhj", "order": order}
    try:
        found = run.with_options(**held).model()
    except InputError:  # what this element does not have
        return model, ()
    where = "is smooth" if smooth else "has corners where moments grow without bound"
    element = "as asked for" if named else "with curved edges it reaches a tolerance with the least time"
    return found, (
        f"element hhj: {element}",
        f"order {order}: for a tolerance of {tolerance:g}, where the deflection {where}",
    )
