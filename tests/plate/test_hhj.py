"""The Hellan-Herrmann-Johnson element: its tables, its rates, and its agreement with the other plate elements."""

from __future__ import annotations

import numpy as np
import pytest

import kshell as ks
from kshell.elements.hierarchic import hierarchic, hierarchic_jets, orthonormal, orthonormal_jets
from kshell.elements.jets import legendre
from kshell.elements.morley import ElementMorley
from kshell.elements.quadrature import triangle_rule
from kshell.plate.hhj import LARGEST_ORDER
from kshell.plate.hhj.tables import canonical, edge_points, tables
from kshell.plate.problem import PlateProblem
from kshell.scene.structure import resolve
from tests.plate.hhj_cases import MATERIAL, hhj, nearest, problem, square

SUPPORTED_CENTRE = 0.004062352660675052  # Navier's series, nu = .3, D = 1
SUPPORTED_ENERGY = 1.70251052472e-3 / 2  # the same series


@pytest.mark.parametrize("degree", [0, 1, 4, 9, 12])
def test_orthonormal_basis(degree):
    points, weights = triangle_rule(2 * degree + 2)
    values = orthonormal(degree, points)
    assert np.abs(values.T @ (weights[:, None] * values) - np.eye(values.shape[1])).max() < 1e-13
    random = np.random.default_rng(0).uniform(-0.2, 1.2, (4, 5, 2))  # outside, too, and in any shape
    jets = orthonormal_jets(degree, random)[0]
    assert np.abs(orthonormal(degree, random) - jets).max() < 1e-12 * np.abs(jets).max()


@pytest.mark.parametrize("jets", [orthonormal_jets, hierarchic_jets])
def test_jets_are_derivatives(jets):
    points = np.random.default_rng(0).uniform(0.1, 0.4, (7, 2))
    h = 1e-5
    for axis in range(2):
        step = h * np.eye(2)[axis]
        change = (jets(6, points + step) - jets(6, points - step)) / (2 * h)
        exact = jets(6, points)
        assert np.abs(change[0] - exact[1 + axis]).max() < 1e-5
        assert np.abs(change[1 + axis] - exact[3 + axis]).max() < 1e-4
        assert np.abs(change[2 - axis] - exact[5]).max() < 1e-4


@pytest.mark.parametrize("order", [1, 2, 5, 8])
def test_hierarchic_basis_spans_the_polynomials_and_its_bubbles_differ_by_legendre(order):
    points = np.random.default_rng(0).uniform(0, 0.5, (200, 2))
    basis = hierarchic(order, points)
    other = orthonormal(order, points)
    assert np.abs(other @ np.linalg.lstsq(other, basis, rcond=None)[0] - basis).max() < 1e-10
    assert np.linalg.matrix_rank(basis) == basis.shape[1]
    s = np.linspace(0.0, 1.0, 9)
    for edge, direction in enumerate(((1, 0), (-1, 1), (0, 1))):
        jets = hierarchic_jets(order, edge_points(edge, s))
        along = np.tensordot(np.array(direction), jets[1:3], axes=1)
        bubbles = slice(3 + edge * (order - 1), 3 + (edge + 1) * (order - 1))
        assert np.abs(along[:, bubbles] - legendre(order, s)[:, 1:order]).max(initial=0.0) < 1e-12


@pytest.mark.parametrize("order", [1, 3, 8, 12])
def test_tables_have_the_functions_at_any_points(order):
    table = tables(order)
    points = np.random.default_rng(0).uniform(0, 0.5, (30, 2))
    jets = hierarchic_jets(order, points)
    found = [table.inside(points)[None], table.gradients(points).swapaxes(0, 1)]
    found.append(orthonormal(order, points) @ table.jets[3:])
    for values, exact in zip(np.concatenate(found), jets, strict=True):
        assert np.abs(values[:, table.deflection] - exact).max() <= 1e-12 * np.abs(exact).max()
        assert np.delete(values, table.deflection, axis=1).max(initial=0.0) == 0.0
    psi = orthonormal_jets(order - 1, points)
    assert np.abs(table.moment_functions(points) - psi[0]).max() < 1e-12 * np.abs(psi[0]).max()
    slopes = table.moment_gradients(points).swapaxes(0, 1)
    assert np.abs(slopes - psi[1:3]).max() <= 1e-12 * np.abs(psi[1:3]).max()


@pytest.mark.parametrize("order", [2, 3, 4])
def test_canonical_interpolant_keeps_its_polynomials(order):
    points = np.random.default_rng(0).uniform(0, 1, (40, 2))
    same = canonical(order, order)
    assert np.abs(same - np.eye(len(same))).max() < 1e-12
    # a polynomial of the order, written in the basis of a higher one, comes back as itself
    low, high = hierarchic(order, points), hierarchic(order + 2, points)
    written = np.linalg.lstsq(high, low, rcond=None)[0]
    assert np.abs(canonical(order, order + 2) @ written - np.eye(low.shape[1])).max() < 1e-9


