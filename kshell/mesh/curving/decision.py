"""Whether flat triangles of a curved surface are curved, and which order of elements their nodes are good for.

What counts is the error of the nodes against the thickness: it acts as an imperfection of the shape, which bends the
shell under its membrane forces. On spheres and cylinders of R / t = 100 and 1000 with noise in their vertices the error
of the largest stress is 5 to 10 times the root mean square of estimate / t; up to GOOD it stays below 2 %, beyond FAIR
flat triangles with elements of order 1 are better.
"""

from __future__ import annotations

from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from kshell.mesh.curving.rebuild import Rebuilt, rebuild
from kshell.mesh.curving.sheets import FLAT
from kshell.mesh.facets import facets as facets_of
from kshell.mesh.triangulation import Curving, Triangulation, changed
from kshell.mesh.words import count, place

Floats = NDArray[np.float64]
AnyMesh = TypeVar("AnyMesh", bound=Triangulation)

GOOD, FAIR = 2e-3, 2e-2  # root mean square of estimate / t
STRESS = 8.0  # relative error of the largest stress, in estimate / t
MOVED = 1e-9  # of the size of the mesh, by which nodes must move to be curved at all
COARSE = np.radians(14.5)  # angle from which facets of a curve may as well be meant as folds
POLYGON = np.radians(46.0)  # angle up to which folds side by side may as well be facets of a curve
BESIDE = 4  # such folds, from which on they are spoken of


def curve(mesh: AnyMesh, thickness: Floats, facets: str = "auto", crease: float = 30.0) -> AnyMesh:
    """The mesh with mid-edge nodes on a smooth surface, or as it is; a note, and its `curving`, say why.

    Parameters
    ----------
    mesh : Triangulation
        Of order 1.
    thickness : (triangle,)
    facets : "auto", "flat" or "curved"
        flat: as it is; curved: with nodes, however large their error.
    crease : float
        Angle in degrees from which neighbours meet in a fold that stays one.
    """
    if facets == "flat":
        return changed(mesh, curving=Curving(3, 'flat triangles, as facets = "flat" says', _as_asked(mesh)))
    found = rebuild(mesh, crease)
    polygon = _polygon(mesh, found, crease)
    if found.moved[found.curved].max(initial=0.0) <= MOVED * mesh.size:
        return changed(mesh, curving=Curving(3, "flat parts and their folds", tuple(polygon), not polygon))
    ratio, worst, at = _against_thickness(found, thickness)
    where = _middle(mesh, at)
    size = (
        f"the error of the nodes is estimated as {_rms(found.estimate[found.curved]):.2g} ({ratio:.2g} of the "
        f"thickness), at most {found.estimate[at]:.2g} ({worst:.2g} of it, at {where})"
    )
    if facets == "auto" and ratio > FAIR:
        reason = f"flat triangles, because the vertices do not tell the curved surface between them: {size}"
        warning = (
            "the mesh has flat triangles (order 1) on a curved surface, and its vertices lie too far off any smooth "
            f"one to curve them: {size}; {FAIR:g} of the thickness is too much. Elements of order 1 are taken, with "
            "which largest stresses are uncertain by 10 % and more; mesh with order 2, name the geometry it was made "
            'from (geometry = "shell.geo") or give coordinates with more digits'
        )
        return changed(mesh, curving=Curving(1, reason, (warning, *polygon)))
    note = _moved(mesh, found, crease) + f"; {size}"
    warnings = [*_doubt(ratio, worst, where, found.estimate[at]), *_coarse(mesh, found), *polygon]
    order = 3 if ratio <= GOOD else 2
    curving = Curving(order, note, tuple(warnings))
    return changed(mesh, midpoints=found.midpoints, curving=curving, notes=(*mesh.notes, note))


def _as_asked(mesh: Triangulation) -> tuple[str, ...]:
    found = facets_of(mesh)
    if found is None:
        return ()
    return (
        'facets = "flat": the mesh is solved with its flat triangles, which meet at up to '
        f"{np.degrees(found.angle):.2g} degrees, e.g. at {place(found.at)}: if they stand for a curved surface these "
        "facets limit the accuracy",
    )


