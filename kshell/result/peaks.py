"""Places where stresses grow without bound as the mesh is refined, so that the largest stress is not taken from there.

Under a point force, at a point that is held and where a support ends on a smooth edge, moments and forces per length of
thin plates and shells are infinite (M. L. Williams, Proc. 1st US Nat. Congr. Appl. Mech. (1952) 325-329; under a point
force like log r), and at corners that turn into the structure: what a mesh gives there is a number of the mesh.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import partial
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.mesh.distinct import distinct
from kshell.mesh.mesh import Mesh
from kshell.mesh.words import place
from kshell.result.deferred import Deferred
from kshell.result.extremes import largest_stress
from kshell.result.result import Result
from kshell.scene.loads import PointForce, PointMoment
from kshell.scene.structure import Structure
from kshell.scene.supports import Elastic

Floats = NDArray[np.float64]

# cosine of the angle by which a boundary may turn at the end of a support that is no corner
SMOOTH = np.cos(np.radians(45.0))
ROUNDING = 1e-7
ALIKE = 1.001  # of the largest stress elsewhere: what is no larger is no peak
FACES = ("von_mises_top", "von_mises_middle", "von_mises_bottom")


NO_CORNERS: Mapping[int, str] = MappingProxyType({})


def peaks(structure: Structure, corners: Mapping[int, str] = NO_CORNERS) -> dict[int, str]:
    """Vertices where stresses grow without bound, with what makes them; `corners` are those of the model, with kind."""
    out = {vertex: f"{'an' if kind[0] in 'aeio' else 'a'} {kind}" for vertex, kind in corners.items()}
    if "ends of supports" not in structure.found:
        structure.found["ends of supports"] = _of_supports(structure)
    out |= structure.found["ends of supports"]
    for load in structure.loads:
        if not isinstance(load.item, PointForce | PointMoment) or load.place is None or load.link:
            continue
        if load.depends_on_time or np.any(load.item.at(load.places(structure.space))):
            words = "a point force" if isinstance(load.item, PointForce) else "a point moment"
            out |= dict.fromkeys(load.place.members.tolist(), words)
    return out


def _of_supports(structure: Structure) -> dict[int, str]:
    """Those that supports make."""
    out = dict.fromkeys(_ends_inside(structure).tolist(), "the end, or a corner, of a support inside")
    out |= dict.fromkeys(_ends(structure).tolist(), "the end of a support")
    for support in structure.supports:
        if support.place is not None and support.place.dimension == 0 and support.item.freedoms:
            what = "spring" if isinstance(support.item, Elastic) else "support"
            out |= dict.fromkeys(support.place.members.tolist(), f"a point {what}")
    return out


def _ends(structure: Structure) -> NDArray[np.integer]:
    """Vertices of a smooth boundary at which the edges on one side are held and those on the other are not."""
    mesh = structure.space
    held = np.zeros(len(mesh.edges), dtype=bool)
    for support in structure.supports:
        letters = set(support.item.freedoms) - {"r"}
        if support.place is not None and letters and not isinstance(support.item, Elastic):
            if support.place.dimension == 1:
                held[support.place.members] = True
            elif support.place.dimension == 2:
                held[mesh.triangle_edges[support.place.members]] = True
    boundary = mesh.boundary_edges
    held = held[boundary]
    if held.all() or not held.any():
        return np.zeros(0, dtype=np.int64)
    ends = mesh.edges[boundary]
    vertex = ends.ravel()
    count = np.bincount(vertex, minlength=len(mesh.points))
    of_held = np.bincount(vertex, np.repeat(held, 2), len(mesh.points))
    along = mesh.points[ends[:, 1]] - mesh.points[ends[:, 0]]
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    leaving = np.stack([along, -along], axis=1).reshape(-1, 3)
    total = np.stack([np.bincount(vertex, leaving[:, k], len(mesh.points)) for k in range(3)], axis=1)
    # two unit vectors that leave a vertex: |a + b|^2 = 2 + 2 a.b, and a.b = -1 where it does not turn
    turns = (total**2).sum(axis=1) > 2.0 - 2.0 * SMOOTH
    return np.flatnonzero((count == 2) & (of_held == 1) & ~turns)


def _ends_inside(structure: Structure) -> NDArray[np.integer]:
    """Vertices inside at which a line that is held, or the border of a surface that is, ends or turns sharply."""
    mesh = structure.space
    found: list[NDArray[np.integer]] = [np.zeros(0, dtype=np.int64)]
    for support in structure.supports:
        if support.place is None or not support.item.freedoms or isinstance(support.item, Elastic):
            continue
        members = support.place.members
        if support.place.dimension == 1:
            found.append(members[mesh.edge_counts[members] > 1])
        elif support.place.dimension == 2:
            count = np.bincount(mesh.triangle_edges[members].ravel(), minlength=len(mesh.edges))
            found.append(np.flatnonzero((count > 0) & (count < mesh.edge_counts)))
    if not any(len(lines) for lines in found):
        return found[0]
    lines = distinct(len(mesh.edges), *found)
    outer = np.zeros(len(mesh.points), dtype=bool)
    outer[mesh.edges[mesh.boundary_edges]] = True
    around: dict[int, list[Floats]] = {}
    for ends in mesh.edges[lines].tolist():
        along = mesh.points[ends[1]] - mesh.points[ends[0]]
        along = along / np.linalg.norm(along)
        for vertex, leaving in zip(ends, (along, -along), strict=True):
            if not outer[vertex]:
                around.setdefault(vertex, []).append(leaving)
    # an edge goes on where another one leaves the vertex the other way, but for a turn that is none
    sharp = [v for v, to in around.items() if (np.array(to) @ np.array(to).T).min(axis=1).max() > -SMOOTH]
    return np.array(sorted(sharp), dtype=np.int64)


def near_peaks(
    result: Result, structure: Structure, corners: Mapping[int, str] = NO_CORNERS
) -> NDArray[np.bool_]:
    """(row,) whether rows lie within the reach of places where stresses grow without bound."""
    found = list(peaks(structure, corners))
    near = np.zeros(len(result.points), dtype=bool)
    if found:
        stress = _largest(result)
        for vertex, reach in zip(found, _reach(structure, found), strict=True):
            near |= _within(structure, result.points, stress, vertex, reach)
    return near


def _within(
    structure: Structure, points: Floats, stress: Floats, vertex: int, reach: float
) -> NDArray[np.bool_]:
    """(row,) whether stresses are those of the peak at a vertex: within its reach, and on its slope.

    Stresses of a peak fall with the distance. Where they are larger than at the peak and all of its neighbours, they
    come from something else, the edge of a hole perhaps, and are no numbers of the mesh.
    """
    mesh: Mesh = structure.space
    around = mesh.triangles[(mesh.triangles == vertex).any(axis=1)]
    distance = np.linalg.norm(points - mesh.points[vertex], axis=1)
    beside = (
        distance <= (1.0 + ROUNDING) * np.linalg.norm(mesh.points[around] - mesh.points[vertex], axis=2).max()
    )
    top = stress[beside].max() if beside.any() else np.inf
    return (distance <= reach) & (beside | (stress <= top))


def mark_peaks(result: Result, structure: Structure, corners: Mapping[int, str] = NO_CORNERS) -> None:
    """Take the largest stress of a result away from peaks, and say so where it was one.

    `extremes["von_mises"]` gets the entry "peak", None or {"value", "at", "why"}; its value is then the largest
    farther from all of them than the thickness and two triangles, or nearer and above them.
    """
    found = peaks(structure, corners)
    if "von_mises" not in result.extremes:
        return
    if not found:  # nothing is computed that nobody looks at
        known = result.extremes
        makers = {key: partial(known.__getitem__, key) for key in known}
        result.extremes = Deferred({**makers, "von_mises": lambda: {**known["von_mises"], "peak": None}})
        return
    stress = _largest(result)
    points, near = result.points, np.zeros(len(stress), dtype=bool)
    worst = int(np.argmax(stress))
    why, radius = "", 0.0
    for vertex, reach in zip(found, _reach(structure, list(found)), strict=True):
        within = _within(structure, points, stress, vertex, reach)
        near |= within
        if within[worst] and not why:
            why, radius = f"{found[vertex]} at {place(structure.space.points[vertex])}", reach
    entry: dict[str, Any] = {**result.extremes["von_mises"], "peak": None}
    if why and not near.all() and entry["value"] > _rounding(result, structure):
        peak = {key: entry[key] for key in ("value", "at")}
        farther = largest_stress(result.rows, result.fields, near)
        if peak["value"] <= ALIKE * farther["value"]:  # as large elsewhere: nothing grows there
            result.extremes["von_mises"] = entry
            return
        entry |= {**farther, "peak": {**peak, "why": why}}
        result.warnings.append(
            f"stresses grow without bound at {why} as the mesh is refined: {peak['value']:.4g} there is a number of "
            f"the mesh; farther than {radius:.3g} from such places the largest is {entry['value']:.4g}"
        )
    result.extremes["von_mises"] = entry


def _rounding(result: Result, structure: Structure) -> float:
    """A stress that is nothing but rounding beside Q t u / size^2, that of bending by all of the displacement u."""
    thickness = np.asarray(result.cell_fields["thickness"]).max()
    moved = np.linalg.norm(result.fields["displacement"], axis=1).max()
    stiffness = np.abs(structure.section.moduli).max()
    return float(ROUNDING * stiffness * thickness * moved / structure.space.size**2)


def _largest(result: Result) -> Floats:
    """(row,) largest stress of all faces."""
    return np.asarray(np.max([np.ravel(values) for values in _stresses(result)], axis=0))


def _stresses(result: Result) -> Iterator[Floats]:
    for name in FACES:
        if name in result.fields:
            yield result.fields[name]


def _reach(structure: Structure, vertices: list[int]) -> list[float]:
    """How far each peak reaches: the thickness, or the two triangles next to it."""
    mesh: Mesh = structure.space
    thickness = structure.thickness
    out = []
    for vertex in vertices:
        around = np.flatnonzero((mesh.triangles == vertex).any(axis=1))
        longest = float(mesh.edge_lengths[mesh.triangle_edges[around]].max())
        out.append(max(float(thickness[around].max()), 2.0 * longest))
    return out
