"""Argyris shells on charts against Koiter elements on the same triangles: how far the poorer of two answers is off.

Second derivatives of Argyris functions are continuous at vertices, and membrane forces everywhere, so that averages of
them tell nothing. Koiter elements of order 3 have about as many unknowns and one order less: what both differ by is
about their error, and above that of the Argyris functions. As both may be off alike, in the value of a probe and in
the energy stored, the energy of their difference counts, too,

    |d|^2 = int (E - E_K) : (A - B D^-1 B) (E - E_K) + (M - M_K) : D^-1 (M - M_K).

Symbols
-------
E, M       membrane strain and moments of the Argyris functions, with index K those of the Koiter elements
A, B, D    stiffnesses of the section

On 22 shells with four meshes each, of 4 to 512 triangles, intervals of energies and probes held in 126 of the 127 runs
whose references are known that well (120 without |d|^2, which missed by up to 7 times); the one is a layer in one
triangle.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from kshell.equilibrium.linear import solve_roughly
from kshell.equilibrium.model import Solved
from kshell.error.assessment import ENERGY, Assessment, Interval
from kshell.error.averages import Averages, hidden
from kshell.error.estimate import Estimate
from kshell.errors import InputError, SolveError
from kshell.result.result import Result
from kshell.shell.chart.energy import ChartKoiter
from kshell.shell.chart.model import ChartModel
from kshell.shell.koiter.energy import Koiter
from kshell.shell.koiter.model import KoiterModel
from kshell.shell.reference import lagrange

Floats = NDArray[np.float64]

ORDER = 3
WHY_NOT = "the difference from Koiter elements of order 3 on the same triangles is no proof"
SAFETY = 2.0  # of differences in energy: thin shells on few triangles are too stiff with both
LIKELY = 0.25  # of the half width


def assess_difference(
    model: ChartModel, solved: Solved, result: Result, names: Sequence[str], marks: bool = False
) -> Assessment:
    """Of small deflections; all named probes, as there are no duals.

    The values of a probe may differ by little where the solutions differ by much: the relative difference in energy is
    added. ``marks`` for refinement are those of the Koiter elements, whose forces and moments jump.
    """
    try:
        # held as the model is: that is not asked again
        other = KoiterModel(replace(model.structure, movable=True), ORDER)
        problem = other.problem
        problem.shared["locator"] = model.problem.locator  # of the same triangles
        initial = problem.loads.initial
        x = solve_roughly(problem.energy, problem.load, problem.reduction, problem.springs, initial)
    except (InputError, SolveError) as error:
        return Assessment(
            why_not=f"no estimate: Koiter elements on the same triangles gave no answer ({error})"
        )
    strain = problem.energy.linear_strain(x)
    if initial is not None:
        strain = strain - initial
    stress = problem.energy.stress(strain)
    stored = 0.5 * float(np.sum(strain * stress))
    if problem.springs is not None:
        stored += 0.5 * float(x @ (problem.springs @ x))
    out = Assessment(why_not=WHY_NOT, geometry=0.0)
    own = result.strain_energy
    differing = energy_of_difference(model, solved, problem.energy, strain, stress)
    apart = float((hidden(problem) * differing).sum())
    off = max(abs(own - stored), 0.5 * apart)
    out.energy = Estimate(own, SAFETY * off, LIKELY * SAFETY * off, "estimated", WHY_NOT)
    share = off / abs(own) if own != 0.0 else 0.0
    for name in names:
        value = result.motion_at_probe(name)
        moved = np.array([other.probe_row(name, letter) @ x for letter in "xyz"])
        # of all of the motion: a small component is no better known for lying across a large one
        width = np.abs(value - moved) + share * float(np.linalg.norm(value))
        out.probes[name] = Interval(value, width, LIKELY * width, "estimated")
    if marks:
        local = Averages(problem).local(strain)
        for name in (ENERGY, *names):
            out.marks[name], out.parts[name] = local, np.zeros_like(local)
    return out


def energy_of_difference(
    model: ChartModel, solved: Solved, koiter: Koiter, strain: Floats, stress: Floats
) -> Floats:
    """(triangle,) |d|^2; strains and stresses (triangle, 2 r) of the Koiter elements."""
    energy: ChartKoiter = model.problem.energy
    surface = energy.surface
    own = energy.linear_strain(solved.x)
    if model.problem.loads.initial is not None:
        own = own - model.problem.loads.initial
    count, q = len(own), len(surface.weights)
    r, psi = koiter.surface.reference.strains, lagrange(koiter.surface.order - 1, surface.points)
    membrane, moment = (psi @ part.reshape(count, -1, 3) for part in (strain[:, :r], stress[:, r:]))
    # M^ab J^2 of the element, and the stress at a point with its weight, where M^12 counts twice
    weight = surface.weights / surface.area_elements
    moment = moment * np.array([1.0, 1.0, 2.0]) * weight[..., None]
    off = own.reshape(count, q, 6)[..., :3] - membrane
    mine = solved.own.stress.reshape(count, q, 6)
    a, b, d = energy.stiffness[..., :3, :3], energy.stiffness[..., :3, 3:], energy.stiffness[..., 3:, 3:]
    # the curvature by which moments differ, once the membrane strains that differ have had their part of them
    bent = mine[..., 3:] - moment
    if np.any(b):
        kappa = np.linalg.solve(d, (bent - (np.swapaxes(b, -1, -2) @ off[..., None])[..., 0])[..., None])[
            ..., 0
        ]
        both = (a @ off[..., None] + b @ kappa[..., None])[..., 0]
    else:
        kappa = np.linalg.solve(d, bent[..., None])[..., 0]
        both = (a @ off[..., None])[..., 0]
    return np.asarray((off * both).sum(axis=(1, 2)) + (kappa * bent).sum(axis=(1, 2)))
