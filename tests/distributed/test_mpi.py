"""The same scenes on several processes under mpiexec: equal to one, and no error leaves one waiting.

Skipped where PETSc or mpiexec is missing: install the extra `distributed`.
"""

import importlib.util
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import kshell as ks

ROOT = Path(__file__).parent.parent.parent
BESIDE = Path(sys.executable).parent / "mpiexec"
MPIEXEC = str(BESIDE) if BESIDE.exists() else shutil.which("mpiexec")
MISSING = [name for name in ("mpi4py", "petsc4py") if importlib.util.find_spec(name) is None]

pytestmark = pytest.mark.skipif(
    bool(MISSING) or MPIEXEC is None,
    reason=f"needs the extra distributed: {', '.join(MISSING)} or mpiexec missing",
)

ENVIRONMENT = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "PYTHONPATH": str(ROOT)}
# parts of result.json of which no more than rounding is left, and what depends on it
ROUNDING = ("balance", "algebra", "half_width", "expected", "estimate", "discretisation", "large_deflection")


def mpi(ranks: int, *arguments: object, code: str = "") -> subprocess.CompletedProcess[str]:
    """`kshell ARGUMENTS` on several processes, after some code."""
    program = f"{code}\nfrom kshell.cli.commands import main\nmain()\n"
    command = [str(MPIEXEC), "-n", str(ranks), sys.executable, "-c", program, *map(str, arguments)]
    return subprocess.run(
        command, env=ENVIRONMENT, cwd=ROOT, capture_output=True, text=True, timeout=120, check=False
    )


def differences(one: Any, other: Any, where: str = "", scale: float | None = None) -> list[tuple[float, str]]:
    """Relative differences of two documents, against the largest number of each list."""
    if isinstance(one, dict):
        assert set(one) == set(other), where
        return [
            d
            for k in one
            if not (where == "" and k == "solver")
            for d in differences(one[k], other[k], f"{where}.{k}")
        ]
    if isinstance(one, list):
        assert len(one) == len(other), where
        numbers = np.abs(np.array([p for p in one if isinstance(p, int | float)], dtype=float))
        size = scale or float(numbers.max(initial=0.0))
        return [
            d
            for k, (p, q) in enumerate(zip(one, other, strict=True))
            for d in differences(p, q, f"{where}[{k}]", size)
        ]
    if isinstance(one, float) or (isinstance(one, int) and isinstance(other, float)):
        return [(abs(one - other) / max(scale or abs(one), 1e-300), where)] if one != other else []
    assert one == other, where
    return []


def require_same(scene: ks.Scene, folder: Path, ranks: int, bound: float, command: str = "solve") -> None:
    """Solve a scene here and on several processes, and compare all that is said of it."""
    file = folder / "scene.toml"
    scene.save(file)
    read = ks.Scene.load(file)
    alone = {"solve": ks.solve, "trace": ks.trace}[command](read)
    done = mpi(ranks, command, file, "-o", folder / "out", "--json", folder / "result.json")
    assert done.returncode == 0, done.stderr
    several = json.loads((folder / "result.json").read_text(encoding="utf-8"))
    expected = json.loads(json.dumps(alone.to_dict()))
    for document in (several, expected):
        largest = max(np.linalg.norm(r["force"]) for r in document["reactions"].values())
        for reaction in document["reactions"].values():  # a force that is nothing but rounding has no digits
            for key in reaction:
                reaction[key] = np.round(np.array(reaction[key]) / largest, 10).tolist()
    for difference, where in differences(expected, several):
        if any(word in where for word in ROUNDING):
            continue
        assert difference <= bound, where
    loaded = ks.Result.load(folder / "out")
    u, own = loaded.fields["displacement"], alone.fields["displacement"]
    assert np.abs(u - own).max() <= bound * np.abs(own).max()


def cylinder(order: int, ratio: float, n: int = 6) -> ks.Mesh:
    return ks.geometry.Cylinder(1.0).mesh(
        n, n, 1 if order == 1 else 2, ("free", "crown", "middle", "wall"), (0.87, np.pi / 2), (0.0, 1.0)
    )


def roof(order: int, ratio: float, **more: Any) -> ks.Scene:
    mesh = cylinder(order, ratio)
    given: dict[str, Any] = {
        "supports": [ks.Symmetry(["crown", "middle"]), ks.Fixed("wall", "xy")],
        "loads": [ks.Gravity((0, -1, 0))],
    }
    return ks.Scene(
        mesh=mesh,
        thickness=ratio,
        material=ks.Isotropic(E=1e4 / ratio, nu=0.3, density=1e-6),
        probes={"edge": (0.766, 0.643, 0.5), "inside": (0.3, 0.95, 0.4)},
        solve={"order": order, "large_deflection": False},
        **{**given, **more},
    )


@pytest.mark.parametrize(
    ("ranks", "order", "ratio", "bound"),
    [(1, 2, 1e-2, 1e-9), (2, 1, 1e-2, 1e-9), (4, 2, 1e-3, 1e-8), (2, 3, 1e-3, 1e-8), (4, 2, 1e-4, 1e-7)],
)
def test_a_shell_on_several_processes_is_that_on_one(
    tmp_path: Path, ranks: int, order: int, ratio: float, bound: float
) -> None:
    require_same(roof(order, ratio), tmp_path, ranks, bound)
