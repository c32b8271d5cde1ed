"""The compiled loops make what those of numpy make, number by number."""

import runpy
import sys
from pathlib import Path

import numpy as np
import pytest
import scipy.sparse as sp
import setuptools

import kshell as ks
from kshell.analysis.models import model_of
from kshell.elements import kernels as element_kernels
from kshell.equilibrium.free_pattern import FreePattern
from kshell.equilibrium.sparsity import Sparsity, group_pairs
from kshell.mesh import kernels as mesh_kernels
from kshell.solvers import kernels
from kshell.solvers.dissection import dissected
from kshell.solvers.multigrid.coarsen import independent
from kshell.solvers.multigrid.galerkin import galerkin
from kshell.solvers.multigrid.hct import interpolation_weights
from kshell.solvers.multigrid.levels import RelaxedLevel, SweptLevel, level_of

ROOT = Path(__file__).parents[2]
VERSIONS = {
    "kshell.elements.compiled": element_kernels.VERSION,
    "kshell.mesh.compiled": mesh_kernels.VERSION,
    "kshell.solvers.compiled": kernels.VERSION,
    "kshell.solvers.fronts": kernels.FRONTS,
    "kshell.solvers.panels": kernels.FRONTS,
    "kshell.solvers.multigrid.compiled": kernels.VERSION,
}
built = pytest.mark.skipif(kernels.compiled is None, reason="kshell was installed without a C compiler")


def elements(random, count, groups=30, each=5):
    """(element, each) groups, in no order; some groups have no element."""
    return np.array([random.permutation(groups)[:each] for _ in range(count)], dtype=np.int32)


def both_ways(monkeypatch, work):
    """What some work returns by compiled loops, and by those of numpy."""
    fast = work()
    monkeypatch.setattr(kernels, "compiled", None)
    monkeypatch.setattr(kernels, "cycles", None)
    return fast, work()


def assert_same(one, other):
    for a, b in zip(one, other, strict=True):
        np.testing.assert_array_equal(a, b)
        assert a.dtype == b.dtype


@built
@pytest.mark.parametrize("count", [1, 40])
def test_pairs_of_groups(monkeypatch, count):
    groups = elements(np.random.default_rng(count), count)
    assert_same(*both_ways(monkeypatch, lambda: group_pairs(groups, 32)))


@built
@pytest.mark.parametrize("coupled", [False, True])
def test_patterns_and_sums(monkeypatch, coupled):
    random = np.random.default_rng(7)
    groups = elements(random, 60)
    sizes = np.where(np.arange(30) % 2, 3, 2)
    start = np.cumsum(sizes) - sizes
    each = np.array([0, 0, 1, 1, 2, 2, 3, 3, 4, 4])  # two unknowns of each group
    unknowns = (start[groups[:, each]] + np.tile([0, 1], 5)).astype(np.int32)
    basis = sp.eye_array(int(sizes.sum()), format="csc")
    keep = np.setdiff1d(np.arange(basis.shape[1]), start[[3, 8]])  # two of them are held
    if coupled:
        turn = basis.tolil()
        turn[start[5], start[5] + 1] = 0.5  # within a group
        basis = sp.csc_array(turn)
    basis = sp.csc_matrix(basis[:, keep])
    sparsity = Sparsity(groups, sizes, unknowns, each)
    matrices = random.standard_normal((60, 10, 10))
    matrices += matrices.swapaxes(1, 2)
    place = random.permutation(30)

    def work():
        pattern = FreePattern(sparsity, basis, place)
        data = np.zeros(pattern.entries + 1)
        pattern.add(data, slice(0, 25), matrices[:25])
        pattern.add(data, slice(25, 60), matrices[25:])
        return pattern.indptr, pattern.indices, pattern.number, data[:-1]

    fast, slow = both_ways(monkeypatch, work)
    assert_same(fast[:3], slow[:3])
    np.testing.assert_allclose(fast[3], slow[3], rtol=1e-14, atol=1e-14 * np.abs(slow[3]).max())


@built
@pytest.mark.parametrize("count", [1, 9, 700])
def test_orders_of_elimination(monkeypatch, count):
    random = np.random.default_rng(count)
    centres = random.uniform(size=(count, 3)) * [3.0, 1.0, 0.1]
    near = np.argsort(np.linalg.norm(centres[:, None] - centres, axis=2), axis=1)[:, :4]
    members = np.concatenate([near, near[:, :1]], axis=1) if near.shape[1] < 4 else near
    fast, slow = both_ways(monkeypatch, lambda: dissected(centres, members, count + 3))
    np.testing.assert_array_equal(fast, slow)
    np.testing.assert_array_equal(np.sort(fast), np.arange(count + 3))


def stepped_plate():
    """Two thicknesses, so that vertices between them have two fans; held at one side."""
    mesh = ks.geometry.Plane().mesh(4, 4, 1, ("left", "right", "bottom", "top"), (0.0, 1.0), (0.0, 1.0))
    middles = mesh.points[mesh.triangles].mean(axis=1)
    halves = {name: mesh.triangles[(middles[:, 0] < 0.5) == low] for name, low in (("a", True), ("b", False))}
    mesh = ks.Mesh.from_arrays(
        mesh.points, mesh.triangles, halves | {"left": mesh.edges[mesh.groups["left"].members]}
    )
    steel = ks.Isotropic(E=1.0, nu=0.3)
    thickness = {"a": 0.1, "b": 0.2}
    return ks.Scene(mesh=mesh, thickness=thickness, material=steel, supports=[ks.Clamped("left")])