def _middle(mesh: Triangulation, edge: int) -> str:
    return place(mesh.points[mesh.edges[edge]].mean(axis=0))


def _rms(values: Floats) -> float:
    return float(np.sqrt(np.mean(values**2)))


def _against_thickness(found: Rebuilt, thickness: Floats) -> tuple[float, float, int]:
    """Root mean square and largest of estimate / t over the edges inside curved sheets, and the edge of the largest."""
    edges = np.flatnonzero(found.curved)
    t = thickness[found.sheets.pair[edges]].min(axis=1)
    ratio = found.estimate[edges] / t
    worst = int(np.argmax(ratio))
    return _rms(ratio), float(ratio[worst]), int(edges[worst])


def _moved(mesh: Triangulation, found: Rebuilt, crease: float) -> str:
    worst = int(np.argmax(found.moved))
    inner = found.sheets.kept & (found.sheets.pair[:, 0] >= 0)
    kept = f", {count(int(inner.sum()), 'edge')} between sheets kept" if inner.any() else ""
    return (
        f"flat triangles curved: nodes at the middle of {int((found.moved > MOVED * mesh.size).sum())} of "
        f"{count(len(found.moved), 'edge')} moved onto a smooth surface through the vertices, by up to "
        f"{found.moved[worst]:.3g} at {_middle(mesh, worst)} (crease = {crease:g}{kept}; "
        'facets = "flat" leaves them)'
    )


def _doubt(ratio: float, worst: float, where: str, estimate: float) -> list[str]:
    if ratio > GOOD:
        return [
            "flat triangles were curved, but their vertices lie off a smooth surface: largest stress uncertain by "
            f"about {STRESS * ratio:.0%} (8 x {ratio:.2g}, the estimated error of the nodes over the thickness)"
        ]
    if worst > FAIR:
        return [
            f"flat triangles were curved, with nodes uncertain by {estimate:.2g} near {where}, {worst:.2g} of the "
            f"thickness: stresses there uncertain by about {STRESS * worst:.0%}; mesh finer there"
        ]
    return []


def _coarse(mesh: Triangulation, found: Rebuilt) -> list[str]:
    """A mast of 24 flat sides, each of coplanar triangles, and a coarse round tube look alike."""
    sheets = found.sheets
    in_plane = (sheets.pair[:, 0] >= 0) & (sheets.angle < FLAT)
    side = np.zeros(len(mesh.triangles), dtype=bool)
    side[sheets.pair[in_plane]] = True
    between = found.curved & side[sheets.pair].all(axis=1)
    angle = np.where(between, sheets.angle, 0.0)
    worst = int(np.argmax(angle))
    if angle[worst] <= COARSE:
        return []
    degrees = np.degrees(angle[worst])
    return [
        f"flat triangles that meet at up to {degrees:.3g} degrees, e.g. at {_middle(mesh, worst)}, are taken for "
        f"facets of a curve, and nodes were moved by up to {found.moved.max():.3g}; if they are folds, say "
        f'facets = "flat", or crease = {max(1, int(degrees) - 1)}'
    ]


def _polygon(mesh: Triangulation, found: Rebuilt, crease: float) -> list[str]:
    """Folds side by side, one strip of triangles between them, that may be facets of a coarse curve."""
    sheets = found.sheets
    fold = (sheets.angle >= np.radians(crease)) & (sheets.angle <= POLYGON)
    ends = np.zeros(len(mesh.points), dtype=bool)
    ends[mesh.edges[fold]] = True
    # triangles between folds, without a vertex off them
    strip: NDArray[np.bool_] = np.all(ends[mesh.triangles], axis=1)
    inner = np.flatnonzero(fold & (sheets.pair[:, 0] >= 0))
    beside = inner[np.all(strip[sheets.pair[inner]], axis=1)]
    if len(beside) < BESIDE:
        return []
    worst = int(beside[np.argmax(sheets.angle[beside])])
    degrees = np.degrees(sheets.angle[worst])
    return [
        f"{count(len(beside), 'edge')} at which flat strips meet at up to {degrees:.3g} degrees, e.g. at "
        f"{_middle(mesh, worst)}, are taken as folds; if they stand for a curve, mesh finer or say "
        f"crease = {int(degrees) + 2}"
    ]
