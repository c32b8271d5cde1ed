"""Frequencies and buckling loads from the matrices of the energy."""

import numpy as np
import pytest
from scipy.sparse.linalg import eigsh

from kshell.shell.koiter import loads, matrices
from kshell.shell.section import Section
from tests.shell.shapes import Model, rectangle


@pytest.mark.parametrize(("order", "n", "tolerance"), [(1, 16, 2e-2), (2, 8, 1e-3), (3, 6, 6e-4)])
def test_frequencies_of_a_cantilever_plate(order, n, tolerance):
    """Square, nu = 0.3: omega a^2 sqrt(m / D) = 3.47100, 8.50619, 21.2839."""
    t = 0.01
    model = Model(rectangle(n, n, 0, 1, 0, 1), order, Section.isotropic(1.0, 0.3, t))
    model.supports.clamp(model.edges(0, 0.0))
    reduction = model.reduction()
    stiffness = reduction.reduce(model.koiter.linear_stiffness())
    mass = reduction.reduce(matrices.mass(model.surface, 1.0))
    values = np.sort(eigsh(stiffness, 3, mass, sigma=0, return_eigenvectors=False))
    bending = t**3 / (12 * 0.91)
    assert np.sqrt(values / bending) == pytest.approx([3.47100, 8.50619, 21.2839], rel=tolerance)


def test_euler_load_of_a_strip():
    model = Model(rectangle(10, 1, 0, 10, 0, 1), 2, Section.isotropic(12.0, 0.0, 0.1))
    model.supports.clamp(model.edges(0, 0.0))
    model.supports.translation(np.arange(model.surface.node_count), "y")
    answer = model.solve(loads.line_force(model.surface, [-1.0, 0, 0], model.edges(0, 10.0)))
    reduction = model.reduction()
    stiffness = reduction.reduce(model.koiter.linear_stiffness())
    geometric = reduction.reduce(model.koiter.geometric_stiffness(answer.stress))
    euler = np.pi**2 * 1e-3 / 400
    (first,) = eigsh(stiffness, 1, -geometric, sigma=0.9 * euler, mode="buckling", return_eigenvectors=False)
    assert first == pytest.approx(euler, rel=1e-3)
