"""The rule that picks a solver, and memory that is foreseen."""

import re
import subprocess
import sys

import numpy as np
import psutil
import pytest
import scipy.sparse as sp

from kshell.errors import InputError, SolveError
from kshell.solvers import auto, backends
from kshell.solvers.auto import MULTIGRID_FROM, choose
from kshell.solvers.backends import BACKENDS, PARDISO, installed_backends
from kshell.solvers.memory import _control_group, factorisation_bytes, fits

from .plates import mesh_of, plate, square, stretched

LITTLE = 1e5  # bytes
HELD = 400 * 10**6  # bytes


@pytest.fixture(scope="module")
def problem():
    return plate(mesh_of(*square(12)), "morley", "clamped")


def test_small_systems_are_factorised(problem):
    choice = choose(problem.assembled.matrix, problem.space, "auto")
    assert choice.backend is installed_backends()[0]
    assert "below" in choice.why


def test_large_systems_go_to_multigrid(problem, monkeypatch):
    monkeypatch.setattr(auto, "MULTIGRID_FROM", dict.fromkeys(MULTIGRID_FROM, 100))
    choice = choose(problem.assembled.matrix, problem.space, "auto")
    assert choice.backend is None
    assert "faster" in choice.why
    thin = plate(mesh_of(*stretched(40, 20)), "morley", "clamped")
    choice = choose(thin.assembled.matrix, thin.space, "auto")
    assert choice.backend is not None
    assert "thinner" in choice.why


@pytest.mark.parametrize("method", ["auto", "direct", "superlu"])
def test_memory_is_foreseen(problem, method):
    choice = choose(problem.assembled.matrix, problem.space, method, available=LITTLE)
    assert choice.backend is None
    assert re.search("would take about .* GB.*multigrid was taken", choice.warnings[0])
    with pytest.raises(SolveError, match="more memory"):
        choose(problem.assembled.matrix, None, method, available=LITTLE)


def test_without_a_space_it_is_direct(problem):
    assert choose(problem.assembled.matrix, None, "auto").backend is not None
    with pytest.raises(InputError, match="Morley and Argyris"):
        choose(problem.assembled.matrix, None, "multigrid")


def test_a_back_end_that_is_missing(problem, monkeypatch):
    monkeypatch.setattr(backends, "_found", lambda modules: modules == ("scipy",))
    assert [backend.key for backend in installed_backends()] == ["superlu"]
    assert choose(problem.assembled.matrix, problem.space, "auto").backend.key == "superlu"
    with pytest.raises(InputError, match="pip install cvxopt"):
        choose(problem.assembled.matrix, problem.space, "cholmod")


def test_the_table_knows_every_back_end():
    assert set(MULTIGRID_FROM) == {(e, b.key) for e in ("morley", "argyris") for b in BACKENDS}


def test_forecast_covers_a_real_factor():
    """SuperLU tells the size of its factors (two triangles): the forecast must not be below, nor far above."""
    problem = plate(mesh_of(*square(60)), "morley", "clamped")
    a = problem.assembled.matrix
    factor = sp.linalg.splu(
        a.tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True}
    )
    stored = 12.0 * (factor.L.nnz + factor.U.nnz)
    assert 0.5 * stored < factorisation_bytes(a.shape[0], a.nnz, "superlu") < 6 * stored


def test_limit_of_a_container(tmp_path):
    assert _control_group(tmp_path) == np.inf
    (tmp_path / "memory.max").write_text("5000\n", encoding="utf-8")
    (tmp_path / "memory.current").write_text("1500\n", encoding="utf-8")
    assert _control_group(tmp_path) == 3500.0
    (tmp_path / "memory.max").write_text("max\n", encoding="utf-8")
    assert _control_group(tmp_path) == np.inf


def test_memory_is_counted_in_bytes():
    """In a process of its own: one that has freed memory holds more of it without growing."""
    program = (
        "import numpy as np\n"
        "from kshell.solvers.memory import available_bytes, peak_bytes\n"
        "before = peak_bytes()\n"
        f"held = np.ones({HELD // 8})\n"
        "print(before, peak_bytes(), available_bytes())\n"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    before, after, available = map(float, done.stdout.split())
    total = psutil.virtual_memory().total
    assert 1e7 < before < after < total
    assert after - before == pytest.approx(HELD, rel=0.2)  # the numbers of pages may be a little late
    assert 0 < available < total


def test_what_fits():
    assert fits(sp.eye(10, format="csr"), "superlu", 1e9)
    assert not fits(sp.eye(10**5, format="csr"), "superlu", 1e3)


def test_pardiso_whose_library_cannot_be_loaded_is_passed_over(tmp_path, monkeypatch):
    """The package is there, MKL, which it loads when it is imported, is not."""
    package = tmp_path / "pypardiso"
    package.mkdir()
    (package / "__init__.py").write_text(
        "raise ImportError('Shared library mkl_rt not found')", encoding="utf-8"
    )
    for name in [name for name in sys.modules if name.partition(".")[0] == "pypardiso"]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.syspath_prepend(tmp_path)
    cached = (backends._found, backends._loads_mkl)
    for function in cached:
        function.cache_clear()
    try:
        assert backends._found(("pypardiso",))
        assert not PARDISO.installed
        assert PARDISO not in installed_backends()
    finally:
        for function in cached:
            function.cache_clear()
