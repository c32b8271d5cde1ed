"""Tangents of one pattern: assembly, supports, factorisation with the count of negative pivots."""

import numpy as np
import pytest
import scipy.sparse as sp

import kshell as ks
from kshell.analysis.models import model_of
from kshell.equilibrium.factor import Factoriser
from kshell.equilibrium.linear import LinearSolver
from kshell.equilibrium.problem import Problem
from kshell.equilibrium.reduced import ReducedPattern
from kshell.equilibrium.reduction import Reduction
from kshell.equilibrium.sparsity import Added
from kshell.errors import SolveError
from kshell.shell.koiter import loads
from kshell.shell.koiter.energy import Koiter
from kshell.shell.koiter.surface import Surface
from kshell.shell.section import Section
from kshell.solvers.backends import CHOLMOD, PARDISO, RSLAB, Singular
from kshell.solvers.dissection import dissected
from kshell.solvers.frontal import Frontal
from kshell.solvers.frontal import installed as fronts_installed
from kshell.solvers.repeated import Cholmod, Pardiso, Rslab, SuperLU
from tests.shell.shapes import SHAPES, Model, patch, rectangle, sphere

SECTION = Section.isotropic(2.0, 0.3, 0.1)
KINDS = [
    SuperLU,
    *[Cholmod] * CHOLMOD.installed,
    *[Rslab] * RSLAB.installed,
    *[Pardiso] * PARDISO.installed,
]


@pytest.mark.parametrize("order", [1, 2, 3])
@pytest.mark.parametrize("shape", SHAPES)
def test_assembled_halves_are_the_sum_of_the_element_matrices(shape, order):
    koiter = Koiter(Surface(SHAPES[shape](), order), SECTION)
    where = koiter.triangle_unknowns
    count, n = where.shape
    matrices = np.random.default_rng(order).normal(size=(count, n, n))
    matrices += matrices.swapaxes(1, 2)
    room = koiter.sparsity.empty()
    for some in (slice(0, 3), slice(3, count)):
        koiter.sparsity.put(room, some, matrices[some])
    whole = koiter.sparsity.matrix(room)
    place = (np.repeat(where, n, axis=1).ravel(), np.tile(where, (1, n)).ravel())
    expected = sp.csr_matrix((matrices.ravel(), place), shape=whole.shape)
    assert abs(whole - expected).max() < 1e-13
    assert whole.has_sorted_indices
    assert (np.diff(whole.indices)[np.setdiff1d(np.arange(whole.nnz - 1), whole.indptr[1:-1] - 1)] > 0).all()


def inclined(model):
    """Supports along directions that are no axes: rows of the basis with none, one and two entries."""
    nodes = model.surface.nodes_of_edges(model.mesh.boundary_edges)
    rng = np.random.default_rng(2)
    model.supports.along(nodes[:2], rng.normal(size=3))
    model.supports.along(nodes[2:4], [1.0, 1.0, 0.0])
    model.supports.along(nodes[3:5], [0.0, 1.0, 1.0])
    model.supports.translation(nodes[6:8], "xyz")
    model.supports.rotation(model.mesh.boundary_edges[:2])
    return model.reduction()


@pytest.mark.parametrize("lower", [True, False])
@pytest.mark.parametrize("moved", [True, False])
def test_reduced_pattern_is_the_product_with_the_basis(lower, moved):
    model = Model(rectangle(2, 2, 0, 1, 0, 0.8), 2, SECTION)
    reduction = inclined(model)
    assert set(np.diff(reduction.basis.tocsr().indptr)) == {0, 1, 2}
    x = 0.02 * np.random.default_rng(1).normal(size=model.surface.unknowns)
    rest, bent = (model.koiter.energy(state, 2).hessian for state in (0 * x, x))
    free = reduction.basis.shape[1]
    place = np.random.default_rng(3).permutation(free) if moved else np.arange(free)
    pattern = ReducedPattern(rest, reduction.basis, place.astype(np.int32), lower)
    assert pattern.fits(bent)
    parts = (pattern.entries(bent), pattern.indices, pattern.indptr)
    found = sp.csc_matrix(parts, shape=(free, free)).toarray()
    back = np.argsort(place)
    expected = (reduction.basis.T @ bent @ reduction.basis).toarray()[back][:, back]
    assert np.allclose(found, np.tril(expected) if lower else expected, atol=1e-14 * np.abs(expected).max())
    assert not pattern.fits(sp.identity(model.surface.unknowns, format="csr"))


@pytest.mark.parametrize("kind", KINDS)
def test_factor_of_each_matrix_in_turn(kind):
    model = Model(rectangle(3, 2, 0, 1, 0, 0.8), 2, SECTION)
    model.supports.clamp(model.edges(0, 0.0))
    factoriser = Factoriser(model.reduction(), model.koiter)
    basis = model.reduction().basis
    stiffness = model.koiter.linear_stiffness()
    rng = np.random.default_rng(4)
    for scale in (1.0, 3.0, 0.5):
        right = rng.normal(size=(basis.shape[1], 2))
        factor = factoriser._with(kind, scale * stiffness)
        for b in (right, right[:, 0]):
            x = factor.solve(b)
            assert x.shape == b.shape
            assert np.allclose(basis.T @ (scale * stiffness @ (basis @ x)), b, atol=1e-8)
        assert factor.negative == 0


