"""Forces at points in the plane of a shell, of loads and of supports: what they stretch grows without bound.

Around such a force membrane forces are like 1 / r, so that what it moves its own place by, and the energy, are like
log 1 / r: finer meshes find more and more. A force along the normal bends only, which is finite; so is one in the plane
of one sheet at a fold, if another sheet bends under it: then it ends where that is as stiff, about a thickness away.

Symbols
-------
F_t        part of the force that no normal at its place has
Theta      opening angle of a sheet at the place
c          2 / (Theta - |sin Theta|) over Young's modulus times the thickness E t: displacement of a wedge along a force
           1, in its softest direction, for each factor e in r

Source: Timoshenko & Goodier, Theory of Elasticity, 3rd ed., articles 36 to 38 (forces on a half plane and on the tip of
a wedge) and 42 (inside a plate: (3 - nu) (1 + nu) / (4 pi) per factor e, up to .3; c is .32).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.equilibrium.model import Solved
from kshell.mesh import quadratic
from kshell.mesh.mesh import Mesh
from kshell.scene.supports import RigidLink
from kshell.shell.model import ShellModel

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

FACTORS = (
    28.0  # factors e from a mesh to the smallest triangles that coordinates have digits for, 40 halvings
)
HELD = 1e-9  # of a unit displacement, that a place is free to make
NEGLIGIBLE = 1e-9  # of the largest force
FLAT = 0.05  # of singular values of normals, below which a fold is none


@dataclass(frozen=True)
class Pushed:
    """A place that a force in the plane pushes.

    Attributes
    ----------
    vertex : int
    support : bool
        Whether the force is that of a support.
    displacement, energy : float
        What the smallest triangles that can be would add to the displacement of the place, and to the strain energy.
    endless : float
        What of the displacement ends with no size of triangles.
    """

    vertex: int
    support: bool
    displacement: float
    energy: float
    endless: float


def pushed(model: Any, answer: Any, factors: Sequence[float] | None) -> list[Pushed]:
    """The places of a shell that forces push in its plane; loads (load,) act times factors.

    Parameters
    ----------
    model : ShellModel
    answer : Solved or State
        Reactions are those of small deflections.
    """
    forces = [(vertex, False, force) for vertex, force in _of_loads(model, factors).items()]
    forces += [(vertex, True, force) for vertex, force in _of_supports(model, answer).items()]
    largest = max((float(np.linalg.norm(force)) for *_, force in forces), default=0.0)
    out = []
    for vertex, support, force in forces:
        if np.linalg.norm(force) > NEGLIGIBLE * largest:
            moved = force if support else _free(model, vertex, force)
            out.append(_Place(model, vertex).pushed(moved, support))
    return [each for each in out if each.displacement > 0.0]


def _of_loads(model: ShellModel, factors: Sequence[float] | None) -> dict[int, Floats]:
    """Forces (3,) of point loads by vertex."""
    out: dict[int, Floats] = {}
    for number, placed in enumerate(model.structure.loads):
        factor = 1.0 if factors is None else factors[number]
        if placed.item.kind != "point_force" or placed.place is None or placed.link or factor == 0.0:
            continue
        values = np.broadcast_to(
            placed.item.at(placed.places(model.structure.space)), (len(placed.place.members), 3)
        )
        for vertex, value in zip(placed.place.members.tolist(), values, strict=True):
            out[vertex] = out.get(vertex, np.zeros(3)) + factor * value
    return out


def _of_supports(model: ShellModel, answer: Any) -> dict[int, Floats]:
    """Reactions (3,) of vertices that are held, or have springs, by themselves."""
    mesh, problem = model.structure.space, model.problem
    if not isinstance(answer, Solved):
        return {}
    alone, lines = np.zeros((2, len(mesh.points)), dtype=bool)
    for placed in model.structure.supports:
        if placed.place is None or isinstance(placed.item, RigidLink):
            continue
        if placed.place.dimension == 0:
            alone[placed.place.members] = True
            continue
        edges = placed.place.members
        if placed.place.dimension == 2:
            edges = mesh.triangle_edges[edges].ravel()
        lines[mesh.edges[edges]] = True
    forces = answer.own.forces
    if problem.springs is not None:
        forces = forces - problem.springs @ answer.x
    return {
        vertex: np.array(
            [problem.discretisation.translation_row(*_at(mesh, vertex), axis) @ forces for axis in range(3)]
        )
        for vertex in np.flatnonzero(alone & ~lines).tolist()
    }


def _at(mesh: Mesh, vertex: int) -> tuple[int, Floats]:
    """A triangle, and the place of a vertex in it."""
    triangle, corner = np.argwhere(mesh.triangles == vertex)[0]
    return int(triangle), np.eye(3)[corner, 1:]


def _free(model: ShellModel, vertex: int, force: Floats) -> Floats:
    """The part (3,) of a force along which its place can move."""
    mesh, problem = model.structure.space, model.problem
    rows = [problem.discretisation.translation_row(*_at(mesh, vertex), axis) for axis in range(3)]
    reduced = np.stack([np.asarray(problem.reduction.basis.T @ row) for row in rows])
    size, axes = np.linalg.eigh(reduced @ reduced.T)
    free = axes[:, size > HELD]
    return np.asarray(free @ (free.T @ force))


class _Place:
    """The sheets around a vertex: their normals, opening angles and stiffness."""

    def __init__(self, model: ShellModel, vertex: int) -> None:
        mesh, section = model.structure.space, model.problem.section
        pieces = model.problem.discretisation.patches()[0]
        triangles, corners = np.nonzero(mesh.triangles == vertex)
        x = mesh.points[mesh.triangles[triangles]]
        sides = [np.take_along_axis(x, ((corners + k) % 3)[:, None, None], axis=1)[:, 0] for k in range(3)]
        first, second = sides[1] - sides[0], sides[2] - sides[0]
        across = _normals(mesh, triangles, corners)
        angle = np.arctan2(np.linalg.norm(np.cross(first, second), axis=1), (first * second).sum(axis=1))
        centres = x.mean(axis=1)[:, None]
        membrane, bending = (of(triangles, centres)[:, 0] for of in (section.membrane, section.bending))
        young = 1.0 / np.linalg.inv(membrane)[:, [0, 1], [0, 1]].max(axis=1)
        t = float(
            np.sqrt(12.0 * np.trace(bending, axis1=1, axis2=2) / np.trace(membrane, axis1=1, axis2=2)).min()
        )
        self.vertex = vertex
        self.to_thickness = max(float(np.log(np.linalg.norm(first, axis=1).max() / t)), 0.0)
        self.normals: list[Floats] = []
        self.stiffness: list[float] = []
        self.doubt = 0.0  # sine of the angle by which normals of one sheet differ
        for piece in np.unique(pieces[triangles]):
            mine = np.flatnonzero(pieces[triangles] == piece)
            sign = np.sign(across[mine] @ across[mine[0]])[:, None]
            normal = (sign * across[mine] * angle[mine][:, None]).sum(axis=0)
            normal /= np.linalg.norm(normal)
            self.normals.append(normal)
            self.doubt = max(self.doubt, float(np.linalg.norm(np.cross(across[mine], normal), axis=1).max()))
            theta = float(angle[mine].sum())
            self.stiffness.append(0.5 * (theta - abs(np.sin(theta))) * float(young[mine].min()))

    def pushed(self, force: Floats, support: bool) -> Pushed:
        """What a force does."""
        left, values, _ = np.linalg.svd(np.array(self.normals).T, full_matrices=False)
        bends = left[:, values > FLAT]
        bending = bends @ (bends.T @ force)
        along = force - bending
        size = float(np.linalg.norm(along)) - self.doubt * float(np.linalg.norm(force))
        endless, energy = 0.0, 0.0
        if size > NEGLIGIBLE * float(np.linalg.norm(force)):
            endless = FACTORS * size / self._stretched(along)
            energy = 0.5 * endless * size
        ends, size = 0.0, float(np.linalg.norm(bending))
        if bends.shape[1] > 1 and size > 0.0:
            ends = self.to_thickness * size / self._stretched(bending)
        return Pushed(self.vertex, support, endless + ends, energy + 0.5 * ends * size, endless)

    def _stretched(self, force: Floats) -> float:
        """Force for each displacement along it and each factor e, of the sheets in whose plane it is."""
        unit = force / np.linalg.norm(force)
        return sum(
            stiff * float(1.0 - (normal @ unit) ** 2)
            for stiff, normal in zip(self.stiffness, self.normals, strict=True)
        )


def _normals(mesh: Mesh, triangles: Ints, corners: Ints) -> Floats:
    """(n, 3) unit normals of triangles at their corners."""
    x = mesh.points[mesh.triangles[triangles]]
    if mesh.midpoints is None:
        normal = np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0])
    else:
        nodes = np.concatenate([x, mesh.midpoints[mesh.triangle_edges[triangles]]], axis=1)
        normal = quadratic.normals(nodes, np.eye(3))[corners, np.arange(len(corners))]
    return np.asarray(normal / np.linalg.norm(normal, axis=1, keepdims=True))
