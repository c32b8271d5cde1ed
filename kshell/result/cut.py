"""Section forces: what the part on one side of a plane exerts on the part on the other.

Symbols
-------
n       unit normal of the surface
nu      unit vector tangent to the surface and normal to the line of the cut, on the side of the plane's normal
t       tangent of the line, n x nu
N, M    membrane forces and moments, symmetric tensors in the tangent plane, force and moment per length
Q       shear forces, div M, per length
f, m    force and moment per length of the line: f = N nu + (Q . nu) n,  m = n x (M nu)
c       centre of the line

The force is the integral of f, the moment that of (x - c) x f + m. Where the line ends at an edge of the surface,
Kirchhoff's theory has a concentrated force more: along the edge Q_n + dM_nt/ds is what loads and supports see
(Timoshenko & Woinowsky-Krieger, section 22), so that div Q + p = 0, integrated over the part, leaves M_nt n of the
edge at the end of the line, and - M_nt n at its start, with M_nt = t_e . M n_e, n_e the normal of the edge out of the
surface and t_e = n x n_e.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kshell.errors import InputError

if TYPE_CHECKING:
    from kshell.mesh.mesh import Mesh
    from kshell.result.result import Result

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

# three Gauss points on (0, 1), and with both ends the places whose polynomial gives the tangent of the line
GAUSS = 0.5 + 0.5 * np.sqrt(0.6) * np.array([-1.0, 0.0, 1.0])
WEIGHTS = np.array([5.0, 8.0, 5.0]) / 18.0
PLACES = np.concatenate([[0.0], GAUSS, [1.0]])


class Segments(NamedTuple):
    """Where a plane cuts triangles.

    Attributes
    ----------
    triangles : (n,)
    ends : (n, 2, 3)
    edges : (n, 2)
        An edge that each end lies on: of ends of the line one of the boundary, elsewhere -1.
    """

    triangles: Ints
    ends: Floats
    edges: Ints


def cut(result: Result, point: ArrayLike, normal: ArrayLike) -> dict[str, Any]:
    """Section forces of a result. See `Result.cut`."""
    origin, axis = _vector("point", point), _vector("normal", normal)
    if not np.any(axis):
        raise InputError("cut: normal = 0: give the direction across the plane")
    axis = axis / np.linalg.norm(axis)
    lines = [_Line(result, segments, axis) for segments in _segments(result.mesh, origin, axis)]
    force, moment = np.mean([line.resultants() for line in lines], axis=0)
    line = lines[0]
    return {
        "at": line.centre,
        "normal": axis,
        "length": float(line.ds.sum()),
        "force": force,
        "moment": moment,
        "N": float(force @ axis),
        "V": force - (force @ axis) * axis,
        "M": moment - (moment @ axis) * axis,
        "T": float(moment @ axis),
    }


def _vector(name: str, value: ArrayLike) -> Floats:
    try:
        out = np.array(value, dtype=float)
    except (TypeError, ValueError):
        out = np.zeros(0)
    if out.shape == (2,):
        out = np.append(out, 0.0)
    if out.shape != (3,) or not np.isfinite(out).all():
        raise InputError(f"cut: {name} = {value!r}: must be three finite numbers")
    return out


def _segments(mesh: Mesh, origin: Floats, axis: Floats) -> list[Segments]:
    """The line of a plane on the flat triangles; twice where it runs along edges, with the triangles of either side."""
    height = (mesh.points - origin) @ axis
    height[np.abs(height) <= 1e-12 * mesh.size] = 0.0
    out: list[Segments] = []
    for above in (height >= 0.0, height > 0.0):
        if out and not np.any(height == 0.0):
            break
        corners = above[mesh.triangles]
        cut = np.flatnonzero(corners.any(axis=1) & ~corners.all(axis=1))
        if len(cut):
            edges = mesh.triangle_edges[cut]
            start, end = np.moveaxis(mesh.edges[edges], -1, 0)
            crossed = above[start] != above[end]
            chosen = edges[crossed].reshape(-1, 2)
            a, b = mesh.edges[chosen].transpose(2, 0, 1)
            share = (height[a] / (height[a] - height[b]))[..., None]
            ends = (1.0 - share) * mesh.points[a] + share * mesh.points[b]
            long = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1) > 1e-12 * mesh.size
            if long.any():
                known = _boundary_ends(mesh, height, chosen[long], above)
                out.append(Segments(cut[long], ends[long], known))
    if out:
        return out
    low, high = height.min(), height.max()
    raise InputError(
        f"cut: the plane does not meet the surface, which lies {low:.6g} to {high:.6g} from it along the normal: move "
        "the point"
    )


def _boundary_ends(mesh: Mesh, height: Floats, edges: Ints, above: NDArray[np.bool_]) -> Ints:
    """(n, 2) boundary edges at the ends of the line, -1 at places that segments share.

    Parameters
    ----------
    height : (vertex,) from the plane
    edges : (n, 2) that segments end on
    above : (vertex,) bool
        Which vertices count as above the plane: those on it show on which side the triangles are.
    """
    a, b = mesh.edges[edges].transpose(2, 0, 1)
    vertex = np.where(height[a] == 0.0, a, np.where(height[b] == 0.0, b, -1))
    key = np.where(
        vertex >= 0, len(mesh.edges) + vertex, edges
    )  # of a place: a vertex, or the inside of an edge
    _, place, count = np.unique(key, return_inverse=True, return_counts=True)
    single = count[place].reshape(key.shape) == 1
    out = np.where(single & (vertex < 0) & np.isin(edges, mesh.boundary_edges), edges, -1)
    rim = mesh.boundary_edges
    for s, e in np.argwhere(single & (vertex >= 0)).tolist():
        there = rim[(mesh.edges[rim] == vertex[s, e]).any(axis=1)]
        other = mesh.edges[there].sum(axis=1) - vertex[s, e]
        side = there[above[other] != above[vertex[s, e]]]
        if len(there):
            out[s, e] = side[0] if len(side) else there[0]
    return out


class _Line:
    """Values along the line of a cut, at three points of each segment.

    Attributes
    ----------
    x, n, nu : (segment, 3, 3)
    ds : (segment, 3)
    """

    def __init__(self, result: Result, segments: Segments, axis: Floats) -> None:
        self.result, self.segments = result, segments
        a, b = segments.ends[:, 0], segments.ends[:, 1]
        asked = a[:, None] + PLACES[:, None] * (b - a)[:, None]
        # a little into the triangle, so that segments along edges take the values of their own side
        inward = result.mesh.points[result.mesh.triangles[segments.triangles]].mean(axis=1)[:, None] - asked
        values = result.at((asked + 1e-7 * inward).reshape(-1, 3))
        values = {name: part.reshape(*asked.shape[:2], -1) for name, part in values.items()}
        tangent = np.einsum("pq,sqk->spk", _derivatives(), values["x"])
        self.values = {name: part[:, 1:4] for name, part in values.items()}
        self.x = self.values["x"]
        self.ds = WEIGHTS * np.linalg.norm(tangent, axis=2)
        self.frame = _frames(self.values)
        self.n = self.frame[:, :, 2]
        nu = np.cross(tangent, self.n)
        nu /= np.linalg.norm(nu, axis=2, keepdims=True)
        self.nu = nu * np.where(nu @ axis < 0.0, -1.0, 1.0)[..., None]
        self.centre = (self.ds[..., None] * self.x).sum(axis=(0, 1)) / self.ds.sum()

    def resultants(self) -> tuple[Floats, Floats]:
        """Force, and moment about the centre."""
        M = _in_space(self.values["M"], self.frame)
        N = _in_space(self.values.get("N", np.zeros_like(self.values["M"])), self.frame)
        f = np.einsum("spij,spj->spi", N, self.nu)
        f += np.einsum("spi,spi->sp", self._shear(), self.nu)[..., None] * self.n
        m = np.cross(self.n, np.einsum("spij,spj->spi", M, self.nu))
        m += np.cross(self.x - self.centre, f)
        force, moment = ((self.ds[..., None] * part).sum(axis=(0, 1)) for part in (f, m))
        for at, concentrated in self._at_ends():
            force = force + concentrated
            moment = moment + np.cross(at - self.centre, concentrated)
        return force, moment

    def _shear(self) -> Floats:
        """(segment, 3, 3) shear forces as vectors; of shells linear between their means at vertices."""
        if "axis_1" not in self.values:
            q = self.values["Q"]
            return q[..., :1] * self.frame[:, :, 0] + q[..., 1:2] * self.frame[:, :, 1]
        result, fields = self.result, self.result.fields
        if "shear" not in fields:
            raise InputError(
                "cut: elements of order 1 have constant moments and so no shear forces: take order 2 or 3"
            )
        first, normal, q = fields["frame_axis_1"], fields["normal"], fields["shear"]
        at_rows = q[:, :1] * first + q[:, 1:2] * np.cross(normal, first)
        triangles = self.segments.triangles
        a, b, c = result.mesh.points[result.mesh.triangles[triangles]].transpose(1, 0, 2)
        basis = np.stack([b - a, c - a], axis=2)  # (segment, 3, 2)
        xi = np.einsum("skj,spj->spk", np.linalg.pinv(basis), self.x - a[:, None])
        weights = np.concatenate([1.0 - xi.sum(axis=2, keepdims=True), xi], axis=2)
        found = np.einsum("sci,spc->spi", at_rows[result.rows.corner[triangles]], weights)
        return found - np.einsum("spi,spi->sp", found, self.n)[..., None] * self.n

    def _at_ends(self) -> list[tuple[Floats, Floats]]:
        """Concentrated forces, and where they are, at the ends of the line on edges of the surface."""
        mesh, out = self.result.mesh, []
        for s, e in np.argwhere(self.segments.edges >= 0).tolist():
            at, edge = self.segments.ends[s, e], self.segments.edges[s, e]
            values = self.result.at(at + 1e-7 * (self.x[s, 1] - at))
            frame = _frames({name: part[None] for name, part in values.items()})[0, 0]
            n = frame[2]
            start, end = mesh.points[mesh.edges[edge]]
            t_e = (end - start) / np.linalg.norm(end - start)
            n_e = np.cross(t_e, n)
            inside = mesh.points[mesh.triangles[self.segments.triangles[s]]].mean(axis=0)
            if n_e @ (inside - at) > 0.0:
                t_e, n_e = -t_e, -n_e
            M = _in_space(values["M"], frame[None])[0]
            # t runs along n x nu: at its end the line leaves the surface
            along = np.cross(n, self.nu[s, 1]) @ (at - self.x[s, 1])
            out.append((at, np.sign(along) * float(t_e @ M @ n_e) * n))
        return out


def _derivatives() -> Floats:
    """(3, 5) derivative at the Gauss points of the polynomial through values at all places."""
    powers = np.arange(5)
    slopes = powers * GAUSS[:, None] ** np.maximum(powers - 1, 0)
    return np.asarray(slopes @ np.linalg.inv(np.vander(PLACES, 5, increasing=True)))


def _frames(values: dict[str, Floats]) -> Floats:
    """(..., 3, 3) rows e_1, e_2, n of the frame of tensors."""
    x = values["x"]
    if "axis_1" not in values:
        return np.broadcast_to(np.eye(3), (*x.shape[:-1], 3, 3))
    first, n = values["axis_1"], values["normal"]
    return np.stack([first, np.cross(n, first), n], axis=-2)


def _in_space(tensor: Floats, frame: Floats) -> Floats:
    """(..., 3, 3) of components xx, yy, xy (..., 3) in frames (..., 3, 3)."""
    e1, e2 = frame[..., 0, :], frame[..., 1, :]

    def dyad(a: Floats, b: Floats) -> Floats:
        return a[..., :, None] * b[..., None, :]

    xx, yy, xy = (tensor[..., k, None, None] for k in range(3))
    return np.asarray(xx * dyad(e1, e1) + yy * dyad(e2, e2) + xy * (dyad(e1, e2) + dyad(e2, e1)))