RATES = [
    (1, 1.8, 1.5),
    (2, 3.6, 2.0),
    (3, 3.7, 3.6),
    (4, 5.6, 5.6),
]  # order, of the deflection, of the energy


@pytest.mark.parametrize(("order", "deflection", "energy"), RATES)
def test_rates_on_the_simply_supported_square(order, deflection, energy):
    errors = []
    for n in (4, 8):
        mesh = square(n)
        _, found = hhj(problem(mesh, [ks.SimplySupported("edge")], [ks.Pressure(1.0)]), order)
        w = found.unknowns[nearest(mesh, 0.5, 0.5)]
        errors.append((abs(w / SUPPORTED_CENTRE - 1), abs(0.5 * found.work / SUPPORTED_ENERGY - 1)))
    rates = np.log2(np.array(errors[0]) / np.array(errors[1]))
    assert rates[0] > deflection
    assert rates[1] > energy


@pytest.mark.parametrize("order", [8, 10, LARGEST_ORDER])
def test_high_orders_lose_no_digits(order):
    mesh = square(4)
    system, found = hhj(problem(mesh, [ks.SimplySupported("edge")], [ks.Pressure(1.0)]), order)
    assert abs(found.unknowns[nearest(mesh, 0.5, 0.5)] / SUPPORTED_CENTRE - 1) < 2e-11
    assert system.count == 9 + 40 * (order - 1) + 56 * order


def test_order_one_is_morley():
    """Same deflections at the vertices, for forces there; and the same energy."""
    mesh = square(4, jitter=0.2)
    loads = [ks.PointForce((0.5, 0.5, 0), (0, 0, 1.0)), ks.PointForce((0.25, 0.75, 0), (0, 0, -0.5))]
    scene = ks.Scene(mesh=mesh, thickness=1.0, material=MATERIAL, supports=[ks.Clamped("left")], loads=loads)
    morley = PlateProblem(resolve(scene, mesh), ElementMorley())
    q = np.linalg.solve(morley.system.matrix, morley.system.load)
    _, found = hhj(problem(mesh, list(scene.supports), loads), 1)
    expected = morley.reduction.expand(q)[: len(mesh.points)]
    assert np.abs(found.unknowns[: len(mesh.points)] - expected).max() < 1e-10 * np.abs(expected).max()


CASES = {
    "line forces": (
        [ks.Clamped("left")],
        [ks.LineForce("right", (0, 0, 1.0)), ks.LineForce("middle", (0, 0, "y"))],
    ),
    "edge moments": (
        [ks.SimplySupported("left"), ks.SimplySupported("right")],
        [ks.EdgeMoment("right", 1.0), ks.EdgeMoment("left", "y")],
    ),
    "edge springs": ([ks.Elastic("left", 30.0, "zr"), ks.SimplySupported("right")], [ks.Pressure(1.0)]),
    "Winkler": ([ks.Elastic("plate", "30*(1+x)", "z"), ks.Free("edge")], [ks.Pressure("1+x*y")]),
    "prescribed": ([ks.Clamped("left"), ks.Fixed("right", "z", value=(0, 0, "0.01*y"))], [ks.Pressure(0.1)]),
    "points": (
        [ks.SimplySupported("left"), ks.Elastic((1.0, 1.0, 0), 5.0, "z"), ks.Fixed((1.0, 0, 0), "z")],
        [ks.Pressure(1.0)],
    ),
    "initial curvature": ([ks.Clamped("left")], [ks.InitialCurvature((0.1, 0.2, 0.05))]),
    "symmetry": ([ks.Clamped("left"), ks.Symmetry("right"), ks.SimplySupported("top")], [ks.Pressure("x")]),
}


@pytest.mark.parametrize("name", CASES)
def test_same_problem_as_argyris(name):
    """Deflections of both elements come together under refinement."""
    supports, loads = CASES[name]
    apart = []
    for n in (4, 8):
        mesh = square(n)
        argyris = problem(mesh, supports, loads)
        a = argyris.system
        w = argyris.reduction.expand(
            np.linalg.solve(a.matrix.toarray() if n == 8 else a.matrix, a.load + a.fixed_load)
        )
        w = w[: 6 * len(mesh.points) : 6]
        _, found = hhj(argyris, 4)
        apart.append(np.abs(found.unknowns[: len(mesh.points)] - w).max() / np.abs(w).max())
    assert apart[1] < 2e-3
    assert apart[1] < 0.45 * apart[0]
