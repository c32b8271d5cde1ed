"""From what a reader delivers to a `Mesh`: unify, renumber, orient, attach groups, check.

Nothing is lost in silence: what cannot be used is an error, what was repaired is a note.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import replace
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from kshell.errors import InputError
from kshell.mesh import check
from kshell.mesh.distinct import distinct
from kshell.mesh.orient import to_reverse
from kshell.mesh.raw import RawGroup, RawMesh
from kshell.mesh.triangulation import KIND_OF_DIMENSION, Group, Triangulation, changed
from kshell.mesh.words import count, place, quoted

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
M = TypeVar("M", bound=Triangulation)


def build(raw: RawMesh, kind: type[M]) -> M:
    """The checked mesh, of the given class.

    Raises
    ------
    InputError
        If the cells are of the wrong kind or unusable; the message names the place and the mending.
    """
    check.only_triangles(raw)
    notes = list(raw.notes)
    nodes, row_of = unify(raw.triangles)
    check.usable_nodes(raw.points, nodes, raw.source)
    n_copies = _unexplained_copies(raw, row_of)
    if n_copies:
        notes.append(f"{count(n_copies, 'copy of a triangle', 'copies of triangles')} left out")

    used, vertex_of = _renumber(nodes[:, :3], len(raw.points))
    points = np.ascontiguousarray(raw.points[used])
    triangles = vertex_of[nodes[:, :3]]
    middle_nodes = nodes[:, 3:] if nodes.shape[1] == 6 else None
    check.nodes_and_vertices(raw.points, vertex_of, middle_nodes, raw.source)
    n_idle = len(raw.points) - len(used) - _distinct(middle_nodes)
    if n_idle:
        notes.append(f"{count(n_idle, 'node')} of no triangle left out")

    areas = check.areas(points, triangles, raw.source)
    bare = kind(points, triangles.astype(np.int32), source=raw.source)
    bare.__dict__["areas"] = areas
    if (
        raw.edge_table is not None and nodes is raw.triangles and used[-1] == len(used) - 1
    ):  # none has a new number
        bare.__dict__["edge_table"] = raw.edge_table
    midpoints = None if middle_nodes is None else _midpoints(bare, raw.points, middle_nodes)
    flat = bare.is_flat
    reverse = to_reverse(bare, flat)
    if reverse.any():
        bare = reversed_triangles(bare, reverse)
        why = "normals point along +z" if flat else "neighbours agree on the normal"
        notes.append(f"{reverse.sum()} of {count(len(triangles), 'triangle')} reversed so that {why}")
    if midpoints is not None:
        check.curved_triangles(bare, midpoints)

    groups = _groups(raw, bare, vertex_of, row_of, notes)
    parts = None if raw.parts is None else raw.parts[np.unique(row_of, return_index=True)[1]]
    mesh = changed(bare, midpoints=midpoints, groups=groups, higher=raw.higher, parts=parts)
    notes += check.connections(mesh)
    object.__setattr__(mesh, "notes", tuple(notes))  # nobody has it yet
    mesh.__dict__["_faces_up"] = True
    return mesh


def reversed_triangles(mesh: M, which: NDArray[np.bool_]) -> M:
    """The mesh with some triangles (a, b, c) turned to (a, c, b); edges keep their numbers."""
    triangles, triangle_edges = mesh.triangles.copy(), mesh.triangle_edges.copy()
    triangles[which] = triangles[which][:, [0, 2, 1]]
    triangle_edges[which] = triangle_edges[which][:, [2, 1, 0]]
    new = replace(mesh, triangles=triangles)
    new.__dict__["edge_table"] = mesh.edge_table.reordered(triangle_edges)
    return new


def unify(triangles: Ints) -> tuple[Ints, Ints]:
    """Each triangle once.

    MSH 2.2 stores a cell once per group; every copy would add its stiffness again.

    Returns
    -------
    unique : (m, 3 or 6) array, in the order of first appearance
    row_of : (n,) the row of `unique` that each stored triangle became
    """
    corners = np.sort(triangles[:, :3], axis=1)
    n = int(corners.max()) + 1
    if n < 2_000_000:  # three indices fit one 64-bit key
        key = (corners[:, 0] * n + corners[:, 1]) * n + corners[:, 2]
        in_order = np.sort(key)  # most meshes have no copies, and sorting alone is quick
        if (in_order[1:] != in_order[:-1]).all():
            return triangles, np.arange(len(triangles))
        _, first, inverse = np.unique(key, return_index=True, return_inverse=True)
    else:
        _, first, inverse = np.unique(corners, axis=0, return_index=True, return_inverse=True)
    inverse = inverse.ravel()
    if len(first) == len(triangles):
        return triangles, np.arange(len(triangles))
    order = np.argsort(first)
    rank = np.empty(len(order), dtype=np.int64)
    rank[order] = np.arange(len(order))
    return triangles[first[order]], rank[inverse]


def _unexplained_copies(raw: RawMesh, row_of: Ints) -> int:
    """Copies of triangles that do not come from a triangle's being in several groups."""
    if len(row_of) == row_of.max() + 1:
        return 0
    copies = 0
    grouped = np.zeros(len(row_of), dtype=bool)
    for group in raw.groups:
        if group.dimension == 2:
            grouped[group.cells] = True
            copies += len(group.cells) - len(np.unique(row_of[group.cells]))
    rest = row_of[~grouped]
    return copies + len(rest) - len(np.setdiff1d(rest, row_of[grouped]))


