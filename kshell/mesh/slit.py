"""A mesh cut open along curves.

Around every vertex the triangles fall into fans, joined by edges that are not cut; every fan gets a vertex of its own.
That one rule covers tips of a cut (one fan: nothing happens), ends on the boundary, crossings and closed curves.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from kshell.errors import InputError
from kshell.mesh.connected import connected_parts
from kshell.mesh.mesh import Group, Mesh
from kshell.mesh.orient import WALKED_FORWARD
from kshell.mesh.select import select
from kshell.mesh.triangulation import EDGE_VERTICES
from kshell.mesh.words import count

Ints = NDArray[np.int64]

LIPS = ("+", "-")


def slit(mesh: Mesh, on: str | Sequence[str]) -> Mesh:
    """The mesh with a slit along groups of curves; both lips are free edges.

    Parameters
    ----------
    mesh : Mesh
    on : str or list of str
        Groups of curves inside the mesh. Edges of groups appear on both lips; NAME+ and NAME- are new groups with the
        lips of each, + to the left of who walks the edge from its lower to its higher vertex and sees the top.

    Raises
    ------
    InputError
        If there is no such group of curves, or it lies on the boundary, where there is nothing to cut.
    """
    chosen = select(mesh, on, dimensions=(1,), what="cut")
    inside = chosen.members[mesh.edge_counts[chosen.members] > 1]
    if not len(inside):
        raise InputError(f'cut on "{chosen.label}": the curve lies on the boundary, there is nothing to cut')
    cut = np.zeros(len(mesh.edges), dtype=bool)
    cut[inside] = True
    origin, triangles = _opened(mesh, cut)
    opened = Mesh(mesh.points[origin], triangles.astype(np.int32), source=mesh.source)
    edge = mesh.edge_index(origin[opened.edges])  # the edge that each was
    groups = {name: _moved(group, origin, edge) for name, group in mesh.groups.items()}
    for name in [on] if isinstance(on, str) else on:
        own = select(mesh, name, dimensions=(1,), what="cut").members
        groups |= _lips(mesh, opened, cut & np.isin(np.arange(len(cut)), own), name)
    doubled = len(origin) - len(mesh.points)
    where = ", ".join(f'"{name}"' for name in ([on] if isinstance(on, str) else on))
    return replace(
        opened,
        midpoints=None if mesh.midpoints is None else mesh.midpoints[edge],
        groups=groups,
        notes=(*mesh.notes, f"cut open along {where}: {count(doubled, 'vertex', 'vertices')} doubled"),
        curving=mesh.curving,
        higher=mesh.higher,
        parts=mesh.parts,
    )


def _opened(mesh: Mesh, cut: NDArray[np.bool_]) -> tuple[Ints, Ints]:
    """(vertex,) the old vertex of each new one, old ones first, and (triangle, 3) new vertices."""
    corners = mesh.triangles.astype(np.int64)
    number = np.arange(corners.size).reshape(corners.shape)  # of each corner of each triangle
    # corners of one vertex at one edge that is not cut belong to the same fan
    ends = corners[:, EDGE_VERTICES]  # (triangle, edge, end)
    key = mesh.triangle_edges.astype(np.int64)[:, :, None] * len(mesh.points) + ends
    whole = np.broadcast_to(~cut[mesh.triangle_edges][:, :, None], key.shape)
    at, which = number[:, EDGE_VERTICES][whole], key[whole]
    _, column = np.unique(which, return_inverse=True)
    _, fan = connected_parts(corners.size + int(column.max(initial=-1)) + 1, at, corners.size + column)
    fan = fan[: corners.size]
    vertex = corners.ravel()
    touched = np.zeros(len(mesh.points), dtype=bool)
    touched[mesh.edges[cut].ravel()] = True
    fan = np.where(touched[vertex], fan, 0)
    pair, first, of_pair = np.unique(
        vertex * (int(fan.max()) + 1) + fan, return_index=True, return_inverse=True
    )
    owner = vertex[first]  # of each fan; sorted, so that fans of a vertex follow each other
    leads = np.ones(len(pair), dtype=bool)
    leads[1:] = owner[1:] != owner[:-1]
    new = np.empty(len(pair), dtype=np.int64)
    new[leads] = owner[leads]
    new[~leads] = len(mesh.points) + np.arange(int((~leads).sum()))
    origin = np.concatenate([np.arange(len(mesh.points)), owner[~leads]])
    return origin, new[of_pair].reshape(corners.shape)


def _moved(group: Group, origin: Ints, edge: NDArray[np.integer]) -> Group:
    """The group with the copies of its vertices or edges."""
    if group.dimension == 2:
        return group
    known = origin if group.dimension == 0 else edge
    return replace(group, members=np.flatnonzero(np.isin(known, group.members)).astype(np.int32))


def _lips(mesh: Mesh, opened: Mesh, cut: NDArray[np.bool_], name: str) -> dict[str, Group]:
    """The edges on either side of a cut."""
    ends = mesh.triangles[:, EDGE_VERTICES]
    forward = (ends[..., 1] > ends[..., 0]) == WALKED_FORWARD  # walked from the lower to the higher vertex
    there = cut[mesh.triangle_edges]
    sides = (there & forward, there & ~forward)
    return {
        f"{name}{sign}": Group(1, np.unique(opened.triangle_edges[side]).astype(np.int32))
        for sign, side in zip(LIPS, sides, strict=True)
    }
