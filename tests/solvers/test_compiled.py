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
from kshell.equilibrium.free_pattern import FreePattern
from kshell.equilibrium.sparsity import Sparsity, group_pairs
from kshell.solvers import kernels
from kshell.solvers.dissection import dissected

ROOT = Path(__file__).parents[2]
built = pytest.mark.skipif(kernels.compiled is None, reason="kshell was installed without a C compiler")


def elements(random, count, groups=30, each=5):
    """(element, each) groups, in no order; some groups have no element."""
    return np.array([random.permutation(groups)[:each] for _ in range(count)], dtype=np.int32)


def both_ways(monkeypatch, work):
    """What some work returns by compiled loops, and by those of numpy."""
    fast = work()
    monkeypatch.setattr(kernels, "compiled", None)
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


def test_they_can_be_left_out(monkeypatch):
    monkeypatch.setenv(kernels.VARIABLE, "0")
    assert kernels._loaded() is None
    monkeypatch.setattr(kernels, "compiled", None)
    assert kernels.which() == "numpy"


@built
def test_what_an_older_installation_left_is_not_used(monkeypatch):
    monkeypatch.delenv(kernels.VARIABLE, raising=False)
    assert kernels._loaded() is not None
    monkeypatch.setattr(kernels, "VERSION", 0)
    assert kernels._loaded() is None


def test_an_installation_does_without_a_compiler(monkeypatch):
    given = {}
    monkeypatch.chdir(ROOT)
    monkeypatch.setattr(setuptools, "setup", given.update)
    monkeypatch.setattr(sys, "argv", ["setup.py"])
    runpy.run_path("setup.py")
    (extension,) = given["ext_modules"]
    assert extension.optional
    assert all((ROOT / source).is_file() for source in extension.sources)
