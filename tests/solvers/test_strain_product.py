"""Products through strains: the same matrix, with digits that its entries have lost."""

import numpy as np
import pytest

import kshell as ks
from kshell.plate.product import strain_product
from kshell.solvers import prepare

from .plates import disk_with_hole, l_shape, mesh_of, plate, square, stretched


@pytest.mark.parametrize("element", ["morley", "argyris"])
@pytest.mark.parametrize(
    ("shape", "supports"), [(l_shape, "mixed"), (disk_with_hole, "simply supported"), (square, "springs")]
)
def test_is_the_matrix(shape, supports, element):
    if supports == "springs":
        supports = [ks.Elastic("boundary", 1e6), ks.Clamped("left")]
    near = 0.2 if shape is disk_with_hole else 1e-6
    problem = plate(mesh_of(*shape(8), near=near), element, supports, "0.01 * (1 + x**2)")
    x = np.random.default_rng(0).standard_normal(len(problem.assembled.load))
    expected = problem.assembled.matrix @ x
    assert np.allclose(strain_product(problem)(x), expected, rtol=0, atol=1e-12 * np.abs(expected).max())


def test_a_turning_plane_bends_nothing():
    """The force of a rigid motion is rounding of the matrix, and much less of it through strains."""
    problem = plate(mesh_of(*square(20)), "argyris", [ks.Elastic("boundary", 1e6)])
    problem.forms = problem.forms[:1]
    product, a = strain_product(problem), problem.assembled.matrix
    vertex = np.zeros((len(problem.space.points), 6))
    vertex[:, 0] = 1.0 + problem.space.points @ [3.0, -2.0]
    vertex[:, 1:3] = [3.0, -2.0]
    motion = np.concatenate([vertex.ravel(), problem.space.edge_normals @ [3.0, -2.0]])
    q = problem.space.reduction.T @ (
        motion / np.asarray(problem.space.reduction.power(2).sum(axis=1)).ravel()
    )
    assert np.allclose(problem.space.reduction @ q, motion)
    assert np.abs(product(q)).max() < 0.3 * np.abs(a @ q).max()


@pytest.mark.parametrize("method", ["superlu", "multigrid"])
def test_refinement_regains_digits(method):
    """Navier's plate, centre deflection 0.00406235266 q a^4 / D, on a mesh where rounding shows."""
    problem = plate(mesh_of(*stretched(48, 1)), "argyris", "simply supported")
    prepared = prepare(problem.assembled.matrix, problem.space, method)
    b = problem.assembled.load
    plain = prepared.solve(b, None)
    mended = prepared.solve(b, None, product=strain_product(problem))
    centre = np.argmin(np.abs(problem.mesh.points[:, :2] - 0.5).sum(axis=1))
    stiffness = 210e9 * 0.01**3 / 12 / (1 - 0.3**2)
    w = problem.reduction.expand(mended.x)[6 * centre] * stiffness / 1e3
    assert w == pytest.approx(0.004062352661, rel=1e-8)
    assert np.linalg.norm(mended.x - plain.x) < 1e-6 * np.linalg.norm(plain.x)
    assert mended.energy_error < 1e-9
    if method == "superlu":
        assert mended.energy_error < 0.2 * plain.energy_error
