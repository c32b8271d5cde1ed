"""Smallest eigenvalues and load factors of matrices whose spectra are known."""

import numpy as np
import pytest
import scipy.sparse as sp
from scipy.linalg import eigh

from kshell.analysis.models import model_of
from kshell.errors import InputError, SolveError
from kshell.solvers import critical, eigen
from kshell.solvers.backends import CHOLMOD
from kshell.solvers.critical import CriticalPencil, factors
from kshell.solvers.eigen import in_range, smallest
from kshell.solvers.eigenbasis import canonical, clusters, orthonormal
from kshell.solvers.pencil import Pencil
from kshell.solvers.repeated import CholmodColumns
from kshell.solvers.symmetric import Half, _columns, factorise_symmetric
from tests.analysis.test_modes import square


def chain(n, free=False):
    """Unit masses between unit springs; held at walls beyond both ends, or free."""
    k = sp.diags([-np.ones(n - 1), 2 * np.ones(n), -np.ones(n - 1)], [-1, 0, 1]).tolil()
    if free:
        k[0, 0] = k[n - 1, n - 1] = 1.0
    return k.tocsr()


def held_values(n):
    return 4 * np.sin(np.arange(1, n + 1) * np.pi / (2 * (n + 1))) ** 2


def free_values(n):
    return 4 * np.sin(np.arange(1, n) * np.pi / (2 * n)) ** 2


def none_rigid(n):
    return np.zeros((n, 0))


@pytest.mark.parametrize("n", [60, 900])
def test_held_chain(n):
    found = smallest(Pencil(chain(n), sp.identity(n, format="csr"), none_rigid(n)), 6)
    assert found.values == pytest.approx(held_values(n)[:6], rel=1e-9)
    assert found.checked
    assert found.vectors.T @ found.vectors == pytest.approx(np.eye(6), abs=1e-10)


@pytest.mark.parametrize("n", [60, 900])
def test_free_chain_without_its_rigid_motion(n):
    mass = sp.identity(n, format="csr")
    rigid = orthonormal(mass, np.ones((n, 1)))
    found = smallest(Pencil(chain(n, free=True), mass, rigid), 5)
    assert found.values == pytest.approx(free_values(n)[:5], rel=1e-9)
    assert found.checked
    assert np.abs(rigid.T @ found.vectors).max() < 1e-8


