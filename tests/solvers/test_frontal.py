"""Cholesky factors by fronts, against full matrices and against what else factorises shells."""

import numpy as np
import pytest
import scipy.sparse as sp

import kshell as ks
from kshell.analysis.models import model_of
from kshell.equilibrium import factor as factorising
from kshell.equilibrium import free_matrices
from kshell.equilibrium.energy import StrainEnergy
from kshell.errors import InputError
from kshell.solvers import frontal, kernels
from kshell.solvers.backends import CHOLMOD, Singular
from kshell.solvers.frontal import Frontal, fronts_of
from tests.shell.test_mechanisms import three_sheets

pytestmark = pytest.mark.skipif(not frontal.installed(), reason="kshell was installed without a C compiler")


def lower_of(matrix):
    """Compressed columns of the lower triangle of a full matrix: indptr, indices, entries."""
    low = sp.csc_matrix(np.tril(matrix))
    low.sort_indices()
    return low.indptr, low.indices, low.data


def positive(random, groups, sizes, chance):
    """A positive definite matrix (n, n) of groups of unknowns that couple by chance."""
    of = np.repeat(np.arange(groups), random.integers(1, sizes + 1, groups))
    near = np.triu(random.random((groups, groups)) < chance, 1)
    near = near | near.T | np.eye(groups, dtype=bool)
    full = random.standard_normal((len(of), len(of))) * near[np.ix_(of, of)]
    full = full + full.T
    return full + np.diag(1.0 + np.abs(full).sum(axis=1))


def banded(random, n, width):
    full = random.standard_normal((n, n))
    full = np.tril(np.triu(full + full.T, -width), width)
    return full + np.diag(1.0 + np.abs(full).sum(axis=1))


def star(n):
    """All unknowns couple with the last one alone: as many children of one front."""
    full = 3.0 * np.eye(n)
    full[-1, :-1] = full[:-1, -1] = 1.0
    full[-1, -1] = n
    return full


CASES = {
    "one": lambda random: np.array([[4.0]]),
    "diagonal": lambda random: np.diag(1.0 + random.random(7)),
    "full": lambda random: positive(random, 1, 1, 1.0) + np.ones((40, 40)) + 40 * np.eye(40),
    "band": lambda random: banded(random, 90, 4),
    "star": lambda random: star(50),
    "parts": lambda random: np.kron(np.eye(5), banded(random, 17, 2)),
    **{
        f"{groups} groups, {chance}": lambda random, g=groups, c=chance: positive(random, g, 5, c)
        for groups in (3, 12, 50)
        for chance in (0.02, 0.1, 0.4)
    },
}


@pytest.mark.parametrize("merging", ["much", "usual", "none"])
@pytest.mark.parametrize("case", CASES)
def test_solutions_are_those_of_the_full_matrix(monkeypatch, case, merging):
    """However many zeros fronts may have, in any order of elimination, of one load and of several."""
    if merging != "usual":
        monkeypatch.setattr(frontal, "ZEROS", np.full(4, 1.0 if merging == "much" else 0.0))
    random = np.random.default_rng(len(case))
    for _ in range(4):
        full = CASES[case](random)
        n = len(full)
        order = random.permutation(n)
        indptr, indices, entries = lower_of(full[np.ix_(order, order)])
        solver = Frontal(indptr, indices)
        for scale in (1.0, 0.25):  # one pattern, two matrices
            factor = solver.factorise(scale * entries)
            assert factor.definite
            assert factor.negative == 0
            for rhs in (random.standard_normal(n), random.standard_normal((n, 3))):
                x = factor.solve(rhs)
                assert x.shape == rhs.shape
                back = scale * full[np.ix_(order, order)] @ x
                np.testing.assert_allclose(back, rhs, atol=1e-12 * np.abs(full).max() * np.abs(x).max())


@pytest.mark.parametrize("case", CASES)
def test_fronts_without_zeros_are_the_pattern_of_the_factor(monkeypatch, case):
    """Their columns, one by one, are those of the full Cholesky factor, in which nothing cancels by chance."""
    monkeypatch.setattr(frontal, "ZEROS", np.zeros(4))
    full = CASES[case](np.random.default_rng(3))
    of = fronts_of(*lower_of(full)[:2])
    assert sorted(of.unknown) == list(range(len(full)))
    assert (of.unknown[of.place] == np.arange(len(full))).all()
    moved = full[np.ix_(of.unknown, of.unknown)]
    expected = np.abs(np.linalg.cholesky(moved)) > 1e-14
    found = np.zeros_like(expected)
    for s in range(len(of.rest)):
        left = of.left[of.begin[s] : of.begin[s + 1]]
        rows = [range(of.first[s], of.first[s + 1]), *(range(of.start[b], of.start[b + 1]) for b in left)]
        rows = np.concatenate([np.array(r) for r in rows])
        assert (np.diff(rows) > 0).all()
        assert of.rest[s] == len(rows) - (of.first[s + 1] - of.first[s])
        for column in range(of.first[s], of.first[s + 1]):
            found[rows[rows >= column], column] = True
    np.testing.assert_array_equal(found, expected)
    p = np.diff(of.first)
    assert of.entries == int(np.sum(p * (p + of.rest)))


