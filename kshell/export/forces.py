"""Loads as forces and moments on nodes, which every program understands: those that do the same work."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.errors import InputError
from kshell.export.nodes import SIMPSON, Nodes, shapes
from kshell.mesh.mesh import EDGE_VERTICES
from kshell.scene.handlers import Handlers
from kshell.scene.loads import (
    EdgeMoment,
    Gravity,
    LineForce,
    PlacedPressure,
    PointForce,
    PointMoment,
    Pressure,
    Snow,
    Traction,
)
from kshell.scene.placed import Placed
from kshell.scene.structure import Structure

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

HANDLERS = Handlers("has no counterpart in .inp files that kshell writes: leave it out")


def nodal_forces(structure: Structure, nodes: Nodes) -> list[Floats]:
    """(node, 6) forces and moments of each load.

    Raises
    ------
    InputError
        For loads that nodes cannot carry, and those that turn with the surface.
    """
    builder = _Builder(structure, nodes)
    out = []
    for placed in structure.loads:
        if placed.link is not None:
            raise InputError(f"{placed.item}: rigid links are not written into .inp files")
        if getattr(placed.item, "follower", False):
            raise InputError(
                f"{placed.item}: a pressure that turns with the surface is no force on nodes: set follower = false"
            )
        builder.forces = np.zeros((len(nodes.points), 6))
        HANDLERS.handle(builder, placed, [])
        out.append(builder.forces)
    return out


class _Builder:
    def __init__(self, structure: Structure, nodes: Nodes) -> None:
        self.structure, self.nodes = structure, nodes
        self.forces: Floats = np.zeros((0, 6))

    def _add(self, nodes: Ints, values: Floats, first: int = 0) -> None:
        """Sum (n, 3) on nodes (n,): forces, or moments from 3 on."""
        np.add.at(self.forces[:, first : first + 3], nodes.ravel(), values.reshape(-1, 3))

    def _on_area(self, triangles: Ints, per_area: Floats, weights: Floats) -> None:
        """Force per area (triangle, q, 3)."""
        nodal = np.einsum("qn,tqx->tnx", shapes(), per_area * weights[..., None])
        self._add(self.nodes.triangles[triangles], nodal)

    def _places(self, load: Any, triangles: Ints) -> tuple[Floats, Floats, Floats]:
        points, normals, weights = self.nodes.quadrature(triangles)
        at = np.concatenate([points, normals], axis=2) if load.needs_normal else points
        return at, normals, weights

    @HANDLERS.of(Pressure, PlacedPressure)
    def _pressure(self, load: Any, placed: Placed[Any]) -> None:
        triangles = placed.members(self.nodes.mesh)
        at, normals, weights = self._places(load, triangles)
        self._on_area(triangles, load.at(at)[..., None] * normals, weights)

    @HANDLERS.of(Traction, Snow)
    def _traction(self, load: Any, placed: Placed[Any]) -> None:
        triangles = placed.members(self.nodes.mesh)
        at, _, weights = self._places(load, triangles)
        self._on_area(triangles, load.at(at), weights)

    @HANDLERS.of(Gravity)
    def _gravity(self, load: Any, placed: Placed[Any]) -> None:
        triangles = placed.members(self.nodes.mesh)
        if self.structure.masses:
            raise InputError(
                f"{load}: added masses are not written into .inp files: leave them or gravity out"
            )
        points, _, weights = self.nodes.quadrature(triangles)
        mass = self.structure.section.mass(triangles, points)
        if not mass.min(initial=np.inf) > 0.0:
            raise InputError(f"{load}: the material has no density: give it, in mass per volume")
        self._on_area(triangles, mass[..., None] * load.at(points), weights)

    def _along(self, edges: Ints) -> tuple[Ints, Floats, Floats]:
        """Nodes (edge, 3), their places, and derivatives of the place along the edge, in that order."""
        nodes = self.nodes.edge(edges)
        x = self.nodes.points[nodes]
        a, m, b = x[:, 0], x[:, 1], x[:, 2]
        tangent = np.stack([-3 * a + 4 * m - b, b - a, a - 4 * m + 3 * b], axis=1)
        return nodes, x, tangent

    @HANDLERS.of(LineForce)
    def _line_force(self, load: Any, placed: Placed[Any]) -> None:
        nodes, x, tangent = self._along(placed.members(self.nodes.mesh))
        length = np.linalg.norm(tangent, axis=2) * SIMPSON
        self._add(nodes, load.at(x) * length[..., None])

    @HANDLERS.of(EdgeMoment)
    def _edge_moment(self, load: Any, placed: Placed[Any]) -> None:
        edges = placed.members(self.nodes.mesh)
        nodes, x, tangent = self._along(edges)
        mesh = self.nodes.mesh
        triangle, local = mesh.edge_owner[edges].T
        ends = mesh.triangles[triangle[:, None], EDGE_VERTICES[local]]
        corners = mesh.points[mesh.triangles[triangle]]
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        inside = corners.mean(axis=1) - mesh.points[ends].mean(axis=1)
        # counterclockwise about the normal the triangle lies to the left; tension at the top turns along t
        left = np.einsum("ex,ex->e", np.cross(normal, tangent[:, 1]), inside) > 0.0
        sense = np.where(left, 1.0, -1.0)[:, None, None]
        self._add(nodes, load.at(x)[..., None] * sense * tangent * SIMPSON[:, None], first=3)

    @HANDLERS.of(PointForce)
    def _point_force(self, load: Any, placed: Placed[Any]) -> None:
        vertices = placed.members(self.nodes.mesh)
        self._add(vertices, load.at(self.nodes.points[vertices]))

    @HANDLERS.of(PointMoment)
    def _point_moment(self, load: Any, placed: Placed[Any]) -> None:
        vertices = placed.members(self.nodes.mesh)
        self._add(vertices, load.at(self.nodes.points[vertices]), first=3)


def combined(forces: Sequence[Floats], factors: Sequence[float]) -> Floats:
    """(node, 6) sum of loads times factors."""
    return np.asarray(
        sum((f * force for f, force in zip(factors, forces, strict=True)), np.zeros_like(forces[0]))
    )
