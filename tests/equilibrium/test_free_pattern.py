"""The lower triangle of T^T K T from element matrices, against the product of the whole matrices."""

import numpy as np
import pytest
import scipy.sparse as sp

from kshell.equilibrium.free_pattern import FreePattern
from kshell.equilibrium.sparsity import Sparsity

SIZES = np.array([3, 2, 3, 3, 1, 2, 3])


def elements(random: np.random.Generator) -> tuple[Sparsity, np.ndarray]:
    """Elements of two groups of three unknowns and one of two or one: not as they are numbered."""
    groups = np.array([[0, 2, 1], [3, 2, 5], [6, 3, 1], [6, 0, 5]], dtype=np.int32)
    start = np.concatenate([[0], np.cumsum(SIZES)])
    member = np.array([0, 1, 0, 1, 0, 1, 2, 2])
    slot = np.array([0, 0, 1, 1, 2, 2, 0, 1])
    unknowns = (start[groups[:, member]] + slot).astype(np.int32)
    matrices = random.standard_normal((len(groups), 8, 8))
    return Sparsity(groups, SIZES, unknowns, member), matrices + matrices.swapaxes(1, 2)


def bases(random: np.random.Generator) -> dict[str, sp.csc_matrix]:
    n = int(SIZES.sum())
    some = np.flatnonzero(~np.isin(np.arange(n), [0, 4, 8, 9, 10, 15]))
    picks = sp.csc_matrix((np.ones(len(some)), (some, np.arange(len(some)))), shape=(n, len(some)))
    combined = picks.tolil()
    tilted, _ = np.linalg.qr(random.standard_normal((3, 3)))
    first = [int(np.flatnonzero(some == u)[0]) for u in (5, 6, 7)]
    combined[5:8, first] = tilted
    combined = sp.csc_matrix(combined)[:, np.delete(np.arange(len(some)), first[2])]
    return {
        "all": sp.identity(n, format="csc"),
        "some": picks,
        "combinations": combined,
        "shuffled": sp.csc_matrix(combined[:, random.permutation(combined.shape[1])]),
        "a sign": sp.csc_matrix(picks @ sp.diags(np.where(np.arange(len(some)) == 3, -1.0, 1.0))),
    }


@pytest.mark.parametrize("which", ["all", "some", "combinations", "shuffled", "a sign"])
@pytest.mark.parametrize("moved", [False, True])
def test_entries_are_those_of_the_product(which, moved):
    random = np.random.default_rng(3)
    sparsity, matrices = elements(random)
    basis = bases(random)[which]
    place = random.permutation(len(SIZES)) if moved else None
    assert FreePattern.possible(sparsity, basis)
    pattern = FreePattern(sparsity, basis, place)
    data = np.zeros(pattern.entries + 1)
    for some in (slice(0, 3), slice(3, 4)):
        pattern.add(data, some, matrices[some])
    lower = sp.csc_matrix((data[:-1], pattern.indices, pattern.indptr), shape=(pattern.size,) * 2).toarray()
    assert sorted(pattern.number) == list(range(basis.shape[1]))
    whole = np.zeros(sparsity.shape)
    for unknowns, matrix in zip(sparsity.unknowns, matrices, strict=True):
        whole[np.ix_(unknowns, unknowns)] += matrix
    wanted = np.zeros_like(lower)
    wanted[np.ix_(pattern.number, pattern.number)] = basis.T @ whole @ basis
    np.testing.assert_allclose(lower, np.tril(wanted), atol=1e-14 * np.abs(wanted).max())
    for column in range(pattern.size):
        rows = pattern.indices[pattern.indptr[column] : pattern.indptr[column + 1]]
        assert rows[0] == column
        assert (np.diff(rows) > 0).all()


def test_columns_over_two_groups_are_told():
    random = np.random.default_rng(3)
    sparsity, _ = elements(random)
    coupled = sp.lil_matrix(sp.identity(sparsity.shape[0]))
    coupled[0, 10] = 1.0
    assert not FreePattern.possible(sparsity, sp.csc_matrix(coupled))
    assert not FreePattern.possible(sparsity, sp.csc_matrix((sparsity.shape[0], 2)))
