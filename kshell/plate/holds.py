"""Consistency terms on curved held edges, after Nitsche (Abh. Math. Sem. Univ. Hamburg 36 (1971) 9-15).

On a curved edge the conditions at vertices and midpoints leave the deflection small, but not zero, between
them, and the edge force V and edge moment M_nn do a little work on it. Taking that work out,

    - int V(w) v + V(v) (w - g)  +  int M_nn(w) v_n + M_nn(v) (w_n - s),        V = Q_n + d M_nt / ds,

lets edge moments converge with the order of the element; without it they stay at order two. A penalty keeps the
matrix positive definite on coarse meshes. On straight edges w and w_n vanish exactly and nothing is added.

Symbols
-------
n, t, k    outward normal, tangent (n turned by 90 degrees), curvature vector dt/ds
M, Q       moments -D (w_xx, w_yy, 2 w_xy), shear forces div M
g, s       prescribed deflection, and slope w_n
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from kshell.elements import PlateElement, matrices
from kshell.plate.domain import Domain
from kshell.plate.forms import Bending, Form

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
OfPlace = Callable[[Floats], Floats]  # values (...) at points (..., 2)

POINTS = 8
# penalties, in units of D / h^3 and D / h; 1e3 leaves a disk with 16 edges indefinite, 1e6 costs digits
VALUE_PENALTY = 1e4
SLOPE_PENALTY = 1e3
KEPT = 1024  # edges whose rows are kept
STEP = 1e-5  # of a triangle's size, for the change of a varying stiffness

# third derivatives xxx, xxy, xyy, yyy to the derivatives of (w_xx, w_yy, 2 w_xy) along x and along y
ALONG_X = np.array([[1.0, 0, 0, 0], [0, 0, 1, 0], [0, 2, 0, 0]])
ALONG_Y = np.array([[0, 1.0, 0, 0], [0, 0, 0, 1], [0, 0, 2, 0]])


@dataclass
class CurvedHold(Form):
    """The terms of one support on curved edges, as a quadratic form.

    Attributes
    ----------
    edges : (n,) int array
    value : bool
        Whether the deflection is held.
    slope : bool
        Whether the rotation about the edge is held.
    side : int
        Of an edge inside, which of its two triangles: 0 or 1.
    """

    domain: Domain
    element: PlateElement
    bending: Bending
    edges: Ints
    value: bool
    slope: bool
    side: int = 0

    everywhere: bool = field(default=False, init=False)

    def __post_init__(self) -> None:
        self.patch = self.domain.edge_patch(self.edges, POINTS, self.side)

    def blocks(self) -> Iterator[tuple[Ints, Ints]]:
        yield np.arange(len(self.edges)), self.patch.triangles

    def matrices(self, positions: Ints, transform: Floats) -> Floats:
        rows = self._rows(positions, transform)
        weight = self.patch.weights[positions][:, :, None]
        stiff = self._penalty(positions)
        total = np.zeros((len(positions), transform.shape[2], transform.shape[2]))
        if self.value:
            total -= _symmetric(rows.force, weight * rows.value)
            total += _product(rows.value, weight * VALUE_PENALTY * stiff[0] * rows.value)
        if self.slope:
            total += _symmetric(rows.moment, weight * rows.slope)
            total += _product(rows.slope, weight * SLOPE_PENALTY * stiff[1] * rows.slope)
        return total

    def load_vectors(self, positions: Ints, transform: Floats, g: Floats | None, s: Floats | None) -> Floats:
        """(n, local) the right-hand side that goes with a prescribed deflection g and slope s (n, point)."""
        rows, penalty = self._rows(positions, transform), self._penalty(positions)
        weight = self.patch.weights[positions]
        out = np.zeros((len(positions), transform.shape[2]))
        if g is not None:
            pull = VALUE_PENALTY * penalty[0] * rows.value - rows.force
            out += ((weight * g)[:, :, None] * pull).sum(axis=1)
        if s is not None:
            turn = SLOPE_PENALTY * penalty[1] * rows.slope + rows.moment
            out += ((weight * s)[:, :, None] * turn).sum(axis=1)
        return out

    def penalty_energy(self, g: Floats | None, s: Floats | None) -> float:
        """Energy of the penalties on a deflection g and slope s (n, point)."""
        penalty, weight = self._penalty(np.arange(len(self.edges))), self.patch.weights
        total = 0.0
        if g is not None:
            total += VALUE_PENALTY * float((weight * penalty[0][..., 0] * g**2).sum())
        if s is not None:
            total += SLOPE_PENALTY * float((weight * penalty[1][..., 0] * s**2).sum())
        return 0.5 * total

    def _penalty(self, positions: Ints) -> tuple[Floats, Floats]:
        """D / h^3 and D / h per edge, (n, 1, 1), h the smaller of length and height of the triangle."""
        triangles = self.patch.triangles[positions]
        mesh = self.domain.mesh
        length = mesh.edge_lengths[self.edges[positions]]
        h = np.minimum(length, 2 * mesh.areas[triangles] / length)
        d = np.abs(self.bending.at(triangles, self.patch.xy[positions])).max(axis=(1, 2, 3))
        return (d / h**3)[:, None, None], (d / h)[:, None, None]

    @cached_property
    def _on_reference(self) -> Rows:
        """Rows of all edges on the reference degrees of freedom, where edges are so few that they are kept."""
        count = self.element.count
        every = np.arange(len(self.edges))
        return self._make_rows(every, np.broadcast_to(np.eye(count), (len(every), count, count)))

    def _rows(self, positions: Ints, transform: Floats) -> Rows:
        if len(self.edges) > KEPT:
            return self._make_rows(positions, transform)
        known = self._on_reference
        return Rows(
            known.value[positions] @ transform,
            known.slope[positions] @ transform,
            known.moment[positions] @ transform,
            known.force[positions] @ transform,
        )

    def _make_rows(self, positions: Ints, transform: Floats) -> Rows:
        patch = self.patch
        triangles, xi, xy = patch.triangles[positions], patch.xi[positions], patch.xy[positions]
        affine = self.domain.affine(triangles)

        def rows(order: int) -> Floats:
            return matrices.rows(self.element, affine, xi, order, transform)

        n, k = patch.normal[positions], patch.curvature[positions]
        t = np.stack([-n[..., 1], n[..., 0]], axis=-1)
        n_s = np.stack([k[..., 1], -k[..., 0]], axis=-1)  # k turned by -90 degrees
        kappa, third = rows(2), rows(3)
        d = self.bending.at(triangles, xy)
        moment = -d @ kappa
        along_x, along_y = -d @ (ALONG_X @ third), -d @ (ALONG_Y @ third)
        if not self.bending.section.constant_per_triangle:
            size = STEP * np.sqrt(np.abs(affine.determinant))[:, None, None]
            dx, dy = (self._stiffness_change(triangles, xy, size * axis) for axis in np.eye(2))
            along_x, along_y = along_x - dx @ kappa, along_y - dy @ kappa
        along_s = t[..., 0, None, None] * along_x + t[..., 1, None, None] * along_y
        shear_x, shear_y = along_x[:, :, 0] + along_y[:, :, 2], along_x[:, :, 2] + along_y[:, :, 1]
        twist_change = _apply(_pair(n, t), along_s) + _apply(_pair(n_s, t) + _pair(n, k), moment)
        gradient = rows(1)
        return Rows(
            value=rows(0)[:, :, 0],
            slope=n[..., 0, None] * gradient[:, :, 0] + n[..., 1, None] * gradient[:, :, 1],
            moment=_apply(_pair(n, n), moment),
            force=n[..., 0, None] * shear_x + n[..., 1, None] * shear_y + twist_change,
        )

    def _stiffness_change(self, triangles: Ints, xy: Floats, step: Floats) -> Floats:
        """Derivative of D along a step (n, 1, 2), by central differences."""
        length = np.abs(step).max(axis=2)[..., None, None]
        return (self.bending.at(triangles, xy + step) - self.bending.at(triangles, xy - step)) / (2 * length)


@dataclass
class HoldLoad:
    """The right-hand side of a `CurvedHold` with a prescribed deflection, slope, or both; no load in statics."""

    hold: CurvedHold
    deflection: OfPlace | None = None
    slope: OfPlace | None = None

    everywhere: bool = field(default=False, init=False)

    def blocks(self) -> Iterator[tuple[Ints, Ints]]:
        yield from self.hold.blocks()

    def vectors(self, positions: Ints, transform: Floats) -> Floats:
        return self.hold.load_vectors(positions, transform, *self._given(self.hold.patch.xy[positions]))

    def energy(self) -> float:
        """Of the penalties on what is prescribed: with it they count what the deflection differs from that."""
        return self.hold.penalty_energy(*self._given(self.hold.patch.xy))

    def _given(self, xy: Floats) -> tuple[Floats | None, Floats | None]:
        return (
            None if self.deflection is None else self.deflection(xy),
            None if self.slope is None else self.slope(xy),
        )

    def resultant(self, origin: Floats) -> Floats:
        return np.zeros(3)

    def gross(self, size: float) -> float:
        return 0.0

    def times(self, factor: float) -> HoldLoad:
        return replace(self, deflection=scaled(factor, self.deflection), slope=scaled(factor, self.slope))


def scaled(factor: float, value: OfPlace | None) -> OfPlace | None:
    """A function of the place times a number."""
    return None if value is None else lambda xy: factor * value(xy)


@dataclass(frozen=True)
class Rows:
    """w, w_n, M_nn and V at the points of edges as rows (n, point, local)."""

    value: Floats
    slope: Floats
    moment: Floats
    force: Floats


def _pair(a: Floats, b: Floats) -> Floats:
    """(..., 3) coefficients of a . M b in M_xx, M_yy, M_xy."""
    return np.stack(
        [a[..., 0] * b[..., 0], a[..., 1] * b[..., 1], a[..., 0] * b[..., 1] + a[..., 1] * b[..., 0]], axis=-1
    )


def _apply(coefficients: Floats, rows: Floats) -> Floats:
    """sum_c coefficients_c rows_c: (n, point, local)."""
    return (coefficients[:, :, None] @ rows)[:, :, 0]


def _product(left: Floats, right: Floats) -> Floats:
    return np.swapaxes(left, 1, 2) @ right


def _symmetric(left: Floats, right: Floats) -> Floats:
    half = _product(left, right)
    return half + np.swapaxes(half, 1, 2)
