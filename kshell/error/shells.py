"""Estimates for Koiter shells: small deflections, and the end state of large ones."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.equilibrium.problem import State
from kshell.error.assessment import ENERGY, Assessment, Interval
from kshell.error.averages import Averages
from kshell.error.chords import TOLD, share_of_flat_parts, words
from kshell.error.estimate import Estimate
from kshell.error.geometry_share import (
    MOST_OF_FACETS,
    curvature_of_triangles,
    domed,
    share_of_chart,
    share_of_cut_quadratics,
    share_of_facets,
    share_of_quadratics,
    turn_between,
    turn_of_triangles,
    weighted,
)
from kshell.errors import SolveError
from kshell.mesh.higher import order_of
from kshell.result.result import Result
from kshell.shell.koiter.model import KoiterModel
from kshell.shell.koiter.recovery import energies

Floats = NDArray[np.float64]
Solve = Callable[[Floats], Floats]

SAFETY = 2.0  # of the sum over triangles, see averages.py
# the same under large deflections: on a strip of single triangles bent to 0.7 of its length twice the sum missed by up
# to 4.6 times with order 2, by 2.6 times with order 3
SAFETY_LARGE = 10.0
# of 2 sum share_T sqrt(U_T U*_T), what shapes change of a displacement at most; U* is the energy of its dual. Where
# these energies lie apart, as those of a tube that widens under pressure and of its ovalling, that is much more than
# the share of U: 350 times for t / R = .01 and quadratic triangles; w was off by up to .13 of that sum
APART = 0.3
STEP = 1e-6  # of the finite differences of strains, relative to the size of the shell
SAFETY_FIRST = 5.0  # of order 1: of 73 folded shells 13 were outside twice the sum, by up to 2.5 times
# of the interval, times what twice the sum is of the energy: where it is much of it, forces and moments do not yet
# follow the truth (of 170 coarse folded and curved shells of orders 2 to 4 with more than a tenth, 21 were outside, by
# up to 2.5 times)
COARSE = 6.0
# of all of the motion of a probe, what components across it are known to at best: they come of what is left of it at a
# support, far from where their duals are (three parts that meet in a T and swing about one end of the third: .03 beside
# 2.2 was off by 2.6 times its interval, by .06 of that of the whole). What nothing couples is known by itself
ACROSS, COUPLED = 0.1, 1e-6
FACETED = (
    "flat triangles stand for a curved surface and meet at such angles that stiffness may be wrong by any factor: mesh "
    "with order 2, name the geometry the mesh was made from, or give the chart"
)
WHY_NOT = "averages of forces and moments are no proof"
UNSTABLE = "the tangent at the end state is singular: its dual does not exist"


def assess_small(
    model: KoiterModel, x: Floats, result: Result, duals: int, names: Sequence[str]
) -> Assessment:
    """Of small deflections x; at most so many dual solutions, for the first of the named probes."""
    problem = model.problem
    if "averages" not in model.estimates:
        model.estimates["averages"] = Averages(problem)
    averages: Averages = model.estimates["averages"]
    strain = problem.energy.linear_strain(x)
    if problem.loads.initial is not None:
        strain = strain - problem.loads.initial
    return _assess(
        model,
        averages,
        strain,
        result,
        (duals, names),
        model.respond,
        problem.energy.linear_strain,
        SAFETY if model.order > 1 else SAFETY_FIRST,
        model.estimates,
    )


def assess_state(
    model: KoiterModel, state: State, result: Result, duals: int, names: Sequence[str]
) -> Assessment:
    """Of the end state of large deflections, with duals of its tangent."""
    problem = model.problem
    equilibrium = model.equilibrium()
    initial = problem.loads.initial
    energy = problem.energy
    strain = energy.strain(state.x, state.memory)
    averages = Averages(problem)
    evaluated, _, _ = equilibrium.evaluate(state.x, state.factor, 2, state.memory)
    try:
        tangent = equilibrium.factorise(evaluated.hessian)
    except SolveError:
        return Assessment(why_not=UNSTABLE)

    def change(z: Floats) -> Floats:
        step = STEP * problem.space.size / max(float(np.abs(z).max()), 1e-300)
        ahead, back = (energy.strain(state.x + s * z, state.memory) for s in (step, -step))
        return np.asarray((ahead - back) / (2.0 * step))

    own = strain if initial is None else strain - state.factor * initial
    return _assess(model, averages, own, result, (duals, names), tangent.solve, change, SAFETY_LARGE)


def _assess(
    model: KoiterModel,
    averages: Averages,
    strain: Floats,
    result: Result,
    duals: tuple[int, Sequence[str]],
    solve: Solve,
    strain_of: Callable[[Floats], Floats],
    safety: float,
    kept: dict[Any, Any] | None = None,
) -> Assessment:
    """`kept` has the axes along which probes move, by probe, and the estimates of duals, by probe and axis."""
    kept = {} if kept is None else kept
    problem = model.problem
    basis = problem.reduction.basis
    transposed = basis.T
    own = averages.local(strain)
    membrane, bending = energies(problem.energy, strain)
    shares, stored = _shares(model, membrane, bending), membrane + bending
    total = float(own.sum())
    seen = float((own / averages.hidden).sum())
    safety *= 1.0 + COARSE * min(seen / max(result.strain_energy, 1e-300), 1.0)
    out = Assessment(why_not=averages.why_not or WHY_NOT, told=averages.told)
    unknown = 0.0 if averages.told else np.inf
    half = 0.5 * safety * total + unknown
    out.energy = Estimate(result.strain_energy, half, half / (2.0 * safety), "estimated", WHY_NOT)
    out.marks[ENERGY] = own
    out.parts[ENERGY] = 0.5 * safety * own
    left, names = duals
    for name in names:
        rows: dict[int, Floats] = {}
        if name not in kept or any((name, k) not in kept for k in kept[name]):
            every = (np.asarray(transposed @ model.probe_row(name, letter)) for letter in "xyz")
            rows = {k: row for k, row in enumerate(every) if np.any(row)}
            kept[name] = tuple(rows)
        moving: tuple[int, ...] = kept[name]
        if len(moving) > left:
            break
        left -= len(moving)
        width = np.full(3, unknown)
        mark, bent = np.zeros(len(own)), np.zeros(len(own))
        for k in moving:
            if (name, k) not in kept:
                dual = strain_of(basis @ solve(rows[k]))
                kept[name, k] = averages.local(dual), sum(energies(problem.energy, dual))
            its_own, its_energy = kept[name, k]
            both = np.sqrt(own * its_own)
            width[k] = safety * float(both.sum()) + unknown
            mark += both
            bent += its_energy
        whole = float(np.linalg.norm(width))
        width = np.where(width > COUPLED * whole, np.maximum(width, ACROSS * whole), width)
        value = result.motion_at_probe(name)
        size = float(np.linalg.norm(value))
        if problem.structure.chart is None and problem.space.midpoints is not None and size > 0.0:
            out.shape_marks[name] = APART * 2.0 * shares * np.sqrt(stored * bent) / size
            out.shapes[name] = float(out.shape_marks[name].sum())
        out.probes[name] = Interval(value, width, width / (2.0 * safety), "estimated")
        out.marks[name], out.parts[name] = mark, safety * mark
    borders = share_at_borders(model)
    if borders > TOLD:
        result.warnings.append(words(borders))
    out.geometry = weighted(shares, stored) + borders
    if problem.space.midpoints is None and problem.structure.chart is None and out.geometry >= MOST_OF_FACETS:
        out.without_any(FACETED)
    out.size = abs(float(result.extremes["deflection"]["value"]))
    return out


def geometry_share(model: KoiterModel, strain: Floats) -> float:
    """Relative error because of the shape of the triangles; strains (triangle, 2 r) tell where the energy is."""
    membrane, bending = energies(model.problem.energy, strain)
    return weighted(_shares(model, membrane, bending), membrane + bending) + share_at_borders(model)


def share_at_borders(model: KoiterModel) -> float:
    """The same because curved borders of flat parts are chords."""
    if "borders" not in model.estimates:  # as the mesh, the same under all loads
        pieces = model.problem.discretisation.patches()[0]
        model.estimates["borders"] = share_of_flat_parts(model.problem.space, pieces)
    return float(model.estimates["borders"])


def share_when_cut(model: KoiterModel, strain: Floats) -> float:
    """The same of finer meshes, whose new nodes lie on the triangles of this one."""
    membrane, bending = energies(model.problem.energy, strain)
    mesh = model.problem.space
    if mesh.midpoints is None:
        return geometry_share(model, strain)
    stretched = membrane / np.maximum(membrane + bending, 1e-300)
    cut = weighted(share_of_cut_quadratics(turn_of_triangles(mesh), stretched), membrane + bending)
    return cut + share_at_borders(model)


def shape_marks(model: KoiterModel, strain: Floats) -> Floats:
    """(triangle,) what each triangle adds to that."""
    membrane, bending = energies(model.problem.energy, strain)
    return np.asarray(_shares(model, membrane, bending) * (membrane + bending))


def _shares(model: KoiterModel, membrane: Floats, bending: Floats) -> Floats:
    problem = model.problem
    mesh = problem.space
    if "turn" not in model.estimates:  # as the mesh, the same under all loads
        model.estimates["turn"] = turn_of_triangles(mesh)
    turn: Floats = model.estimates["turn"]
    known = model.order if problem.structure.chart is not None else min(model.order, order_of(mesh))
    if known > 2:
        stretched = membrane / np.maximum(membrane + bending, 1e-300)
        slender = problem.structure.thickness * curvature_of_triangles(mesh)
        return share_of_chart(known, turn, domed(mesh), stretched, slender)
    if mesh.midpoints is not None:
        return share_of_quadratics(turn)
    return share_of_facets(turn_between(mesh, problem.discretisation.patches()[0]))
