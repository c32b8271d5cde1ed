"""Moments in exact equilibrium with the loads: those of an HHJ solution and a correction in each triangle alone.

Moments of order p balance F o I, I the canonical interpolant of order p: F itself for pressures of degree p - 3,
line loads of degree p - 2 and forces at vertices (Brezzi & Raviart 1976; Comodi, Math. Comp. 52 (1989) 17-29). What
is left, F - F o I, is a sum of functionals of single triangles that vanish on P_p(T), rigid motions among them. The
plate of order p' of that triangle alone, all edges free, carries it with m_nn = 0. With p' = degree + 3 nothing is
left: equilibrium holds for every test function, and no constant enters the bounds. The forces of springs, - k w, are
loads of degree p.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from kshell.elements.hierarchic import hierarchic
from kshell.elements.quadrature import interval_rule, triangle_rule
from kshell.plate.forms import AreaSpring, EdgeSpring, Form
from kshell.plate.hhj.state import HHJSolution
from kshell.plate.hhj.system import HHJSystem
from kshell.plate.hhj.tables import LARGEST_ORDER, canonical, edge_points, tables
from kshell.plate.hhj.translate import along, places
from kshell.plate.linear_form import LinearForm
from kshell.plate.loading import AreaLoad, EdgeLoad

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

BLOCK = 1024


def required_order(order: int, loads: Sequence[LinearForm], springs: list[Form]) -> int:
    """The order p' that leaves no load over, for loads of known degree."""
    need = order
    for load in loads:
        if isinstance(load, AreaLoad):
            need = max(need, (load.degree or 0) + 3)
        elif isinstance(load, EdgeLoad) and not load.moment:
            need = max(need, (load.degree or 0) + 2)
    for spring in springs:
        if isinstance(spring, AreaSpring):
            need = max(need, order + (spring.degree or 0) + 3)
        elif isinstance(spring, EdgeSpring) and not spring.rotation:
            need = max(need, order + (spring.degree or 0) + 2)
    return min(need, LARGEST_ORDER)


class Equilibrated:
    """Equilibrated moments of a solution.

    Parameters
    ----------
    system : HHJSystem
    solution : HHJSolution
    loads : list of LinearForm
        The loads of the solution.
    springs : list of Form
        The springs of the system.

    Attributes
    ----------
    order : int
        p', at least that of the system.
    moments : (T, k, 3) array
        Coefficients in the orthonormal basis of degree order - 1.
    """

    def __init__(
        self, system: HHJSystem, solution: HHJSolution, loads: Sequence[LinearForm], springs: list[Form]
    ) -> None:
        self.system, self.solution = system, solution
        self.order = required_order(system.order, loads, springs)
        self.moments = solution.moments
        if self.order > system.order:
            left = self._left_over(loads, springs)
            own = np.flatnonzero(np.abs(left).max(axis=1) > 0.0)
            moments = np.zeros((len(left), tables(self.order).moments, 3))
            moments[:, : solution.moments.shape[1]] = solution.moments
            for start in range(0, len(own), BLOCK):
                chosen = own[start : start + BLOCK]
                moments[chosen] += self._alone(chosen, left[chosen])
            self.moments = moments

    def _left_over(self, loads: Sequence[LinearForm], springs: list[Form]) -> Floats:
        """(T, n) F_T - F_T o I on the hierarchic basis of order p'."""
        parts = [self._tested(order, loads, springs) for order in (self.order, self.system.order)]
        return parts[0] - parts[1] @ canonical(self.system.order, self.order)

    def _tested(self, order: int, loads: Sequence[LinearForm], springs: list[Form]) -> Floats:
        """(T, n) what acts along z on each triangle, on the hierarchic basis of an order."""
        system, triangles = self.system, self.system.triangles
        degree = max([load.degree or 0 for load in loads if isinstance(load, AreaLoad | EdgeLoad)], default=0)
        degree = max(degree, self.order)
        out = np.zeros((len(triangles), (order + 1) * (order + 2) // 2))
        xi, w = triangle_rule(order + degree)
        s, ws = interval_rule((order + degree) // 2 + 1)
        basis = hierarchic(order, xi)
        on_edges = np.stack([hierarchic(order, edge_points(edge, s)) for edge in range(3)])
        for load in loads:
            if isinstance(load, AreaLoad):
                chosen = np.arange(len(triangles)) if load.triangles is None else load.triangles
                values = load.values(chosen, triangles.xy(xi, chosen))
                out[chosen] += (values * w * triangles.area[chosen, None]) @ basis
            elif isinstance(load, EdgeLoad) and not load.moment:
                owner, place = places(triangles, load.edges)
                values = load.value(along(triangles, load.edges, s))
                self._add_on_edges(out, owner, place, values * ws, on_edges)
        for spring in springs:
            if isinstance(spring, AreaSpring):
                chosen = spring.triangles
                w_own = self.solution.local[chosen] @ system.tables.inside(xi).T
                values = -spring.stiffness(triangles.xy(xi, chosen)) * w_own
                out[chosen] += (values * w * triangles.area[chosen, None]) @ basis
            elif isinstance(spring, EdgeSpring) and not spring.rotation:
                owner, place = places(triangles, spring.edges)
                rows = np.stack([system.tables.on_edge(edge, s) for edge in range(3)])[place]
                w_own = (rows @ self.solution.local[owner][..., None])[..., 0]
                values = -spring.stiffness(along(triangles, spring.edges, s)) * w_own
                self._add_on_edges(out, owner, place, values * ws, on_edges)
        return out

    def _add_on_edges(self, out: Floats, owner: Ints, place: Ints, values: Floats, basis: Floats) -> None:
        values = values * self.system.triangles.lengths[owner, place][:, None]
        np.add.at(out, owner, (values[:, None] @ basis[place])[:, 0])

    def _alone(self, chosen: Ints, load: Floats) -> Floats:
        """(n, k, 3) moments of order p' of single free triangles under loads that rigid motions do not feel."""
        t, system = tables(self.order), self.system
        g = system.map[chosen]
        rows = (g.reshape(-1, 12) @ t.rows).reshape(len(g), 3 * t.moments, t.count)[..., 3:]
        right = np.zeros((len(g), t.count))
        right[:, t.deflection] = load
        u = np.linalg.solve(
            rows.swapaxes(1, 2) @ rows, right[:, 3:, None]
        )  # vertices held: they carry nothing
        strains = (rows @ u).reshape(len(g), 3, t.moments)
        factor = system.factor if system.factor.ndim == 2 else system.factor[chosen]
        out: Floats = strains.swapaxes(1, 2) @ factor / system.root[chosen, None, None]
        return out
