"""Supports of a shell: from places to conditions on the motion, and springs."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.equilibrium.reduction import Reduction
from kshell.errors import InputError
from kshell.mesh.connected import connected_parts
from kshell.mesh.mesh import Mesh
from kshell.mesh.select import Selection
from kshell.mesh.vectors import cross
from kshell.scene.handlers import Handlers
from kshell.scene.placed import Placed
from kshell.scene.supports import (
    Clamped,
    Elastic,
    Fixed,
    Free,
    Hinge,
    RigidLink,
    SimplySupported,
    Support,
    Symmetry,
)
from kshell.shell.discretisation import Discretisation
from kshell.shell.links import Link, LinkConditions

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

# a line of symmetry that turns by more is taken apart there, if it does not lie in one plane
CORNER = np.radians(25.0)
# how far a planar line may leave its plane, against its size
PLANAR = 1e-3

HANDLERS = Handlers("is nothing that shells have: leave it out")


@dataclass
class Alone:
    """Conditions of one support by itself, made when its reactions are asked for: models of estimates have none."""

    make: Callable[[], Any]
    add: Callable[[Any], None]

    @cached_property
    def _conditions(self) -> Any:
        made = self.make()
        self.add(made)
        return made

    @cached_property
    def _reduction(self) -> Reduction:
        found: Reduction = self._conditions.alone()
        return found

    def alone(self) -> Reduction:
        """The motions that they leave."""
        return self._reduction


@dataclass
class HeldGroup:
    """What one support does.

    Attributes
    ----------
    label : str
    conditions : Alone or LinkConditions, or None for springs
    spring : sparse matrix or None
    place : Selection, optional
        Where; None at the point of a rigid link.
    """

    label: str
    conditions: Any = None
    spring: sp.csr_matrix | None = None
    place: Selection | None = None


@dataclass
class ShellSupports:
    """All supports of a shell.

    Attributes
    ----------
    conditions : of the discretisation
        All together.
    groups : list of HeldGroup
        One by one, for reactions.
    links : list of Link
        Rigid links.
    warnings : list of str
    projectors : list
        Onto what each group with conditions holds, once reactions were shared among them.
    """

    conditions: Any
    groups: list[HeldGroup] = field(default_factory=list)
    links: list[Link] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)
    projectors: list[Any] = field(default_factory=list)

    @property
    def springs(self) -> sp.csr_matrix | None:
        """Stiffness of all springs, None where there are none."""
        found = [group.spring for group in self.groups if group.spring is not None]
        return None if not found else sum(found[1:], found[0])


def hinge_edges(supports: Iterable[Placed[Support]], mesh: Mesh) -> Ints:
    """Edges of all hinge lines.

    Raises
    ------
    InputError
        If a hinge is at the boundary, where there is nothing to release.
    """
    edges: list[Ints] = [np.zeros(0, dtype=np.int64)]
    for placed in supports:
        if isinstance(placed.item, Hinge):
            chosen = placed.members(mesh)
            outside = chosen[mesh.edge_counts[chosen] == 1]
            if len(outside):
                x, y, z = mesh.points[mesh.edges[outside[0]]].mean(axis=0)
                raise InputError(
                    f"{placed.item}: the edge at ({x:.6g}, {y:.6g}, {z:.6g}) belongs to one triangle only: a hinge "
                    "joins sheets; at the boundary the rotation is free already, with simply_supported too"
                )
            edges.append(chosen)
    return np.unique(np.concatenate(edges))


def apply_supports(
    supports: Iterable[Placed[Support]], mesh: Mesh, discretisation: Discretisation
) -> ShellSupports:
    """Translate the supports of a structure.

    Parameters
    ----------
    mesh : Mesh
        In space.

    Raises
    ------
    InputError
        For supports that do not fit.
    """
    builder = _Builder(mesh, discretisation, ShellSupports(discretisation.conditions()))
    supports = list(supports)
    for placed in sorted(
        supports, key=lambda placed: placed.link is not None
    ):  # links before what holds them
        HANDLERS.handle(builder, placed, builder.out.warnings)
    return builder.out


@dataclass
class _Builder:
    mesh: Mesh
    discretisation: Discretisation
    out: ShellSupports

    @HANDLERS.of(Free, Hinge)
    def _nothing_held(self, support: Any, placed: Placed[Any]) -> None:
        """A hinge releases, which the discretisation knows already."""

    @HANDLERS.of(RigidLink)
    def _link(self, support: Any, placed: Placed[Any]) -> None:
        chosen, _ = self._where(support, placed)
        self.out.links.append(Link.of(support, chosen, self.discretisation))

    @HANDLERS.of(Elastic)
    def _springs(self, support: Any, placed: Placed[Any]) -> None:
        chosen, what = self._where(support, placed)
        for along in support.directions():
            spring = self.discretisation.spring(chosen, along, support.stiffness_at, what)
            self.out.groups.append(HeldGroup(chosen.label, spring=spring, place=chosen))

    @HANDLERS.of(Symmetry)
    def _symmetry(self, support: Any, placed: Placed[Any]) -> None:
        chosen, what = self._where(support, placed)
        pieces = _planar_pieces(self.mesh, chosen)
        normals = []
        for edges in pieces:
            try:
                normals.append(self.out.conditions.symmetry(edges))
            except InputError as error:
                raise InputError(f"{what}: {error}") from None

        def hold(conditions: Any) -> None:
            for edges, normal in zip(pieces, normals, strict=True):
                conditions.symmetry(edges, normal)

        own = Alone(self.discretisation.conditions, hold)
        self.out.groups.append(HeldGroup(chosen.label, conditions=own, place=chosen))

    @HANDLERS.of(Clamped, SimplySupported, Fixed)
    def _held(self, support: Any, placed: Placed[Any]) -> None:
        if placed.link is not None:
            link = next(link for link in self.out.links if link.item is placed.link)
            link.hold(support.freedoms, support.translation_at(np.array([placed.link.to]))[0])
            held = LinkConditions(link, self.discretisation.unknowns)
            self.out.groups.append(HeldGroup(placed.link.name, conditions=held))
            return
        chosen, what = self._where(support, placed)
        letters = support.freedoms.replace("r", "")

        def hold(conditions: Any) -> None:
            if letters:
                axes = getattr(support, "axes", None)
                conditions.translations(chosen, letters, support.translation_at, axes)
            if "r" in support.freedoms:
                conditions.rotations(
                    chosen, what, support.rotation_at if support.rotation is not None else None
                )

        hold(self.out.conditions)
        own = Alone(self.discretisation.conditions, hold)
        self.out.groups.append(HeldGroup(chosen.label, conditions=own, place=chosen))

    @staticmethod
    def _where(support: Any, placed: Placed[Any]) -> tuple[Selection, str]:
        assert placed.place is not None  # supports are somewhere
        return placed.place, f"support {support.kind} on '{placed.place.label}'"


def _planar_pieces(mesh: Mesh, chosen: Selection) -> list[Ints]:
    """A line of symmetry in pieces that may have planes of their own: connected, and split at sharp corners.

    All of it, or a piece, that lies in one plane, not a straight line, stays whole if the surface leaves it across
    that plane.
    """
    if _is_cut(mesh, chosen.members):
        return [chosen.members]
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
    label = connected_parts(len(edges) + len(mesh.points), rows, len(edges) + columns)[1][: len(edges)]
    return [edges[label == k] for k in range(int(label.max(initial=-1)) + 1)]


def _is_cut(mesh: Mesh, edges: Ints) -> bool:
    """Whether edges lie in one plane that the surface crosses rather than lies in."""
    x = mesh.points[np.unique(mesh.edges[edges])]
    _, size, rows = np.linalg.svd(x - x.mean(axis=0), full_matrices=False)
    if len(x) < 3 or size[1] < PLANAR * size[0] or size[2] > PLANAR * size[0]:
        return False
    a, b, c = (mesh.points[mesh.triangles[mesh.edge_owner[edges, 0], k]] for k in range(3))
    normal = cross(b - a, c - a)
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
