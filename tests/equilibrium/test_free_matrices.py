"""Tangents near rest, factorised with what is known of the stiffness, against those put together for themselves."""

import numpy as np
import pytest
import scipy.sparse as sp

import kshell as ks
from kshell.analysis.large import indicate
from kshell.analysis.models import model_of
from kshell.equilibrium.condensed import Condensed
from kshell.equilibrium.factor import Factoriser
from kshell.equilibrium.free_matrices import DENSE_UP_TO
from kshell.equilibrium.linear import LinearSolver
from kshell.equilibrium.merged import Columns, Merged, Mirrored
from kshell.equilibrium.problem import Problem
from kshell.shell.koiter.energy import Koiter
from kshell.shell.section import Section
from kshell.solvers.backends import CHOLMOD, PARDISO, RSLAB, Singular
from kshell.solvers.frontal import Frontal
from kshell.solvers.frontal import installed as fronts_installed
from kshell.solvers.repeated import Cholmod, Pardiso, Rslab, SuperLU
from tests.shell.shapes import Model, rectangle

SECTION = Section.isotropic(2.0, 0.3, 0.1)
KINDS = [
    *[Frontal] * fronts_installed(),
    SuperLU,
    *[Cholmod] * CHOLMOD.installed,
    *[Rslab] * RSLAB.installed,
    *[Pardiso] * PARDISO.installed,
]


def held(order, n):
    """A strip with inclined supports, more unknowns than full matrices are for, or fewer."""
    model = Model(rectangle(n, n, 0, 1, 0, 0.8), order, SECTION)
    nodes = model.surface.nodes_of_edges(model.mesh.boundary_edges)
    model.supports.clamp(model.edges(0, 0.0))
    model.supports.along(nodes[-3:], np.array([1.0, 2.0, 0.5]))
    return model, model.reduction()


def springs_on(model):
    """Stiffness that couples unknowns of nodes far from each other, too."""
    size = model.surface.unknowns
    row = sp.csr_matrix(([1.0, -1.0, 0.5], ([0, 0, 0], [0, 4, size - 40])), shape=(1, size))
    return (0.01 * sp.identity(size) + 0.3 * row.T @ row).tocsr()


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("springs", [False, True])
@pytest.mark.parametrize(("order", "n"), [(1, 9), (2, 6), (3, 5), (2, 2)])
def test_tangents_near_rest_are_those_put_together(kind, springs, order, n, monkeypatch):
    """Several in turn; the factor of the stiffness stays as it is."""
    model, reduction = held(order, n)
    assert (model.koiter.unknowns <= DENSE_UP_TO) == (n == 2)
    monkeypatch.setattr(Factoriser, "_kinds", lambda *_: [kind])
    added = springs_on(model) if springs else None
    linear = LinearSolver(model.koiter, reduction, added)
    rng = np.random.default_rng(order)
    load = rng.normal(size=model.surface.unknowns)
    before = linear.respond(reduction.basis.T @ load)
    problem = Problem(model.koiter, reduction, load, springs=added).factorised_by(linear.factoriser)
    for size in (2e-7, 1e-6):
        x = reduction.basis @ rng.normal(size=reduction.basis.shape[1]) * size
        stress = size * rng.normal(size=(len(model.mesh.triangles), model.koiter.strains))
        energy, residual, factor = problem.near_rest(x, stress)
        expected, forces, _ = problem.evaluate(x, 1.0, 2, model.koiter.rest, stress)
        assert energy.hessian is None
        assert energy.value == pytest.approx(expected.value, rel=1e-12)
        np.testing.assert_allclose(residual, forces, atol=1e-12 * np.abs(forces).max())
        tangent = reduction.reduce(expected.hessian).toarray()
        assert np.linalg.eigvalsh(tangent)[0] > 0.0
        assert factor.negative == 0
        right = rng.normal(size=(len(tangent), 2))
        for rhs in (right, right[:, 0]):
            np.testing.assert_allclose(tangent @ factor.solve(rhs), rhs, atol=1e-7)
    np.testing.assert_array_equal(linear.respond(reduction.basis.T @ load), before)


@pytest.mark.parametrize("order", [1, 3])
def test_unstable_tangents_are_told_with_their_negative_eigenvalues(order):
    model, reduction = held(order, 5)
    linear = LinearSolver(model.koiter, reduction)
    problem = Problem(model.koiter, reduction, np.zeros(model.surface.unknowns))
    problem = problem.factorised_by(linear.factoriser)
    stress = model.koiter.stress(
        model.koiter.linear_strain(np.random.default_rng(0).normal(size=model.surface.unknowns))
    )
    x = np.zeros(model.surface.unknowns)
    _, _, factor = problem.near_rest(x, stress)
    values = np.linalg.eigvalsh(
        reduction.reduce(problem.evaluate(x, 1.0, 2, model.koiter.rest, stress)[0].hessian).toarray()
    )
    assert factor.negative == np.sum(values < 0) > 0


