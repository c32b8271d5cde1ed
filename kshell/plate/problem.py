"""A plate ready to solve: a structure turned into matrix, loads and space, stage by stage."""

from __future__ import annotations

import copy
from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.elements import ElementArgyris, ElementMorley, PlateElement, matrices
from kshell.material.laminate import require_symmetric
from kshell.mesh.check import plate_problems
from kshell.mesh.words import count, place
from kshell.plate.assembly import Assembled, Part, assemble, assemble_load, assemble_loads, residual
from kshell.plate.chains import BLUNT_CORNER
from kshell.plate.conditions import SharedSlopes
from kshell.plate.corners import corner_angles, infinite_moments, singular_corners
from kshell.plate.domain import Domain
from kshell.plate.fans import make_fans
from kshell.plate.forms import Bending, Form
from kshell.plate.held import Supports
from kshell.plate.inertia import Mass
from kshell.plate.layout import Layout
from kshell.plate.linear_form import LinearForm
from kshell.plate.loading import LOAD_DEGREE
from kshell.plate.loads import Loads, apply_loads
from kshell.plate.pattern import FullPattern, Pattern
from kshell.plate.points import PlatePoints
from kshell.plate.recovery import Fields
from kshell.plate.reduction import Reduction
from kshell.plate.rigid import Hanging, drift_warning, require_held
from kshell.plate.space import plate_space
from kshell.plate.supports import apply_supports
from kshell.scene.lines import inner_lines
from kshell.scene.placed import Placed
from kshell.scene.structure import Structure
from kshell.scene.supports import Elastic
from kshell.solvers import PlateSpace
from kshell.solvers.dense import DENSE_UP_TO

Floats = NDArray[np.float64]

ELEMENTS: dict[str, type[PlateElement]] = {"morley": ElementMorley, "argyris": ElementArgyris}

# error of the deflection over the ratio of the stiffest to the softest bending: 2e-13 to 3e-11 were measured on simply
# supported disks with nu near -1, where all bending is of the softest kind (verification/failures/poisson.py)
AMPLIFIED = 3e-11
WORTH_SAYING = 1e-6
ROUNDED = 1e-9  # relative difference of strain energy and work from which the matrix tells the former badly


