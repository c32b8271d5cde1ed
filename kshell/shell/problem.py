"""A shell ready to solve: a structure turned into energy, loads and conditions."""

from __future__ import annotations

import copy
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any, cast

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.equilibrium.problem import Follower, Problem, State
from kshell.equilibrium.reduction import Reduction
from kshell.errors import InputError
from kshell.material.materials import rotated
from kshell.mesh import quadratic
from kshell.mesh.closest import Locator
from kshell.mesh.vectors import cross
from kshell.mesh.words import place
from kshell.result.rows import Rows
from kshell.scene.lines import shell_lines
from kshell.scene.loads import Temperature
from kshell.scene.structure import Structure
from kshell.scene.thermal import left_stress
from kshell.shell.discretisation import Discretisation
from kshell.shell.held import Hanging, require_held
from kshell.shell.links import SMALL_ONLY, with_links
from kshell.shell.loads import ShellLoads, apply_loads
from kshell.shell.means import split_patches
from kshell.shell.section import Section as Stiffness
from kshell.shell.shape_checks import shape_warnings
from kshell.shell.supports import ShellSupports, apply_supports

Floats = NDArray[np.float64]

# an angle between x and the normal below which the projection of x says little
NEARLY_NORMAL = np.radians(10.0)
# what of `ShellProblem.shared` depends on no support and no load
OF_MESH = ("locator", "of shape", "singular")


