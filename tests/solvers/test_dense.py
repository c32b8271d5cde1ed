"""Small systems are solved densely, and never otherwise than by the sparse way."""

import numpy as np
import pytest

import kshell as ks
from kshell.elements import ElementArgyris, ElementMorley
from kshell.plate.model import PlateModel
from kshell.plate.problem import PlateProblem
from kshell.scene.structure import resolve
from kshell.solvers import solve_system
from kshell.solvers.dense import DenseFactor, solve_dense
from tests.plate.plates import UNIT, rectangle

HELD = [ks.Clamped("left"), ks.SimplySupported("right"), ks.Elastic("top", 3.0)]


def scene(mesh, supports, loads):
    return ks.Scene(mesh=mesh, thickness=1.0, material=ks.Isotropic(**UNIT), supports=supports, loads=loads)


@pytest.mark.parametrize("element", [ElementMorley(), ElementArgyris()], ids=["morley", "argyris"])
def test_dense_and_sparse_assembly_and_solution_agree(element):
    made = scene(rectangle(3), HELD, [ks.Pressure("1 + x")])
    problem = PlateProblem(resolve(made, made.mesh), element)
    assert problem.small
    dense, sparse = problem.system, problem.assembled
    size = np.abs(dense.matrix).max()
    assert np.abs(dense.matrix - sparse.matrix.toarray()).max() < 1e-14 * size
    assert dense.load == pytest.approx(sparse.load, abs=1e-15)
    found = solve_dense(dense.matrix, dense.load)
    expected = solve_system(sparse.matrix, sparse.load, method="superlu")
    assert found is not None
    assert found.x == pytest.approx(expected.x, rel=1e-9, abs=1e-12 * np.abs(expected.x).max())
    assert found.energy_error < 1e-12


@pytest.mark.parametrize(
    "matrix",
    [np.diag([1.0, 0.0]), np.diag([1.0, -1.0]), np.array([[1.0, 1.0], [1.0, 1.0]]), np.diag([1.0, np.nan])],
    ids=["no stiffness", "negative", "singular", "not finite"],
)
def test_what_is_not_positive_definite_is_left_to_the_sparse_way(matrix):
    assert solve_dense(matrix, np.ones(2)) is None


def test_a_load_that_is_not_finite_is_an_input_error():
    with pytest.raises(ks.InputError, match="not finite"):
        solve_dense(np.eye(2), np.array([1.0, np.inf]))


def test_small_plates_take_it_and_larger_ones_do_not():
    loads = [ks.Pressure(1.0)]
    small = ks.solve(scene(rectangle(2), HELD, loads), element="argyris", solver="direct")
    large = ks.solve(scene(rectangle(10), HELD, loads), element="argyris", solver="direct")
    multigrid = ks.solve(scene(rectangle(2), HELD, loads), element="argyris", solver="multigrid")
    assert "LAPACK" in small.solver["name"]
    assert "LAPACK" not in large.solver["name"]
    assert "multigrid" in multigrid.solver["name"]
    assert multigrid.strain_energy == pytest.approx(small.strain_energy, rel=1e-8)


@pytest.mark.parametrize("cells", [3, 8])
def test_answers_to_further_loads_come_from_the_factor_of_the_first(cells):
    """Of one load and of several, on few unknowns and on many."""
    made = scene(rectangle(cells), HELD, [ks.Pressure("1 + x")])
    model = PlateModel(resolve(made, made.mesh), "argyris")
    assert model.problem.small == (cells == 3)
    loads = np.random.default_rng(1).normal(size=(model.unknowns, 3))
    alone = PlateModel(resolve(made, made.mesh), "argyris")
    expected = np.linalg.solve(alone.problem.assembled.matrix.toarray(), loads)
    model.solve()
    found = model.respond(loads)
    assert found == pytest.approx(expected, rel=0, abs=1e-8 * np.abs(expected).max())
    assert model.respond(loads[:, 1]) == pytest.approx(found[:, 1], rel=0, abs=1e-14 * np.abs(found).max())
    assert alone.respond(loads) == pytest.approx(expected, rel=0, abs=1e-8 * np.abs(expected).max())


def test_a_factor_tells_whether_it_is_one():
    assert DenseFactor(np.diag([2.0, 1.0])).good
    assert not DenseFactor(np.diag([2.0, -1.0])).good
    assert not DenseFactor(np.diag([2.0, np.inf])).good
