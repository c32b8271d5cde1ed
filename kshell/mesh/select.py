"""From what a user writes after `on` to vertices, edges or triangles."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.errors import InputError, clipped
from kshell.mesh.mesh import KIND_OF_DIMENSION, Group, Mesh
from kshell.mesh.words import count, nearest_name, place, quoted, shown

# farther than this fraction of the mesh size a point is not on the vertex it is moved to
MOVED = 1e-6


@dataclass(frozen=True)
class Selection:
    """A part of a mesh that a support, load or probe acts on.

    Attributes
    ----------
    dimension : int
        0, 1 or 2: `members` are vertices, edges or triangles.
    members : (n,) int array
        Sorted, without repetition, never empty.
    label : str
        What the user asked for, for messages and as the key of reactions.
    distance : float
        How far the nearest vertex is from the point asked for; 0 for groups.
    warning : str or None
        Words for the user when `distance` is not negligible.
    """

    dimension: int
    members: NDArray[np.int32]
    label: str
    distance: float = 0.0
    warning: str | None = None


def select(
    mesh: Mesh,
    on: str | Sequence[str] | Sequence[float] | NDArray[np.float64],
    *,
    dimensions: Iterable[int] = (0, 1, 2),
    what: str = "support",
) -> Selection:
    """The vertices, edges or triangles meant by a group name, a list of names, or a point.

    Parameters
    ----------
    mesh : Mesh
    on : str, list of str, or point
        A name may be the "dimension:tag" of gmsh. Where groups of several kinds share a name, the plain name
        means the one whose kind `dimensions` allows. Of a list the union is taken. A point (x, y) or
        (x, y, z) means the nearest vertex.
    dimensions : iterable of int
        The kinds allowed: 0 points, 1 curves, 2 surfaces.
    what : str
        Who asks, for messages.

    Raises
    ------
    InputError
        If a group is unknown, empty, incomplete, ambiguous or of the wrong kind, or the point is not one.
    """
    allowed = tuple(sorted(set(dimensions)))
    if isinstance(on, str):
        group = _group(mesh, on, allowed, what)
        return Selection(group.dimension, group.members, on)
    items: list[Any] = list(on)
    if not items:
        raise InputError(f"{what}: `on` is an empty list. {_existing(mesh)}")
    if all(isinstance(item, str) for item in items):
        return _union(mesh, items, allowed, what)
    if any(isinstance(item, str) for item in items):
        raise InputError(
            f"{what}: `on` mixes names and numbers: {shown(items)}. Give a name, a list of names, or a point [x, y, "
            "z]"
        )
    return _nearest_vertex(mesh, items, allowed, what)


def _union(mesh: Mesh, names: list[str], allowed: tuple[int, ...], what: str) -> Selection:
    groups = [_group(mesh, name, allowed, what) for name in names]
    if len({group.dimension for group in groups}) > 1:
        kinds = ", ".join(
            f"'{name}' is a {group.kind} group" for name, group in zip(names, groups, strict=True)
        )
        raise InputError(
            f"{what}: a list of groups must be of one kind, but {kinds}. Write one {what} for each kind"
        )
    members = np.unique(np.concatenate([group.members for group in groups])).astype(np.int32)
    return Selection(groups[0].dimension, members, ", ".join(names))


def _group(mesh: Mesh, name: str, allowed: tuple[int, ...], what: str) -> Group:
    """The one group of this name (or of the same name with its kind added) that is allowed and usable."""
    variants = {name: mesh.groups[name]} if name in mesh.groups else {}
    for kind in KIND_OF_DIMENSION:
        if f"{name} ({kind})" in mesh.groups:
            variants[f"{name} ({kind})"] = mesh.groups[f"{name} ({kind})"]
    if not variants:
        variants = {
            k: g for k, g in mesh.groups.items() if g.tag is not None and f"{g.dimension}:{g.tag}" == name
        }
    if not variants:
        close = nearest_name(name, list(mesh.groups))
        guess = f" Did you mean '{close}'?" if close else ""
        raise InputError(f"{what}: no group '{clipped(name)}' in {mesh.source}.{guess} {_existing(mesh)}")
    fitting = {key: group for key, group in variants.items() if group.dimension in allowed}
    if not fitting:
        group = next(iter(variants.values()))
        needed = " or ".join(KIND_OF_DIMENSION[d] for d in allowed)
        same_kind = [key for key, other in mesh.groups.items() if other.dimension in allowed]
        others = f" Groups of that kind: {quoted(same_kind)}" if same_kind else f" {_existing(mesh)}"
        raise InputError(
            f"{what}: '{clipped(name)}' is a {group.kind} group, but a {needed} is needed.{others}"
        )
    if len(fitting) > 1:
        raise InputError(
            f"{what}: '{clipped(name)}' is the name of several groups: say which one of {quoted(fitting)}"
        )
    key, group = next(iter(fitting.items()))
    if group.lost:
        raise InputError(
            f"{what}: {count(group.lost, 'cell')} of group '{key}' in {mesh.source} belong to no triangle, "
            f"so only a part of it would be used. {_EMBED[group.dimension]}"
        )
    if not len(group.members):
        raise InputError(
            f"{what}: group '{key}' in {mesh.source} is empty. Its name is declared but no cell carries its "
            "tag: mesh again with the physical group on existing entities (MSH 2.2 saved with `Mesh.SaveAll "
            "= 1` loses all tags: save as MSH 4.1)"
        )
    return group


_EMBED = (
    "Embed the point in the surface before meshing, in the .geo file `Point{5} In Surface{1};`, in "
    "Python `gmsh.model.mesh.embed(0, [5], 2, 1)`",
    "Embed the curve in the surface before meshing, in the .geo file `Curve{5} In Surface{1};`, in "
    "Python `gmsh.model.mesh.embed(1, [5], 2, 1)`",
    "Mesh again in one piece",
)


def _existing(mesh: Mesh) -> str:
    if not mesh.groups:
        return (
            'The mesh has no groups: name parts of it in the .geo file, `Physical Curve("left") = {4};`, '
            "or give a point [x, y, z]"
        )
    listed = ", ".join(f"'{name}' ({group.kind})" for name, group in list(mesh.groups.items())[:20])
    more = f" and {len(mesh.groups) - 20} more" if len(mesh.groups) > 20 else ""
    return f"Groups there: {listed}{more}"


def _nearest_vertex(mesh: Mesh, items: list[Any], allowed: tuple[int, ...], what: str) -> Selection:
    try:
        point = np.array([float(item) for item in items])
    except (TypeError, ValueError):
        point = np.array([np.nan])
    if len(point) not in (2, 3) or not np.isfinite(point).all():
        raise InputError(f"{what}: {shown(items)} is no point: give two or three finite numbers, [x, y, z]")
    if 0 not in allowed:
        needed = " or ".join(KIND_OF_DIMENSION[d] for d in allowed)
        raise InputError(
            f"{what}: the point {place(point)} is given, but a {needed} group is needed. {_existing(mesh)}"
        )
    label = place(point)
    if len(point) == 2:
        point = np.append(point, 0.0)
    distances = np.linalg.norm(mesh.points - point, axis=1)
    vertex = int(np.argmin(distances))
    distance = float(distances[vertex])
    _require_near(mesh, point, distance, f"{what} at {label}")
    warning = None
    if distance > MOVED * mesh.size:
        warning = (
            f"{what} at {label}: no vertex there; the nearest one, {place(mesh.points[vertex])}, "
            f"{distance:.3g} away, is used. Embed the point when meshing, in the .geo file `Point{{5}} In "
            "Surface{1};`"
        )
    return Selection(0, np.array([vertex], dtype=np.int32), label, distance, warning)


def _require_near(mesh: Mesh, point: NDArray[np.float64], distance: float, what: str) -> None:
    """Refuse a point that lies farther from the surface than a mesh size: it is meant in other units, or misplaced."""
    typical = float(np.sqrt(2 * np.median(mesh.areas)))
    if distance <= typical:
        return
    from kshell.mesh.closest import Locator

    found = Locator.of(mesh).find(point[None])
    off = float(found.distance[0])
    if off > typical:
        low, high = mesh.points.min(axis=0), mesh.points.max(axis=0)
        raise InputError(
            f"{what}: the point lies {off:.3g} off the surface, more than a mesh size ({typical:.3g}); the nearest "
            f"place of the surface is {place(found.x[0])}, and the mesh reaches from {place(low)} to {place(high)}: "
            "look at the coordinates and their unit"
        )
