"""The Koiter shell on triangles as analyses need it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.mesh.mesh import Mesh
from kshell.scene.on_chart import ChartLift
from kshell.scene.structure import Structure
from kshell.shell.koiter.discretisation import KoiterDiscretisation
from kshell.shell.koiter.yielding import YieldingKoiter
from kshell.shell.model import ShellModel
from kshell.shell.problem import ShellProblem
from kshell.shell.reference import subdivision
from kshell.shell.supports import hinge_edges

Floats = NDArray[np.float64]


class KoiterModel(ShellModel):
    """A Koiter shell of order p.

    Parameters
    ----------
    structure : Structure
    order : int
        From 1 to 6.
    reasons : sequence of str
        Why this model.
    offsets : (node, 3), optional
        By which the nodes are moved before anything is solved, without stress.

    Raises
    ------
    InputError
        If a support, load, material or thickness does not fit, or the shell is not held.
    """

    nodal = True

    def __init__(
        self,
        structure: Structure,
        order: int,
        reasons: Sequence[str] = (),
        offsets: Floats | None = None,
    ) -> None:
        lift = None if structure.chart is None else ChartLift(structure.chart)
        if offsets is not None:
            structure = structure.on(moved_mesh(structure.space, order, offsets))
        hinges = hinge_edges(structure.supports, structure.space)
        discretisation = self._discretised(structure.parameters, order, lift, hinges, offsets)
        super().__init__(ShellProblem(structure, discretisation), reasons)

    def _discretised(self, *given: Any) -> KoiterDiscretisation:
        return KoiterDiscretisation(*given)

    def displaced(self, displacement: Callable[[Floats], Floats]) -> Floats:
        surface = self.problem.discretisation.surface
        x = np.zeros(surface.unknowns)
        x[: surface.rotation_start] = displacement(surface.nodes).ravel()
        return x

    @property
    def yields(self) -> bool:
        return isinstance(self.problem.energy, YieldingKoiter)

    def of_order(self, order: int) -> KoiterModel:
        """The same shell with elements of another order."""
        return KoiterModel(self.structure, order, self.reasons)

    def contact_surface(self) -> tuple[Floats, NDArray[np.integer]]:
        surface = self.problem.discretisation.surface
        return surface.nodes, surface.triangle_nodes[:, subdivision(self.order)].reshape(-1, 3)


def moved_mesh(mesh: Mesh, order: int, offsets: Floats) -> Mesh:
    """The mesh with nodes of an order moved by (node, 3) offsets."""
    count, edges = len(mesh.points), len(mesh.edges)
    points = mesh.points + offsets[:count]
    if mesh.midpoints is None:
        return replace(mesh, points=points)
    ends = offsets[:count][mesh.edges].sum(axis=1)
    inner = offsets[count : count + (order - 1) * edges].reshape(edges, order - 1, 3)
    # the polynomial of the edge at its middle, alike in both directions
    at = np.arange(order + 1)
    others = (0.5 * order - at) / np.where(np.eye(order + 1, dtype=bool), 1.0, at[:, None] - at)
    weights = np.prod(np.where(np.eye(order + 1, dtype=bool), 1.0, others), axis=1)
    middle = weights[0] * ends + np.einsum("k,ekx->ex", weights[1:-1], inner)
    return replace(mesh, points=points, midpoints=mesh.midpoints + middle)
