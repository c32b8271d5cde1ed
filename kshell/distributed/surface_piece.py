"""What is dealt out of a shell: some triangles of a surface, and what belongs to them.

Whatever depends on neighbours, as directors at edges and normals do, is found on the whole surface.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from kshell.mesh.mesh import Mesh
from kshell.shell.koiter.edges import Directors
from kshell.shell.koiter.surface import Surface
from kshell.shell.reference import reference_triangle
from kshell.shell.section import Section

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]


@dataclass(frozen=True)
class SurfacePlaces:
    """The numbers in the whole of what some triangles have, each ascending.

    Attributes
    ----------
    triangles, nodes, sets, rotations, unknowns : int arrays
        Sets are those of the rotations of an edge.
    """

    triangles: Ints
    nodes: Ints
    sets: Ints
    rotations: Ints
    unknowns: Ints

    @classmethod
    def of(cls, surface: Surface, triangles: Ints) -> SurfacePlaces:
        """Those of some triangles of a surface, which ascend."""
        p = surface.order
        nodes = np.unique(surface.triangle_nodes[triangles])
        sets = np.unique(surface.rotation_edge[triangles])
        rotations = (p * sets[:, None].astype(np.int64) + np.arange(p)).ravel()
        translations = (3 * nodes[:, None].astype(np.int64) + np.arange(3)).ravel()
        return cls(
            triangles, nodes, sets, rotations, np.append(translations, surface.rotation_start + rotations)
        )


@dataclass(frozen=True)
class SurfaceData:
    """What makes a `PartSurface`: arrays alone, in numbers of the part."""

    order: int
    nodes: Floats
    triangle_nodes: NDArray[np.int32]
    rotation_edge: NDArray[np.int32]
    edge_sign: NDArray[np.int8]
    sets: int

    @classmethod
    def of(cls, surface: Surface, places: SurfacePlaces) -> SurfaceData:
        """That of some triangles of a surface."""
        some = places.triangles
        return cls(
            surface.order,
            surface.nodes[places.nodes],
            np.searchsorted(places.nodes, surface.triangle_nodes[some]).astype(np.int32),
            np.searchsorted(places.sets, surface.rotation_edge[some]).astype(np.int32),
            surface.edge_sign[some],
            len(places.sets),
        )


class PartSurface(Surface):
    """A part of a surface by itself, for energies and masses.

    Parameters
    ----------
    data : SurfaceData
    """

    def __init__(self, data: SurfaceData) -> None:
        vertices = int(data.triangle_nodes[:, :3].max()) + 1
        self.order, self.nodes, self.flat_nodes = data.order, data.nodes, data.nodes
        self.mesh = Mesh(data.nodes[:vertices], data.triangle_nodes[:, :3])
        self.reference = reference_triangle(data.order)
        self.triangle_nodes, self.edge_sign = data.triangle_nodes, data.edge_sign
        self.node_count = len(data.nodes)
        self.rotation_owner = np.zeros(data.sets, dtype=np.int32)  # edges of the whole, of no use here
        self._number_unknowns(data.rotation_edge)


def section_of(section: Section, triangles: Ints, points: Floats | None = None) -> Section:
    """The section of some triangles.

    Parameters
    ----------
    points : (n, point, 3), optional
        Places in these triangles at which it is asked for if it varies inside them; nowhere else then.
    """

    def some(values: Floats) -> Floats:
        return values[triangles] if len(values) > 1 else values

    varying = None
    if section.varying is not None:
        assert points is not None
        varying = Tabulated(*section.varying(triangles, points))
    return replace(
        section,
        membrane=some(section.membrane),
        coupling=some(section.coupling),
        bending=some(section.bending),
        angle=some(section.angle),
        direction=section.direction_of(triangles),
        varying=varying,
    )


@dataclass(frozen=True)
class Tabulated:
    """A, B, D of triangles at their interior points, (triangle, point, 3, 3)."""

    membrane: Floats
    coupling: Floats
    bending: Floats

    def __call__(self, triangles: Ints, points: Floats) -> tuple[Floats, Floats, Floats]:
        """Those of some triangles, whose points are known."""
        return self.membrane[triangles], self.coupling[triangles], self.bending[triangles]


def directors_of(directors: Directors, places: SurfacePlaces) -> Directors:
    """The directors of some triangles."""
    return Directors(
        np.ascontiguousarray(directors.vectors[:, places.rotations]),
        directors.base[places.nodes],
        directors.angle[places.triangles],
    )
