"""An error on any process, at any stage, ends all of them: one message, the right exit code, none left waiting.

Skipped where PETSc or mpiexec is missing: install the extra `distributed`.
"""

import os
import signal
import subprocess
import time
from pathlib import Path

import psutil
import pytest

import kshell as ks
from tests.distributed.processes import ENVIRONMENT, MISSING, ROOT, command_of, run_code

pytestmark = pytest.mark.skipif(bool(MISSING), reason=f"the extra distributed is not installed: {MISSING}")

HANGS = 240.0  # seconds after which what has not ended waits for ever, however busy the machine is
MAIN = "from kshell.cli.commands import main\nmain()\n"
# where an error is put: module, what is called there, and the stage it belongs to
STAGES = {
    "read": ("kshell.scene.scene", "Scene.read_mesh"),
    "resolve": ("kshell.analysis.solve", "resolve"),
    "deal": ("kshell.distributed.surface_piece", "SurfaceData.of"),
    "receive": ("kshell.distributed.surface_piece", "PartSurface.__init__"),
    "assemble": ("kshell.shell.koiter.energy", "Koiter.linear_stiffness"),
    "supports": ("kshell.shell.problem", "apply_supports"),
    "reduce": ("kshell.distributed.numbering", "blocks_of"),
    "factor": ("kshell.distributed.factor", "Mumps._new"),
    "refine": ("kshell.shell.koiter.energy", "Koiter.linear_strain"),
    "recover": ("kshell.shell.model", "answer_linear"),
    "cut": ("kshell.distributed.saving", "piece_of"),
    "write": ("kshell.distributed.saving", "write_triangles"),
    # outside of what processes agree on
    "spread": ("kshell.distributed.shares", "Share.spread"),
    # of a plate
    "maps": ("kshell.distributed.plate_piece", "PlateData.of"),
    "part": ("kshell.distributed.plate_piece", "PlatePart.__init__"),
    "forms": ("kshell.distributed.plate", "assemble"),
}
PLATE = ("maps", "part", "forms")
INJECT = """
import importlib, os, sys
module, name, rank, kind, mark = {arguments!r}
if os.environ["PMI_RANK"] == rank:
    place = importlib.import_module(module)
    *path, last = name.split(".")
    for part in path:
        place = getattr(place, part)
    import kshell.errors
    errors = {{**vars(kshell.errors), "MemoryError": MemoryError, "ValueError": ValueError}}
    def fails(*given, **more):
        open(mark, "w").close()
        raise errors[kind]("put here on purpose")
    setattr(place, last, fails)
"""
# all say that they are there; then one of them takes its time, and the others wait for it
SLOW = """
import os, time
from kshell.shell.koiter.energy import Koiter
old = Koiter.linear_strain
def slowly(*given):
    rank = os.environ["PMI_RANK"]
    open(os.path.join({folder!r}, rank), "w").write(str(os.getpid()))
    if rank == "1":
        time.sleep(3600)
    return old(*given)
Koiter.linear_strain = slowly
"""


@pytest.fixture(scope="module")
def scene(tmp_path_factory: pytest.TempPathFactory) -> Path:
    mesh = ks.geometry.Cylinder(1.0).mesh(6, 6, 2, ("a", "b", "c", "d"), (0.5, 1.4), (0.0, 1.0))
    file = tmp_path_factory.mktemp("scene") / "scene.toml"
    ks.Scene(
        mesh=mesh,
        thickness=0.01,
        material=ks.Isotropic(E=1.0, nu=0.3),
        supports=[ks.Clamped("a")],
        loads=[ks.Pressure(1e-9)],
    ).save(file)
    return file


@pytest.fixture(scope="module")
def plate(tmp_path_factory: pytest.TempPathFactory) -> Path:
    mesh = ks.geometry.Plane().mesh(4, 4, 1, ("a", "b", "c", "d"), (0.0, 1.0), (0.0, 1.0))
    file = tmp_path_factory.mktemp("plate") / "scene.toml"
    ks.Scene(
        mesh=mesh,
        thickness=0.01,
        material=ks.Isotropic(E=1.0, nu=0.3),
        supports=[ks.Clamped("a")],
        loads=[ks.Pressure(1e-9)],
        solve={"model": "plate", "large_deflection": False},
    ).save(file)
    return file


