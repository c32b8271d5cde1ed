"""Moments and forces of several deflections of one plate at once: on the sides of triangles, along curves, inside.

Where the stiffness is constant in each triangle all of them are one row each on the derivatives of the reference
triangle, so that a few products with tables give them for all triangles and deflections together.

Symbols
-------
M, Q      bending moments - D kappa and shear forces div M
n, t      outward normal of a side, and its tangent as the triangle is walked around counter-clockwise
V_n       Q_n + d M_nt / dt
"""

from __future__ import annotations

import copy
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from functools import cached_property, lru_cache, partial
from typing import Self

import numpy as np
from numpy.typing import NDArray

from kshell.elements.quadrature import interval_rule
from kshell.elements.reference import VERTICES, DualBasis
from kshell.mesh.refine import AROUND
from kshell.plate.domain import BLOCK, EdgePatch
from kshell.plate.loads import Loads
from kshell.plate.problem import PlateProblem
from kshell.plate.recovery import shear_rows
from kshell.shell.reference import first_derivatives, lattice

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

POINTS = 4  # on edges: moments of quintics are cubics there
STEP = 1e-7  # of the size of the plate: differences of a varying stiffness


class Rows:
    """What tractions of a plate have in common, whatever its loads: sides, and rows on reference derivatives.

    Attributes
    ----------
    length, tangent : (T, side), (T, side, 2)
        Of chords, walked around.
    points : (side, point, 2)
        Gauss points on the sides of the reference triangle.
    """

    def __init__(self, problem: PlateProblem) -> None:
        self._affine = problem.domain.affine(problem.every)
        self._section = problem.section
        ends = self._affine.corners[:, AROUND]
        step = ends[:, :, 1] - ends[:, :, 0]  # (T, side, 2)
        self.length: Floats = np.hypot(step[..., 0], step[..., 1])
        self.tangent: Floats = step / self.length[..., None]
        s, _ = interval_rule(POINTS)
        corners = VERTICES[AROUND]  # (side, end, 2)
        self.points = corners[:, :1] + s[:, None] * (corners[:, 1:] - corners[:, :1])  # (side, point, 2)
        self._basis = problem.element.basis

    def table(self, order: int, xi: Floats) -> Floats:
        """(derivative, 21, point) of the basis at reference points (point, 2), the same for all triangles."""
        return _table(self._basis, order, xi.tobytes())

    @cached_property
    def moment(self) -> Floats:
        """(T, 3, reference derivative) of M."""
        return np.asarray(-self._section.bending_per_triangle() @ self._affine.curvature_map)

    @cached_property
    def shear(self) -> Floats:
        """(T, 2, reference derivative) of Q."""
        return np.asarray(shear_rows(self._section.bending_per_triangle()) @ self._affine.third_map)

    @cached_property
    def inside(self) -> Floats:
        """(T, reference derivative) of div Q."""
        change = np.swapaxes(self._affine.inverse, 1, 2)  # (T, xy, reference)
        row = np.zeros((len(self.length), 5))
        for reference in range(2):
            row[:, reference : reference + 4] += (change[..., reference, None] * self.shear).sum(axis=1)
        return row

    @cached_property
    def sides(self) -> list[tuple[Floats, Floats]]:
        """Of M_nn (T, second derivative) and V_n (T, third derivative), side by side."""
        first = self._affine.inverse  # (T, reference, xy)
        out = []
        for side in range(3):
            tx, ty = self.tangent[:, side].T
            nx, ny = ty, -tx
            twist = _on(self.moment, nx * tx, ny * ty, nx * ty + ny * tx)  # (T, 3) on 11, 12, 22
            row = nx[:, None] * self.shear[:, 0] + ny[:, None] * self.shear[:, 1]
            for reference in range(2):
                speed = first[:, reference, 0] * tx + first[:, reference, 1] * ty
                row[:, reference : reference + 3] += speed[:, None] * twist
            out.append((_on(self.moment, nx * nx, ny * ny, 2 * nx * ny), row))
        return out


