"""Direct back ends: the same answer from each, refinement to rounding, and bad input named."""

import numpy as np
import pytest
import scipy.sparse as sp

from kshell.errors import InputError, SolveError
from kshell.solvers import FreeMotion, prepare, solve_system
from kshell.solvers.backends import installed_backends
from kshell.solvers.checks import describe_motion

BACKENDS = [backend.key for backend in installed_backends()]


def beam(n: int, clamped: bool = True) -> sp.csr_matrix:
    """Bending stiffness of a chain of n points, squared second differences, clamped at one end or free."""
    second = sp.diags([1.0, -2.0, 1.0], [0, 1, 2], shape=(n, n + 2)).tocsr()
    a = (second.T @ second).tocsr()
    return a[2:, 2:] if clamped else a


@pytest.mark.parametrize("method", BACKENDS)
def test_cantilever_beam(method):
    """A tip load on second differences, whose deflection is a sum of moments times lever arms."""
    n = 60
    load = np.zeros(n)
    load[-1] = 1.0
    solution = solve_system(beam(n), load, method=method)
    # the moment n - j + 1 at point j turns all that lies beyond it
    w = [sum((k - j + 1.0) * (n - j + 1.0) for j in range(1, k + 1)) for k in range(1, n + 1)]
    assert np.allclose(solution.x, w, rtol=1e-9)
    assert solution.energy_error < 1e-9


@pytest.mark.parametrize("method", BACKENDS)
def test_several_loads_share_one_setup(method):
    rng = np.random.default_rng(0)
    a = beam(40)
    loads = rng.standard_normal((40, 3))
    prepared = prepare(a, method=method)
    together = prepared.solve(loads)
    again = prepared.solve(loads[:, 1])
    assert together.x.shape == (40, 3)
    assert np.allclose(together.x[:, 1], again.x, rtol=1e-8)
    assert together.seconds["setup"] > 0
    assert again.seconds["setup"] == 0


def test_refinement_gains_digits():
    """An answer with a solver that is only good to 1e-3 is refined far beyond it."""
    from kshell.solvers.refine import refine

    a = beam(30)
    exact = np.linspace(1, 2, 30)
    b = (a @ exact)[:, None]
    rough = np.linalg.inv(a.toarray()) * (1 + 1e-3)
    x, history, steps, left = refine(lambda v: a @ v, b, lambda r: rough @ r)
    assert steps == 3
    assert history[0] == pytest.approx(1e-3, rel=0.01)
    assert history[-1] < 1e-11
    assert np.allclose(left, b - (a @ x), atol=1e-12 * np.abs(b).max())
    assert np.allclose(x[:, 0], exact, rtol=1e-8)


@pytest.mark.parametrize("method", BACKENDS)
def test_free_beam_is_singular(method):
    a = beam(50, clamped=False)
    with pytest.raises(SolveError, match="singular") as caught:
        solve_system(a, np.ones(a.shape[0]), method=method)
    assert isinstance(caught.value.state, FreeMotion)
    moved = caught.value.state.vector
    assert np.linalg.norm(a @ moved) < 1e-8 * np.linalg.norm(moved)


@pytest.mark.parametrize("method", BACKENDS)
def test_loose_part_is_named(method):
    a = sp.block_diag([beam(50), beam(20, clamped=False)]).tocsr()
    with pytest.raises(SolveError, match="1 of 2 unconnected parts"):
        solve_system(a, np.ones(a.shape[0]), method=method)


def test_bad_input():
    a = beam(10)
    load = np.ones(10)
    load[3] = np.nan
    with pytest.raises(InputError, match=r"NaN.*first at 3"):
        solve_system(a, load)
    with pytest.raises(InputError, match="10 unknowns"):
        solve_system(a, np.ones(9))
    with pytest.raises(InputError, match="unknown solver"):
        solve_system(a, np.ones(10), method="magic")
    with pytest.raises(InputError, match="must be positive"):
        solve_system(a, np.ones(10), method="superlu", tolerance=-1.0)
    with pytest.raises(InputError, match="square"):
        prepare(sp.csr_matrix((3, 4)))
    broken = a.copy()
    broken.data[0] = np.inf
    with pytest.raises(InputError, match="not finite"):
        prepare(broken)
    with pytest.raises(SolveError, match="not positive definite"):
        prepare(-a)


@pytest.mark.parametrize("method", BACKENDS)
def test_indefinite_matrix_is_refused(method):
    a = beam(10) + sp.diags(np.linspace(-0.4, 0.0, 10))
    assert np.linalg.eigvalsh(a.toarray())[0] < 0
    with pytest.raises(SolveError, match="not positive definite"):
        prepare(a, method=method)


def test_motion_in_words_without_space():
    a = sp.block_diag([beam(5), beam(4, clamped=False)]).tocsr()
    vector = np.r_[np.zeros(5), np.ones(6)]
    assert (
        describe_motion(a, vector)
        == "1 of 2 unconnected parts (6 of 11 unknowns) can move without any stiffness"
    )


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
@pytest.mark.parametrize("method", BACKENDS)
def test_loads_beyond_numbers_are_named(method):
    with pytest.raises(SolveError, match="energies that numbers cannot hold"):
        solve_system(beam(60), np.full(60, 1e300), method=method)


def test_zero_load_gives_zero():
    solution = solve_system(beam(10), np.zeros(10))
    assert not solution.x.any()
    assert solution.energy_error == 0.0