@pytest.mark.parametrize("n", [61, 901])
def test_unknowns_without_mass_follow_the_others(n):
    """Every second one carries none: what is left is a chain of springs in pairs, of half the stiffness."""
    mass = np.ones(n)
    mass[::2] = 0.0
    found = smallest(Pencil(chain(n), sp.diags(mass).tocsr(), none_rigid(n)), 5)
    # between the walls lie n // 2 masses, each with two springs of 1/2; the end springs are 1/2, too
    assert found.values == pytest.approx(0.5 * held_values(n // 2)[:5], rel=1e-9)
    assert found.checked


def test_double_values_are_all_found():
    one = chain(400)
    k = sp.block_diag([one, one, one]).tocsr()
    found = smallest(Pencil(k, sp.identity(1200, format="csr"), none_rigid(1200)), 7)
    assert found.values == pytest.approx(np.repeat(held_values(400)[:3], 3)[:7], rel=1e-8)
    assert found.checked


@pytest.mark.parametrize("seed", range(20))
def test_random_spectra_with_clusters(seed):
    """Dense clusters, hidden by a random orthogonal similarity of blocks."""
    random = np.random.default_rng(seed)
    n = 320
    values = np.sort(
        random.choice(random.uniform(0.1, 10.0, 40), n) + random.choice([0.0, 20.0], n, p=[0.1, 0.9])
    )
    basis = np.linalg.qr(random.standard_normal((n, n)))[0]
    k = sp.csr_matrix(basis @ (values[:, None] * basis.T))
    k = (0.5 * (k + k.T)).tocsr()
    count = int(random.integers(1, 12))
    found = smallest(Pencil(k, sp.identity(n, format="csr"), none_rigid(n)), count)
    assert found.values == pytest.approx(values[:count], rel=1e-8)


def test_range_with_both_ends_inside_the_spectrum():
    n = 900
    known = held_values(n)
    found = in_range(
        Pencil(chain(n), sp.identity(n, format="csr"), none_rigid(n)), known[10] * 0.99, known[20] * 1.01, 50
    )
    assert found.values == pytest.approx(known[10:21], rel=1e-8)
    assert found.checked


def test_range_from_zero_leaves_rigid_motions_out():
    n = 900
    mass = sp.identity(n, format="csr")
    pencil = Pencil(chain(n, free=True), mass, orthonormal(mass, np.ones((n, 1))))
    found = in_range(pencil, 0.0, free_values(n)[3] * 1.01, 50)
    assert found.values == pytest.approx(free_values(n)[:4], rel=1e-8)


def test_too_many_in_a_range():
    n = 900
    with pytest.raises(InputError, match="modes lie in it, more than 10"):
        in_range(Pencil(chain(n), sp.identity(n, format="csr"), none_rigid(n)), 0.5, 2.0, 10)


def test_next_to_a_shift():
    n = 900
    known = held_values(n)
    found = smallest(
        Pencil(chain(n), sp.identity(n, format="csr"), none_rigid(n)), 3, shift=known[30] * 1.001
    )
    assert found.values == pytest.approx(known[29:32], rel=1e-8)


def test_more_modes_than_masses():
    mass = np.zeros(30)
    mass[:4] = 1.0
    with pytest.raises(InputError, match="there are only 4 modes"):
        smallest(Pencil(chain(30), sp.diags(mass).tocsr(), none_rigid(30)), 5)


def test_energy_through_strains_is_believed():
    """The entries carry an error that the energy formed otherwise has not."""
    n = 900
    exact = chain(n)
    wrong = (exact + 1e-8 * sp.diags(np.random.default_rng(0).uniform(-1, 1, n))).tocsr()

    def energy(x):
        return x.T @ (exact @ x)

    pencil = Pencil(wrong, sp.identity(n, format="csr"), none_rigid(n), energy, lambda x: exact @ x)
    assert smallest(pencil, 4).values == pytest.approx(held_values(n)[:4], rel=1e-10)


def test_negative_eigenvalues_are_counted():
    n = 500
    known = held_values(n)
    middle = 0.5 * (known[6] + known[7])
    assert factorise_symmetric((chain(n) - middle * sp.identity(n)).tocsr(), False).count_negative() == 7


def test_basis_of_a_cluster_does_not_depend_on_where_it_came_from():
    random = np.random.default_rng(3)
    x = np.linalg.qr(random.standard_normal((50, 3)))[0]
    turn = np.linalg.qr(random.standard_normal((3, 3)))[0]
    values, weight = np.ones(3), np.ones(50)
    assert canonical(values, x @ turn, weight) == pytest.approx(canonical(values, x, weight), abs=1e-12)


def test_clusters():
    assert clusters(np.array([1.0, 1.0 + 1e-9, 2.0, 3.0, 3.0, 3.0])) == [(0, 2), (2, 3), (3, 6)]


@pytest.mark.parametrize("n", [80, 800])
def test_factors_of_both_signs(n):
    """G is -1 on one chain, +2 on the other: the values of the first, and minus half of those of the second."""
    k = sp.block_diag([chain(n // 2), chain(n // 2)]).tocsr()
    g = sp.diags(np.repeat([-1.0, 2.0], n // 2)).tocsr()
    found = factors(CriticalPencil(k, g), 6)
    known = held_values(n // 2)
    both = np.concatenate([known, -0.5 * known])
    both = both[np.argsort(np.abs(both))][:6]
    assert found.values == pytest.approx(both, rel=1e-8)
    assert found.checked


def test_equal_sizes_have_the_positive_factor_first():
    k = sp.block_diag([chain(200), chain(200)]).tocsr()
    g = sp.diags(np.repeat([1.0, -1.0], 200)).tocsr()
    found = factors(CriticalPencil(k, g), 4)
    known = held_values(200)
    assert found.values == pytest.approx([known[0], -known[0], known[1], -known[1]], rel=1e-8)


def test_no_stress_no_buckling():
    with pytest.raises(SolveError, match="no membrane forces"):
        factors(CriticalPencil(chain(50), sp.csr_matrix((50, 50))), 2)


@pytest.mark.skipif(not CHOLMOD.installed, reason="cvxopt is not installed")
@pytest.mark.parametrize("seed", range(12))
def test_columns_count_as_eigenvalues_say(seed):
    """Shifted plates between their eigenvalues, without pardiso; solutions give their loads back."""
    random = np.random.default_rng(seed)
    held = "".join(random.choice(list("CSF"), 3)) + "C"
    model = model_of(square(held, n=3), element=("argyris", "morley")[seed % 2], analysis="modes")
    k, m = model.stiffness(), model.mass()
    values = eigh(k.toarray(), m.toarray(), eigvals_only=True)
    for number in random.choice(np.arange(1, 20), 3, replace=False):
        if values[number] - values[number - 1] < 1e-3 * values[number]:
            continue
        shifted = (k - 0.5 * (values[number] + values[number - 1]) * m).tocsr()
        order = random.permutation(len(values)) if number % 2 else None
        half = Half.of(shifted, order)
        factor = CholmodColumns(*half[:2], order is not None).factorise(half.data)
        solve = half.solving(factor.solve)
        assert half.diagonal() == pytest.approx(
            shifted.diagonal()[order if order is not None else slice(None)]
        )
        assert factor.count_negative() == number
        rhs = random.standard_normal(len(values))
        assert np.linalg.norm(shifted @ solve(rhs) - rhs) < 1e-6 * np.linalg.norm(rhs)


@pytest.mark.skipif(not CHOLMOD.installed, reason="cvxopt is not installed")
def test_pivots_that_vanish_are_not_believed():
    """[[0, 1], [1, 0]] has no factors with pivots on the diagonal: another library takes over."""
    matrix = sp.csr_matrix(np.kron(np.eye(200), [[0.0, 1.0], [1.0, 0.0]]))
    assert _columns(Half.of(matrix)) is None
    factor = factorise_symmetric(matrix, False, np.random.default_rng(0).permutation(400))
    assert factor.solve(np.ones(400)) == pytest.approx(np.ones(400))
    assert factor.count_negative() in (200, None)


@pytest.mark.parametrize("options", [{"element": "morley"}, {"model": "shell", "order": 2}])
def test_large_matrices_are_counted_without_the_first_factor(options, monkeypatch):
    """In an order of their mesh, the vectors sharpened before: the same values, and a solution on demand."""
    model = model_of(square("CCSF", n=6), analysis="modes", **options)
    pencil = Pencil(model.stiffness(), model.mass(), np.zeros((model.unknowns, 0)), order=model.elimination)
    monkeypatch.setattr(eigen, "WHOLE", 10)
    before = smallest(pencil, 4)
    monkeypatch.setattr(eigen, "LARGE", 10)
    found = smallest(pencil, 4)
    assert sorted(model.elimination()) == list(range(model.unknowns))
    assert found.values == pytest.approx(before.values, rel=1e-9)
    assert found.vectors == pytest.approx(before.vectors, abs=1e-6 * np.abs(before.vectors).max())
    assert found.checked == before.checked
    x = found.vectors[:, 0]
    assert found.solve(pencil.stiffness @ x) == pytest.approx(x, abs=1e-8 * np.abs(x).max())


def test_large_matrices_have_the_same_factors(monkeypatch):
    """In an order of their mesh."""
    model = model_of(square("CCCC", n=8), analysis="buckling", element="morley")
    press = (model.mass() * 1e-3).tocsr()
    pencil = CriticalPencil(model.stiffness(), -press, order=model.elimination)
    monkeypatch.setattr(critical, "WHOLE", 10)
    before = factors(pencil, 3)
    monkeypatch.setattr(eigen, "LARGE", 10)
    found = factors(pencil, 3)
    assert found.values == pytest.approx(before.values, rel=1e-9)
    assert found.checked == before.checked
