"""Mid-edge nodes on a smooth surface through the vertices of flat triangles, with an estimate of their error.

Inside a sheet a node is the middle of the chord moved along the normal of the edge onto the surfaces fitted at both
ends, and their mean. The estimate of its error is the largest of half the difference of the two and the residuals of
both fits. Quadrics come first; where their estimate is not small quartics are fitted, too, and where neither is small
against the bow, the fits that do not reach over a jump of curvature (one_sided.py); each edge takes what has the
smallest estimate.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kshell.mesh import quadratic
from kshell.mesh.curving.borders import arcs, onto_sheets
from kshell.mesh.curving.fits import QUADRIC, QUARTIC, Fits, Neighbourhoods
from kshell.mesh.curving.one_sided import Edges, candidates, one_sided
from kshell.mesh.curving.sheets import Sheets, find_sheets
from kshell.mesh.triangulation import Triangulation

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

CREASE = 30.0  # degrees
STEPS = 5  # of Newton's method from the chord to a surface
QUADRIC_ENOUGH = 2e-4  # estimate, in the bow, up to which quartics are not tried
ENOUGH = 0.01  # the same, up to which jumps of curvature are not looked for
MUCH_BETTER = (
    0.2  # residual of a fit near, in the estimate, from which it may be one beside a jump of curvature
)
LEAST_BOW = 1e-3  # in the length of the edge, for these ratios
WILD = 3.0  # turn of an arc, in the largest angle between facets near, beyond which it is no curve of theirs
STRAIGHTENED = 5  # times that triangles turned inside out are looked for


@dataclass(frozen=True)
class Rebuilt:
    """Nodes for the edges of flat triangles.

    Attributes
    ----------
    midpoints : (edge, 3)
    estimate : (edge,) of their error, a length
    moved : (edge,) from the middle of the chord
    curved : (edge,) bool, edges inside curved sheets: those that the estimate is for
    sheets : Sheets
    """

    midpoints: Floats
    estimate: Floats
    moved: Floats
    curved: Bools
    sheets: Sheets


def rebuild(mesh: Triangulation, crease: float = CREASE) -> Rebuilt:
    """Mid-edge nodes for a mesh of order 1.

    Parameters
    ----------
    mesh : Triangulation
    crease : float
        Angle in degrees from which neighbours meet in a fold that stays one.
    """
    sheets = find_sheets(mesh, np.radians(crease))
    chord = mesh.points[mesh.edges].mean(axis=1)
    nodes, estimate = chord.copy(), np.zeros(len(chord))
    inner = np.flatnonzero(~sheets.kept)
    inner = inner[~sheets.flat[sheets.pair[inner, 0]]]
    curved = np.zeros(len(chord), dtype=bool)
    curved[inner] = True
    near = Neighbourhoods(mesh.points, sheets)
    quadrics = Fits(near, QUADRIC)
    quadrics.fit(np.unique(sheets.triangles[~sheets.flat]))
    if len(inner):
        edges = _edges(mesh, sheets, quadrics, inner)
        bow, estimate[inner] = _inside(mesh, edges, quadrics, inner)
        nodes[inner] += bow[:, None] * edges.normal
        _hold_wild(mesh, sheets, crease, chord, nodes, estimate, inner)
    found = arcs(mesh, sheets.kept)
    nodes[found.edges] = onto_sheets(mesh, sheets, quadrics, found)
    estimate[found.edges] = found.spread
    _unfold(mesh, chord, nodes, estimate)
    return Rebuilt(nodes, estimate, np.linalg.norm(nodes - chord, axis=1), curved, sheets)


def _edges(mesh: Triangulation, sheets: Sheets, fits: Fits, inner: Ints) -> Edges:
    pair = sheets.pair[inner]
    ends = np.empty((len(inner), 2), dtype=np.int64)
    for end in range(2):
        corner = np.argmax(mesh.triangles[pair[:, 0]] == mesh.edges[inner, end, None], axis=1)
        ends[:, end] = sheets.triangles[pair[:, 0], corner]
    corners = sheets.triangles[pair].sum(axis=2) - ends.sum(axis=1)[:, None]
    points = fits.near.points
    normal = fits.normals(ends[:, 0]) + fits.normals(ends[:, 1])
    along = points[ends[:, 1]] - points[ends[:, 0]]
    normal -= ((normal * along).sum(axis=1) / (along * along).sum(axis=1))[:, None] * along
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    return Edges(ends, corners, normal)


def _inside(mesh: Triangulation, edges: Edges, quadrics: Fits, inner: Ints) -> tuple[Floats, Floats]:
    """Bows along the normals of the edges, and estimates of their errors."""
    length = mesh.edge_lengths[inner]
    bow, estimate = _mean(edges, quadrics)

    def doubtful(part: float) -> Ints:
        return np.flatnonzero(~(estimate <= part * np.maximum(np.abs(bow), LEAST_BOW * length)))

    doubt = doubtful(QUADRIC_ENOUGH)
    if not len(doubt):
        return bow, estimate
    quartics = Fits(quadrics.near, QUARTIC)
    quartics.fit(np.unique(edges.ends[doubt]))
    few = edges.some(doubt)
    _take_better(bow, estimate, doubt, *_mean(few, quartics))
    doubt = doubtful(ENOUGH)
    if len(doubt):
        few = edges.some(doubt)
        row, vertex = candidates(few, quadrics.near.step)
        quartics.fit(np.unique(vertex))
        for fits in (quadrics, quartics):
            # noise, and meshes that are too coarse, leave no fit near that is much better than the others
            least = np.full(len(doubt), np.inf)
            np.minimum.at(least, row, np.where(fits.determined[vertex], fits.residual[vertex], np.inf))
            better = np.flatnonzero(least <= MUCH_BETTER * estimate[doubt])
            mine = np.isin(row, better)
            part = few.some(better)
            found = one_sided(part, fits, np.searchsorted(better, row[mine]), vertex[mine])
            _take_better(bow, estimate, doubt[better], *found)
    return bow, estimate


def _take_better(bow: Floats, estimate: Floats, which: Ints, new: Floats, new_estimate: Floats) -> None:
    better = ~(new_estimate >= estimate[which])
    bow[which[better]], estimate[which[better]] = new[better], new_estimate[better]


def _mean(edges: Edges, fits: Fits) -> tuple[Floats, Floats]:
    """Mean of the bows of the surfaces at both ends, and the estimate of its error."""
    points = fits.near.points
    middle = points[edges.ends].mean(axis=1)
    one, other = (fits.heights(edges.ends[:, end], middle, edges.normal, STEPS) for end in range(2))
    estimate = np.maximum(0.5 * np.abs(one - other), fits.residual[edges.ends].max(axis=1))
    bow = 0.5 * (one + other)
    lost = ~np.isfinite(bow)
    return np.where(lost, 0.0, bow), np.where(lost, np.inf, estimate)


def _hold_wild(
    mesh: Triangulation,
    sheets: Sheets,
    crease: float,
    chord: Floats,
    nodes: Floats,
    estimate: Floats,
    inner: Ints,
) -> None:
    """Put arcs that turn by far more than the facets near them back on their chords."""
    angle = np.where(sheets.angle < np.radians(crease), sheets.angle, 0.0)
    at = np.zeros(len(mesh.points))
    for k in range(2):
        np.maximum.at(at, mesh.edges[:, k], angle)
    around = at[mesh.triangles].max(axis=1)
    for k in range(3):
        np.maximum.at(at, mesh.triangles[:, k], around)
    bow = np.linalg.norm(nodes[inner] - chord[inner], axis=1)
    turn = 8 * bow / mesh.edge_lengths[inner]
    wild = inner[turn > WILD * at[mesh.edges[inner]].max(axis=1) + 1e-9]
    estimate[wild] = np.maximum(estimate[wild], np.linalg.norm(nodes[wild] - chord[wild], axis=1))
    nodes[wild] = chord[wild]


def _unfold(mesh: Triangulation, chord: Floats, nodes: Floats, estimate: Floats) -> None:
    """Straighten triangles that their nodes would turn inside out."""
    for _ in range(STRAIGHTENED):
        bad = quadratic.inside_out(mesh, nodes)
        if not len(bad):
            return
        edges = np.unique(mesh.triangle_edges[bad])
        moved = np.linalg.norm(nodes[edges] - chord[edges], axis=1)
        estimate[edges] = np.maximum(estimate[edges], moved)
        nodes[edges] = chord[edges]
