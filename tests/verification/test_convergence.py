"""Observed rates of convergence beside the expected ones, as tables.

The compliance (twice the strain energy) converges like the square of the error in the energy norm. The rate
is the slope between the coarsest and the finest mesh of a row.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass

import numpy as np
import pytest
from skfem.quadrature import get_quadrature
from skfem.refdom import RefTri

from kshell.errors import KshellWarning
from verification.cases import Run, find


@dataclass(frozen=True)
class Rate:
    """A row: what converges how fast."""

    case: str
    element: str
    quantity: str
    refinements: tuple[int, int]
    rate: float
    order: int = 1

    def __str__(self) -> str:
        return f"{self.case}-{self.element}-order{self.order}-{self.quantity}"


SMOOTH = [
    # quintics: energy 8 (energy norm 4), deflection 6, moments 4, Kirchhoff's edge force 4 at least
    Rate("ssss.sinus.ba1", "argyris", "compliance", (4, 16), 8),
    Rate("ssss.sinus.ba1", "argyris", "w_c", (4, 16), 6),
    Rate("ssss.sinus.ba1", "argyris", "Mx_c", (8, 32), 4),
    Rate("ssss.sinus.ba1", "argyris", "R", (8, 32), 4),
    # uniform pressure: w has r^4 log r in the corners, felt by the corner force alone
    Rate("ssss.uniform.ba1", "argyris", "w_c", (4, 16), 5.6),
    Rate("ssss.uniform.ba1", "argyris", "V_x0", (8, 32), 4),
    Rate("ssss.uniform.ba1", "argyris", "R", (8, 32), 2),
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

# On curved edges Argyris holds the true edge at its nodes: order 6 clamped, 5 simply supported, with
# meshes of order 1 and 2 alike because the shape of the edge is rebuilt from the nodes.
CURVED = [
    *(
        Rate(case, "argyris", quantity, refinements, rate, order)
        for order in (1, 2)
        for case, quantity, refinements, rate in (
            ("disk.clamped.uniform", "w_c", (4, 8), 6),
            ("disk.clamped.uniform", "compliance", (4, 8), 6),
            ("disk.ss.uniform", "w_c", (4, 8), 5),
            ("disk.ss.uniform", "compliance", (4, 8), 5),
            ("disk.ss.uniform", "Mt_edge", (4, 8), 2.2),
            ("annulus.CC.q.b0.5", "compliance", (3, 6), 5.9),
            ("annulus.SS.q.b0.5", "w_mid", (3, 6), 5.4),
            ("annulus.GS.q.b0.5", "w_in", (3, 6), 5.2),
        )
    ),
    Rate("ellipse.clamped.2", "argyris", "w_c", (4, 8), 6.2, order=2),
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

CLOSE = 0.35


def slope(row: Rate) -> float:
    errors = []
    for n in row.refinements:
        case, run = find(row.case), Run(row.element, n, row.order)
        value = case.quantities[row.quantity].of(case.solve(run))
        errors.append(abs(value / case.references[row.quantity].value - 1))
    return float(np.log(errors[0] / errors[1]) / np.log(row.refinements[1] / row.refinements[0]))


@pytest.mark.parametrize("row", SMOOTH + CURVED + SINGULAR, ids=str)
def test_rate(row):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", KshellWarning)  # coarse meshes turn sharply along arcs
        observed = slope(row)
    assert observed == pytest.approx(row.rate, abs=CLOSE)


def energy_norm(result, exact, degree):
    """Error of the moments in the energy norm, for bending stiffness 1 and nu = 0.3, relative."""
    reference, weight = get_quadrature(RefTri, degree)
    mesh = result.mesh
    barycentric = np.stack([1 - reference.sum(0), *reference], axis=1)  # (point, corner)
    points = barycentric @ mesh.points[mesh.triangles]  # (triangle, point, 3)
    if result.model["element"] == "morley":
        found = np.broadcast_to(result.cell_fields["moment"][:, None], points.shape)
    else:
        found = result.at(points.reshape(-1, 3))["M"].reshape(points.shape)
    true = exact(points[..., 0], points[..., 1])

    def norm(m):
        xx, yy, xy = np.moveaxis(m, -1, 0)
        density = (xx**2 + yy**2 - 0.6 * xx * yy + 2.6 * xy**2) / (1 - 0.3**2)
        return np.sqrt(np.sum(density * weight * 2 * mesh.areas[:, None]))

    return norm(found - true) / norm(true)


def sinus(x, y):
    """Moments of w = sin(pi x) sin(pi y) / (4 pi^4)."""
    u, v = np.pi * x, np.pi * y
    both = 1.3 * np.sin(u) * np.sin(v) / (4 * np.pi**2)
    return np.stack([both, both, -0.7 * np.cos(u) * np.cos(v) / (4 * np.pi**2)], axis=-1)


def supported_disk(x, y):
    """Moments of the simply supported disk: M_r = 3.3 (1 - r^2) / 16, M_t = (3.3 - 1.9 r^2) / 16."""
    r2 = x**2 + y**2
    radial, tangential = 3.3 * (1 - r2) / 16, (3.3 - 1.9 * r2) / 16
    c, s = x / np.sqrt(r2), y / np.sqrt(r2)
    return np.stack(
        [
            radial * c**2 + tangential * s**2,
            radial * s**2 + tangential * c**2,
            (radial - tangential) * c * s,
        ],
        axis=-1,
    )


@pytest.mark.parametrize(
    ("id", "exact", "element", "refinements", "rate"),
    [
        ("ssss.sinus.ba1", sinus, "argyris", (4, 16), 4),
        ("ssss.sinus.ba1", sinus, "morley", (8, 32), 1),
        ("disk.ss.uniform", supported_disk, "argyris", (4, 12), 2.5),  # the edge is held at its nodes only
        ("disk.ss.uniform", supported_disk, "morley", (8, 32), 1),
    ],
)
def test_rate_in_the_energy_norm(id, exact, element, refinements, rate):
    errors = [
        energy_norm(find(id).solve(Run(element, n)), exact, 8 if element == "argyris" else 4)
        for n in refinements
    ]
    observed = np.log(errors[0] / errors[1]) / np.log(refinements[1] / refinements[0])
    assert observed == pytest.approx(rate, abs=0.25)
