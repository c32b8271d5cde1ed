"""What a mesh must fulfil, in words for the user: what is wrong, where, and how to mend it.

The functions that take raw arrays are used while a mesh is built; `plate_problems` says whether a finished
mesh can be a plate.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kshell.errors import InputError
from kshell.mesh import quadratic
from kshell.mesh.quality import Quality, Summary, quality, summary
from kshell.mesh.raw import RawMesh
from kshell.mesh.triangulation import FLAT, Triangulation
from kshell.mesh.unjoined import unjoined
from kshell.mesh.words import count, place

__all__ = ["Quality", "Summary", "plane_of", "plate_problems", "quality", "summary"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

# twice the area below this fraction of the longest edge squared is no area at all
NO_AREA = 1e-10

HOW_TO_TRIANGLES = {
    "solid cells": "kshell models the midsurface of a thin body: describe that surface, and mesh in two "
    "dimensions, `gmsh -2 file.geo`, without a Physical Volume",
    "triangles of order 5 or higher": "Set `Mesh.ElementOrder = 2;` (or 1) and mesh again",
    "quadrilaterals of order 3 or higher": "Set `Mesh.ElementOrder = 2;` (or 1) and mesh again",
}


def only_triangles(raw: RawMesh) -> None:
    """Raise if the mesh has no triangles, or cells that are none of a surface mesh."""
    if raw.other_cells:
        what = " and ".join(f"{number} {kind}" for kind, number in raw.other_cells.items())
        first = next(iter(raw.other_cells))
        how = HOW_TO_TRIANGLES.get(first, "Mesh again with triangles")
        raise InputError(
            f"{raw.source}: has {what}, but kshell takes triangles and quadrilaterals of order 1 or 2. {how}"
        )
    if len(raw.triangles):
        return
    if raw.segments:
        raise InputError(
            f"{raw.source}: has {count(raw.segments, 'line cell')} but no triangles. Mesh the surface, "
            "`gmsh -2 file.geo`; where physical groups exist gmsh saves nothing else, so the surface needs "
            'one too: `Physical Surface("plate") = {1};`'
        )
    raise InputError(f"{raw.source}: has no triangles. Mesh the surface first: `gmsh -2 file.geo`")


def usable_nodes(points: Floats, triangles: Ints, source: str) -> None:
    """Raise where a triangle names a node that does not exist, twice the same, or one without a place."""
    low, high = int(triangles[:, :3].min()), int(triangles.max())
    if low < 0 or high >= len(points):
        bad = low if low < 0 else high
        row = int(np.flatnonzero(np.equal(triangles, bad).any(axis=1))[0])
        raise InputError(
            f"{source}: triangle {row} names node {bad}, but there are nodes 0 to {len(points) - 1} only"
        )
    if not np.isfinite(points).all():
        finite: NDArray[np.bool_] = np.all(np.isfinite(points), axis=1)
        nodes = np.unique(triangles[triangles >= 0])
        broken = nodes[~finite[nodes]]
        if len(broken):
            raise InputError(
                f"{source}: {count(len(broken), 'node')} of the triangles have coordinates that are not "
                f"finite numbers, e.g. node {broken[0]}: {points[broken[0]].tolist()}. Repair the file or "
                "export it again"
            )
    corners = triangles[:, :3]
    equal = corners == corners[:, [2, 0, 1]]
    if equal.any():
        same = np.flatnonzero(equal.any(axis=1))
        where = place(points[triangles[same[0], 0]])
        raise InputError(
            f"{source}: {count(len(same), 'triangle')} with the same corner twice, e.g. triangle {same[0]} "
            f"at {where}. Remove such cells, or mesh again"
        )


def nodes_and_vertices(points: Floats, vertex_of: Ints, middle_nodes: Ints | None, source: str) -> None:
    """Raise where the mid-edge node of one triangle is a corner of another."""
    if middle_nodes is None:
        return
    nodes = middle_nodes[middle_nodes >= 0]
    both = nodes[vertex_of[nodes] >= 0]
    if len(both):
        raise InputError(
            f"{source}: the node at {place(points[both[0]])} is a corner of one triangle and a mid-edge node "
            f"of another ({count(len(np.unique(both)), 'such node')}): the mesh does not fit together there. "
            "Mesh again in one piece"
        )


def areas(points: Floats, triangles: Ints, source: str) -> Floats:
    """(triangle,) areas; raise where a triangle has none."""
    a, b, c = points[triangles.T]
    sides = np.empty((3, *a.shape))
    sides[0], sides[1], sides[2] = b - a, c - a, c - b
    u, v = sides[0].T, sides[1].T
    x, y, z = u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]
    twice_area: Floats = np.sqrt(x * x + y * y + z * z)
    longest = (sides * sides).sum(axis=2).max(axis=0)
    bad = (twice_area <= NO_AREA * longest).nonzero()[0]
    if len(bad):
        middle = (a + b + c)[bad[0]] / 3
        raise InputError(
            f"{source}: {count(len(bad), 'triangle')} without area, e.g. triangle {bad[0]} at "
            f"{place(middle)}. Such cells come from edges or faces of the geometry that are too short: merge "
            "them (`Geometry.Tolerance`, `Coherence;`) and mesh again"
        )
    return 0.5 * twice_area


def is_flat(points: Floats) -> bool:
    """Whether all points lie in one plane z = const."""
    return bool(np.ptp(points[:, 2]) <= FLAT * np.linalg.norm(np.ptp(points, axis=0)))


def curved_triangles(mesh: Triangulation, midpoints: Floats) -> None:
    """Raise where the mid-edge nodes turn a triangle of order 2 inside out."""
    bad = quadratic.inside_out(mesh, midpoints)
    if len(bad):
        where = place(mesh.points[mesh.triangles[bad[0]]].mean(axis=0))
        raise InputError(
            f"{mesh.source}: {count(len(bad), 'triangle')} of order 2 turned inside out by their mid-edge "
            f"nodes, the worst at {where}. Mesh finer along the curved edge, or "
            "use gmsh's optimisation: `Mesh.HighOrderOptimize = 2;`"
        )


def connections(mesh: Triangulation) -> list[str]:
    """Raise where parts of the mesh touch without being joined; say in words what else is odd."""
    notes = unjoined(mesh)
    branches = np.flatnonzero(mesh.edge_counts > 2)
    if len(branches):
        middle = mesh.points[mesh.edges[branches[0]]].mean(axis=0)
        notes.append(
            f"{count(len(branches), 'edge')} shared by more than two triangles, e.g. at {place(middle)}: "
            "sheets of a shell branch there"
        )
    return notes


def plane_of(mesh: Triangulation) -> tuple[Floats, Floats, float]:
    """The best plane through the mesh.

    Returns
    -------
    centre : (3,) array
    normal : (3,) unit array, its largest component positive
    distance : float
        The largest distance of a node from that plane.
    """
    x = mesh.points if mesh.midpoints is None else np.concatenate([mesh.points, mesh.midpoints])
    centre = x.mean(axis=0)
    scatter = (x - centre).T @ (x - centre)
    normal = np.linalg.eigh(scatter)[1][:, 0]
    if normal[np.argmax(np.abs(normal))] < 0:
        normal = -normal
    return centre, normal, float(np.abs((x - centre) @ normal).max())


def plate_problems(mesh: Triangulation) -> None:
    """Raise what a plate in its plane z = const cannot take.

    Raises
    ------
    InputError
        If the mesh is not planar, planar but not in a plane z = const, or branches.
    """
    z = mesh.points[:, 2] if mesh.midpoints is None else np.concatenate([mesh.points, mesh.midpoints])[:, 2]
    if np.ptp(z) > FLAT * mesh.size:
        centre, normal, distance = plane_of(mesh)
        if distance > 1e-7 * mesh.size:
            off = np.abs((mesh.points - centre) @ normal)
            raise InputError(
                f"{mesh.source}: not planar, so it is no plate: nodes lie up to {distance:.3g} off the best "
                f"plane, e.g. the vertex {place(mesh.points[np.argmax(off)])}. Flatten it, or solve it as a "
                "shell (model "
                f'= "shell")'
            )
        axis = np.argmax(np.abs(normal))
        if normal[axis] > 1 - 1e-12:
            plane = f"{'xyz'[axis]} = {centre[axis]:.6g}"
        else:
            plane = f"{normal[0]:.4g} x + {normal[1]:.4g} y + {normal[2]:.4g} z = {centre @ normal:.6g}"
        turn = np.cross(normal, [0.0, 0.0, 1.0])
        angle = float(np.arccos(np.clip(normal[2], -1.0, 1.0)))
        axis_text = ", ".join(f"{c:.6g}" for c in turn / np.linalg.norm(turn) + 0.0)
        about = ", ".join(f"{c:.6g}" for c in centre)
        raise InputError(
            f"{mesh.source}: lies in the plane {plane}, but a plate lies in a plane z = const. Turn it "
            f"there, in the .geo file with `Rotate {{{{{axis_text}}}, {{{about}}}, {angle:.12g}}} {{ "
            "Surface{:}; }`, or solve it as a shell "
            '(model = "shell")'
        )
    branches = np.flatnonzero(mesh.edge_counts > 2)
    if len(branches):
        middle = mesh.points[mesh.edges[branches[0]]].mean(axis=0)
        raise InputError(
            f"{mesh.source}: {count(len(branches), 'edge')} shared by more than two triangles, e.g. at "
            f"{place(middle)}: in a plane that means triangles lie upon each other. Remove the copies, or "
            "mesh again in one piece"
        )