class Tractions(ABC):
    """Of deflections of a plate with the Argyris element.

    Parameters
    ----------
    problem : PlateProblem
    d : (dof, k) array
        Physical degrees of freedom.

    Attributes
    ----------
    deflections : sequence of (dof,) arrays
        Whose they are, as they were given.
    """

    deflections: Sequence[Floats] = ()

    def __init__(self, problem: PlateProblem, d: Floats) -> None:
        self.problem = problem
        self.every = problem.every
        self.affine = problem.domain.affine(self.every)
        if "tractions" not in problem.shared:
            problem.shared["tractions"] = Rows(problem)
        rows: Rows = problem.shared["tractions"]
        self.rows, self.length, self.tangent = rows, rows.length, rows.tangent
        s, self.weights = interval_rule(POINTS)
        self.along_side = _differentiation(s)
        self.points = rows.points
        self.basis = problem.element.basis
        self.reference: Floats = np.empty((len(self.every), d.shape[1], problem.element.count))  # (T, k, 21)
        for start in range(0, len(self.every), BLOCK):  # maps of all triangles take 3.5 kB of each
            some = self.every[start : start + BLOCK]
            m = problem.element.transformation(problem.domain.affine(some))
            self.reference[some] = np.swapaxes(m @ d[problem.layout.triangle_dofs(some)], 1, 2)

    def of(self, number: int) -> Self:
        """Those of one of the deflections."""
        out = copy.copy(self)
        out.reference = self.reference[:, number : number + 1]
        out.deflections = self.deflections[number : number + 1]
        return out

    def derivatives(self, chosen: Ints, xi: Floats, order: int) -> Floats:
        """(n, k, point, derivative) on the reference triangle, at points (point, 2) or (n, point, 2)."""
        local = self.reference[chosen]
        if xi.ndim == 2:
            of_all = self.rows.table(order, xi).transpose(1, 2, 0)  # (21, point, derivative)
            flat = local.reshape(-1, local.shape[2]) @ of_all.reshape(local.shape[2], -1)
            return np.asarray(flat.reshape(*local.shape[:2], *of_all.shape[1:]))
        table = self.basis.tabulate(xi, order)
        return np.moveaxis(table @ np.swapaxes(local, 1, 2)[:, None], 3, 1)

    @abstractmethod
    def inside(self, xi: Floats) -> Floats:
        """(T, k, point) div Q at reference points (point, 2)."""

    @abstractmethod
    def sides(self) -> tuple[Floats, Floats]:
        """M_nn and V_n (T, k, side, point) on the chords of triangles, at the points walked around."""

    @abstractmethod
    def at(self, chosen: Ints, xi: Floats) -> tuple[Floats, Floats]:
        """M (n, k, point, 3) and Q (n, k, point, 2) of triangles at reference points (point, 2) or (n, point, 2)."""

    def shear_at(self, chosen: Ints, xi: Floats) -> Floats:
        """Q (n, k, point, 2) of triangles at reference points."""
        return self.at(chosen, xi)[1]

    def along(self, patch: EdgePatch) -> tuple[Floats, Floats]:
        """M_nn and V_n (n, k, point) of the triangles of a patch along its curves, which it has `POINTS` points on."""
        return self._of_tensors(*self.at(patch.triangles, patch.xi), patch)

    def _of_tensors(self, m: Floats, q: Floats, patch: EdgePatch) -> tuple[Floats, Floats]:
        """M_nn and V_n from M (n, k, point, 3) and Q (n, k, point, 2) along a patch."""
        nx, ny = patch.normal[:, None, :, 0], patch.normal[:, None, :, 1]
        tx, ty = -ny, nx
        normal = nx**2 * m[..., 0] + ny**2 * m[..., 1] + 2 * nx * ny * m[..., 2]
        twist = nx * tx * m[..., 0] + ny * ty * m[..., 1] + (nx * ty + ny * tx) * m[..., 2]
        speed = (patch.weights / self.weights)[:, None]
        step = patch.xy[:, -1] - patch.xy[:, 0]
        sense = np.sign(tx.mean(axis=2) * step[:, :1] + ty.mean(axis=2) * step[:, 1:])[..., None]
        change = sense * (twist @ self.along_side.T) / speed
        return normal, nx * q[..., 0] + ny * q[..., 1] + change