def _renumber(corners: Ints, n_nodes: int) -> tuple[Ints, Ints]:
    """Nodes that are corners, and the vertex number of every node (-1 for the others)."""
    is_vertex = np.zeros(n_nodes, dtype=bool)
    is_vertex[corners] = True
    used = np.flatnonzero(is_vertex)
    vertex_of = np.full(n_nodes, -1, dtype=np.int64)
    vertex_of[used] = np.arange(len(used))
    return used, vertex_of


def _distinct(middle_nodes: Ints | None) -> int:
    if middle_nodes is None:
        return 0
    nodes = np.unique(middle_nodes)
    return int(np.count_nonzero(nodes >= 0))


def _midpoints(mesh: Triangulation, node_points: Floats, middle_nodes: Ints) -> Floats:
    """Mid-edge nodes by edge; straight edges where no triangle brings one."""
    edges, nodes = mesh.triangle_edges.ravel(), middle_nodes.ravel()
    if nodes.min(initial=0) < 0:
        given = nodes >= 0
        edges, nodes = edges[given], nodes[given]
    ends = mesh.edges
    midpoints: Floats = 0.5 * (mesh.points[ends[:, 0]] + mesh.points[ends[:, 1]])
    midpoints[edges] = brought = node_points[nodes]
    off = midpoints[edges] - brought
    gap = np.sqrt((off * off).sum(axis=1))
    far = (gap > 1e-6 * mesh.edge_lengths[edges]).nonzero()[0]
    if len(far):
        edge = edges[far[0]]
        raise InputError(
            f"{mesh.source}: the two triangles at the edge near {place(midpoints[edge])} have different "
            f"mid-edge nodes, {gap[far[0]]:.3g} apart ({count(len(far), 'such edge')}): the surface is torn "
            "there. Mesh again in one piece"
        )
    return midpoints


def _groups(
    raw: RawMesh, mesh: Triangulation, vertex_of: Ints, row_of: Ints, notes: list[str]
) -> dict[str, Group]:
    """Groups in vertex, edge and triangle numbers of `mesh`, under names that are unique."""
    parts: dict[tuple[str, int], list[RawGroup]] = defaultdict(list)
    for group in raw.groups:
        parts[group.name.strip() or f"{group.dimension}:{group.tag}", group.dimension].append(group)
    dimensions_of: dict[str, list[int]] = defaultdict(list)
    for name, dimension in parts:
        dimensions_of[name].append(dimension)

    groups: dict[str, Group] = {}
    for (name, dimension), stored in parts.items():
        tags = sorted({group.tag for group in stored if group.tag is not None})
        if len(stored) > 1:
            notes.append(
                f"{len(stored)} groups of {KIND_OF_DIMENSION[dimension]}s are called '{name}': taken together"
            )
        key = name if len(dimensions_of[name]) == 1 else f"{name} ({KIND_OF_DIMENSION[dimension]})"
        found = [_members(group, mesh, vertex_of, row_of) for group in stored]
        total = (len(mesh.points), len(mesh.edges), len(mesh.triangles))[dimension]
        members = distinct(total, *(indices for indices, _ in found)).astype(np.int32)
        lost = sum(n for _, n in found) + sum(group.lost for group in stored)
        groups[key] = Group(dimension, members, tags[0] if tags else None, lost)
        if lost:
            notes.append(
                f"group '{key}': {lost} of its "
                f"{count(lost + len(members), KIND_OF_DIMENSION[dimension] + ' cell')} belong to no "
                "triangle, so it cannot be used whole"
            )
    empty = [name for name, group in groups.items() if not len(group.members) and not group.lost]
    if empty:
        saved_all = " (an MSH 2.2 file saved with `Mesh.SaveAll = 1` loses its groups: save as MSH 4.1)"
        notes.append(f"no cells in {quoted(empty)}{saved_all if len(empty) == len(groups) else ''}")
    twice = [name for name, dimensions in dimensions_of.items() if len(dimensions) > 1]
    if twice:
        both = [f"{name} ({KIND_OF_DIMENSION[d]})" for name in twice for d in sorted(dimensions_of[name])]
        notes.append(f"names used for several kinds of groups are told apart as {quoted(both)}")
    return groups


def _members(group: RawGroup, mesh: Triangulation, vertex_of: Ints, row_of: Ints) -> tuple[Ints, int]:
    """Member indices (-1 removed) and how many distinct stored cells have none."""
    if group.dimension == 2:
        return row_of[group.cells], 0
    vertices = vertex_of[group.cells]
    if group.dimension == 0:
        found = vertices
        cells = group.cells.reshape(-1, 1)
    else:
        found = mesh.edge_index(vertices).astype(np.int64)
        if (vertices < 0).any():
            found[(vertices < 0).any(axis=1)] = -1
        cells = group.cells
    missing = found < 0
    if not missing.any():
        return found, 0
    return found[~missing], len(np.unique(np.sort(cells[missing], axis=1), axis=0))
