"""Commands on several processes write what they write on one, and leave no memory behind.

Skipped where PETSc or mpiexec is missing: install the extra `distributed`.
"""

import json
from pathlib import Path

import numpy as np
import pytest

import kshell as ks
from tests.distributed.processes import MISSING, run_code
from tests.distributed.test_mpi import cases, large

pytestmark = pytest.mark.skipif(bool(MISSING), reason=f"the extra distributed is not installed: {MISSING}")

MAIN = "from kshell.cli.commands import main\nmain()\n"
# megabytes of each process after a solve, from the second one on
AGAIN = """
import gc, sys, warnings
import psutil
import kshell as ks
from kshell.distributed.team import world

warnings.simplefilter("ignore")
scene = ks.Scene.load(sys.argv[1])
taken = []
for _ in range(6):
    ks.solve(scene, solver="petsc")
    gc.collect()
    taken.append(psutil.Process().memory_info().rss / 1e6)
every = world().communicator.gather(taken[1:])
if every is not None:
    print(every)
"""


def test_all_files_of_load_cases_are_written(tmp_path: Path) -> None:
    cases().save(tmp_path / "scene.toml")
    out = tmp_path / "out"
    done = run_code(
        2,
        MAIN,
        "solve",
        tmp_path / "scene.toml",
        "-o",
        out,
        "--tables",
        "--report",
        "--json",
        tmp_path / "r.json",
    )
    assert done.returncode == 0, done.stderr
    names = {path.name for path in out.iterdir()}
    assert {"result-000.vtu", "result-001.vtu", "result.pvtu", "result.json"} <= names
    assert {"case-one.vtu", "case-both.vtu", "envelope.vtu", "envelope.csv", "report.html"} <= names
    assert "result.vtu" not in names
    written = json.loads((tmp_path / "r.json").read_text(encoding="utf-8"))
    assert {"two", "both"} <= set(written["cases"])
    assert done.stdout.count("written: ") >= len(names) - 1  # said once, by the first


def test_what_cannot_go_on_is_written_up_to_there(tmp_path: Path) -> None:
    scene = large(analysis="path", steps=3)
    scene = ks.Scene(
        mesh=scene.mesh,
        thickness=0.1,
        material=scene.material,
        supports=scene.supports,
        loads=[ks.LineForce("right", (0, 0, 40.0)), ks.Pressure(3e6, follower=True)],
        solve={"model": "shell", "order": 2, "analysis": "path", "steps": 3},
    )
    scene.save(tmp_path / "scene.toml")
    done = run_code(2, MAIN, "trace", tmp_path / "scene.toml", "-o", tmp_path / "out")
    assert done.returncode == 1, done.stderr
    (message,) = [line for line in done.stderr.splitlines() if line.startswith("error: ")]
    assert "cannot be increased" in message
    state = ks.Result.load(tmp_path / "out")
    assert np.isfinite(state.fields["displacement"]).all()
    assert (tmp_path / "out" / "result-001.vtu").exists()


def test_factors_of_earlier_solves_are_freed(tmp_path: Path) -> None:
    mesh = ks.geometry.Cylinder(1.0).mesh(30, 30, 2, ("a", "b", "c", "d"), (0.5, 1.4), (0.0, 1.0))
    ks.Scene(
        mesh=mesh,
        thickness=0.01,
        material=ks.Isotropic(E=1.0, nu=0.3),
        supports=[ks.Clamped("a")],
        loads=[ks.Pressure(1e-9)],
        solve={"order": 2, "large_deflection": False},
    ).save(tmp_path / "scene.toml")
    done = run_code(2, AGAIN, tmp_path / "scene.toml")
    assert done.returncode == 0, done.stderr
    for taken in json.loads(done.stdout):
        assert taken[-1] - taken[0] < 30.0  # four factors and matrices are 60