class ConstantTractions(Tractions):
    """With a stiffness that is constant in each triangle, and no initial curvature."""

    def _rows(self, row: Floats, table: Floats) -> Floats:
        """(T, k, point) rows (T, derivative) on the derivatives in a table."""
        count, k, n = self.reference.shape
        flat = self.reference.reshape(-1, n)
        out: Floats = np.zeros((count, k, table.shape[2]))
        for number, part in enumerate(table):
            out += row[:, number, None, None] * (flat @ part).reshape(count, k, -1)
        return out

    def inside(self, xi: Floats) -> Floats:
        return self._rows(self.rows.inside, self.rows.table(4, xi))

    def sides(self) -> tuple[Floats, Floats]:
        count, k = self.reference.shape[:2]
        normal, force = np.empty((2, count, k, 3, POINTS))
        for side, rows in enumerate(self.rows.sides):
            second, third = (self.rows.table(order, self.points[side]) for order in (2, 3))
            normal[:, :, side], force[:, :, side] = self._rows(rows[0], second), self._rows(rows[1], third)
        return normal, force

    def at(self, chosen: Ints, xi: Floats) -> tuple[Floats, Floats]:
        m = _times(self.rows.moment[chosen], self.derivatives(chosen, xi, 2))
        return m, self.shear_at(chosen, xi)

    def shear_at(self, chosen: Ints, xi: Floats) -> Floats:
        return _times(self.rows.shear[chosen], self.derivatives(chosen, xi, 3))


class VaryingTractions(Tractions):
    """With any stiffness, and initial curvatures.

    Parameters
    ----------
    problem : PlateProblem
    d : (dof, k) array
        Physical degrees of freedom.
    loads : sequence of Loads
        Of each deflection, for its initial curvatures.
    """

    def __init__(self, problem: PlateProblem, d: Floats, loads: Sequence[Loads]) -> None:
        super().__init__(problem, d)
        self._loads = loads
        # the same step in all triangles: what it leaves is no jump between them
        self._step = STEP * problem.mesh.size

    def at(self, chosen: Ints, xi: Floats) -> tuple[Floats, Floats]:
        affine = self.problem.domain.affine(chosen)
        second, third = (
            _times(to_xy, self.derivatives(chosen, xi, order))
            for order, to_xy in ((2, affine.curvature_map), (3, affine.third_map))
        )
        changes = [third[..., columns] * np.array([1.0, 1.0, 2.0]) for columns in ([0, 2, 1], [1, 3, 2])]
        xy = affine.corners[:, None, 0] + xi @ np.swapaxes(affine.jacobian, 1, 2)
        for number, loads in enumerate(self._loads):
            if loads.curvatures:
                initial, *slopes = self._with_slopes(partial(loads.initial_curvature, chosen), xy)
                second[:, number] -= initial
                for change, slope in zip(changes, slopes, strict=True):
                    change[:, number] -= slope
        bending = self.problem.bending
        if bending.constant is None:
            stiffness, *slopes = self._with_slopes(partial(bending.at, chosen), xy)
        else:
            stiffness, slopes = bending.at(chosen, xy), []
        m = -_times(stiffness, second)
        along = [-_times(stiffness, change) for change in changes]
        for part, slope in zip(along, slopes, strict=False):
            part -= _times(slope, second)
        dx, dy = along
        return m, np.stack([dx[..., 0] + dy[..., 2], dx[..., 2] + dy[..., 1]], axis=-1)

    def of(self, number: int) -> Self:
        out = super().of(number)
        out._loads = self._loads[number : number + 1]
        return out

    def _with_slopes(self, of: Callable[[Floats], Floats], xy: Floats) -> list[Floats]:
        """A function of points (n, point, 2) and its derivatives by x and y."""
        here = of(xy)
        return [here, *((of(xy + self._step * axis) - here) / self._step for axis in np.eye(2))]

    def inside(self, xi: Floats) -> Floats:
        _, shear = self.at(self.every, lattice(2))
        # (direction, point, node) along the reference axes, then along x and y
        slopes = np.einsum("aqn,tknv->tkqav", first_derivatives(2, xi), shear)
        return np.einsum("tkqav,tav->tkq", slopes, self.affine.inverse)

    def sides(self) -> tuple[Floats, Floats]:
        m, q = (
            part.reshape(*part.shape[:2], 3, POINTS, -1)
            for part in self.at(self.every, self.points.reshape(-1, 2))
        )
        tx, ty = (self.tangent[:, None, :, None, axis] for axis in range(2))
        nx, ny = ty, -tx
        normal = nx**2 * m[..., 0] + ny**2 * m[..., 1] + 2 * nx * ny * m[..., 2]
        twist = nx * tx * m[..., 0] + ny * ty * m[..., 1] + (nx * ty + ny * tx) * m[..., 2]
        change = twist @ self.along_side.T / self.length[:, None, :, None]
        return normal, nx * q[..., 0] + ny * q[..., 1] + change


