"""Argyris shells on charts against Koiter elements on the same triangles: how far the poorer of two answers is off.

Second derivatives of Argyris functions are continuous at vertices, and membrane forces everywhere, so that averages of
them tell nothing. Koiter elements of order 3 have about as many unknowns and one order less: what both differ by is
about their error, and above that of the Argyris functions.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kshell.equilibrium.model import Solved
from kshell.error.assessment import ENERGY, Assessment, Interval
from kshell.error.averages import Averages
from kshell.error.estimate import Estimate
from kshell.errors import InputError, SolveError
from kshell.result.result import Result
from kshell.shell.chart.model import ChartModel
from kshell.shell.koiter.model import KoiterModel
from kshell.shell.koiter.recovery import energies

ORDER = 3
WHY_NOT = "the difference from Koiter elements of order 3 on the same triangles is no proof"
SAFETY = 2.0  # of the difference of energies: thin shells on few triangles are too stiff with both
LIKELY = 0.25  # of the half width


def assess_difference(
    model: ChartModel, solved: Solved, result: Result, names: Sequence[str], marks: bool = False
) -> Assessment:
    """Of small deflections; all named probes, as there are no duals.

    The values of a probe may differ by little where the solutions differ by much: the relative difference of their
    energies is added. ``marks`` for refinement are those of the Koiter elements, whose forces and moments jump.
    """
    try:
        other = KoiterModel(model.structure, ORDER)
        its = other.solve()
    except (InputError, SolveError) as error:
        return Assessment(
            why_not=f"no estimate: Koiter elements on the same triangles gave no answer ({error})"
        )
    problem = other.problem
    strain = problem.energy.linear_strain(its.x)
    if problem.loads.initial is not None:
        strain = strain - problem.loads.initial
    stored = float(sum(part.sum() for part in energies(problem.energy, strain)))
    out = Assessment(why_not=WHY_NOT, geometry=0.0)
    own = result.strain_energy
    half = SAFETY * abs(own - stored)
    out.energy = Estimate(own, half, LIKELY * half, "estimated", WHY_NOT)
    share = abs(own - stored) / abs(own) if own != 0.0 else 0.0
    for name in names:
        value = result.motion_at_probe(name)
        moved = np.array([other.probe_row(name, letter) @ its.x for letter in "xyz"])
        off = np.abs(value - moved) + share * np.abs(value)
        out.probes[name] = Interval(value, off, LIKELY * off, "estimated")
    if marks:
        local = Averages(problem).local(strain)
        for name in (ENERGY, *names):
            out.marks[name], out.parts[name] = local, np.zeros_like(local)
    return out
