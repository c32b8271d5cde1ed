"""Is the plate held? A rigid motion that no support resists is named before anything is solved.

A plate in bending moves rigidly as w = c0 + c1 x + c2 y, each piece of the mesh on its own.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kshell.errors import InputError
from kshell.mesh.mesh import Mesh
from kshell.mesh.words import place
from kshell.plate.conditions import Conditions
from kshell.plate.domain import Domain
from kshell.plate.forms import Form
from kshell.plate.layout import Layout

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

LOOSE = 1e-10  # resistance to a motion, relative to the largest one in the piece
SURELY = 1e-6  # of a bound of that resistance: far above its rounding
UNRESISTED = 1e-24  # of conditions, whose rows are of size one, that is rounding
LOST = 5.0  # rounding of a sum of forces, in units of the last digit of all together, over the root of their number
DRIFT = 1e-3  # motion by rounding over the largest deflection that is worth saying


@dataclass(frozen=True, eq=False)
class Hanging:
    """Rigid motions of a piece that nothing but springs resists.

    Attributes
    ----------
    stiffness : (k, k)
        Of the springs against them; as displacements of the size of the piece.
    """

    stiffness: Floats

    def moved_by(self, force: float) -> float:
        """Deflection by forces that rounding has left."""
        return float(force * np.abs(np.linalg.pinv(self.stiffness, hermitian=True)).max(initial=0.0))


def drift_warning(hanging: list[Hanging], left: float, gross: float, count: int, largest: float) -> list[str]:
    """Of a plate that hangs on springs so soft that the rounding of its loads moves it.

    Parameters
    ----------
    left : float
        What loads and reactions differ by: the rounding of forces inside.
    gross : float
        Sum of the sizes of all loads, of whose balance rounding leaves something, too.
    count : int
        Unknowns.
    largest : float
        Deflection.
    """
    lost = max(left, LOST * np.sqrt(count) * np.finfo(float).eps * gross)
    drift = max((piece.moved_by(lost) for piece in hanging), default=0.0)
    if drift <= DRIFT * largest:
        return []
    return [
        f"springs alone keep the plate in place, so soft that rounding of its loads may move it by about {drift:.1g} "
        f"as a whole, of deflections up to {largest:.3g}; moments and stresses are right. Hold it, or take stiffer "
        "springs"
    ]


def require_held(
    domain: Domain, layout: Layout, conditions: Conditions, springs: list[Form]
) -> list[Hanging]:
    """The motions that springs alone resist; InputError if a piece of the plate can move freely, naming both."""
    mesh = domain.mesh
    piece = mesh.sheets
    piece_count = int(piece.max()) + 1
    gram = np.zeros((piece_count, 3, 3))
    centres, sizes = _extent(mesh, piece, piece_count)

    def add(rows: Floats, member: Ints) -> None:
        if piece_count == 1:
            gram[0] += rows.T @ rows
        else:
            np.add.at(gram, member, rows[:, :, None] * rows[:, None, :])

    if conditions.fans:
        piece_of_vertex = np.zeros(len(mesh.points), dtype=np.int64)
        piece_of_vertex[mesh.triangles] = piece[:, None]
        vertices = layout.fans.vertex[np.concatenate(conditions.fans)]
        member = piece_of_vertex[vertices]
        motion = _rigid_at_vertices(layout, vertices, centres[member], sizes[member])
        add((np.concatenate(conditions.rows)[:, None] @ motion)[:, 0], member)
    for edges in conditions.edges:
        member = piece[mesh.edge_owner[edges, 0]]
        ends = domain.points[mesh.edges[edges]]
        t = (ends[:, 1] - ends[:, 0]) / mesh.edge_lengths[edges][:, None]
        slope = np.stack([np.zeros(len(edges)), t[:, 1], -t[:, 0]], axis=1)
        add(slope, member)
    for triangles, rows in zip(conditions.triangles, conditions.triangle_rows, strict=True):
        member = piece[triangles]
        motion = rigid_of_triangles(domain, layout, triangles, centres[member], sizes[member])
        add((rows[:, None] @ motion)[:, 0] * sizes[member][:, None], member)
    by_conditions, stiffness = (gram.copy(), np.zeros_like(gram)) if springs else (gram, gram)
    for spring in springs:
        for positions, triangles in spring.blocks():
            member = piece[triangles]
            motion = rigid_of_triangles(domain, layout, triangles, centres[member], sizes[member])
            m = layout.element.transformation(domain.affine(triangles))
            resistance = spring.matrices(positions, m @ motion)
            total = np.zeros((piece_count, 3, 3))
            np.add.at(total, member, resistance)
            stiffness += total
            biggest = np.abs(total).max(axis=(1, 2), initial=0.0)
            gram += total / np.where(biggest > 0, biggest, 1.0)[:, None, None]

    if not springs and all(_surely_held(*piece_gram.ravel().tolist()) for piece_gram in gram):
        return []
    value, vector = np.linalg.eigh(gram)
    loose = np.flatnonzero(value[:, 0] < LOOSE * np.maximum(value[:, 2], 1e-300))
    if len(loose):
        k = int(loose[0])
        free = vector[k][:, value[k] < LOOSE * max(value[k, 2], 1e-300)]
        raise InputError(_words(free, centres[k], sizes[k], piece_count, mesh, piece == k))
    return _hanging(by_conditions, stiffness) if springs else []


def _surely_held(
    a: float, b: float, c: float, _b: float, d: float, e: float, _c: float, _e: float, f: float
) -> bool:
    """Whether the least eigenvalue of a matrix (3, 3) of resistances is far from loose.

    With determinant and trace t it is at least 4 det / t^2, as the product of the other two is at most t^2 / 4.
    """
    trace = a + d + f
    return 4.0 * (a * (d * f - e * e) - b * (b * f - c * e) + c * (b * e - c * d)) > SURELY * trace**3


def _hanging(by_conditions: Floats, stiffness: Floats) -> list[Hanging]:
    """From the resistance (piece, 3, 3) of conditions and the stiffness (piece, 3, 3) of springs."""
    out = []
    for resisted, stiff in zip(by_conditions, stiffness, strict=True):
        value, vector = np.linalg.eigh(resisted)
        loose = vector[:, value < max(LOOSE * value[-1], UNRESISTED)]
        if loose.shape[1]:
            out.append(Hanging(loose.T @ stiff @ loose))
    return out


def _extent(mesh: Mesh, piece: Ints, count: int) -> tuple[Floats, Floats]:
    """Centre (piece, 2) and size (piece,) of the pieces."""
    if count == 1:
        x = mesh.points[mesh.triangles.ravel(), :2]
        middle = x.mean(axis=0)
        return middle[None], np.abs(x - middle).max(keepdims=True)[0]
    corners = mesh.points[mesh.triangles, :2].reshape(-1, 2)
    label = np.repeat(piece, 3)
    number = np.bincount(label, minlength=count)
    centre = np.stack([np.bincount(label, corners[:, k], count) / number for k in range(2)], axis=1)
    distance = np.abs(corners - centre[label]).max(axis=1)
    size = np.zeros(count)
    np.maximum.at(size, label, distance)
    return centre, size


def _rigid_at_vertices(layout: Layout, vertices: Ints, centre: Floats, size: Floats) -> Floats:
    """(n, per_vertex, 3) scaled degrees of freedom of w = 1, (x - x0) / L, (y - y0) / L at vertices."""
    out = np.zeros((len(vertices), layout.per_vertex, 3))
    out[:, 0, 0] = 1.0
    out[:, 0, 1:] = (layout.mesh.points[vertices, :2] - centre) / size[:, None]
    if layout.per_vertex > 1:
        out[:, 1, 1] = out[:, 2, 2] = layout.vertex_sizes[vertices] / size
    return out


def rigid_of_triangles(
    domain: Domain, layout: Layout, triangles: Ints, centre: Floats, size: Floats
) -> Floats:
    """(n, local, 3) physical degrees of freedom of the three rigid motions in triangles."""
    b = layout.per_vertex
    affine = domain.affine(triangles)
    out = np.zeros((len(triangles), layout.element.count, 3))
    for v in range(3):
        out[:, b * v, 0] = 1.0
        out[:, b * v, 1:] = (affine.corners[:, v] - centre) / size[:, None]
        if b > 1:
            out[:, b * v + 1, 1] = out[:, b * v + 2, 2] = 1.0 / size
    out[:, 3 * b :, 1:] = affine.normals / size[:, None, None]
    return out


def rigid_motions(domain: Domain, layout: Layout, centre: Floats, triangles: Ints) -> Floats:
    """(dof, 3) physical degrees of freedom of w = 1, y - y_c and -(x - x_c) in some triangles, zero elsewhere."""
    n = len(triangles)
    about = np.broadcast_to(centre[:2], (n, 2))
    local = rigid_of_triangles(domain, layout, triangles, about, np.ones(n))  # 1, x - x_c, y - y_c
    out = np.zeros((layout.count, 3))
    out[layout.triangle_dofs(triangles)] = np.stack([local[..., 0], local[..., 2], -local[..., 1]], axis=-1)
    return out


def _words(
    free: Floats, centre: Floats, size: float, pieces: int, mesh: Mesh, inside: NDArray[np.bool_]
) -> str:
    where = ""
    if pieces > 1:
        spot = mesh.points[mesh.triangles[inside]].mean(axis=(0, 1))[:2]
        where = f" (the piece of {int(inside.sum())} triangles around {place(spot)}, one of {pieces} pieces)"
    if free.shape[1] == 3:
        return (
            f"the plate{where} is not held: it can move along z and tilt freely; add supports, for example "
            "clamped or simply_supported on a curve group, or z on three points"
        )
    if free.shape[1] == 2:
        # all remaining motions vanish at one point, or all are tilts (w prescribed nowhere)
        offset, slopes = free[0], free[1:] / size
        point = centre.copy()
        if np.abs(offset).max() >= 1e-6:
            point += np.linalg.lstsq(slopes.T, -offset, rcond=None)[0]
        if np.abs(slopes.T @ (point - centre) + offset).max() < 1e-6 * np.abs(free).max():
            return (
                f"the plate{where} is held at a single point: it can tilt in any direction about {place(point)}; "
                "add supports that hold it at two more points, or along a line"
            )
    c0, slope = free[0, 0], free[1:, 0] / size
    steep = np.linalg.norm(slope)
    if steep * size < 1e-6 * abs(c0):
        return (
            f"the plate{where} can move along z: its supports hold rotations only; hold the deflection somewhere "
            '(clamped, simply_supported, or fix = "z")'
        )
    point = centre - c0 * slope / steep**2
    axis = np.array([-slope[1], slope[0]]) / steep
    return (
        f"the plate{where} is a mechanism: it can turn about the line through {place(point)} along "
        f"({axis[0]:.3g}, {axis[1]:.3g}); hold its deflection off that line, or clamp the edge on it"
    )
