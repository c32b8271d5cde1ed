"""The mesh of a scene in space: for a chart the surface over its parameter plane."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.errors import InputError
from kshell.mesh.check import is_flat
from kshell.mesh.mesh import Mesh
from kshell.mesh.words import count, place

Floats = NDArray[np.float64]

POINT = 1e-12  # length of an edge, against the size of the mesh, that is none
REGULAR = 1e-9  # sine of the angle of the tangents of a chart below which it has no normal


def mesh_in_space(chart: Any, mesh: Mesh) -> Mesh:
    """The mesh itself, or the same triangles on the chart, of order 2, with the same groups.

    Raises
    ------
    InputError
        If there is a chart but the mesh is not flat in a plane z = const, or the chart takes an edge to a point
        or to none.
    """
    if chart is None:
        return mesh
    nodes = mesh.points if mesh.midpoints is None else np.concatenate([mesh.points, mesh.midpoints])
    if not is_flat(nodes):
        z = nodes[:, 2]
        raise InputError(
            f"{mesh.source}: the scene has a chart, so the mesh must lie in its parameter plane (u, v, 0), but z goes "
            f"from {z.min():g} to {z.max():g}: mesh the parameters, or leave the chart out"
        )
    middle = mesh.points[mesh.edges].mean(axis=1) if mesh.midpoints is None else mesh.midpoints
    space = replace(mesh, points=lifted(chart, mesh.points), midpoints=lifted(chart, middle))
    _require_edges(mesh, space)
    return space


def _require_edges(mesh: Mesh, space: Mesh) -> None:
    """Raise if the chart takes an edge to a point, as at the pole of a sphere."""
    shrunk = np.flatnonzero(~(space.edge_lengths > POINT * space.size))
    if len(shrunk):
        (a, b), at = mesh.points[mesh.edges[shrunk[0]]], space.points[mesh.edges[shrunk[0], 0]]
        raise InputError(
            f"{mesh.source}: the chart takes {count(len(shrunk), 'edge')} to single points, e.g. the one from (u, v) = "
            f"{place(a)} to {place(b)} to {place(at)}: it has no tangents and no normal there. Leave such places, "
            "poles and tips, out of the mesh, or mesh the surface in space"
        )


@dataclass(frozen=True)
class ChartLift:
    """From the parameters of a chart to its surface.

    Attributes
    ----------
    chart : Chart
    """

    chart: Any

    def __call__(self, parameters: Floats) -> Floats:
        """Points (n, 3) over parameters (n, 2 or 3)."""
        return lifted(self.chart, parameters)

    def normals(self, parameters: Floats) -> Floats | None:
        """(n, 3) unit normals there; None where one of them does not exist, or derivatives are not known."""
        if self.chart.map.highest < 1:
            return None
        x_u, x_v = np.moveaxis(self.chart.derivatives(*parameters[:, :2].T, order=1)[1], -2, 0)
        normal = np.cross(x_u, x_v)
        length = np.linalg.norm(normal, axis=1)
        if np.any(length <= REGULAR * np.linalg.norm(x_u, axis=1) * np.linalg.norm(x_v, axis=1)):
            return None
        out: Floats = normal / length[:, None]
        return out


def lifted(chart: Any, parameters: Floats) -> Floats:
    """Points (n, 3) of the chart over parameters (n, 2 or 3)."""
    return np.asarray(chart.derivatives(*parameters[:, :2].T, order=0)[0], dtype=float)
