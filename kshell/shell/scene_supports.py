"""Supports of a scene on a shell: from names to conditions on the motion, and springs."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.csgraph import connected_components

from kshell.errors import InputError
from kshell.mesh.mesh import Mesh
from kshell.mesh.select import Selection, select

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

# a line of symmetry that turns by more is taken apart there, if it does not lie in one plane
CORNER = np.radians(25.0)
# how far a planar line may leave its plane, against its size
PLANAR = 1e-3


@dataclass
class HeldGroup:
    """What one support of the scene does.

    Attributes
    ----------
    label : str
    conditions : of the discretisation, or None for springs
    spring : sparse matrix or None
    """

    label: str
    conditions: Any = None
    spring: sp.csr_matrix | None = None


@dataclass
class SceneSupports:
    """All supports of a scene.

    Attributes
    ----------
    conditions : of the discretisation
        All together.
    groups : list of HeldGroup
        One by one, for reactions.
    warnings : list of str
    """

    conditions: Any
    groups: list[HeldGroup] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)

    @property
    def springs(self) -> sp.csr_matrix | None:
        """Stiffness of all springs, None where there are none."""
        found = [group.spring for group in self.groups if group.spring is not None]
        return None if not found else sum(found[1:], found[0])


def hinge_edges(supports: list[Any], mesh: Mesh) -> Ints:
    """Edges of all hinge lines.

    Raises
    ------
    InputError
        If a hinge is not on curves, or at the boundary, where there is nothing to release.
    """
    edges: list[Ints] = [np.zeros(0, dtype=np.int64)]
    for support in supports:
        if support.kind == "hinge":
            chosen = select(mesh, support.on, dimensions=(1,), what=str(support))
            outside = chosen.members[mesh.edge_counts[chosen.members] == 1]
            if len(outside):
                x, y, z = mesh.points[mesh.edges[outside[0]]].mean(axis=0)
                raise InputError(
                    f"{support}: the edge at ({x:.6g}, {y:.6g}, {z:.6g}) belongs to one triangle only: a hinge joins "
                    "sheets; at the boundary the rotation is free already, with simply_supported too"
                )
            edges.append(chosen.members)
    return np.unique(np.concatenate(edges))


def apply_supports(supports: list[Any], mesh: Mesh, discretisation: Any) -> SceneSupports:
    """Translate the supports of a scene.

    Parameters
    ----------
    mesh : Mesh
        In space.

    Raises
    ------
    InputError
        For groups that do not exist or do not fit the kind of support.
    """
    out = SceneSupports(discretisation.conditions())
    for support in supports:
        several = isinstance(support.on, tuple) and isinstance(support.on[0], str)
        for on in support.on if several else (support.on,):
            _add(out, support, on, mesh, discretisation)
    return out


def _add(out: SceneSupports, support: Any, on: Any, mesh: Mesh, discretisation: Any) -> None:
    dimensions = (1,) if support.kind in ("symmetry", "hinge") else (0, 1, 2)
    chosen = select(mesh, on, dimensions=dimensions, what=f"support {support.kind}")
    if chosen.warning:
        out.warnings.append(chosen.warning)
    if support.kind in ("free", "hinge"):
        return
    what = f"support {support.kind} on '{chosen.label}'"
    if support.kind == "elastic":
        for letter in support.freedoms:
            spring = discretisation.spring(chosen, letter, support.stiffness_at, what)
            out.groups.append(HeldGroup(chosen.label, spring=spring))
        return
    own = discretisation.conditions()
    pieces = _planar_pieces(mesh, chosen) if support.kind == "symmetry" else []
    for conditions in (out.conditions, own):
        if support.kind == "symmetry":
            for edges in pieces:
                try:
                    conditions.symmetry(edges)
                except InputError as error:
                    raise InputError(f"{what}: {error}") from None
            continue
        letters = support.freedoms.replace("r", "")
        if letters:
            axes = getattr(support, "axes", None)
            conditions.translations(chosen, letters, support.translation_at, axes)
        if "r" in support.freedoms:
            conditions.rotations(chosen, what)
    out.groups.append(HeldGroup(chosen.label, conditions=own))


def _planar_pieces(mesh: Mesh, chosen: Selection) -> list[Ints]:
    """A line of symmetry in pieces that may have planes of their own: connected, and split at sharp corners.

    A piece that lies in one plane, not a straight line, stays whole if the surface leaves it across that plane.
    """
    pieces = []
    for edges in _connected(mesh, chosen.members, np.zeros(0, dtype=np.int64)):
        pieces += [edges] if _is_cut(mesh, edges) else _connected(mesh, edges, _corners(mesh, edges))
    return pieces


def _connected(mesh: Mesh, edges: Ints, cut_at: Ints) -> list[Ints]:
    """Edges that hang together by vertices other than those of `cut_at`."""
    ends = mesh.edges[edges].astype(np.int64)
    number = np.arange(len(edges))
    keep = ~np.isin(ends, cut_at)
    rows = np.concatenate([number[keep[:, k]] for k in (0, 1)])
    columns = np.concatenate([ends[keep[:, k], k] for k in (0, 1)])
    link = sp.csr_matrix((np.ones(len(rows)), (rows, columns)), shape=(len(edges), len(mesh.points)))
    count, label = connected_components(link @ link.T, directed=False)
    return [edges[label == k] for k in range(count)]


def _is_cut(mesh: Mesh, edges: Ints) -> bool:
    """Whether edges lie in one plane that the surface crosses rather than lies in."""
    x = mesh.points[np.unique(mesh.edges[edges])]
    _, size, rows = np.linalg.svd(x - x.mean(axis=0), full_matrices=False)
    if len(x) < 3 or size[1] < PLANAR * size[0] or size[2] > PLANAR * size[0]:
        return False
    a, b, c = (mesh.points[mesh.triangles[mesh.edge_owner[edges, 0], k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    return bool(np.abs(normal @ rows[2]).max() < np.sin(CORNER))


def _corners(mesh: Mesh, edges: Ints) -> Ints:
    """Vertices where a chain of edges turns sharply, branches or crosses itself."""
    ends = mesh.edges[edges]
    along = mesh.points[ends[:, 1]] - mesh.points[ends[:, 0]]
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    vertex = np.concatenate([ends[:, 0], ends[:, 1]])
    leaving = np.concatenate([along, -along])
    count = np.bincount(vertex, minlength=len(mesh.points))
    # two unit vectors that leave a vertex in opposite directions add up to nothing
    total = np.stack([np.bincount(vertex, leaving[:, k], len(mesh.points)) for k in range(3)], axis=1)
    sharp = np.linalg.norm(total, axis=1) > 2.0 * np.sin(0.5 * CORNER)
    return np.flatnonzero((count > 2) | ((count == 2) & sharp))