def tractions_of(
    problem: PlateProblem,
    deflections: Sequence[Floats],
    loads: Sequence[Loads],
    keepers: Sequence[PlateProblem | None] = (),
) -> Tractions:
    """Of deflections (dof,) with their loads; a keeper, the plate under the loads of one of them, keeps them all."""
    d = np.stack(deflections, axis=1)
    if problem.section.constant_per_triangle and not any(own.curvatures for own in loads):
        found: Tractions = ConstantTractions(problem, d)
    else:
        found = VaryingTractions(problem, d, loads)
    found.deflections = deflections
    for number, keeper in enumerate(keepers):
        if keeper is not None:
            keeper.__dict__["_tractions"] = deflections[number], loads[number], found, number
    return found


def tractions_among(problem: PlateProblem, d: Floats) -> tuple[Tractions, int]:
    """Tractions among which those of a deflection under the loads are, and its place."""
    known = problem.__dict__.get("_tractions")
    if known is None or known[0] is not d or known[1] is not problem.loads:
        return tractions_of(problem, [d], [problem.loads], [problem]), 0
    return known[2], known[3]


@lru_cache(maxsize=64)
def _table(basis: DualBasis, order: int, xi: bytes) -> Floats:
    """(derivative, 21, point) of a basis at reference points (point, 2), made once for all plates."""
    return np.moveaxis(basis.tabulate(np.frombuffer(xi).reshape(-1, 2), order), 0, 2)


def _times(matrix: Floats, vector: Floats) -> Floats:
    """(n, k, point, i) matrices (n, i, j) or (n, point, i, j) times vectors (n, k, point, j)."""
    matrix = matrix[:, None, None] if matrix.ndim == 3 else matrix[:, None]
    # sums of whole arrays: products of so small matrices one by one take longer
    rows = [
        sum(matrix[..., i, j] * vector[..., j] for j in range(matrix.shape[-1]))
        for i in range(matrix.shape[-2])
    ]
    return np.stack(rows, axis=-1)


def _on(moment: Floats, xx: Floats, yy: Floats, xy: Floats) -> Floats:
    """(T, 3) a component of moments (T, 3, 3)."""
    out: Floats = xx[:, None] * moment[:, 0] + yy[:, None] * moment[:, 1] + xy[:, None] * moment[:, 2]
    return out


def _differentiation(s: Floats) -> Floats:
    """(point, point) matrix that differentiates the polynomial through values at points."""
    powers = np.vander(s, increasing=True)
    slopes = np.zeros_like(powers)
    slopes[:, 1:] = powers[:, :-1] * np.arange(1, len(s))
    return np.asarray(slopes @ np.linalg.inv(powers))