@built
@pytest.mark.parametrize("element", ["morley", "argyris"])
def test_matrices_of_plates(monkeypatch, element):
    fast, slow = both_ways(
        monkeypatch, lambda: model_of(stepped_plate(), element=element, model="plate").stiffness()
    )
    assert_same((fast.indptr, fast.indices), (slow.indptr, slow.indices))
    np.testing.assert_allclose(fast.data, slow.data, rtol=1e-14, atol=1e-14 * np.abs(slow.data).max())


def level(random, height, rows=40, coarse=9):
    """A sparse symmetric positive definite matrix in blocks, and an interpolation from a coarser level."""
    near = sp.random_array((rows, rows), density=0.1, rng=random) + sp.eye_array(rows)
    matrix = sp.kron(near @ near.T, np.ones((height, height)), format="csr")
    matrix.data = random.uniform(-0.1, 0.1, matrix.nnz)
    matrix = sp.csr_matrix(matrix + matrix.T)
    matrix += sp.diags(0.1 + np.asarray(abs(matrix).sum(axis=1)).ravel())
    above = sp.random_array((rows, coarse), density=0.3, rng=random, format="lil")
    above[rows - 1] = 0.0  # a row without any, and a column: a vertex that no unknown feels
    above[:, coarse - 1] = 0.0
    above = above.tocsr()
    blocks = random.standard_normal((above.nnz, height, 3))
    blocks[:, :, 2] *= above.indices[:, None] != 2  # one freedom is held
    prolongation = sp.bsr_matrix(
        (blocks, above.indices.astype(np.int32), above.indptr.astype(np.int32)),
        shape=(height * rows, 3 * coarse),
    )
    matrix = matrix.tobsr((height, height))
    matrix.sort_indices()
    return matrix, prolongation


@built
@pytest.mark.parametrize("height", [1, 3])
def test_coarse_matrices(monkeypatch, height):
    """Also where a row of the product has so many blocks that its places must grow."""
    for coarse in (9, 150):
        parts = level(np.random.default_rng(height), height, coarse=coarse)
        fast, slow = both_ways(monkeypatch, lambda p=parts: galerkin(*p).toarray())
        monkeypatch.undo()
        np.testing.assert_allclose(fast, slow, rtol=1e-14, atol=1e-14 * np.abs(slow).max())
        assert np.count_nonzero(fast) == np.count_nonzero(slow)
        assert fast[8, 8] == fast[-1, -1] == 1.0


@built
@pytest.mark.parametrize("height", [1, 3])
@pytest.mark.parametrize("count", [1, 2])
def test_sweeps_and_what_they_leave(monkeypatch, height, count):
    random = np.random.default_rng(height)
    matrix, prolongation = level(random, height)
    rhs, below = random.standard_normal(matrix.shape[0]), random.standard_normal(prolongation.shape[1])

    def work():
        here = level_of(matrix, prolongation, count)
        x, left = here.before(rhs)
        out = [type(here), x.copy(), left.copy(), here.restrict(left), here.interpolate(below)]
        return [*out, *here.after(rhs, x, left, out[-1], True), here.residual(rhs, rhs)]

    fast, slow = both_ways(monkeypatch, work)
    assert (fast[0], slow[0]) == (SweptLevel, RelaxedLevel)
    for one, other in zip(fast[1:], slow[1:], strict=True):
        np.testing.assert_allclose(one, other, rtol=0, atol=1e-13 * np.abs(other).max() + 1e-14)


@built
def test_interpolation_by_clough_and_tocher(monkeypatch):
    random = np.random.default_rng(3)
    corners = random.standard_normal((200, 3, 2))
    inside = np.einsum("nc,ncx->nx", random.dirichlet([1, 1, 1], 200), corners)
    assert_same(*both_ways(monkeypatch, lambda: [interpolation_weights(inside, corners)]))


@built
def test_independent_sets(monkeypatch):
    random = np.random.default_rng(4)
    edges = np.unique(np.sort(random.integers(0, 200, (500, 2)), axis=1), axis=0)
    edges = edges[edges[:, 0] < edges[:, 1]].astype(np.int32)
    turn = random.permutation(200).astype(np.uint64)
    allowed = random.uniform(size=200) < 0.8
    fast, slow = both_ways(monkeypatch, lambda: [independent(turn, edges, allowed)])
    assert_same(fast, slow)
    assert fast[0].any()
    assert not fast[0][edges].all(axis=1).any()


def test_they_can_be_left_out(monkeypatch):
    monkeypatch.setenv(mesh_kernels.VARIABLE, "0")
    assert {mesh_kernels.loaded(name, version) for name, version in VERSIONS.items()} == {None}
    monkeypatch.setattr(kernels, "compiled", None)
    assert kernels.which() == "numpy"


@built
def test_what_an_older_installation_left_is_not_used(monkeypatch):
    monkeypatch.delenv(mesh_kernels.VARIABLE, raising=False)
    there = [name for name, version in VERSIONS.items() if mesh_kernels.loaded(name, version) is not None]
    assert there
    assert {mesh_kernels.loaded(name, VERSIONS[name] + 1) for name in there} == {None}


def test_an_installation_does_without_a_compiler(monkeypatch):
    given = {}
    monkeypatch.chdir(ROOT)
    monkeypatch.setattr(setuptools, "setup", given.update)
    monkeypatch.setattr(sys, "argv", ["setup.py"])
    runpy.run_path("setup.py")
    assert {extension.name for extension in given["ext_modules"]} == set(VERSIONS)
    for extension in given["ext_modules"]:
        assert extension.optional
        assert all((ROOT / source).is_file() for source in extension.sources)