@pytest.mark.parametrize("kind", [None, *[k for k in KINDS if k is not Cholmod]])
def test_negative_eigenvalues_are_counted(kind):
    """Against dense eigenvalues, for a stiffness minus growing multiples of the identity."""
    model = Model(rectangle(3, 2, 0, 1, 0, 0.8), 2, SECTION)
    model.supports.clamp(model.edges(0, 0.0))
    reduction = model.reduction()
    factoriser = Factoriser(reduction, model.koiter)
    stiffness = model.koiter.linear_stiffness()
    values = np.linalg.eigvalsh(reduction.reduce(stiffness).toarray())
    added, one = Added(), sp.identity(stiffness.shape[0], format="csr")
    for count in (0, 1, 3, 10, 1, 0):
        shift = values[count] - 0.3 * (values[count] - values[count - 1] if count else values[0])
        matrix = added.to(stiffness.copy(), one, -shift)
        factor = factoriser.factorise(matrix) if kind is None else factoriser._with(kind, matrix)
        assert factor.negative == count
        b = np.random.default_rng(count).normal(size=len(values))
        assert np.allclose(reduction.reduce(matrix) @ factor.solve(b), b, atol=1e-8)


def test_a_singular_tangent_is_said_to_be():
    model = Model(patch(), 2, SECTION)
    model.supports.clamp(model.mesh.boundary_edges)
    factoriser = Factoriser(model.reduction(), model.koiter)
    stiffness = model.koiter.linear_stiffness()
    with pytest.raises(SolveError, match="not finite"):
        factoriser.factorise(np.nan * stiffness)
    with pytest.raises(SolveError, match="singular"):
        factoriser.factorise(0.0 * stiffness)


def test_nothing_free_is_no_error():
    koiter = Koiter(Surface(patch(), 1), SECTION)
    none = Reduction(
        sp.csc_matrix((koiter.unknowns, 0)), np.zeros(koiter.unknowns), np.zeros(0, dtype=np.int32)
    )
    factor = Factoriser(none, koiter).factorise(koiter.linear_stiffness())
    assert factor.solve(np.zeros(0)).shape == (0,)
    assert factor.negative == 0


def test_added_matrices_in_place_or_not():
    rng = np.random.default_rng(5)
    base = sp.random(30, 30, 0.2, "csr", rng=rng) + sp.identity(30, format="csr")
    inside = base.copy()
    inside.data = rng.normal(size=base.nnz) * (rng.uniform(size=base.nnz) < 0.5)
    inside.eliminate_zeros()
    outside = sp.random(30, 30, 0.1, "csr", rng=rng)
    added = Added()
    for other in (inside, 2 * inside, outside, inside):
        fresh = base.copy()
        assert abs(added.to(fresh, other, -0.7) - (base - 0.7 * other)).max() < 1e-14


def test_nested_dissection_is_an_order_with_little_fill():
    from scipy.sparse.linalg import splu

    model = Model(rectangle(24, 24, 0, 1, 0, 1), 1, SECTION)
    sparsity = model.koiter.sparsity
    place = dissected(model.koiter.centres, sparsity.groups, len(sparsity.sizes))
    assert np.array_equal(np.sort(place), np.arange(len(sparsity.sizes)))
    assert np.array_equal(np.sort(model.koiter.elimination), np.arange(model.koiter.unknowns))
    matrix = model.koiter.linear_stiffness() + sp.identity(model.koiter.unknowns)
    back = np.argsort(model.koiter.elimination)
    options = {"diag_pivot_thresh": 0.0, "options": {"SymmetricMode": True}}
    dissection = splu(matrix[back][:, back].tocsc(), "NATURAL", **options).nnz
    assert dissection < 1.2 * splu(matrix.tocsc(), "MMD_AT_PLUS_A", **options).nnz
    assert dissection < 0.3 * splu(matrix.tocsc(), "NATURAL", **options).nnz


def test_follower_pressure_is_symmetric_where_the_edges_are_held():
    def problem(held):
        model = Model(rectangle(3, 3, 0, 1, 0, 1), 2, SECTION, sphere(3.0))
        model.supports.simple(model.mesh.boundary_edges if held else model.edges(0, 0.0))
        zero = np.zeros(model.surface.unknowns)
        return Problem(
            model.koiter, model.reduction(), zero, lambda x: loads.follower_pressure(model.surface, x, 0.1)
        )

    assert problem(True)._symmetric()
    assert not problem(False)._symmetric()