class ShellProblem:
    """A structure as a shell problem.

    Parameters
    ----------
    structure : Structure
    discretisation : KoiterDiscretisation or ArgyrisDiscretisation
        On its mesh.

    Attributes
    ----------
    space : Mesh
        The mesh in space.
    energy : StrainEnergy
    load : (unknowns,)
        All loads at rest.
    reduction : Reduction
    springs : sparse, optional
        Stiffness of elastic supports.

    Raises
    ------
    InputError
        If a support, load, material or thickness does not fit, or the shell is not held.
    """

    def __init__(self, structure: Structure, discretisation: Discretisation) -> None:
        self.structure, self.space, self.section = structure, structure.space, structure.section
        self.discretisation = discretisation
        self.energy: Any = discretisation.energy(
            self._stiffness(), None if structure.elastic else self.section.inelastic()
        )
        self.supports: ShellSupports = apply_supports(structure.supports, self.space, discretisation)
        self.loads: ShellLoads = apply_loads(structure, discretisation, self.energy, self.supports.links)
        self.reduction: Reduction = with_links(self.supports.conditions.reduction(), self.supports.links)
        self.springs: sp.csr_matrix | None = self.supports.springs
        # what does not depend on the loads' sizes, found once; shared with the copies under other loads
        self.shared: dict[str, Any] = {}
        self.hanging: list[Hanging] = []
        if not structure.movable:
            self.hanging = require_held(self.space, discretisation, self.reduction, self.springs)

    @cached_property
    def added_mass(self) -> sp.csr_matrix | None:
        """(unknowns, unknowns) of added masses; None where there are none."""
        parts = []
        for placed in self.structure.masses:
            assert placed.place is not None  # masses are somewhere
            # a mass is to the velocity what a spring is to the motion
            parts += [
                self.discretisation.spring(placed.place, axis, placed.item.at, str(placed.item))
                for axis in np.eye(3)
            ]
        return sum(parts[1:], parts[0]).tocsr() if parts else None

    @cached_property
    def load(self) -> Floats:
        return self.sum_of(self.loads.forces)

    def sum_of(self, forces: list[Floats]) -> Floats:
        """Sum of (unknowns,) arrays, zeros where there are none."""
        total: Floats = np.sum([np.zeros(self.discretisation.unknowns), *forces], axis=0)
        return total

    def under(self, factors: Sequence[float], motion: float) -> ShellProblem:
        """The same shell under its loads times factors, (load,), and its prescribed motion times one."""
        out = copy.copy(self)
        out.__dict__.pop("load", None)
        out.loads = self.loads.times(factors)
        out.reduction = self.reduction.times(motion)
        return out

    def loaded(self, structure: Structure, factor: float) -> ShellProblem:
        """The same shell under the loads and prescribed motions of another structure, times a factor."""
        out = copy.copy(self)
        out.__dict__.pop("load", None)
        out.structure = structure
        out.shared = {name: found for name, found in self.shared.items() if name in OF_MESH}
        if structure.loads != self.structure.loads:
            out.loads = apply_loads(structure, self.discretisation, self.energy, self.supports.links)
        given = self.reduction.given
        if structure.supports != self.structure.supports:
            supports = apply_supports(structure.supports, self.space, self.discretisation)
            given = with_links(supports.conditions.reduction(), supports.links).given
        if factor != 1.0:
            out.loads = out.loads.times([factor] * len(structure.loads))
        out.reduction = self.reduction._replace(given=factor * given, following=None)
        return out

    def _stiffness(self) -> Stiffness:
        """A, B, D about the meshed surface, offset below the middle of the material."""
        section, offset = self.section, self.structure.offset
        uniform = section.uniform and np.ptp(offset) == 0.0

        def at(triangles: NDArray[np.integer], points: Floats) -> tuple[Floats, Floats, Floats]:
            a, b, d = (
                section.membrane(triangles, points),
                section.coupling(triangles, points),
                section.bending(triangles, points),
            )
            z = offset[triangles][:, None, None, None]
            return a, b + z * a, d + 2 * z * b + z * z * a

        triangles = np.arange(len(self.space.triangles))
        points, weight = self.discretisation.interior_points(triangles[:1] if uniform else triangles)
        triangles = triangles[: len(points)]
        weight = (weight / weight.sum(axis=1, keepdims=True))[..., None, None]
        a, b, d = ((weight * m).sum(axis=1) for m in at(triangles, points))
        stiffness = Stiffness.from_stiffness(a, d, b, direction=self.structure.direction)
        return stiffness if section.constant_per_triangle else replace(stiffness, varying=at)

    def equilibrium(self) -> Problem:
        """The same for large deflections, all loads and prescribed motions growing with one factor.

        Rigid links turn by small turns; what goes far asks `require_no_links` before.
        """
        loads = self.loads
        dead = [force for k, force in enumerate(loads.forces) if k not in loads.followers]
        follower: Follower | None = None
        if loads.followers:

            def follower(x: Floats) -> tuple[Floats, Any]:
                parts = [follow(x) for follow in loads.followers.values()]
                return np.sum([force for force, _ in parts], axis=0), sum(stiffness for _, stiffness in parts)

        return Problem(
            self.energy,
            self.reduction,
            self.sum_of(dead),
            follower,
            self.springs,
            initial=loads.initial,
        )

    def left_stress(self, part: float) -> Callable[[int, NDArray[np.integer], Floats], Floats]:
        """Stress that layers keep under a part of the temperatures: of a face, triangles, and points in space."""
        offset = np.broadcast_to(self.structure.offset, (len(self.space.triangles),))

        def of(face: int, triangles: NDArray[np.integer], points: Floats) -> Floats:
            total = np.zeros((*points.shape[:2], 3))
            for _, placed in self.loads.warmth:
                here = np.isin(triangles, placed.members(self.space))
                some, load = triangles[here], cast(Temperature, placed.item)
                total[here] += part * left_stress(load, self.section, face, some, points[here], offset[some])
            return total

        return of

    @property
    def pieces(self) -> NDArray[np.integer]:
        """(triangle,) smooth pieces, cut along edges inside across which forces or moments jump."""
        if "pieces" not in self.shared:
            smooth, _ = self.discretisation.patches()
            self.shared["pieces"] = split_patches(self.space, smooth, shell_lines(self.structure))
        found: NDArray[np.integer] = self.shared["pieces"]
        return found

    @property
    def rows(self) -> Rows:
        """What the rows of fields at vertices belong to: vertices, once for each piece."""
        if "rows" not in self.shared:
            self.shared["rows"] = Rows.of_patches(self.space, self.pieces)
        found: Rows = self.shared["rows"]
        return found

    def require_no_links(self) -> None:
        """Raise InputError if a rigid link turns, which is for small deflections only."""
        for link in self.supports.links:
            raise InputError(f"{link.item}: {SMALL_ONLY}")

    @property
    def locator(self) -> Locator:
        """Of points on the surface at rest."""
        if "locator" not in self.shared:
            self.shared["locator"] = Locator.of(self.space)
        found: Locator = self.shared["locator"]
        return found

    def forces_at(self, state: State) -> list[Floats]:
        """(unknowns,) force of each load in a state."""
        loads = self.loads
        return [
            state.factor * (loads.followers[k](state.x)[0] if k in loads.followers else force)
            for k, force in enumerate(loads.forces)
        ]

    def warnings(self) -> list[str]:
        """What the user should know about the model."""
        out = [*self.supports.warnings, *self.loads.warnings]
        if "of shape" not in self.shared:
            self.shared["of shape"] = shape_warnings(self.space, self.discretisation, self.section)
        out += self.shared["of shape"]
        out += self._axes_warnings()
        out += self.discretisation.warnings()
        still = not np.any(self.load) and self.loads.initial is None
        if still and not np.any(self.reduction.given):
            out.append("there is no load and no prescribed motion: the deflection is zero")
        return out

    def _axes_warnings(self) -> list[str]:
        """Material axes counted from the projection of x jump where x is nearly normal."""
        directed = any(_depends_on_direction(q) for q in self.section.moduli)
        if self.structure.direction is not None or not directed:
            return []
        mesh = self.space
        corners = mesh.points[mesh.triangles]
        normal = cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[None]
        if mesh.midpoints is not None:
            normal = quadratic.normals(quadratic.node_points(mesh, mesh.midpoints), quadratic.NODES)
        along = (np.abs(normal[..., 0]) / np.linalg.norm(normal, axis=2)).max(axis=0)
        worst = int(np.argmax(along))
        if along[worst] < np.cos(NEARLY_NORMAL):
            return []
        return [
            f"material axes: x is nearly normal to the shell near {place(corners[worst].mean(axis=0))}, so its "
            "projection, from which the angles of the material count, turns fast there; give a direction that is "
            "never normal, for example direction = [0, 0, 1]"
        ]


def _depends_on_direction(q: Floats) -> bool:
    """Whether a plane-stress stiffness (3, 3) is not isotropic: it changes when it is turned."""
    return bool(
        np.abs(rotated(q, 30.0) - q).max() + np.abs(rotated(q, 45.0) - q).max() > 1e-9 * np.abs(q).max()
    )
