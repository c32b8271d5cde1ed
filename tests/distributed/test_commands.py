"""Commands on several processes write what they write on one, and leave no memory behind.

Skipped where PETSc or mpiexec is missing: install the extra `distributed`.
"""

import json
from pathlib import Path

import numpy as np
import pytest

import kshell as ks
from tests.distributed.processes import MISSING, run_code
from tests.distributed.test_mpi import SCENES, cases, large

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


def test_states_of_a_path_are_written_into_one_file(tmp_path: Path) -> None:
    pytest.importorskip("h5py")
    large(analysis="path", steps=3).save(tmp_path / "scene.toml")
    done = run_code(2, MAIN, "trace", tmp_path / "scene.toml", "-o", tmp_path / "out", "--xdmf")
    assert done.returncode == 0, done.stderr
    names = {path.name for path in (tmp_path / "out").iterdir()}
    assert {"series.xdmf", "series.h5", "result.pvtu"} <= names
    assert not [name for name in names if name.startswith("series-")]


# what each process of two is told
ASKED = """
import json, os, sys, warnings
import numpy as np
import kshell as ks

warnings.simplefilter("ignore")
folder, name = sys.argv[1:]
result = ks.solve(ks.Scene.load(f"{folder}/{name}.toml"), solver="petsc")
said = {}
asked = {
    "at": lambda: result.at((0.3, 0.4, 0.0))["u"],
    "cut": lambda: result.cut((0.3, 0.93, 0.45), (0, 0.3, 1))["force"],
    "along": lambda: result.reaction_along(next(iter(result.reactions)))["resultant"]["force"],
    "save": lambda: result.save(f"{folder}/{name}-saved", xdmf=True),
}
for what, ask in asked.items():
    try:
        said[what] = np.ravel(ask()).tolist()
    except ks.KshellError as error:
        said[what] = f"{type(error).__name__}: {error}"
with open(f"{folder}/{name}-{os.environ['PMI_RANK']}.json", "w") as file:
    json.dump(said, file)
"""


@pytest.mark.parametrize("name", ["cases", "argyris"])
def test_what_a_result_is_asked_is_answered_or_refused_in_words(tmp_path: Path, name: str) -> None:
    SCENES[name]().save(tmp_path / f"{name}.toml")
    done = run_code(2, ASKED, tmp_path, name)
    assert done.returncode == 0, done.stderr
    first, other = (
        json.loads((tmp_path / f"{name}-{rank}.json").read_text(encoding="utf-8")) for rank in range(2)
    )
    alone = ks.solve(ks.Scene.load(tmp_path / f"{name}.toml"))
    np.testing.assert_allclose(first["at"], np.ravel(alone.at((0.3, 0.4, 0.0))["u"]), rtol=1e-7, atol=1e-12)
    force = alone.cut((0.3, 0.93, 0.45), (0, 0.3, 1))["force"] if name == "cases" else np.array([])
    if len(force):
        np.testing.assert_allclose(first["cut"], force, atol=1e-7 * np.abs(force).max())
    resultant = alone.reaction_along(next(iter(alone.reactions)))["resultant"]["force"]
    np.testing.assert_allclose(first["along"], resultant, atol=1e-7 * np.abs(resultant).max())
    np.testing.assert_allclose(other["along"], first["along"])
    for what in ("at", "cut"):
        assert other[what].startswith("SolveError: the first process alone has mesh and fields")
    # what the first finds wrong before anything is written ends both
    assert first["save"] == other["save"]
    assert first["save"].startswith("InputError: xdmf: this result has no states")


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
