"""The meshes of a refinement so far, and the next one."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.analysis.first_mesh import LARGEST_TURN, SHARE_SHAPE
from kshell.analysis.refined_mesh import HALF, Refiner
from kshell.analysis.remeshed import turns as turns_of_triangles
from kshell.analysis.run import Run
from kshell.analysis.static import Answered
from kshell.equilibrium.model import Model, Solved
from kshell.error.assessment import ENERGY, Assessment
from kshell.error.bounds import PlatePair
from kshell.error.curve_doubt import turns
from kshell.error.geometry_share import QUADRATIC_POWER, turn_of_triangles
from kshell.error.marking import doerfler
from kshell.error.plate_averages import at_chords
from kshell.error.plates import geometry_share
from kshell.error.shells import shape_marks, share_when_cut
from kshell.error.sizes import MOST_GROWTH, wanted_ratios
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
WELL_BELOW = 0.8  # of the largest turn, that sizes are made for
AIM = 0.5  # of the tolerance, that sizes are made for
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
    shapes: dict[str, float] = field(default_factory=dict)  # by probe, the first of them that refining keeps
    quartics: bool = False  # in the place of cubics
    why: tuple[str, ...] = ()  # the element and the order


def next_mesh(loop: Refinement, level: Level, tolerance: float, growth: float = MOST_GROWTH) -> Mesh:
    """The next mesh: finer where the quantities that are not known well enough have their error.

    Curved shells of geometry files are meshed anew, with at most `growth` times as many triangles; others are cut.
    """
    anew = _anew(loop, level, tolerance, growth)
    return _bisected(loop, level, tolerance) if anew is None else anew


def _anew(loop: Refinement, level: Level, tolerance: float, growth: float) -> Mesh | None:
    """The geometry meshed by the sizes that meet the tolerance; None where that cannot be."""
    found, model, state = level.assessment, level.model, level.answered and level.answered.state
    if loop.refiner.remesher is None or not isinstance(model, KoiterModel):
        return None
    mesh = model.structure.parameters
    rate = 2.0 * (model.order - 1)
    turn = turns_of_triangles(mesh)
    ratios = np.where(turn > LARGEST_TURN, WELL_BELOW * LARGEST_TURN / np.maximum(turn, LARGEST_TURN), 1.0)
    for name in loop.names or [ENERGY]:
        off = found.relative(name)
        if off > tolerance:
            ratios = np.minimum(ratios, wanted_ratios(found.marks[name], AIM * tolerance / off, rate, growth))
        if found.shapes.get(name, 0.0) > SHARE_SHAPE * tolerance:
            wanted = SHARE_SHAPE * tolerance / found.shapes[name]
            of_shape = wanted_ratios(found.shape_marks[name], wanted, QUADRATIC_POWER, growth)
            ratios = np.minimum(ratios, of_shape)
    if isinstance(state, Solved) and (found.geometry or 0.0) > SHARE_SHAPE * tolerance:
        assert found.geometry is not None
        marks = shape_marks(model, model.problem.energy.linear_strain(state.x))
        wanted = SHARE_SHAPE * tolerance / found.geometry
        ratios = np.minimum(ratios, wanted_ratios(marks, wanted, QUADRATIC_POWER, growth))
    ratios[_of_jumps(loop, level, tolerance)] = HALF
    return loop.refiner.sized(mesh, ratios)


def _bisected(loop: Refinement, level: Level, tolerance: float) -> Mesh:
    found = level.assessment
    marks = np.zeros(len(level.model.structure.parameters.triangles))
    for name in loop.names or [ENERGY]:
        own = found.marks[name]
        if found.relative(name) > tolerance and own.sum() > 0.0:
            marks += own / own.sum()
    mesh = level.model.structure.parameters
    marks[~cuttable(mesh)] = 0.0
    jumps = _of_jumps(loop, level, tolerance)
    if loop.pair:
        return loop.refiner.refined(mesh, np.union1d(doerfler(marks, SHARE_BOUNDS), jumps))
    far = level.half_width > FAR * tolerance
    chosen = doerfler(marks, SHARE_FAR if far else SHARE_ESTIMATES)
    chosen = np.union1d(np.union1d(chosen, _of_bad_shape(loop, level, tolerance)), jumps)
    if not far or loop.run.scene.chart is None:
        finer = loop.refiner.refined(mesh, chosen)
        if loop.refiner.lost and not loop.frozen:
            _freeze(loop, level)
        return finer
    once = bisect(mesh, chosen)
    worst = doerfler(marks, SHARE_WORST)
    return bisect(once.mesh, np.flatnonzero(np.isin(once.parent, worst))).mesh


def too_coarse(loop: Refinement, level: Level) -> bool:
    """Whether triangles of a first mesh turn by more than shares of shapes were measured for, and can be smaller."""
    mesh = level.model.structure.parameters
    first = len(loop.levels) == 1 and loop.refiner.remesher is not None
    return first and bool(turn_of_triangles(mesh).max() > LARGEST_TURN)


def _freeze(loop: Refinement, level: Level) -> None:
    """From here on new nodes lie on the triangles of this level, whose shape is kept."""
    model, state = level.model, level.answered and level.answered.state
    loop.frozen = level.assessment.geometry or 0.0
    if isinstance(model, KoiterModel) and isinstance(state, Solved):
        loop.cut = share_when_cut(model, model.problem.energy.linear_strain(state.x))


def by_loads(loop: Refinement, level: Level) -> float:
    """The most that missed loads add to the relative half width of what is asked for."""
    return max(level.assessment.by_loads.get(name, 0.0) for name in loop.names or [ENERGY])


def _of_jumps(loop: Refinement, level: Level, tolerance: float) -> Ints:
    """Triangles in which loads and springs change faster than they are integrated, where that matters."""
    mesh, out = level.model.structure.space, np.zeros(0, dtype=np.int64)
    every: list[Placed[Any]] = [*level.model.structure.loads, *level.model.structure.supports]
    shares, add = level.model.structure.missed, by_loads(loop, level)
    for placed in every:
        if not shares or placed.missed / shares * add < SHARE_JUMPS * tolerance:
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


def keep_shapes(loop: Refinement, found: Assessment) -> None:
    """What the shape changes of probes, no less than on the first mesh where finer ones keep its shape."""
    if loop.frozen > 0.0:
        for name, share in found.shapes.items():
            loop.shapes.setdefault(name, share)
            found.shapes[name] = max(share, loop.shapes[name])


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