def test_an_unstable_inside_is_not_hidden_by_what_is_outside():
    """K_ii < 0 with S > 0: the matrix of both has a negative eigenvalue."""
    inside = Condensed(np.array([[0, 1]]), np.array([1]), sp.identity(2, format="csc"))
    matrix = np.array([[[1.0, 1.0], [1.0, -1.0]]])
    reduced = matrix.copy()
    inside.of_matrix().reduce(slice(0, 1), reduced)
    assert reduced[0, 0, 0] == pytest.approx(2.0)
    with pytest.raises(Singular):
        inside.of_matrix().reduce(slice(0, 1), matrix.copy(), definite=True)


def test_large_structures_keep_nothing_and_have_the_same_tangents(monkeypatch):
    found = []
    for kept in (Koiter.kept, 0):
        monkeypatch.setattr(Koiter, "kept", kept)
        model, reduction = held(3, 5)
        linear = LinearSolver(model.koiter, reduction)
        problem = Problem(model.koiter, reduction, np.ones(model.surface.unknowns))
        problem = problem.factorised_by(linear.factoriser)
        _, residual, factor = problem.near_rest(np.zeros(model.surface.unknowns))
        found.append(factor.solve(reduction.basis.T @ residual))
        assert bool(linear.factoriser._free._known) == (kept > 0)
    np.testing.assert_allclose(found[1], found[0], atol=1e-9 * np.abs(found[0]).max())


def test_sums_and_mirrors_of_patterns():
    rng = np.random.default_rng(3)
    lower = sp.tril(sp.random(20, 20, 0.2, rng=rng) + sp.identity(20)).tocsc()
    other = sp.tril(sp.random(20, 20, 0.1, rng=rng)).tocsc()
    lower.sort_indices()
    merged = Merged(Columns(lower.indptr, lower.indices, None), other)
    for entries in (lower.data, np.zeros(lower.nnz), rng.normal(size=lower.nnz)):
        same = sp.csc_matrix((entries, lower.indices, lower.indptr), shape=lower.shape)
        total = merged.with_other(entries)
        assert abs(total.filled(total.entries) - (same + other)).max() == 0.0
        assert np.array_equal(total.indices, merged.with_other(None).indices)
        whole = Mirrored(Columns(lower.indptr, lower.indices, None)).whole(entries)
        assert abs(whole.filled(whole.entries) - (same + sp.tril(same, -1).T)).max() == 0.0


def roof(load, supports, chart):
    names, u, v = ("a", "b", "c", "d"), (0, 0.7), (0, 25)
    given = ks.geometry.Chart.from_expressions("25*sin(u)", "v", "25*cos(u)") if chart else None
    if chart:
        mesh = ks.geometry.Plane().parameter_mesh(4, 4, names, u_range=u, v_range=v)
    else:
        mesh = ks.geometry.Cylinder(R=25.0).mesh(4, 4, 2, names, u, v, "alternate")
    return ks.Scene(
        mesh=mesh,
        chart=given,
        thickness=0.25,
        material=ks.Isotropic(E=4.32e8, nu=0.2),
        supports=supports,
        loads=[ks.Traction((0, 0, -load))],
    )


@pytest.mark.parametrize("load", [1.0, 90.0, 3e4])
@pytest.mark.parametrize(
    ("element", "supports"),
    [
        ("koiter", [ks.Clamped("a"), ks.Fixed("c", "xz")]),
        ("koiter", [ks.Clamped("a"), ks.Elastic("c", 1e4)]),
        ("argyris", [ks.Clamped("a"), ks.Clamped("c")]),
    ],
)
def test_what_decides_about_large_deflections_is_the_same(load, element, supports, monkeypatch):
    model = model_of(roof(load, supports, element == "argyris"), model="shell", element=element)
    solution = model.solve().own
    found = indicate(model, solution)
    monkeypatch.setattr(Factoriser, "near_rest", lambda *_: None)
    expected = indicate(model, solution)
    assert found.change == pytest.approx(expected.change, rel=1e-6)
    assert found.energy == pytest.approx(expected.energy, rel=1e-9)
    assert found.negative == expected.negative
    assert found.matters == expected.matters
