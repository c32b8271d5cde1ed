"""The elements against scikit-fem, against polynomials, and far from the origin."""

from math import factorial

import numpy as np
import pytest
import skfem
from hypothesis import given, settings
from hypothesis import strategies as st
from skfem.helpers import dd, ddot, dot, grad, mul

from kshell.elements import AffineTriangles, ElementArgyris, ElementMorley, matrices
from kshell.elements.quadrature import triangle_rule
from tests.plate.plates import rectangle

ELEMENTS = [ElementMorley(), ElementArgyris()]
BARE = {"morley": skfem.ElementTriMorley, "argyris": skfem.ElementTriArgyris}


def ids(element):
    return element.name


@skfem.BilinearForm
def bending_form(u, v, _):
    hessian = dd(u)
    stress = 0.7 * hessian
    stress[0, 0] += 0.3 * (hessian[0, 0] + hessian[1, 1])
    stress[1, 1] += 0.3 * (hessian[0, 0] + hessian[1, 1])
    return ddot(stress, dd(v))


@skfem.BilinearForm
def mass_form(u, v, _):
    return u * v


@skfem.BilinearForm
def tension_form(u, v, w):
    n = np.array([[2.0, 0.3], [0.3, -1.0]])
    return dot(mul(n[:, :, None, None] + 0 * w.x[0], grad(u)), grad(v))


@skfem.LinearForm
def load_form(v, _):
    return 3.0 * v


def distorted():
    return rectangle(4, 3, a=1.3, b=0.7, skew=0.2, wobble=0.2)


@pytest.mark.parametrize("element", ELEMENTS, ids=ids)
def test_batched_matrices_are_those_of_scikit_fem_forms(element):
    mesh = distorted()
    basis = skfem.Basis(mesh.to_skfem(), element, intorder=10)
    triangles = AffineTriangles.of_mesh(mesh)
    m = element.transformation(triangles)
    n = len(triangles)
    d = np.array([[1.0, 0.3, 0.0], [0.3, 1.0, 0.0], [0.0, 0.0, 0.35]])
    tension = np.array([[2.0, 0.3], [0.3, -1.0]])
    cases = [
        (bending_form, matrices.stiffness(element, triangles, np.tile(d, (n, 1, 1)), m)),
        (mass_form, matrices.mass(element, triangles, np.ones(n), m)),
        (tension_form, matrices.geometric_stiffness(element, triangles, np.tile(tension, (n, 1, 1)), m)),
    ]
    dofs = basis.element_dofs.T
    for form, blocks in cases:
        expected = form.assemble(basis).toarray()
        found = np.zeros_like(expected)
        np.add.at(found, (dofs[:, :, None], dofs[:, None, :]), blocks)
        assert np.abs(found - expected).max() < 1e-11 * np.abs(expected).max()
    vector = np.zeros(basis.N)
    np.add.at(vector, dofs, matrices.load(element, triangles, np.full(n, 3.0), m))
    assert np.allclose(vector, load_form.assemble(basis), rtol=0, atol=1e-13)


@pytest.mark.parametrize("element", ELEMENTS, ids=ids)
def test_same_answer_as_bare_scikit_fem_where_that_can_be_trusted(element):
    ours = distorted().to_skfem()
    mesh = skfem.MeshTri(ours.p, ours.t)  # sorts the vertices of triangles, which the bare elements rely on
    energies = []
    for used in (element, BARE[element.name]()):
        basis = skfem.Basis(mesh, used, intorder=8)
        held = basis.get_dofs().all()
        system = skfem.condense(bending_form.assemble(basis), load_form.assemble(basis), D=held)
        energies.append(load_form.assemble(basis) @ skfem.solve(*system))
    assert energies[0] == pytest.approx(energies[1], rel=1e-8)


@pytest.mark.parametrize("element", ELEMENTS, ids=ids)
@pytest.mark.parametrize(("shift", "scale"), [(0.0, 1.0), (1e6, 1.0), (0.0, 1e-6), (0.0, 1e6)])
def test_stiffness_does_not_depend_on_place_and_scales_exactly(element, shift, scale):
    mesh = rectangle(4)
    d = np.tile(np.diag([1.0, 1.0, 0.5]), (len(mesh.triangles), 1, 1))

    def scaled_stiffness(points, size):
        triangles = AffineTriangles.of_arrays(points, mesh.triangles)
        m = element.transformation(triangles)
        powers = np.concatenate([np.tile(element.vertex_powers, 3), np.tile(element.edge_powers, 3)])
        return matrices.stiffness(element, triangles, d, m * size ** -powers.astype(float)) * size**2

    reference = scaled_stiffness(mesh.points[:, :2], 1.0)
    moved = scaled_stiffness(mesh.points[:, :2] * scale + shift, scale)
    assert np.abs(moved - reference).max() < 1e-9 * np.abs(reference).max()