class PlateProblem:
    """A structure as a plate problem.

    Parameters
    ----------
    structure : Structure
        Its mesh in a plane of constant z.
    element : PlateElement
    curved : bool, optional
        Whether the domain follows a curved boundary; as the element does, if not given.
    reduced : bool
        Whether unknowns are numbered, and supports that contradict each other found, at once.

    Raises
    ------
    InputError
        If a support, load, material or thickness does not fit, or the plate is not held.
    """

    def __init__(
        self, structure: Structure, element: PlateElement, curved: bool | None = None, reduced: bool = True
    ) -> None:
        self.structure, self.mesh, self.section = structure, structure.space, structure.section
        self.element = element
        plate_problems(self.mesh)
        require_symmetric(self.section.coupling_ratio)
        quintic = element.maxdeg > 2
        self.lines = inner_lines(structure) if quintic else None
        followed = None if self.lines is None else np.flatnonzero(self.lines.lines)
        self.domain = Domain(self.mesh, quintic if curved is None else curved, followed)
        fans = None if self.lines is None else make_fans(self.domain, self.lines)
        self.layout = Layout(self.mesh, element, fans, self.domain.bent)
        self.bending = Bending(self.domain, element, self.section)
        self.supports: Supports = apply_supports(structure.supports, self.domain, self.layout, self.bending)
        self.loads: Loads = apply_loads(
            structure.loads, self.domain, self.layout, self.bending, self.section, structure.masses
        )
        springs = [form for _, form in self.supports.springs]
        # what does not depend on loads, found once; shared with the copies under other loads
        self.shared: dict[Any, Any] = {}
        self.hanging: list[Hanging] = []
        if not structure.movable:
            self.hanging = require_held(self.domain, self.layout, self.supports.conditions, springs)
        self._shared = shared_slopes(self.domain, element) if len(self.domain.bent) else None
        if reduced:
            _ = self.reduction
        holds = [form for _, form in self.supports.holds]
        self.forms: list[Form] = [self.bending, *springs, *holds, *self.supports.ties]

    @cached_property
    def reduction(self) -> Reduction:
        """The unknowns that the supports leave."""
        return Reduction(self.layout, self.supports.conditions, self._shared)

    @cached_property
    def inertia(self) -> list[Form]:
        """Forms of the mass: that of the material, and added ones."""
        # a mass is to the velocity what a spring is to the motion
        springs: list[Placed[Any]] = [
            Placed(Elastic(placed.item.on, placed.item.value, "z"), placed.place)
            for placed in self.structure.masses
        ]
        added = apply_supports(springs, self.domain, self.layout, self.bending).springs if springs else []
        return [Mass(self.domain, self.element, self.section), *(form for _, form in added)]

    @property
    def small(self) -> bool:
        """Whether the matrix is best a dense array."""
        return self.reduction.count <= DENSE_UP_TO

    @property
    def size_over_height(self) -> float:
        """Size of the plate over the median height of its triangles on their longest edges."""
        longest = self.mesh.edge_lengths[self.mesh.triangle_edges].max(axis=1)
        heights = np.sort(2 * self.mesh.areas / longest)
        return float(self.mesh.size / heights[len(heights) // 2])

    @cached_property
    def assembled(self) -> Assembled:
        """Matrix and loads on the unknowns, and the share of prescribed motion."""
        return self._assemble(Pattern(self.reduction))

    @cached_property
    def system(self) -> Assembled:
        """The same, with the matrix as a dense array where it is small."""
        return self._assemble(FullPattern(self.reduction)) if self.small else self.assembled

    def _assemble(self, pattern: Pattern | FullPattern) -> Assembled:
        loads: list[LinearForm] = [*self.loads.forms, *self.supports.hold_loads]
        return assemble(self.forms, loads, self.domain, self.reduction, pattern)

    @cached_property
    def space(self) -> PlateSpace:
        """For multigrid, and for naming what moves freely."""
        space = plate_space(self.domain, self.layout, self.supports.conditions, self.reduction)
        if self.section.constant_per_triangle:
            bending = self.section.bending_per_triangle()
        else:
            every = np.arange(len(self.mesh.triangles))
            centres = self.mesh.points[self.mesh.triangles].mean(axis=1)
            bending = self.section.bending(every, centres[:, None])[:, 0]
        stiffness = bending[:, 0, 0] + bending[:, 1, 1]
        if stiffness.max() < 2.0 * stiffness.min():
            return space
        return replace(space, stiffness=stiffness)  # coarse levels follow its jumps

    @cached_property
    def _load_table(self) -> tuple[Floats, Floats]:
        """Each load, and last what holds the motion along curved edges: (load + 1, q), and (load + 1,) works."""
        loads = [self.loads.of(number) for number in range(len(self.structure.loads))]
        return assemble_loads([*loads, self.supports.hold_loads], self.domain, self.reduction)

    def under(self, factors: Sequence[float], motion: float) -> PlateProblem:
        """The same plate under its loads times factors, (load,), and its prescribed motion times one."""
        out = copy.copy(self)
        out.loads = self.loads.times(factors)
        out.supports = self.supports.times(motion)
        out.reduction = self.reduction.times(motion)
        vectors, works = self._load_table
        scale = np.array([*factors, motion])
        load, work = scale @ vectors, motion * float(scale @ works)
        out.__dict__.pop("_load_table", None)  # of the loads before they were multiplied
        changed = {
            "load": load,
            "load_work": work,
            "fixed_load": motion * self.system.fixed_load,
            "fixed_energy": motion**2 * self.system.fixed_energy,
        }
        for name in ("system", "assembled"):
            if name in self.__dict__:
                out.__dict__[name] = replace(self.__dict__[name], **changed)
        return out

    def loaded(self, structure: Structure, factor: float) -> PlateProblem:
        """The same plate under the loads and prescribed motions of another structure, times a factor."""
        out = copy.copy(self)
        for name in ("_load_table", "system", "assembled", "_known"):
            out.__dict__.pop(name, None)
        out.structure = structure
        if structure.loads != self.structure.loads:
            out.loads = apply_loads(
                structure.loads, self.domain, self.layout, self.bending, self.section, structure.masses
            )
        if structure.supports != self.structure.supports:
            out.supports = apply_supports(structure.supports, self.domain, self.layout, self.bending)
            out.reduction = Reduction(self.layout, out.supports.conditions, self._shared)
        if factor != 1.0:
            out.loads = out.loads.times([factor] * len(structure.loads))
            out.supports, out.reduction = out.supports.times(factor), out.reduction.times(factor)
        return out

    def energies(self, q: Floats) -> tuple[float, float]:
        """Strain energy, and the work of the loads and of supports that move when all of them act slowly.

        Both are equal unless initial curvature is held back, which stores energy. With r = K d - f what supports exert
        on the prescribed motion g, the work of supports is r g / 2; along curved edges what is prescribed enters by
        `HoldLoad`, whose energy is counted on what w and w_n differ from it.
        """
        a = self.system
        on_motion = self._work_of_supports(q)
        elastic = float(0.5 * (q @ (a.matrix @ q)) - q @ a.fixed_load + 0.5 * a.fixed_energy)
        work = 0.5 * (float(q @ a.load) + a.load_work + on_motion)
        if self.supports.hold_loads:
            weak, weak_work = assemble_load(list(self.supports.hold_loads), self.domain, self.reduction)
            pull = float(q @ weak) + weak_work - sum(load.energy() for load in self.supports.hold_loads)
            elastic, work = elastic - pull, work - pull
        if not self.loads.curvatures:
            if abs(elastic - work) > ROUNDED * max(abs(elastic), abs(work)) and not self.supports.hold_loads:
                elastic = self._stored(q)
            return elastic, work
        fixed, fixed_work = assemble_load(list(self.loads.curvatures), self.domain, self.reduction)
        pull = float(q @ fixed) + fixed_work
        return elastic - pull + self.held_back(), work - 0.5 * pull

    def _stored(self, q: Floats) -> float:
        """Strain energy, bending through strains: of small triangles that move far the matrix tells it badly."""
        d = self.reduction.expand(q)
        whole = Part(self.domain, self.every)
        return 0.5 * float(d @ residual(self.forms, [], self.reduction, d, whole))

    def _work_of_supports(self, q: Floats) -> float:
        """Work g (K d - f) of what supports exert on the prescribed motion, as if it acted in full."""
        a = self.system
        return a.fixed_energy - float(q @ a.fixed_load) - a.load_work

    def held_back(self) -> float:
        """Energy of the initial curvatures, all together, in a plate that does not bend."""
        total = 0.0
        for patch in self.domain.patches(2 * LOAD_DEGREE):
            k = self.loads.initial_curvature(patch.triangles, patch.xy)[..., None]
            d = self.bending.stiffness(patch.triangles, patch.xy, patch.weights)
            total += float((np.swapaxes(k, 2, 3) @ d @ k).sum()) / 2
        return total

    def fields(self, d: Floats) -> Fields:
        """What can be read off physical degrees of freedom; those of the last ones are kept."""
        known = self.__dict__.get("_known")
        if known is None or known.d is not d or known.loads is not self.loads:
            jump = None if self.lines is None else self.lines.jump
            known = Fields(self.domain, self.layout, self.bending, self.section, self.loads, d, jump)
            known.locator = self.locator
            self.__dict__["_known"] = known
        return known

    @property
    def every(self) -> NDArray[np.int64]:
        """All triangles; the batch that was assembled where there is but one, whose maps are then at hand."""
        return self.domain.every

    @cached_property
    def locator(self) -> PlatePoints:
        """For values anywhere."""
        if "locator" not in self.shared:
            self.shared["locator"] = PlatePoints(self.domain)
        found: PlatePoints = self.shared["locator"]
        return found

    @property
    def singular(self) -> dict[int, str]:
        """Corners where moments grow without bound, with their kind."""
        if "singular" not in self.shared:
            self.shared["singular"] = infinite_moments(self, self.corner_angles)
        found: dict[int, str] = self.shared["singular"]
        return found

    @property
    def corner_angles(self) -> dict[int, float]:
        """Interior angle at each corner of the boundary."""
        if "corner angles" not in self.shared:
            boundary = self.domain.boundary if len(self.domain.boundary.edges) else None
            self.shared["corner angles"] = corner_angles(self.mesh, boundary)  # Morley keeps to the chords
        found: dict[int, float] = self.shared["corner angles"]
        return found

    def drift(self, largest: float, loads: Loads, left: float) -> list[str]:
        """What should be said of a plate on springs under loads that deflect it by so much, and that leave so much."""
        if not self.hanging:
            return []
        size = float(self.mesh.size)
        gross = sum(form.gross(size) for form in loads.forms)
        return drift_warning(self.hanging, left, gross, self.reduction.count, largest)

    def warnings(self, loads: Loads | None = None) -> list[str]:
        """What the user should know about the model, under its own loads or other ones."""
        loads = self.loads if loads is None else loads
        corners = singular_corners(self.mesh, self.singular, self.corner_angles)
        out = [*self.supports.warnings, *loads.warnings, *corners]
        ends = self.layout.fans.ends
        if len(ends):
            out.append(
                "lines of supports, or of jumps of the stiffness, end or turn inside the plate at "
                f"{count(len(ends), 'vertex', 'vertices')}, one at {place(self.mesh.points[ends[0]])}: moments grow "
                "without bound there, values near it depend on the mesh; refine the mesh towards it"
            )
        boundary = self.domain.curves
        if boundary.sharpest > BLUNT_CORNER:
            out.append(
                f"the edge, or a line inside, turns by {np.degrees(boundary.sharpest):.0f} degrees at a vertex near "
                f"{place(boundary.sharpest_at)} and is taken as a smooth curve there, because it turns alike at the "
                "neighbouring vertices; if it is a corner, use two or more elements on each side of it, if it is a "
                "curve, refine it"
            )
        ratio = self.section.stiffness_ratio
        if ratio * AMPLIFIED > WORTH_SAYING:
            out.append(
                f"the material is nearly singular: its stiffest bending is {ratio:.1e} times as stiff as its softest "
                "(a Poisson's ratio near -1), and errors of mesh and rounding grow with that: deflections may be "
                f"off by {min(ratio * AMPLIFIED, 1.0):.0e} of themselves; check the elastic constants"
            )
        if not loads.forms and not np.any(self.reduction.particular):
            out.append("there is no load and no prescribed motion: the deflection is zero")
        return out


def shared_slopes(domain: Domain, element: PlateElement) -> SharedSlopes:
    """The slopes that both triangles at a curved edge inside have in common, at its true middle."""
    edges = domain.bent
    first, second = (domain.edge_points(edges, np.array([0.5]), np.ones(1), side) for side in range(2))
    rows = []
    for patch in (first, second):
        affine = domain.affine(patch.triangles)
        gradient = matrices.rows(element, affine, patch.xi, 1, element.transformation(affine))
        rows.append((first.normal[:, :, None, :] @ gradient)[:, 0, 0])
    triangles = np.concatenate([first.triangles, second.triangles])
    return SharedSlopes(np.concatenate([edges, edges]), triangles, np.concatenate(rows))