def test_cuts_follow_the_lines_of_a_regular_mesh():
    """The first separator of n x n cells is one grid line: n + 1 vertices and n edges, not twice as many."""
    n = 16
    i = np.arange((n + 1) ** 2).reshape(n + 1, n + 1)
    a, b, c, d = i[:-1, :-1].ravel(), i[1:, :-1].ravel(), i[1:, 1:].ravel(), i[:-1, 1:].ravel()
    triangles = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    points = np.stack(np.meshgrid(np.arange(n + 1), np.arange(n + 1), indexing="ij"), axis=-1).reshape(-1, 2)
    sides = np.sort(triangles[:, [[0, 1], [1, 2], [0, 2]]], axis=2).reshape(-1, 2)
    edges, number = np.unique(sides, axis=0, return_inverse=True)
    members = np.concatenate([triangles, len(points) + number.reshape(-1, 3)], axis=1)
    place = dissected(points[triangles].mean(axis=1), members, len(points) + len(edges))
    middle = np.concatenate([points.astype(float), points[edges].mean(axis=1)])
    last = middle[place >= len(place) - (2 * n + 1)]
    assert np.ptp(last, axis=0).min() == 0.0


@pytest.mark.parametrize("elements", [0, 1, 5])
def test_few_elements_have_an_order_too(elements):
    members = np.arange(3 * elements).reshape(elements, 3)
    place = dissected(np.zeros((elements, 2)), members, 3 * elements)
    assert np.array_equal(np.sort(place), np.arange(3 * elements))


def pinched_hemisphere(thickness):
    """A quarter of it, with a hole: bending alone."""
    chart = ks.geometry.Sphere(R=1.0)
    mesh = chart.mesh(8, 8, 2, ("x", "y", "hole", "free"), (0.0, np.pi / 2), (np.radians(18), np.pi / 2))
    scene = ks.Scene(
        mesh=mesh,
        thickness=thickness,
        material=ks.Isotropic(E=1.0, nu=0.3),
        supports=[ks.Symmetry("x"), ks.Symmetry("y"), ks.Fixed((1.0, 0.0, 0.0), "z")],
        loads=[ks.PointForce((1.0, 0, 0), (1.0, 0, 0)), ks.PointForce((0, 1.0, 0), (0, -1.0, 0))],
    )
    return model_of(scene, model="shell", order=3, large_deflection=False).problem


@pytest.mark.parametrize("ratio", [1e-5, 1e-6])
def test_very_thin_shells_are_right_on_every_back_end(ratio, monkeypatch):
    """The energy of bending, U = U_1 / t^3; at R / t = 1000 a little of the work stretches the shell."""
    energies = []
    for thickness, kinds in ((1e-3, [SuperLU]), (ratio, [*KINDS, *[Frontal] * fronts_installed()])):
        problem = pinched_hemisphere(thickness)
        for kind in kinds:
            monkeypatch.setattr(Factoriser, "_first", lambda _, made, *__, kind=kind: made(kind))
            try:
                solution = LinearSolver(problem.energy, problem.reduction).solve(problem.load)
            except Singular:
                assert kind is Pardiso  # it says so where its pivots are rounding; then the next one is taken
                continue
            energies.append(0.5 * float(problem.load @ solution.x) * thickness**3)
    assert energies[1] == pytest.approx(energies[0], rel=0.01)
    np.testing.assert_allclose(energies[2:], energies[1], rtol=1e-6)


def test_large_shells_give_up_what_is_made_anew(monkeypatch):
    """What is left out before the factor is made does not change the solution."""
    known = pinched_hemisphere(1e-2)
    whole = LinearSolver(known.energy, known.reduction).solve(known.load)
    monkeypatch.setattr(Koiter, "kept", 0)
    forget, made = Koiter.forget, []

    def forgotten(energy):
        made.append("constitutive" in energy.__dict__)
        forget(energy)
        made.append("constitutive" in energy.__dict__)

    monkeypatch.setattr(Koiter, "forget", forgotten)
    problem = pinched_hemisphere(1e-2)
    found = LinearSolver(problem.energy, problem.reduction).solve(problem.load)
    assert made == [True, False]
    np.testing.assert_allclose(found.x, whole.x, atol=1e-8 * np.abs(whole.x).max())


@pytest.mark.parametrize("cholesky", [True, False])
def test_factors_of_positive_matrices_alone(cholesky, monkeypatch):
    """With CHOLMOD or without: None where an eigenvalue is negative, the solution where none is."""
    if not cholesky:
        monkeypatch.setattr(type(CHOLMOD), "installed", False)
    elif not CHOLMOD.installed:
        pytest.skip("CHOLMOD is not installed")
    model = Model(rectangle(3, 2, 0, 1, 0, 0.8), 1, SECTION)
    model.supports.clamp(model.edges(0, 0.0))
    factoriser = Factoriser(model.reduction(), model.koiter)
    stiffness = model.koiter.linear_stiffness()
    large = sp.identity(stiffness.shape[0], format="csr") * abs(stiffness).max()
    assert factoriser.positive((stiffness - large).tocsr()) is None
    found = factoriser.positive((stiffness + large).tocsr())
    basis = model.reduction().basis
    rhs = np.random.default_rng(3).normal(size=basis.shape[1])
    assert basis.T @ ((stiffness + large) @ (basis @ found.solve(rhs))) == pytest.approx(rhs)
