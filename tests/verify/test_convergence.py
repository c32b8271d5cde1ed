"""Observed rates of convergence beside the expected ones, as tables.

The compliance (twice the strain energy) converges like the square of the error in the energy norm. The rate
is the slope between the coarsest and the finest mesh of a row.
"""

import warnings

import numpy as np
import pytest
from skfem.quadrature import get_quadrature
from skfem.refdom import RefTri

from kshell.errors import KshellWarning
from kshell.verify.cases import Run, find
from kshell.verify.cases.rates import CLOSE, RATES, ROOM


@pytest.mark.parametrize("row", RATES, ids=str)
def test_rate(row):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", KshellWarning)  # coarse meshes turn sharply along arcs
        measured = row.measure()
    assert min(measured.errors) > ROOM * measured.rounding  # else rounding is measured: take coarser meshes
    assert measured.rate == pytest.approx(row.rate, abs=CLOSE)


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


def test_a_quartic_on_a_disk_is_exact():
    assert energy_norm(find("disk.ss.uniform").solve(Run("argyris", 2)), supported_disk, 8) < 1e-9