@pytest.mark.parametrize("bad", [-1.0, 0.0, np.nan, np.inf])
def test_pivots_that_are_not_positive_numbers_are_refused(bad):
    full = banded(np.random.default_rng(5), 60, 3)
    indptr, indices, entries = lower_of(full)
    solver = Frontal(indptr, indices)
    for at in (0, 31, 59):
        wrong = entries.copy()
        wrong[indptr[at]] = bad if bad in (-1.0, np.inf) or np.isnan(bad) else 0.0
        with pytest.raises(Singular, match="pivot"):
            solver.factorise(wrong)
    x = solver.factorise(entries).solve(np.ones(60))  # the next matrix is not spoilt by it
    np.testing.assert_allclose(full @ x, np.ones(60), atol=1e-13)


def roof(order=2, supports=None):
    mesh = ks.geometry.Cylinder(1.0).mesh(12, 12, 2, ("a", "b", "c", "d"), (0.8, 1.6), (0.0, 1.0))
    return ks.Scene(
        mesh=mesh,
        thickness=0.01,
        material=ks.Isotropic(E=1e6, nu=0.3),
        supports=[ks.Symmetry(["b", "c"]), ks.Fixed("d", "xy")] if supports is None else supports,
        loads=[ks.Traction((0, -1, 0))],
        solve={"order": order, "large_deflection": False, "error": "off"},
    )


def ways(monkeypatch, work):
    """What a shell gives by fronts, and by each library that there is instead."""
    monkeypatch.setattr(factorising, "FRONTS_FROM", 0)
    monkeypatch.setattr(free_matrices, "DENSE_UP_TO", 0)
    used = []
    made = Frontal.factorise
    monkeypatch.setattr(Frontal, "factorise", lambda self, e: used.append(len(e)) or made(self, e))
    yield work()
    assert used
    monkeypatch.setattr(kernels, "fronts", lambda: None)
    used.clear()
    yield work()
    monkeypatch.setattr(type(CHOLMOD), "installed", False)
    yield work()
    assert not used


@pytest.mark.parametrize("springs", [False, True])
@pytest.mark.parametrize("order", [1, 2, 3])
def test_shells_are_the_same_whoever_factorises(monkeypatch, order, springs):
    held = [ks.Clamped("d"), ks.Elastic("b", 1e3, "z")] if springs else None
    found = [
        (result.strain_energy, result.fields["displacement"])
        for result in ways(monkeypatch, lambda: ks.solve(roof(order, held)))
    ]
    for energy, u in found[1:]:
        assert abs(energy - found[0][0]) < 1e-10 * abs(energy)  # rslab differs by 1.2e-11
        np.testing.assert_allclose(u, found[0][1], atol=1e-10 * np.abs(u).max())


def test_a_mechanism_is_refused_whoever_factorises(monkeypatch):
    scene = ks.Scene(
        mesh=three_sheets(),
        thickness=0.003,
        material=ks.Isotropic(E=210e9, nu=0.3),
        supports=[ks.Clamped("held"), ks.Hinge("fold")],
        loads=[ks.Pressure(10.0)],
        solve={"order": 2, "large_deflection": False},
    )

    def refused():
        with pytest.raises(InputError, match="can move freely"):
            ks.solve(scene)
        return True

    assert all(ways(monkeypatch, refused))


def test_strains_of_many_unknowns_are_made_once(monkeypatch):
    """Fronts leave them their room; what keeps a copy of the matrix beside the factor makes them again."""
    monkeypatch.setattr(StrainEnergy, "kept", 100)
    made = []
    koiter = type(model_of(roof()).problem.energy)
    gradient = koiter._gradient
    monkeypatch.setattr(koiter, "_gradient", lambda self, *a: made.append(1) or gradient(self, *a))

    def work():
        made.clear()
        model = model_of(roof())
        model.solve("direct")
        return len(made) / len(model.problem.energy.blocks)

    assert list(ways(monkeypatch, work))[:2] == [1.0, 2.0]
