"""The meshes of a refinement so far, and the next one."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.analysis.first_mesh import SHARE_SHAPE
from kshell.analysis.refined_mesh import Refiner
from kshell.analysis.run import Run
from kshell.analysis.static import Answered
from kshell.equilibrium.model import Model, Solved
from kshell.error.assessment import ENERGY, MISSED, Assessment
from kshell.error.bounds import PlatePair
from kshell.error.curve_doubt import turns
from kshell.error.marking import doerfler
from kshell.error.plate_averages import at_chords
from kshell.error.plates import geometry_share
from kshell.error.shells import shape_marks
from kshell.mesh.mesh import Mesh
from kshell.mesh.refine import bisect, cuttable
from kshell.mesh.words import place
from kshell.plate.hhj.model import HHJModel
from kshell.plate.model import PlateModel
from kshell.scene.jumps import missed_forces
from kshell.scene.placed import Placed
from kshell.shell.koiter.model import KoiterModel

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

SHARE_BOUNDS, SHARE_ESTIMATES, SHARE_FAR = 0.6, 0.7, 0.8  # of the sum of marks that is cut
SHARE_JUMPS = 0.3  # of the tolerance, that missed loads may use up
FAR, SHARE_WORST = 30.0, 0.5  # times the tolerance, from which the worst are cut twice


@dataclass
class Level:
    """One mesh and what is known on it.

    Attributes
    ----------
    half_width : float
        Largest one of what is asked for, relative.
    shape : float
        What will be left of it on any finer mesh, because these keep the shape of the first one.
    """

    run: Run
    model: Model
    assessment: Assessment
    unknowns: int
    half_width: float
    seconds: float
    answered: Answered | None = None
    pair: PlatePair | None = None
    shape: float = 0.0


@dataclass
class Refinement:
    """The levels of a refinement, and why it ended."""

    run: Run
    names: list[str]
    pair: bool
    begin: float
    refiner: Refiner
    levels: list[Level] = field(default_factory=list)
    why_not: str = ""
    frozen: float = 0.0  # share of a shape that refining adds nothing to
    cut: float = 0.0  # the same of finer meshes, if it is more
    quartics: bool = False  # in the place of cubics
    why: tuple[str, ...] = ()  # the element and the order


def next_mesh(loop: Refinement, level: Level, tolerance: float) -> Mesh:
    """The next mesh: cut where the quantities that are not known well enough have their error."""
    found = level.assessment
    marks = np.zeros(len(level.model.structure.parameters.triangles))
    for name in loop.names or [ENERGY]:
        own = found.marks[name]
        if found.relative(name) > tolerance and own.sum() > 0.0:
            marks += own / own.sum()
    mesh = level.model.structure.parameters
    marks[~cuttable(mesh)] = 0.0
    jumps = _of_jumps(level, tolerance)
    if loop.pair:
        return loop.refiner.refined(mesh, np.union1d(doerfler(marks, SHARE_BOUNDS), jumps)).mesh
    far = level.half_width > FAR * tolerance
    chosen = doerfler(marks, SHARE_FAR if far else SHARE_ESTIMATES)
    chosen = np.union1d(np.union1d(chosen, _of_bad_shape(loop, level, tolerance)), jumps)
    once = loop.refiner.refined(mesh, chosen)
    if not far or loop.run.scene.chart is None:
        return once.mesh
    worst = doerfler(marks, SHARE_WORST)
    return bisect(once.mesh, np.flatnonzero(np.isin(once.parent, worst))).mesh


def _of_jumps(level: Level, tolerance: float) -> Ints:
    """Triangles in which loads and springs change faster than they are integrated, where that matters."""
    mesh, out = level.model.structure.space, np.zeros(0, dtype=np.int64)
    every: list[Placed[Any]] = [*level.model.structure.loads, *level.model.structure.supports]
    for placed in every:
        if MISSED * placed.missed < SHARE_JUMPS * tolerance:
            continue
        members = placed.members(mesh)
        dimension = 2 if placed.place is None else placed.place.dimension
        worst = members[doerfler(missed_forces(placed.item, mesh, members, dimension)[1], SHARE_FAR)]
        owners = worst if dimension == 2 else mesh.edge_owner[worst, 0]
        out = np.union1d(out, owners.astype(np.int64))
    return out[cuttable(level.model.structure.parameters)[out]]


def share_of_shape(loop: Refinement, model: Model, found: Assessment) -> float:
    """Relative error because of the shape of a mesh: what refining adds nothing to, and what it does."""
    followed = loop.refiner.followed
    if followed is None:
        return max(found.geometry or 0.0, loop.frozen, loop.cut if loop.levels else 0.0)
    assert isinstance(model, PlateModel | HHJModel)
    domain = model.problem.domain
    if not domain.curves.curved.any():  # Morley plates end at chords
        return loop.frozen + (found.geometry or 0.0)
    return loop.frozen + geometry_share(domain, followed.missed(domain))


def _of_bad_shape(loop: Refinement, level: Level, tolerance: float) -> Ints:
    """Triangles that miss the shape they could have, where that matters."""
    followed, model, state = loop.refiner.followed, level.model, level.answered and level.answered.state
    if followed is not None and isinstance(model, PlateModel | HHJModel):
        domain = model.problem.domain
        if not domain.curves.curved.any():
            if (level.assessment.geometry or 0.0) - loop.frozen < SHARE_SHAPE * tolerance:
                return np.zeros(0, dtype=np.int64)
            return at_chords(model.problem, SHARE_ESTIMATES)
        missed = followed.missed(domain)
        if geometry_share(domain, missed) >= SHARE_SHAPE * tolerance:
            worst = domain.curves.edges[doerfler(missed * turns(domain.curves), SHARE_ESTIMATES)]
            return np.asarray(domain.mesh.edge_owner[worst, 0], dtype=np.int64)
    elif (
        loop.run.scene.chart is not None
        and isinstance(model, KoiterModel)
        and isinstance(state, Solved)
        and (level.assessment.geometry or 0.0) >= SHARE_SHAPE * tolerance
    ):
        return doerfler(shape_marks(model, model.problem.energy.linear_strain(state.x)), SHARE_ESTIMATES)
    return np.zeros(0, dtype=np.int64)


def blocked(loop: Refinement, level: Level) -> str:
    """Where triangles cannot be cut any more and leave more than the tolerance, in words; empty if nowhere."""
    mesh, found = level.model.structure.parameters, level.assessment
    smallest = ~cuttable(mesh)
    for name in loop.names or [ENERGY]:
        if smallest.any() and found.floor(name, smallest) > float(loop.run.options.tolerance):
            worst = int(np.argmax(found.parts[name] * smallest))
            at = place(mesh.points[mesh.triangles[worst]].mean(axis=0))
            size = mesh.edge_lengths[mesh.triangle_edges[worst]].min()
            return (
                f"the triangles at {at} are as small as coordinates resolve there ({size:.0e}), and what they leave is "
                "more"
            )
    return ""
