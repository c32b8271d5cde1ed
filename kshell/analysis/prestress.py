"""The stiffness of a structure under load: what its stresses add to the stiffness at rest.

Plates take the membrane forces of a plane-stress solution; shells those, and the moments, of their linear solution, or
the tangent at the end of a path where large deflections are asked for.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import scipy.sparse as sp

from kshell.analysis.membrane import ORDER, MembraneState, UniformState, membrane_state
from kshell.analysis.path import grow_load
from kshell.analysis.run import Run
from kshell.analysis.sense import at_rest_first
from kshell.equilibrium.finite_model import FiniteModel
from kshell.equilibrium.model import Model, Solved
from kshell.errors import InputError
from kshell.plate.assembly import assemble
from kshell.plate.inertia import Membrane
from kshell.plate.model import PlateModel
from kshell.plate.pattern import Pattern
from kshell.scene.structure import Structure

# order of membrane forces beside Morley elements, whose own error is of the second order
MORLEY_ORDER = 2
# entries of a geometric stiffness, against those of the stiffness, that are rounding
NOTHING = 1e-12


@dataclass
class Prestress:
    """A stiffness under load.

    Attributes
    ----------
    stiffness : (free, free) CSR matrix
    reasons, warnings : list of str
    """

    stiffness: sp.csr_matrix
    reasons: list[str] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)


@dataclass
class Stressed:
    """What some loads do to the stiffness.

    Attributes
    ----------
    geometric : (free, free) CSR matrix
    membrane : MembraneState or None
        Of plates.
    solved : Solved or None
        Of shells.
    """

    geometric: sp.csr_matrix
    membrane: MembraneState | None = None
    solved: Solved | None = None


def stressed(model: Model, structure: Structure, factors: Sequence[float], motion: float = 1.0) -> Stressed:
    """Geometric stiffness of the linear solution under the loads of the structure times factors (load,).

    Raises
    ------
    InputError
        If the loads push a plate away in its plane.
    SolveError
        If there is no linear solution.
    """
    if isinstance(model, PlateModel):
        order = ORDER if model.element == "argyris" else MORLEY_ORDER
        state = membrane_state(structure, factors, motion, order)
        return Stressed(plate_geometric(model, state), membrane=state)
    solved = model.under(factors, motion).solve()
    return Stressed(model.geometric_stiffness(solved), solved=solved)


def plate_geometric(model: PlateModel, state: MembraneState | UniformState) -> sp.csr_matrix:
    """Of membrane forces of a plate."""
    problem = model.problem
    form = Membrane(problem.domain, problem.element, state.at, state.degree)
    pattern = Pattern(problem.reduction)
    return assemble([form], [], problem.domain, problem.reduction, pattern).matrix


def prestressed(model: Model, run: Run) -> Prestress:
    """The stiffness under all loads of the scene.

    Raises
    ------
    InputError
        If there are no loads, or loads that turn with the surface whose stiffness is not symmetric.
    SolveError
        If the loaded state is not found.
    """
    structure = run.structure
    if not structure.loads and all(placed.item.value is None for placed in structure.supports):
        raise InputError("prestress = true needs loads, or a prescribed motion: the scene has none")
    factor = run.options.prestress
    factors, motion = _acting(run)
    if run.options.large_deflection is True:
        whole = motion == 1.0 and all(f == 1.0 for f in factors)
        return _on_path(model if whole else model.under(factors, motion), run, factor)
    found = stressed(model, structure, factors, motion)
    stiffness = model.stiffness()
    at = "" if factor == 1.0 else f" at the load factor {factor:g}"
    out = Prestress(
        (stiffness + found.geometric).tocsr(), [f"prestress: the stresses of the linear solution{at}"]
    )
    if abs(found.geometric).max() <= NOTHING * abs(stiffness).max():
        out.warnings.append(
            "prestress: the loads cause no membrane forces, the frequencies are those without them"
        )
    return out


def _acting(run: Run) -> tuple[list[float], float]:
    """Factors of the loads, and of the prescribed motion, that act before the structure vibrates.

    Raises
    ------
    InputError
        If nothing acts at rest before a response.
    """
    structure, factor = run.structure, run.options.prestress
    moved = [placed.item.fixed for placed in structure.supports if placed.item.value is not None]
    if not at_rest_first(run.options):
        factors = [1.0 if placed.item.fixed else factor for placed in structure.loads]
        return factors, 1.0 if moved and all(moved) else factor
    if not any(moved) and not any(placed.item.fixed for placed in structure.loads):
        raise InputError(
            "prestress = true in a response needs loads, or a prescribed motion, with fixed = true: these act at rest, "
            "the others shake"
        )
    if factor != 1.0:
        raise InputError(
            f"prestress = {factor:g} in a response: loads at rest have fixed = true and act as they are; give true"
        )
    return [float(placed.item.fixed) for placed in structure.loads], 1.0


def _on_path(model: Model, run: Run, factor: float) -> Prestress:
    """The tangent at the end of a path of large deflections, at a factor of the loads of the scene."""
    if not isinstance(model, FiniteModel):
        raise InputError(f"large_deflection = true with prestress is for shells, not for a {model.kind}")
    trace = grow_load(model, run)
    if trace.failure is not None:
        raise trace.failure
    state, equilibrium = trace.states[-1], model.equilibrium()
    energy, _, _ = equilibrium.evaluate(state.x, state.factor, 2, state.memory)
    reduced = equilibrium.reduction.reduce(energy.hessian)
    if abs(reduced - reduced.T).max() > 1e-9 * abs(reduced).max():
        raise InputError(
            "prestress: the stiffness of a pressure that turns with the surface is not symmetric where the edge of the "
            "surface is free, so there are no modes: leave follower out, or hold the edge"
        )
    out = Prestress((0.5 * (reduced + reduced.T)).tocsr())
    out.reasons.append(
        f"prestress: the state of large deflections at the load factor {factor * state.factor:g}"
    )
    return out
