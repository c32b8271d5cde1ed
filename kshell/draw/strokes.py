"""Strokes on a surface: crosses along principal directions, arrows along shear forces.

Values are those of the elements at places spread evenly over the surface, where the result knows them, in the plane of
the triangle that is drawn there. A cross has a stroke along each principal direction; its length is the size of the
principal value, its colour tells the sign. The longest stroke reaches from place to place; beside peaks, where values
grow without bound, strokes that would be longer end there, or all others would be dots.

T          symmetric tensor in the frame (e_1, e_2 = n x e_1): xx yy xy
t_1 >= t_2 its principal values, along d_1 = cos(a) e_1 + sin(a) e_2 and d_2 = n x d_1
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kshell.draw.drawn import Drawn
from kshell.draw.pictures import PRINCIPAL
from kshell.draw.space import cut_in_four
from kshell.material.tensors import principal, principal_angle

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

PLACES = 190  # about this many on a flat square
LEAST = 1 / 34  # of the longest side of what is drawn: places are no nearer to each other
CANDIDATES = 16 * PLACES
APART = 0.62  # of the distance between places
OPPOSITE = -0.5  # cosine of normals from which sides are seen one by one
HALF = 0.49  # of that distance: half of the longest stroke
OFTEN, BEYOND = 0.9, 4.0  # that part of the sizes, times that, is what the longest stroke may stand for
SHORTEST = 2e-3  # of the longest: shorter strokes are not drawn
HEAD, ASIDE = 0.36, 0.19  # of an arrow: its head along it, and to each side
POSITIVE, NEGATIVE, ARROW = "#c2182b", "#1f5fb4", "#101010"


class Places(NamedTuple):
    """Where strokes are drawn.

    Attributes
    ----------
    rest : (n, 3)
        In the undeformed surface.
    drawn : (n, 3)
        In the surface as it is drawn.
    stretch : (n, 3, 3)
        Takes directions at rest to those in the triangle that is drawn there.
    normal : (n, 3)
        Unit normals as drawn.
    apart : float
        Least distance.
    """

    rest: Floats
    drawn: Floats
    stretch: Floats
    normal: Floats
    apart: float


class Principal(NamedTuple):
    """Principal values (n, 2), the larger first, and their unit directions (n, 2, 3) in space."""

    values: Floats
    directions: Floats


class Strokes(NamedTuple):
    """Straight lines on the surface as drawn.

    Attributes
    ----------
    lines : (n, 2, 3)
    normals : (n, 3)
    place : (n,)
        Which of the places each belongs to.
    colour : str
    words : str
        What the colour says.
    longest : str
        What the longest line of all colours stands for.
    """

    lines: Floats
    normals: Floats
    place: Ints
    colour: str
    words: str
    longest: str


def strokes_of(drawn: Drawn, what: str, scale: float) -> list[Strokes]:
    """What is drawn over a picture: crosses, arrows, or nothing.

    Parameters
    ----------
    drawn : Drawn
    what : str
        Name of a picture.
    scale : float
        By which displacements are drawn.
    """
    if what != "shear" and what not in PRINCIPAL:
        return []
    places = spread(drawn, scale)
    return strokes_at(places, drawn.result.at(places.rest), what)


def strokes_at(places: Places, values: dict[str, Floats], what: str) -> list[Strokes]:
    """The same at given places, of what `Result.at` says there."""
    return _arrows(places, values) if what == "shear" else _crosses(places, values, what)


def _crosses(places: Places, values: dict[str, Floats], what: str) -> list[Strokes]:
    found = principal_of(values, what)
    sizes = np.abs(found.values).max(axis=1, initial=0.0)
    most = full_length(sizes)
    words = f"{most:.4g}" + (" and more" if sizes.max(initial=0.0) > most else "")
    along = np.einsum("nij,naj->nai", places.stretch, found.directions)
    along /= np.maximum(np.linalg.norm(along, axis=2, keepdims=True), 1e-300)
    parts = np.clip(found.values / most, -1.0, 1.0)
    size = HALF * places.apart * np.abs(parts)
    out = []
    for colour, sign, name in zip((POSITIVE, NEGATIVE), (1.0, -1.0), PRINCIPAL[what].signs, strict=True):
        at, which = np.nonzero(sign * parts > SHORTEST)
        if not len(at):
            continue
        half = size[at, which, None] * along[at, which]
        lines = np.stack([places.drawn[at] - half, places.drawn[at] + half], axis=1)
        out.append(Strokes(lines, places.normal[at], at, colour, name, words))
    return out


def _arrows(places: Places, values: dict[str, Floats]) -> list[Strokes]:
    if "Q" not in values:
        return []
    first, second, _ = frame_at(values)
    force = values["Q"][:, :1] * first + values["Q"][:, 1:2] * second
    size = np.linalg.norm(force, axis=1)
    most = full_length(size)
    along = np.einsum("nij,nj->ni", places.stretch, force)
    along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-300)
    along *= (2 * HALF * places.apart * np.minimum(size / most, 1.0))[:, None]
    across = np.cross(places.normal, along)
    start, end = places.drawn - 0.5 * along, places.drawn + 0.5 * along
    heads = [np.stack([end, end - HEAD * along + side * ASIDE * across], axis=1) for side in (1.0, -1.0)]
    lines = np.concatenate([np.stack([start, end], axis=1), *heads])
    place = np.tile(np.arange(len(start)), 3)
    return [Strokes(lines, places.normal[place], place, ARROW, "along the shear force", f"{most:.4g}")]


def full_length(sizes: Floats) -> float:
    """The value that the longest stroke stands for, of the sizes (n,) that are drawn."""
    most = float(sizes.max(initial=0.0))
    usual = BEYOND * float(np.quantile(sizes, OFTEN)) if len(sizes) else 0.0
    return (min(most, usual) if usual > 0.0 else most) or 1.0


def longest(strokes: Sequence[Strokes], nodes: Floats) -> int | None:
    """The node of (n, 3) nearest to the middle of the longest line; None without lines."""
    lines = np.concatenate([np.zeros((0, 2, 3)), *(each.lines for each in strokes)])
    if not len(lines):
        return None
    middle = lines[np.argmax(np.linalg.norm(lines[:, 1] - lines[:, 0], axis=1))].mean(axis=0)
    return int(np.argmin(np.linalg.norm(nodes - middle, axis=1)))


def principal_of(values: dict[str, Floats], what: str) -> Principal:
    """Principal values and directions of a picture of crosses, of what `Result.at` says at points."""
    tensor = values[PRINCIPAL[what].at_points]
    first, second, _ = frame_at(values)
    angle = principal_angle(tensor)[:, None]
    c, s = np.cos(angle), np.sin(angle)
    return Principal(principal(tensor), np.stack([c * first + s * second, c * second - s * first], axis=1))


def frame_at(values: dict[str, Floats]) -> tuple[Floats, Floats, Floats]:
    """Unit vectors (n, 3) of the frame of tensors and the normal; of plates the global axes."""
    count = len(values["x"])
    normal = values.get("normal", np.tile([0.0, 0.0, 1.0], (count, 1)))
    first = values.get("axis_1", np.tile([1.0, 0.0, 0.0], (count, 1)))
    normal = normal / np.linalg.norm(normal, axis=1, keepdims=True)  # interpolated ones of files are shorter
    first = first - np.sum(first * normal, axis=1, keepdims=True) * normal
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    return first, np.cross(normal, first), normal


def spread(points: Drawn, scale: float) -> Places:
    """Places spread evenly over the surface, inside triangles."""
    rest, drawn, triangles = points.rest, points.deformed(scale), points.triangles
    corners = np.concatenate([rest[triangles], drawn[triangles]], axis=2)  # (triangle, corner, 6)
    while len(corners) < CANDIDATES:
        corners = cut_in_four(corners)
    centres = corners[:, :, :3].mean(axis=1)
    extent = np.ptp(rest, axis=0)
    area = 0.5 * np.linalg.norm(_normals(corners[:, :, :3]), axis=1).sum()
    apart = max(float(np.sqrt(area / PLACES)), LEAST * float(extent.max()))
    chosen = _thinned(centres, _unit(_normals(corners[:, :, :3])), rest.min(axis=0), extent, apart)
    corners = corners[chosen]
    sides = corners[:, 1:] - corners[:, :1]  # (place, 2, 6)
    before, after = sides[..., :3], sides[..., 3:]
    return Places(
        centres[chosen],
        corners[:, :, 3:].mean(axis=1),
        np.swapaxes(after, 1, 2) @ np.swapaxes(np.linalg.pinv(before), 1, 2),
        _unit(_normals(corners[:, :, 3:])),
        apart,
    )


def _normals(corners: Floats) -> Floats:
    """(n, 3) of triangles (n, 3, 3), twice as long as their area."""
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])


def _unit(vectors: Floats) -> Floats:
    return np.asarray(vectors / np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), 1e-300))


def _thinned(points: Floats, normals: Floats, low: Floats, extent: Floats, apart: float) -> Ints:
    """Numbers of points (n, 3) no nearer to each other than that on one side: the nearest to the middles of boxes."""
    count = np.maximum(np.rint(extent / apart), 1.0)
    cell = np.maximum(extent / count, 1e-300)
    boxes = np.clip(np.floor((points - low) / cell), 0, count - 1).astype(np.int64)
    off = np.linalg.norm(points - (low + (boxes + 0.5) * cell), axis=1)
    order = np.argsort(off, kind="stable")
    _, first = np.unique(boxes[order], axis=0, return_index=True)
    some = order[np.sort(first)]
    kept: list[int] = []
    for k in some.tolist():
        near = np.linalg.norm(points[kept] - points[k], axis=1) < APART * apart
        if not np.any(near & (normals[kept] @ normals[k] > OPPOSITE)):
            kept.append(k)
    return np.array(kept, dtype=np.int64)
