"""Which model a scene asks for: plate or shell, with which element, and why, in words.

A plate in its plane z = const bends only. Everything else is a shell, which bends and stretches: surfaces
in space, and flat meshes whose loads, supports or layers stretch them.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np

from kshell.analysis.sense import BENDING, at_rest_first, require_plate, require_sense, shaking, yields
from kshell.errors import InputError
from kshell.material.laminate import NEGLIGIBLE_COUPLING
from kshell.mesh.check import is_flat
from kshell.mesh.facets import facets
from kshell.mesh.facing import top_words
from kshell.mesh.words import shown
from kshell.scene.loads import Temperature, exceeds
from kshell.scene.options import SolveOptions
from kshell.scene.placed import Placed
from kshell.scene.structure import Structure
from kshell.scene.supports import Elastic, Hinge, RigidLink, Support
from kshell.scene.thermal import couples
from kshell.shell.limits import THINNEST, USE_KOITER
from kshell.shell.reference import LARGEST_ORDER
from kshell.solvers.memory import SHARE, available_bytes
from kshell.values.varying import is_constant

# up to here a factorisation of the Argyris matrix takes seconds; beyond, Morley keeps it there
ARGYRIS_UP_TO = 100_000
ORDERS = {"morley": 2, "argyris": 5}
DERIVATIVES = 2  # of charts, which Argyris elements look at
# order of HHJ plates up to so many triangles: few elements of a high order cost least where the deflection is smooth,
# meshes of many are graded toward what is not
HHJ_ORDERS = ((6, 200.0), (5, 2000.0), (4, 20000.0), (3, np.inf))
# peak memory of a solve with cubics, in bytes per triangle, measured at 5,000 and 10,000 triangles with a reserve
CUBICS_BYTES = 180e3


@dataclass(frozen=True)
class ModelChoice:
    """A model and why it was taken.

    Attributes
    ----------
    kind : "plate" or "shell"
    element : str
        Of a shell "koiter" or "argyris"; of a plate "argyris", "morley" or "hhj".
    order : int
        Polynomial degree.
    reasons : tuple of str
    """

    kind: Literal["plate", "shell"]
    element: str
    order: int
    reasons: tuple[str, ...]


def choose_model(structure: Structure, options: SolveOptions) -> ModelChoice:
    """The model asked for, or the cheapest one that has everything in the structure.

    Raises
    ------
    InputError
        If options contradict each other or the structure.
    """
    require_sense(structure, options)
    kind, why = _kind(structure, options)
    if kind == "plate":
        require_plate(structure)
        return _plate(structure, options, why)
    if options.solver == "multigrid":
        raise InputError('solver = "multigrid" is for plates: shells are solved with "direct" or "auto"')
    if options.element == "argyris" and structure.chart is None:
        raise InputError(
            'element = "argyris" takes a shell on a chart only (key chart, with the mesh in its parameter plane): '
            'leave element out, or take "koiter"'
        )
    if structure.chart is not None and options.order == "auto" and options.element in ("auto", "argyris"):
        return _on_chart(structure, options, why)
    order, reason = _order(structure, options)
    asked = (
        "as asked for"
        if options.element == "koiter"
        else "for surfaces with folds, branches and any curvature"
    )
    mesh = structure.parameters
    shape = () if mesh.curving is None else (f"shape: {mesh.curving.reason}",)
    top = tuple(f"top: {words}" for words in top_words(structure.space))
    return ModelChoice("shell", "koiter", order, (why, f"element koiter: {asked}", reason, *shape, *top))


def _plate(structure: Structure, options: SolveOptions, why: str) -> ModelChoice:
    """The element asked for, or the one that suits the size of the mesh."""
    n, element = len(structure.space.triangles), options.element
    if element in ("hhj", "koiter") or options.order != "auto":
        reason = "element hhj: " + ("as asked for" if element != "auto" else "it has that order")
        if options.order != "auto":
            order, which = int(options.order), f"order {options.order}: as asked for"
        else:
            order, limit = next(pair for pair in HHJ_ORDERS if n <= pair[1])
            which = f"order {order}: up to {limit:g} triangles" if np.isfinite(limit) else f"order {order}"
            which += ", few elements of a high order"
        return ModelChoice("plate", "hhj", order, (why, reason, which))
    if element != "auto":
        reason = f"element {element}: as asked for"
    elif n <= ARGYRIS_UP_TO:
        element = "argyris"
        reason = f"element argyris: {n} triangles are few enough for quintics, the most accurate choice"
    else:
        element = "morley"
        reason = (
            f"element morley: {n} triangles are more than {ARGYRIS_UP_TO}, where quintics would take long; "
            'element = "argyris" has them all the same'
        )
    return ModelChoice("plate", element, ORDERS[element], (why, reason))


def _kind(structure: Structure, options: SolveOptions) -> tuple[Literal["plate", "shell"], str]:
    mesh, chart = structure.parameters, structure.chart
    if options.model != "auto":
        return options.model, f"kind {options.model}: as asked for"
    if chart is not None:
        return "shell", f"kind shell: the mesh lies in the parameter plane of {shown(chart)}"
    middles = mesh.midpoints
    flat = mesh.is_flat if middles is None else is_flat(np.concatenate([mesh.points, middles]))
    if options.element == "hhj":
        return "plate", "kind plate: element hhj was asked for"
    if options.element == "koiter" or options.order != "auto":
        return "shell", "kind shell: the Koiter element was asked for"
    if options.element in ("morley", "hhj") or (
        options.element == "argyris" and flat and not options.large_asked
    ):
        return "plate", f"kind plate: element {options.element} was asked for"
    if not flat:
        return "shell", "kind shell: the mesh does not lie in a plane z = const"
    if (
        options.large_asked
        or (options.analysis == "dynamic" and options.large_deflection is not False)
        or structure.touching
        or yields(structure, options)
    ):
        return "shell", "kind shell: large deflections of a flat mesh stretch it"
    bends = options.analysis in BENDING
    rest = at_rest_first(options)
    stretching = next(_stretching(shaking(structure) if rest else structure, not bends, rest), None)
    if stretching is None and bends:
        return "plate", "kind plate: the mesh is flat, its modes are those of bending"
    if stretching is None:
        return "plate", "kind plate: the mesh is flat, bending alone describes it"
    return "shell", f"kind shell: the mesh is flat, but {stretching}"


def _stretching(structure: Structure, moved: bool, rest: bool = False) -> Iterator[str]:
    """What in a flat structure stretches the plate in its plane, in words.

    Parameters
    ----------
    moved : bool
        Whether loads and motions there count, too.
    rest : bool
        Whether motions with fixed = true are those of the state at rest, and do not.
    """
    mesh = structure.space
    if structure.section.coupling_ratio > NEGLIGIBLE_COUPLING:
        yield "the layers are not symmetric about their middle, so bending stretches them"
    if structure.offset.any():
        yield "the material lies off the mesh, so bending stretches it"
    if structure.imperfection is not None:
        yield "its imperfection curves it"
    for held in structure.supports:
        support = held.item
        if isinstance(support, Hinge):
            yield f"{support} is a hinge line"
        elif isinstance(support, RigidLink):
            yield f"{support} moves in space"
        elif getattr(support, "axes", None) is not None:
            yield f"{support} has axes of its own"
        elif moved and support.value is not None and not (rest and support.fixed):
            value = support.translation_at(held.vertices(mesh))
            if exceeds(value[:, :2], value):
                yield f"{support} moves it in its plane"
    for placed in structure.loads if moved else ():
        words = placed.item.stretches(placed.places(mesh))
        if words:
            yield f"{placed.item} {words}"
        elif isinstance(placed.item, Temperature) and couples(placed.item, structure.section):
            yield f"{placed.item} bends and stretches it at once, because its layers expand differently"


def _on_chart(structure: Structure, options: SolveOptions, why: str) -> ModelChoice:
    from kshell.shell.chart.lines import large_across_lines

    if options.element == "argyris":
        across = large_across_lines(structure) if _finite(options) else ""
        if across:
            raise InputError(f'element = "argyris": {across}: {USE_KOITER}, or leave element out')
        return ModelChoice("shell", "argyris", 5, (why, "element argyris: as asked for"))
    thickness, size = float(structure.thickness.max()), _size_on_chart(structure)
    beyond = _beyond_argyris(structure, options)
    if thickness >= THINNEST * size and not beyond:
        reason = (
            "element argyris: the chart is smooth and not very thin, so quintics need the fewest unknowns"
        )
        return ModelChoice("shell", "argyris", 5, (why, reason))
    order, reason = _order(structure, options)
    what = beyond or f"thickness {thickness:.3g} is small against the size {size:.3g}: no locking"
    return ModelChoice("shell", "koiter", order, (why, f"element koiter: {what}", reason))


def _finite(options: SolveOptions) -> bool:
    """Whether the analysis goes beyond the linear solution."""
    if options.analysis == "dynamic":
        return options.large_deflection is not False
    return options.large_asked or options.prestress or options.analysis == "buckling"


def _beyond_argyris(structure: Structure, options: SolveOptions) -> str:
    """What the Argyris element on charts does not have, in words; empty if it has everything."""
    from kshell.shell.chart.lines import has_curved_edges, large_across_lines

    given = structure.chart.map.highest
    if given < DERIVATIVES:
        return f"the chart has derivatives up to order {given} only"
    if structure.section.inelastic() and options.analysis in ("static", "path", "dynamic"):
        return "the material remembers its past"
    if structure.imperfection is not None:
        return "the imperfection moves its nodes"
    if has_curved_edges(structure.parameters):
        return "edges of the mesh are curved in the plane of the parameters"
    for held in structure.supports:
        if isinstance(held.item, RigidLink) or _held_by_koiter_only(held):
            return f"{held.item} needs it"
        if held.item.rotation is not None:
            return f"{held.item} prescribes a rotation"
    for placed in structure.loads:
        if getattr(placed.item, "follower", False):
            return f"{placed.item} needs it"
    return large_across_lines(structure) if _finite(options) else ""


def _held_by_koiter_only(held: Placed[Support]) -> bool:
    """Surfaces that may not turn though they move, or that move by different amounts."""
    support = held.item
    if held.place is None or held.place.dimension != 2 or isinstance(support, Elastic):
        return False
    turned = "r" in support.freedoms and not set("xyz") <= set(support.freedoms)
    return turned or (support.value is not None and not is_constant(support.value))


def _size_on_chart(structure: Structure) -> float:
    return float(np.linalg.norm(np.ptp(structure.space.points, axis=0)))


def _order(structure: Structure, options: SolveOptions) -> tuple[int, str]:
    if options.order != "auto":
        if options.order > LARGEST_ORDER:
            raise InputError(
                f"order = {options.order}: the Koiter element of shells has orders up to {LARGEST_ORDER}; higher ones "
                'are those of plates, element = "hhj"'
            )
        return options.order, f"order {options.order}: as asked for"
    if yields(structure, options):
        return 1, "order 1: the section yields, triangle by triangle"
    mesh = structure.parameters
    if mesh.curving is not None and mesh.curving.order < 3:
        return mesh.curving.order, f"order {mesh.curving.order}: as good as the shape is known"
    true_shape = structure.chart is not None or mesh.curving is not None or facets(mesh) is None
    if not true_shape:
        return (
            2,
            "order 2: the mesh has flat triangles (order 1), whose shape limits the accuracy of higher orders",
        )
    return true_shape_order(len(mesh.triangles), available_bytes())


def true_shape_order(triangles: int, available: float) -> tuple[int, str]:
    """Order of the Koiter element on triangles of true shape, and why.

    Cubics cost 1.8 times the time of quadratics on the same mesh and are more accurate than those on a mesh of 64
    times as many triangles (Scordelis-Lo roof: 5e-7 with 80, quadratics 8e-6 with 1,280), so whoever refines a mesh
    must never be given quadratics instead, unless cubics do not fit into the memory.

    Parameters
    ----------
    triangles : int
    available : float or None
        Bytes; None where the system does not say.
    """
    need = CUBICS_BYTES * triangles
    if available is None or need <= SHARE * available:
        return 3, "order 3: cubics, accurate on few triangles of true shape; orders 4 to 6 are more so"
    return 2, (
        f"order 2: cubics on {triangles} triangles would take about {need / 1e9:.2g} GB, of {available / 1e9:.2g} GB "
        f"that are left; they would be more accurate on a mesh of {int(SHARE * available / CUBICS_BYTES)} triangles "
        "than quadratics on this one"
    )
