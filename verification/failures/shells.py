"""A rectangle of parameters lifted to a shell, its edges and vertices found by their parameters."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from kshell.mesh.mesh import Mesh
from kshell.shell.koiter.energy import Koiter
from kshell.shell.koiter.supports import Supports
from kshell.shell.koiter.surface import Surface
from kshell.shell.section import Section

Floats = NDArray[np.float64]
NEAR = 1e-9


class ShellModel:
    """Surface, energy and supports on a mesh in the parameter plane.

    Parameters
    ----------
    mesh : Mesh
    order : int
    section : Section
    lift : function, optional
        Points of the mesh (n, 3) to the surface.
    energy : type, optional
        What to make of surface and section.
    """

    def __init__(
        self,
        mesh: Mesh,
        order: int,
        section: Section,
        lift: Callable[[Floats], Floats] | None = None,
        energy: type[Koiter] = Koiter,
    ) -> None:
        self.mesh = mesh
        self.surface = Surface(mesh, order, lift)
        self.koiter = energy(self.surface, section)
        self.supports = Supports(self.surface)

    def edges(self, axis: int, value: float) -> NDArray[np.integer]:
        """Boundary edges at a value of a parameter."""
        return edges_at(self.mesh, axis, value)

    def vertex(self, u: float, v: float) -> int:
        """The vertex nearest to parameters."""
        return vertex_at(self.mesh, u, v)


def edges_at(mesh: Mesh, axis: int, value: float) -> NDArray[np.integer]:
    """Boundary edges at a value of a parameter."""
    boundary = mesh.boundary_edges
    middle = mesh.points[mesh.edges[boundary]].mean(axis=1)
    return np.asarray(boundary[np.abs(middle[:, axis] - value) < NEAR])


def vertex_at(mesh: Mesh, u: float, v: float) -> int:
    """The vertex nearest to parameters."""
    return int(np.argmin(np.hypot(mesh.points[:, 0] - u, mesh.points[:, 1] - v)))


def cylinder(radius: float) -> Callable[[Floats], Floats]:
    """Arc length and axis to a cylinder with its crown at z = radius."""
    return lambda q: np.column_stack(
        [radius * np.sin(q[:, 0] / radius), q[:, 1], radius * np.cos(q[:, 0] / radius)]
    )