def errors_in(text: str) -> list[str]:
    return [line for line in text.splitlines() if line.startswith("error: ")]


@pytest.mark.parametrize(
    ("stage", "rank", "kind", "code"),
    [
        ("read", 0, "InputError", 2),
        ("resolve", 0, "InputError", 2),
        ("supports", 0, "InputError", 2),
        ("deal", 0, "ValueError", 1),
        ("receive", 1, "SolveError", 1),
        ("assemble", 2, "MemoryError", 1),
        ("reduce", 1, "SolveError", 1),
        ("factor", 1, "SolveError", 1),
        ("refine", 1, "SolveError", 1),
        ("recover", 0, "ValueError", 1),
        ("cut", 0, "SolveError", 1),
        ("write", 1, "SolveError", 1),
        ("spread", 1, "ValueError", 1),
        ("maps", 0, "ValueError", 1),
        ("part", 1, "SolveError", 1),
        ("forms", 1, "MemoryError", 1),
    ],
)
def test_an_error_on_one_process_ends_all(
    scene: Path, plate: Path, tmp_path: Path, stage: str, rank: int, kind: str, code: int
) -> None:
    mark = tmp_path / "failed"
    inject = INJECT.format(arguments=(*STAGES[stage], str(rank), kind, str(mark)))
    done = run_code(  # where one is left waiting, the run never ends, which is an error
        max(rank + 1, 2),
        inject + MAIN,
        "solve",
        plate if stage in PLATE else scene,
        "-o",
        tmp_path / "out",
        timeout=HANGS,
    )
    assert mark.exists()
    assert done.returncode == code, done.stderr
    (message,) = errors_in(done.stderr)
    assert "out of memory" in message if kind == "MemoryError" else "put here on purpose" in message
    assert not list(tmp_path.glob("out/*"))  # nothing half written
    assert "Traceback" not in done.stderr


def test_bad_input_is_said_once(scene: Path) -> None:
    done = run_code(3, MAIN, "solve", scene, "--set", "support.0.on=nowhere")
    assert done.returncode == 2
    assert len(errors_in(done.stderr)) == 1
    assert "nowhere" in done.stderr
    assert done.stdout == ""


def test_a_folder_that_only_the_first_cannot_write(scene: Path, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("", encoding="utf-8")
    done = run_code(2, MAIN, "solve", scene, "-o", tmp_path / "file" / "out")
    assert done.returncode == 2
    (message,) = errors_in(done.stderr)
    assert "cannot be written" in message
    done = run_code(2, MAIN, "solve", scene, "--json", tmp_path / "file" / "result.json")
    assert done.returncode == 2
    assert len(errors_in(done.stderr)) == 1


@pytest.mark.parametrize("words", [["buckling"], ["check"], ["converge"]])
def test_what_is_not_for_several_is_refused_once(scene: Path, words: list[str]) -> None:
    done = run_code(2, MAIN, *words, scene)
    assert done.returncode == 2
    (message,) = errors_in(done.stderr)
    assert "several processes" in message


def test_a_killed_process_ends_all(scene: Path, tmp_path: Path) -> None:
    command = command_of(3, SLOW.format(folder=str(tmp_path)) + MAIN, "solve", scene, "-o", tmp_path / "out")
    with subprocess.Popen(
        command, env=ENVIRONMENT, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as running:
        begin = time.monotonic()
        while len(list(tmp_path.glob("[0-9]"))) < 3 and time.monotonic() - begin < HANGS:
            time.sleep(0.1)
        time.sleep(0.5)  # the others wait for the slow one now
        pids = [int((tmp_path / str(rank)).read_text(encoding="utf-8")) for rank in range(3)]
        processes = [psutil.Process(pid) for pid in pids]
        os.kill(pids[1], signal.SIGKILL)
        running.communicate(timeout=HANGS)
        assert running.returncode != 0
    ended, _ = psutil.wait_procs(processes, timeout=HANGS)
    assert len(ended) == 3
    assert not (tmp_path / "out" / "result.json").exists()
