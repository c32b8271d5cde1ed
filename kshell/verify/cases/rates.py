"""Observed rates of convergence beside the expected ones, as tables.

The compliance (twice the strain energy) converges like the square of the error in the energy norm. The rate
is the slope between the coarsest and the finest mesh of a row. It says something of the discretisation only where
that is what the errors consist of: on the finest mesh of each row they stay `ROOM` times above what rounding
leaves, which grows with the condition number of bending, like the fourth power of the cells across (Strang & Fix 1973,
section 5.2).

Koiter elements of degree p: energy 2 p, deflection 2 p at vertices, moments p + 1 inside for odd p and p for even p,
p at clamped edges, all as long as the triangles have the shape of the surface: pieces of degree 2 and 3 have an
error of order 4.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kshell.verify.cases.case import ON_MESH, TRUE_SURFACE, Outcome, Run
from kshell.verify.cases.catalogue import find

CLOSE = 0.35  # how far an observed rate may lie from the expected one
ROOM = (
    5.0  # between rounding and the errors that a rate is measured from: less moves it by more than CLOSE / 2
)


@dataclass(frozen=True)
class Rate:
    """A row: what converges how fast."""

    case: str
    method: str
    quantity: str
    refinements: tuple[int, int]
    rate: float
    order: int = 1

    @property
    def name(self) -> str:
        """Such as argyris-4-16."""
        coarse, fine = self.refinements
        return f"{self.method}-{coarse}-{fine}{ON_MESH[self.order]}"

    def measure(self) -> Measured:
        """The errors on both meshes."""
        case = find(self.case)
        quantity, reference = case.quantities[self.quantity], case.references[self.quantity]
        unknowns, errors = [], []
        for n in self.refinements:
            result = case.solve(Run.of(self.method, n, self.order))
            unknowns.append(result.unknowns)
            errors.append(reference.error(quantity.of(result)))
        return Measured(self, (unknowns[0], unknowns[1]), (errors[0], errors[1]))

    def __str__(self) -> str:
        return f"{self.case}-{self.method}-order{self.order}-{self.quantity}"


@dataclass(frozen=True)
class Measured:
    """The relative errors of a row on its two meshes."""

    row: Rate
    unknowns: tuple[int, int]
    errors: tuple[float, float]

    @property
    def rate(self) -> float:
        """The observed one."""
        coarse, fine = self.row.refinements
        return float(np.log(self.errors[0] / self.errors[1]) / np.log(fine / coarse))

    @property
    def rounding(self) -> float:
        """What rounding leaves on the finest mesh at the most, relative: renumbered vertices change no more."""
        return float(np.finfo(float).eps) * self.row.refinements[1] ** 4

    def compare(self) -> Outcome:
        """The observed rate beside the expected one."""
        row = self.row
        return Outcome(
            row.case,
            row.name,
            f"rate {row.quantity}",
            self.unknowns[1],
            self.rate,
            row.rate,
            abs(self.rate / row.rate - 1),
            CLOSE / row.rate,
            self.unknowns[1],
        )


SMOOTH = [
    # quintics: energy 8 (energy norm 4), deflection 6, moments 4, Kirchhoff's edge force 4 at least
    Rate("ssss.sinus.ba1", "argyris", "compliance", (4, 12), 8),
    Rate("ssss.sinus.ba1", "argyris", "w_c", (4, 16), 6),
    Rate("ssss.sinus.ba1", "argyris", "Mx_c", (8, 32), 4),
    Rate("ssss.sinus.ba1", "argyris", "R", (4, 16), 6),
    # uniform pressure: w has r^4 log r in the corners; the forces there are averages of w
    Rate("ssss.uniform.ba1", "argyris", "w_c", (4, 16), 5.6),
    Rate("ssss.uniform.ba1", "argyris", "V_x0", (8, 32), 4),
    Rate("ssss.uniform.ba1", "argyris", "R", (2, 8), 6),
    Rate("clamped.uniform.ba1", "argyris", "w_c", (4, 16), 6),
    Rate("clamped.uniform.ba1", "argyris", "Mx_edge", (4, 16), 5),
    Rate("levy.SFSC.ba1.5", "argyris", "w_c", (4, 16), 6.3),
    Rate("levy.SFSF.ba1", "argyris", "Mx_y1", (4, 16), 4.8),
    Rate("triangle.ss.right", "argyris", "w_c", (3, 12), 6),
    # Morley: energy norm 1, everything else 2
    Rate("ssss.sinus.ba1", "morley", "compliance", (8, 32), 2),
    Rate("ssss.sinus.ba1", "morley", "w_c", (8, 32), 2),
    Rate("ssss.sinus.ba1", "morley", "Mx_c", (8, 32), 2),
    Rate("clamped.uniform.ba1", "morley", "w_c", (8, 32), 2),
    Rate("levy.SSSF.ba1", "morley", "w_c", (8, 32), 2),
]

# On curved edges Argyris holds the true edge, with consistency terms between its nodes: order 6 and more, with
# meshes of order 1 and 2 alike because the shape of the edge is rebuilt from the nodes. Disks under uniform pressure,
# whose deflection is a quartic and whose edge is known to rounding, have errors of rounding on every mesh.
CURVED = [
    *(
        Rate(case, "argyris", quantity, refinements, rate, order)
        for order in (1, 2)
        for case, quantity, refinements, rate in (
            ("annulus.CC.q.b0.5", "compliance", (3, 6), 8.2),
            ("annulus.SS.q.b0.5", "w_mid", (2, 12), 6.3),
            ("annulus.GS.q.b0.5", "w_in", (2, 8), 6.5),
        )
    ),
    Rate("disk.clamped.uniform", "morley", "w_c", (8, 32), 2),
    Rate("disk.ss.uniform", "morley", "w_c", (8, 32), 2),
    Rate("annulus.GS.q.b0.5", "morley", "w_in", (6, 24), 2),
]

# Where the solution is singular, layers of smaller triangles lower the error, not the rate.
SINGULAR = [
    Rate("ssss.point.ba1", "argyris", "w_c", (4, 16), 2),  # w = r^2 log r
    Rate("lshape.clamped", "argyris", "compliance", (8, 32), 1.3),  # w = r^1.54: 1.09 in the limit
    Rate("polygon.ss.6", "morley", "w_c", (8, 32), 1.55),  # w = r^1.5: 1 in the limit
]

# Plates as shells: no error of the shape
FLAT = [
    *(
        Rate(case, f"koiter{degree}", quantity, refinements, rate)
        for degree, refinements, rows in (
            (1, (8, 32), {"w_c": 2, "compliance": 2, "Mx_c": 2, "Mx_edge": 1}),
            (2, (4, 16), {"w_c": 4, "compliance": 4, "Mx_c": 2, "Mx_edge": 2}),
            (3, (6, 24), {"w_c": 6, "compliance": 6, "Mx_c": 4, "Mx_edge": 3}),
        )
        for quantity, rate in rows.items()
        for case in ("clamped.uniform.ba1" if quantity == "Mx_edge" else "ssss.sinus.ba1",)
    ),
    Rate("clamped.uniform.ba1", "koiter1", "w_c", (8, 32), 2),
    Rate("clamped.uniform.ba1", "koiter2", "w_c", (4, 16), 3.7),
    Rate("disk.ss.uniform", "koiter1", "w_c", (6, 24), 2, 2),
    Rate("disk.ss.uniform", "koiter2", "w_c", (4, 16), 4.2, 2),
    Rate("disk.ss.uniform", "koiter3", "compliance", (3, 12), 4, 2),
]

SHELLS = [
    # layers along the edges: flat triangles are still far from their order 2, cubics feel their shape last
    Rate("shell.scordelis_lo", "koiter1", "w_free_edge", (16, 48), 1.9),
    Rate("shell.scordelis_lo", "koiter2", "w_free_edge", (8, 32), 4, 2),
    Rate("shell.scordelis_lo", "koiter2", "compliance", (8, 32), 4, 2),
    Rate("shell.scordelis_lo", "koiter3", "w_free_edge", (6, 12), 6, 2),
    Rate("shell.scordelis_lo", "koiter3", "w_free_edge", (6, 12), 6.1, TRUE_SURFACE),
    Rate("shell.scordelis_lo", "argyris", "w_free_edge", (2, 8), 6.3, TRUE_SURFACE),
    Rate("shell.quarter_circle.t0.001", "koiter1", "u_tip", (16, 48), 2),
    Rate("shell.quarter_circle.t0.001", "koiter2", "u_tip", (8, 32), 4, 2),
    Rate("shell.quarter_circle.t0.001", "koiter3", "u_tip", (6, 24), 4, 2),
    Rate("shell.quarter_circle.t0.001", "koiter3", "u_tip", (6, 24), 4.1, TRUE_SURFACE),
    Rate("shell.tube.force", "koiter1", "w_end", (24, 96), 1.9),
    Rate("shell.tube.force", "koiter2", "w_end", (12, 48), 4, 2),
    Rate("shell.tube.force", "koiter2", "slope_end", (12, 48), 3, 2),
    Rate("shell.tube.force", "koiter3", "slope_end", (12, 48), 4.6, 2),
    Rate("shell.tube.force", "argyris", "w_end", (4, 16), 6, TRUE_SURFACE),
    Rate("shell.sphere.pressure.t0.1", "koiter2", "compliance", (4, 16), 4.2, 2),
    Rate("shell.sphere.pressure.t0.1", "argyris", "compliance", (2, 8), 7, TRUE_SURFACE),
]

RATES = (*SMOOTH, *CURVED, *SINGULAR, *FLAT, *SHELLS)
