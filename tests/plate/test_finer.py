"""The deflection between vertices, of a degree more than the element's."""

from __future__ import annotations

import numpy as np
import pytest

import kshell as ks
from kshell.elements.quadrature import interval_rule, triangle_rule
from kshell.elements.reference import VERTICES
from tests.plate.hhj_cases import square
from tests.plate.plates import disk

STRIP = ks.Isotropic(E=12.0, nu=0.0)  # D = 1
TURN = np.random.default_rng(5).uniform(0, 2 * np.pi, 60)
INSIDE = (
    0.9
    * np.sqrt(np.linspace(0.01, 1, 60))[:, None]
    * np.stack([np.cos(TURN), np.sin(TURN), 0 * TURN], axis=1)
)
EVERY = np.random.default_rng(3).uniform(0.02, 0.98, (20, 3)) * [1, 1, 0]


def strip(order, load, **options):
    made = ks.Scene(
        mesh=square(2, jitter=0.2), thickness=1.0, material=STRIP, supports=[ks.Clamped("left")], loads=[load]
    )
    return ks.solve(made, element="hhj", order=order, large_deflection=False, error="off", **options)


@pytest.mark.parametrize(
    ("order", "load", "w", "slope"),
    [
        (2, ks.LineForce("right", (0, 0, 1.0)), lambda x: x**2 * (3 - x) / 6, lambda x: x - x**2 / 2),
        (
            3,
            ks.Pressure(1.0),
            lambda x: x**2 * (6 - 4 * x + x**2) / 24,
            lambda x: (3 * x - 3 * x**2 + x**3) / 6,
        ),
        (2, ks.InitialCurvature((0.5, 0.0, 0.0)), lambda x: x**2 / 4, lambda x: x / 2),
    ],
)
def test_polynomials_of_a_degree_more_are_exact(order, load, w, slope):
    """Beams whose moments the element has exactly, and whose deflection it has not."""
    found = strip(order, load).at(EVERY)
    assert found["u"][:, 2] == pytest.approx(w(EVERY[:, 0]), abs=1e-11)
    assert found["rotation"][:, 1] == pytest.approx(-slope(EVERY[:, 0]), abs=1e-10)


def wavy(order, n):
    made = ks.Scene(
        mesh=disk(n),
        thickness=1.0,
        material=ks.Isotropic(E=12 * (1 - 0.3**2), nu=0.3),
        supports=[ks.SimplySupported("edge")],
        loads=[ks.Pressure("exp(x)*cos(3*y)")],
    )
    return ks.solve(made, element="hhj", order=order, large_deflection=False, error="off")


@pytest.fixture(scope="module")
def exact():
    return wavy(9, 4).at(INSIDE)


@pytest.mark.parametrize("order", [3, 4, 5, 6])
@pytest.mark.parametrize("n", [2, 4])
def test_nearer_than_the_elements_own(exact, order, n):
    result = wavy(order, n)
    fields = result.evaluate.__self__
    at = fields.locator.find(INSIDE[:, :2])
    own = fields.of_the_element(at.triangles, at.xi, 0)[:, 0, 0]
    w = exact["u"][:, 2]
    error = np.linalg.norm(result.at(INSIDE)["u"][:, 2] - w)
    assert error < 0.6 * np.linalg.norm(own - w)


@pytest.mark.parametrize("order", [2, 3, 5])
def test_keeps_what_the_element_knows(order):
    """Values at vertices, moments along edges, straight and curved, and inside."""
    result = wavy(order, 2)
    fields = result.evaluate.__self__
    every = np.arange(len(result.mesh.triangles))
    size = np.abs(fields.vertex_displacement).max()

    def difference(xi):
        return (fields.derivatives(every, xi, 0) - fields.of_the_element(every, xi, 0))[..., 0]

    assert difference(VERTICES) == pytest.approx(0.0, abs=1e-12 * size)
    s, weights = interval_rule(order + 8)
    patch = fields.domain.edge_points(result.mesh.boundary_edges, s, weights)
    off = fields.derivatives(patch.triangles, patch.xi, 0) - fields.of_the_element(
        patch.triangles, patch.xi, 0
    )
    assert (off[..., 0] * weights).sum(axis=1) == pytest.approx(0.0, abs=1e-12 * size)
    assert np.abs(off).max() > 1e-9 * size  # it is another function
    straight = ~fields.domain.is_curved
    xi, w = triangle_rule(2 * order)
    if order > 2:
        assert (difference(xi)[straight] @ w) == pytest.approx(0.0, abs=1e-12 * size)


def test_the_lowest_order_keeps_its_own():
    result = wavy(1, 2)
    fields = result.evaluate.__self__
    every = np.arange(len(result.mesh.triangles))
    xi, _ = triangle_rule(3)
    assert fields.derivatives(every, xi, 0) == pytest.approx(fields.of_the_element(every, xi, 0), abs=0)