corner = st.tuples(st.floats(-1, 1), st.floats(-1, 1))


@settings(max_examples=40, deadline=None, derandomize=True)
@given(st.lists(corner, min_size=3, max_size=3), st.integers(0, 1), st.integers(0, 2**20))
def test_polynomials_of_full_degree_are_reproduced(corners, which, seed):
    """Degrees of freedom of a random polynomial give back its values and derivatives anywhere."""
    x = np.array(corners)
    area = abs(np.linalg.det(np.stack([x[1] - x[0], x[2] - x[0]])))
    longest = max(np.linalg.norm(x[i] - x[j]) for i in range(3) for j in range(i))
    if longest == 0 or area < 0.05 * longest**2:
        return
    element = ELEMENTS[which]
    c = np.random.default_rng(seed).normal(size=(element.maxdeg + 1, element.maxdeg + 1))
    c = np.tril(c[::-1])[::-1]  # total degree only

    def w(p, dx=0, dy=0):
        reduced = np.polynomial.polynomial.polyder(
            np.polynomial.polynomial.polyder(c, dx, axis=0), dy, axis=1
        )
        return np.polynomial.polynomial.polyval2d(p[..., 0], p[..., 1], reduced)

    triangles = AffineTriangles.of_arrays(x, np.array([[2, 0, 1]]))
    points = triangles.corners[0]
    parts = [(0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2)][: len(element.vertex_powers)]
    values = [[w(p, *part) for part in parts] for p in points]
    middle = points[[[0, 1], [1, 2], [0, 2]]].mean(axis=1)
    normal = triangles.normals[0]
    slopes = w(middle, 1, 0) * normal[:, 0] + w(middle, 0, 1) * normal[:, 1]
    d = np.concatenate([np.ravel(values), slopes])
    vector = element.transformation(triangles) @ d[None, :, None]
    xi = np.array([[0.2, 0.3], [1.2, -0.4]])  # the second lies outside
    at = points[0] + xi @ triangles.jacobian[0].T
    expected = {
        0: [w(at)],
        1: [w(at, 1, 0), w(at, 0, 1)],
        2: [w(at, 2, 0), w(at, 0, 2), 2 * w(at, 1, 1)],
        3: [w(at, 3, 0), w(at, 2, 1), w(at, 1, 2), w(at, 0, 3)],
    }
    scale = np.abs(c).max() * (longest**2 / area) ** 5
    for order, wanted in expected.items():
        found = matrices.rows(element, triangles, xi, order, vector)[0, :, :, 0].T
        assert np.allclose(found, wanted, atol=1e-9 * scale / min(longest, 1) ** order)


def test_argyris_is_continuously_differentiable_across_edges():
    mesh = rectangle(2, wobble=0.2)
    element = ElementArgyris()
    basis = skfem.Basis(mesh.to_skfem(), element)
    d = np.random.default_rng(3).normal(size=basis.N)
    inner = np.flatnonzero(mesh.edge_counts == 2)
    for edge in inner:
        a, b = mesh.points[mesh.edges[edge], :2]
        points = a + np.linspace(0.1, 0.9, 5)[:, None] * (b - a)
        sides = []
        for t in np.flatnonzero((mesh.triangle_edges == edge).any(axis=1)):
            one = AffineTriangles.of_mesh(mesh, np.array([t]))
            vector = element.transformation(one) @ d[basis.element_dofs[:, t]][None, :, None]
            xi = one.reference_coordinates(points[None])
            sides.append([matrices.rows(element, one, xi, k, vector)[0, :, :, 0] for k in (0, 1)])
        for k in (0, 1):
            assert np.allclose(sides[0][k], sides[1][k], atol=1e-9)


@pytest.mark.parametrize("degree", [5, 12, 19, 20, 23, 30])
def test_triangle_rules_integrate_polynomials_of_their_degree(degree):
    """x^i y^j over the reference triangle is i! j! / (i + j + 2)!."""
    points, weights = triangle_rule(degree)
    x, y = points.T
    assert min(x.min(), y.min(), (1 - x - y).min()) > 0
    for i in range(degree + 1):
        exact = factorial(i) * factorial(degree - i) / factorial(degree + 2)
        assert np.sum(weights * x**i * y ** (degree - i)) == pytest.approx(exact, rel=1e-12)
