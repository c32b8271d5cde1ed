"""The system of a plate: element matrices, elimination of what is inside triangles, factorisation, refinement.

Refinement forms its residuals from strains of the deflection less the plane through the vertices of each triangle.
In the hierarchic basis that plane is the vertices' own share, so that nothing cancels but the slopes. The entries of
the matrix itself would leave eps / h^4 of the deflection, and moments out of equilibrium by as much.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.plate.hhj.arcs import Arcs
from kshell.plate.hhj.geometry import Triangles
from kshell.plate.hhj.numbering import Held, Numbering
from kshell.plate.hhj.state import HHJSolution, Load, Spring
from kshell.plate.hhj.tables import tables
from kshell.solvers.checks import FREE_MOTION, softest_vector

Floats = NDArray[np.float64]
Solve = Callable[[Any], Any]
Ints = NDArray[np.int64]

DENSE_UP_TO = 350  # unknowns up to which a dense factorisation is the fastest (measured, with assembly)
BLOCK = 2048  # triangles whose matrices are made at a time
STEPS = 6
ROUNDING = 1e-16


class HHJSystem:
    """A plate of order p, ready for any number of loads.

    Parameters
    ----------
    triangles : Triangles
    order : int
    stiffness : (3, 3) or (T, 3, 3) array
        C of m = C (w_xx, w_yy, 2 w_xy).
    held : Held
    springs : list of Spring
    arcs : Arcs, optional
        The triangles at curved edges.
    method : str
        Of `kshell.solvers.prepare`, where the system is not small.

    Raises
    ------
    SolveError
        If the plate is not held.
    """

    def __init__(
        self,
        triangles: Triangles,
        order: int,
        stiffness: Floats,
        held: Held,
        springs: tuple[Spring, ...] = (),
        method: str = "direct",
        arcs: Arcs | None = None,
    ) -> None:
        self.triangles, self.order, self.held, self.springs = triangles, order, held, springs
        self.tables = tables(order)
        self.stiffness = np.asarray(stiffness, dtype=np.float64)
        low: Floats = np.linalg.cholesky(self.stiffness).astype(np.float64)
        self.factor = low.swapaxes(-1, -2)  # B, C = B^T B
        self.map = triangles.strain_map(self.factor)
        self.numbering = Numbering(triangles, order, held)
        self.root = np.sqrt(triangles.area)
        self.arcs = arcs
        if arcs is not None:
            self.arc_rows = arcs.rows(self.map, self.factor)
            # strains of planes, which only slopes that are held cannot follow
            self.arc_planes = (self.arc_rows @ arcs.planes) * arcs.pure.any(axis=1)[:, None, None]
        outer = self._eliminate()
        self.solver, self.solver_name = _factorise(self.numbering, outer, method)

    @property
    def count(self) -> int:
        """Number of unknowns of the system."""
        return self.numbering.free_count

    def rows(self, chosen: Any = slice(None)) -> Floats:
        """(n, 3 k, m) l of some triangles as a matrix on the local unknowns."""
        t = self.tables
        g = self.map[chosen]
        out = (g.reshape(-1, 12) @ t.rows).reshape(len(g), 3 * t.moments, t.count)
        if self.arcs is not None:
            place = self.arcs.place[chosen]
            out[place >= 0] = self.arc_rows[place[place >= 0]]
        return out

    def _eliminate(self) -> Floats:
        """(T, o, o) element matrices without the inner unknowns; what takes them out and back is kept."""
        t, n = self.tables, len(self.triangles)
        o = t.outer
        out = np.empty((n, o, o))
        self.inner_inverse = np.empty((n, t.count - o, t.count - o))
        self.back = np.empty((n, t.count - o, o))  # inner = inner_inverse f - back outer
        for start in range(0, n, BLOCK):
            block = slice(start, min(start + BLOCK, n))
            rows = self.rows(block)
            k = rows.swapaxes(1, 2) @ rows
            for spring in self.springs:
                here = np.flatnonzero((spring.triangles >= start) & (spring.triangles < block.stop))
                part = spring.rows[here]
                np.add.at(k, spring.triangles[here] - start, part.swapaxes(1, 2) @ part)
            if t.count == o:
                out[block] = k
                continue
            self.inner_inverse[block] = np.linalg.inv(k[:, o:, o:])
            coupling = k[:, o:, :o]
            self.back[block] = self.inner_inverse[block] @ coupling
            out[block] = k[:, :o, :o] - coupling.swapaxes(1, 2) @ self.back[block]
        return out

    def relative(self, u: Floats) -> Floats:
        """(T, m) local unknowns less the plane through the vertices of each triangle."""
        out = u.copy()
        first = self.tables.slopes(0).start
        planes = (self.triangles.plane_slopes @ u[:, :3, None])[..., 0]
        out[:, first : first + 3 * self.order : self.order] -= planes
        out[:, :3] = 0.0
        return out

    def strains(self, u: Floats) -> Floats:
        """(T, 3, k) l of local unknowns (T, m)."""
        reference = (self.relative(u) @ self.tables.forward).reshape(len(u), 12, -1)
        out = self.map @ reference
        if self.arcs is not None:
            own = u[self.arcs.triangles]
            bent = own[..., None] - self.arcs.planes @ own[:, :3, None]
            found = self.arc_rows @ bent + self.arc_planes @ own[:, :3, None]
            out[self.arcs.triangles] = found.reshape(len(own), 3, -1)
        return out

    def forces(self, strains: Floats) -> Floats:
        """(T, m) l^T of scaled strains (T, 3, k)."""
        reference = self.map.swapaxes(1, 2) @ strains
        out = reference.reshape(len(strains), -1) @ self.tables.forward.T
        if self.arcs is not None:
            own = strains[self.arcs.triangles].reshape(len(self.arc_rows), 1, -1)
            out[self.arcs.triangles] = (own @ self.arc_rows)[:, 0]
        return out

    def moments(self, strains: Floats) -> Floats:
        """(T, k, 3) coefficients of m in psi of strains l."""
        found = strains.swapaxes(1, 2) / self.root[:, None, None]
        if self.arcs is not None:
            own = strains[self.arcs.triangles].swapaxes(1, 2)
            found[self.arcs.triangles] = self.arcs.up.swapaxes(1, 2) @ own
        return found @ self.factor

    def no_load(self) -> Load:
        """A load of zero, to be added to."""
        return Load(np.zeros((len(self.triangles), self.tables.count)), np.zeros(self.numbering.vertices))

    def matrix(self) -> Any:
        """Stiffness on the free unknowns, CSR."""
        return _sparse(self.numbering, self._eliminate())

    def condensed(self, load: Load) -> Floats:
        """(free,) the load on the free unknowns, what acts inside triangles carried to their edges."""
        o = self.tables.outer
        local = load.local if load.initial is None else load.local + self.forces(load.initial)
        out = self.numbering.gather(local[:, :o] - (local[:, None, o:] @ self.back)[:, 0])
        at_vertices = load.vertices[self.numbering.free[: self.numbering.vertices]]
        out[: len(at_vertices)] += at_vertices
        return out

    def product(self, free: Floats) -> Floats:
        """Stiffness times free unknowns, through strains."""
        return self.product_of(self.numbering.scatter(free))

    def product_of(self, unknowns: Floats | None) -> Floats:
        """(free,) stiffness times all unknowns (count,), through strains; None is zero."""
        if unknowns is None:
            return np.zeros(self.count)
        u = self._local(unknowns)
        force = self.forces(self.strains(u))
        for spring in self.springs:
            np.add.at(force, spring.triangles, spring.forces(u))
        o = self.tables.outer
        return self.numbering.gather(force[:, :o] - (force[:, None, o:] @ self.back)[:, 0])

    def _local(self, unknowns: Floats) -> Floats:
        """(T, m) local unknowns of all unknowns, those inside triangles free of forces."""
        outer = unknowns[self.numbering.outer]
        return np.concatenate([outer, -(self.back @ outer[..., None])[..., 0]], axis=1)

    def motion(self, unknowns: Floats) -> HHJSolution:
        """A motion (count,) by itself, without loads."""
        u = self._local(unknowns)
        strains = self.strains(u)
        moments = self.moments(strains)
        return HHJSolution(unknowns, u, strains, moments, self.no_load(), 0.0)

    def energy(self, solution: HHJSolution) -> float:
        """Strain energy of a solution, of its springs too."""
        return 0.5 * float((solution.strains**2).sum()) + self.spring_energy(solution)

    def spring_energy(self, solution: HHJSolution) -> float:
        """Of the springs alone."""
        total = 0.0
        for spring in self.springs:
            total += float(((spring.rows @ solution.local[spring.triangles][..., None]) ** 2).sum())
        return 0.5 * total

    def solve(self, load: Load, held: Held | None = None) -> HHJSolution:
        """The solution under a load, refined to rounding.

        ``held`` has other prescribed values than those of the system; `Held()` prescribes none.
        """
        o, numbering = self.tables.outer, self.numbering
        prescribed = numbering.given(self.held if held is None else held)
        d = np.zeros(numbering.count) if prescribed is None else prescribed
        u = np.zeros((len(self.triangles), self.tables.count))
        if prescribed is not None:
            u[:, :o] = d[numbering.outer]
        at_rest = prescribed is None and load.initial is None
        vertices = load.vertices[numbering.free[: numbering.vertices]]
        sizes: list[float] = []
        for _ in range(STEPS):
            residual = load.local if at_rest and not sizes else self._residual(load, u)
            inner = (self.inner_inverse @ residual[:, o:, None])[..., 0]
            # back^T f_i = K_oi K_ii^-1 f_i
            right = numbering.gather(residual[:, :o] - (residual[:, None, o:] @ self.back)[:, 0])
            right[: len(vertices)] += vertices
            free = self.solver(right) if len(right) else right
            own = float((inner * residual[:, o:]).sum())
            sizes.append(math.sqrt(abs(free @ right) + abs(own)))
            step = numbering.scatter(free)
            d = d + step
            local = step[numbering.outer]
            u[:, :o] = d[numbering.outer]
            u[:, o:] += inner - (self.back @ local[..., None])[..., 0]
            if _finished(sizes):
                break
        strains = self.strains(u)
        if load.initial is not None:
            strains = strains - load.initial
        moments = self.moments(strains)
        work = float((load.local * u).sum() + load.vertices @ d[: numbering.vertices])
        scale = max(sizes[0], 1e-300)
        return HHJSolution(d, u, strains, moments, load, work, tuple(size / scale for size in sizes))

    def _residual(self, load: Load, u: Floats) -> Floats:
        strains = self.strains(u)
        if load.initial is not None:
            strains -= load.initial
        out = load.local - self.forces(strains)
        for spring in self.springs:
            np.add.at(out, spring.triangles, -spring.forces(u))
        return out


def _finished(sizes: list[float]) -> bool:
    """Whether another step of refinement would change nothing, or has stopped gaining."""
    if sizes[0] == 0.0:
        return True
    if len(sizes) < 2:
        return False
    rate = sizes[-1] / max(sizes[-2], 1e-300)
    return rate > 0.3 or sizes[-1] * rate < ROUNDING * sizes[0]


def _factorise(numbering: Numbering, outer: Floats, method: str) -> tuple[Solve, str]:
    """Sum of the element matrices, factorised."""
    n, at = numbering.free_count, numbering.local_number
    if n == 0:
        return lambda right: right, "none"
    if n <= DENSE_UP_TO:
        solve = _dense(n, at, outer)
        if solve is not None:
            return solve, "Cholesky (LAPACK)"
    from kshell.solvers.auto import choose
    from kshell.solvers.direct import Factorisation

    matrix = _sparse(numbering, outer)
    choice = choose(matrix, None, method)
    assert choice.backend is not None  # multigrid is for other elements
    factor = Factorisation(matrix, choice.backend, choice.why)
    return factor.apply, factor.name


def _sparse(numbering: Numbering, outer: Floats) -> Any:
    """Sum of the element matrices as CSR."""
    import scipy.sparse as sp

    n, at, o = numbering.free_count, numbering.local_number, outer.shape[1]
    row, column = np.repeat(at, o, axis=1).ravel(), np.tile(at, (1, o)).ravel()
    keep = (row < n) & (column < n)
    return sp.coo_matrix((outer.ravel()[keep], (row[keep], column[keep])), shape=(n, n)).tocsr()


def _dense(n: int, at: Ints, outer: Floats) -> Solve | None:
    """Dense Cholesky; None where the matrix is singular or nearly so, for a sparse solver to find words."""
    from scipy.linalg.lapack import dpotrf, dpotrs

    place = at[:, :, None] * (n + 1) + at[:, None]  # what is held has a row of its own
    whole = np.bincount(place.ravel(), outer.ravel(), (n + 1) * (n + 1)).reshape(n + 1, n + 1)
    full = np.ascontiguousarray(whole[:n, :n])
    diagonal = full.diagonal()
    if not (diagonal.min() > 0.0 and diagonal.max() < np.inf):
        return None
    factor, info = dpotrf(full.T, lower=1, clean=0)
    if info != 0:
        return None

    def solve(right: Any) -> Any:
        return dpotrs(factor, right, lower=1)[0]

    _, stiffness = softest_vector(full, solve)
    return solve if stiffness > FREE_MOTION else None
