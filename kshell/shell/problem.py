"""A shell ready to solve: the scene's words turned into energy, loads and conditions."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.analysis.model_choice import ModelChoice
from kshell.equilibrium.problem import Follower, Problem, State
from kshell.errors import InputError
from kshell.material.materials import rotated
from kshell.material.section import Section, shell_section
from kshell.mesh import quadratic
from kshell.mesh.closest import Locator
from kshell.mesh.mesh import Mesh
from kshell.mesh.words import place
from kshell.scene.on_chart import lifted, mesh_in_space
from kshell.scene.scene import Scene
from kshell.shell.held import require_held
from kshell.shell.koiter.discretisation import USE_KOITER, KoiterDiscretisation
from kshell.shell.scene_loads import SceneLoads, apply_loads
from kshell.shell.scene_supports import SceneSupports, apply_supports, hinge_edges
from kshell.shell.section import Section as Stiffness
from kshell.shell.shape_checks import shape_warnings

Floats = NDArray[np.float64]

# an angle between x and the normal below which the projection of x says little
NEARLY_NORMAL = np.radians(10.0)


class ShellProblem:
    """A scene as a shell problem.

    Parameters
    ----------
    scene : Scene
    mesh : Mesh
        Of the scene, as read.
    choice : ModelChoice
    offsets : (node, 3), optional
        By which the nodes of a Koiter discretisation are moved.

    Attributes
    ----------
    space : Mesh
        The mesh in space.
    discretisation : KoiterDiscretisation or ArgyrisDiscretisation
    energy : StrainEnergy
    load : (unknowns,)
    reduction : Reduction

    Raises
    ------
    InputError
        If a support, load, material or thickness does not fit, or the shell is not held.
    """

    def __init__(self, scene: Scene, mesh: Mesh, choice: ModelChoice, offsets: Floats | None = None) -> None:
        self.scene, self.mesh, self.choice = scene, mesh, choice
        self.space = mesh_in_space(scene, mesh)
        if offsets is not None:
            self.space = moved_mesh(self.space, choice.order, offsets)
        self.section: Section = shell_section(self.space, scene.thickness, scene.material, scene.layers)
        hinges = hinge_edges(list(scene.supports), self.space)
        self.discretisation = _discretise(scene, mesh, choice, hinges, offsets)
        self.energy = self.discretisation.energy(self._stiffness())
        self.supports: SceneSupports = apply_supports(list(scene.supports), self.space, self.discretisation)
        self.loads: SceneLoads = apply_loads(
            list(scene.loads), self.space, self.discretisation, self.energy, self.section
        )
        if self.loads.initial is not None:
            self.energy.initial = self.loads.initial
        self.load: Floats = np.sum([np.zeros(self.discretisation.unknowns), *self.loads.forces], axis=0)
        self.reduction = self.supports.conditions.reduction()
        self.springs: sp.csr_matrix | None = self.supports.springs
        require_held(self.space, self.discretisation, self.reduction, self.springs)

    def _stiffness(self) -> Stiffness:
        """A, B, D about the meshed surface, offset below the middle of the material."""
        section, z = self.section, self.scene.offset

        def at(triangles: NDArray[np.integer], points: Floats) -> tuple[Floats, Floats, Floats]:
            a, b, d = (
                section.membrane(triangles, points),
                section.coupling,
                section.bending(triangles, points),
            )
            return a, b + z * a, d + 2 * z * b + z * z * a

        triangles = np.arange(len(self.space.triangles))
        constant = not isinstance(self.scene.thickness, dict) and section.constant_per_triangle
        points, weight = self.discretisation.interior_points(triangles[:1] if constant else triangles)
        triangles = triangles[: len(points)]
        weight = (weight / weight.sum(axis=1, keepdims=True))[..., None, None]
        a, b, d = ((weight * m).sum(axis=1) for m in at(triangles, points))
        stiffness = Stiffness.from_stiffness(a, d, b, direction=self.scene.direction)
        return stiffness if section.constant_per_triangle else replace(stiffness, varying=at)

    def equilibrium(self) -> Problem:
        """The same for large deflections, all loads and prescribed motions growing with one factor."""
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
            np.sum([np.zeros(self.discretisation.unknowns), *dead], axis=0),
            follower,
            self.springs,
            initial=loads.initial,
        )

    @cached_property
    def locator(self) -> Locator:
        """Of points on the surface at rest."""
        return Locator.of(self.space)

    def forces_at(self, state: State) -> list[Floats]:
        """(unknowns,) force of each load in a state."""
        loads = self.loads
        return [
            state.factor * (loads.followers[k](state.x)[0] if k in loads.followers else force)
            for k, force in enumerate(loads.forces)
        ]

    def reasons(self) -> list[str]:
        """Why this model, in words."""
        return [*self.choice.reasons]

    def warnings(self) -> list[str]:
        """What the user should know about the model."""
        out = [*self.supports.warnings, *self.loads.warnings]
        out += shape_warnings(self.space, self.discretisation, self.section)
        out += self._axes_warnings()
        still = not np.any(self.load) and self.loads.initial is None
        if still and not np.any(self.reduction.given):
            out.append("there is no load and no prescribed motion: the deflection is zero")
        return out

    def _axes_warnings(self) -> list[str]:
        """Material axes counted from the projection of x jump where x is nearly normal."""
        directed = any(_depends_on_direction(q) for q in self.section.moduli)
        if self.scene.direction is not None or not directed:
            return []
        mesh = self.space
        corners = mesh.points[mesh.triangles]
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[None]
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


def moved_mesh(mesh: Mesh, order: int, offsets: Floats) -> Mesh:
    """The mesh with nodes of an order moved by (node, 3) offsets."""
    count, edges = len(mesh.points), len(mesh.edges)
    points = mesh.points + offsets[:count]
    if mesh.midpoints is None:
        return replace(mesh, points=points)
    ends = offsets[:count][mesh.edges].sum(axis=1)
    inner = offsets[count : count + (order - 1) * edges].reshape(edges, order - 1, 3).sum(axis=1)
    # the polynomial of the edge at its middle
    middle = {1: 0.5 * ends, 2: inner, 3: (9 * inner - ends) / 16}[order]
    return replace(mesh, points=points, midpoints=mesh.midpoints + middle)


def _depends_on_direction(q: Floats) -> bool:
    """Whether a plane-stress stiffness (3, 3) is not isotropic: it changes when it is turned."""
    return bool(
        np.abs(rotated(q, 30.0) - q).max() + np.abs(rotated(q, 45.0) - q).max() > 1e-9 * np.abs(q).max()
    )


def _discretise(
    scene: Scene, mesh: Mesh, choice: ModelChoice, hinges: NDArray[np.integer], offsets: Floats | None
) -> Any:
    if choice.element == "argyris":
        from kshell.shell.chart.discretisation import ArgyrisDiscretisation

        if len(hinges):
            raise InputError(
                f"support hinge: Argyris functions on a chart are smooth, so there are no hinges: {USE_KOITER}"
            )
        return ArgyrisDiscretisation(mesh, scene.chart)
    lift: Callable[[Floats], Floats] | None = None
    if scene.chart is not None:

        def lift(points: Floats) -> Floats:
            return lifted(scene, points)

    return KoiterDiscretisation(mesh, choice.order, lift, hinges, offsets)
