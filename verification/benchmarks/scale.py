"""What a large linear solve takes on several processes, by process and by unknown, for verification/scale.md.

    mpiexec -n 4 python -m verification.benchmarks.scale CELLS [ORDER] [ELEMENT]

A cylindrical roof of CELLS x CELLS cells, or with ELEMENT morley or argyris a square plate. One line of JSON with
entries and flops of the factors as MUMPS counts them, and one by process: processor seconds and peak memory after every
stage, messages of kshell, and bytes of the arrays in them over the unknowns.
"""

from __future__ import annotations

import json
import math
import sys
import time
from collections.abc import Callable
from typing import Any

import numpy as np

import kshell as ks
from kshell.analysis.model_choice import choose_model
from kshell.analysis.models import model_of_team
from kshell.distributed.koiter import KoiterPiece
from kshell.distributed.team import Team, world
from kshell.plate.model import PlateModel
from kshell.scene.structure import resolve
from kshell.shell.koiter.constitutive import TriangleStiffness
from kshell.solvers import prepare
from kshell.solvers.memory import peak_bytes
from kshell.solvers.multigrid.pcg import conjugate_gradients


class Counting(Team):
    """A team that counts what kshell sends and gets: messages, and bytes of arrays in them."""

    messages, bytes = 0, 0

    def send(self, value: Any, rank: int, tag: int) -> None:
        self._count(value)
        super().send(value, rank, tag)

    def receive(self, rank: int, tag: int) -> Any:
        value = super().receive(rank, tag)
        self._count(value)
        return value

    def sum(self, shape: tuple[int, ...], *given: Any) -> Any:
        found = super().sum(shape, *given)
        self._count(found)
        return found

    def _count(self, value: Any) -> None:
        self.messages, self.bytes = self.messages + 1, self.bytes + bytes_of(value)


def bytes_of(value: Any) -> int:
    """Of the arrays in something."""
    if isinstance(value, np.ndarray):
        return value.nbytes
    if isinstance(value, tuple | list):
        return sum(map(bytes_of, value))
    return sum(map(bytes_of, vars(value).values())) if hasattr(value, "__dict__") else 0


def roof(cells: int, order: int) -> ks.Scene:
    names = ("free", "crown", "middle", "wall")
    span = (math.radians(50), math.pi / 2), (0.0, 1.0)
    mesh = ks.geometry.Cylinder(1.0).mesh(cells, cells, 1 if order == 1 else 2, names, *span)
    return ks.Scene(
        mesh=mesh,
        thickness=0.01,
        material=ks.Isotropic(E=1e6, nu=0.3),
        supports=[ks.Symmetry(["crown", "middle"]), ks.Fixed("wall", "xy")],
        loads=[ks.Traction((0, -1, 0))],
        solve={"order": order, "large_deflection": False, "solver": "petsc"},
    )


def square(cells: int, element: str) -> ks.Scene:
    names = ("left", "right", "bottom", "top")
    mesh = ks.geometry.Plane().mesh(cells, cells, 1, names, (0.0, 1.0), (0.0, 1.0))
    return ks.Scene(
        mesh=mesh,
        thickness=0.01,
        material=ks.Isotropic(E=1e6, nu=0.3),
        supports=[ks.Clamped(list(names))],
        loads=[ks.Pressure(1.0)],
        solve={"element": element, "model": "plate", "large_deflection": False, "solver": "petsc"},
    )


# of this process: processor seconds and peak memory after each stage
STAGES: dict[str, list[float]] = {}
# processor seconds of the least of some repetitions
LEAST: dict[str, float] = {}
REPEATS = 3


def note(team: Team, stage: str) -> None:
    """On every process: what it took since the last stage."""
    now = time.process_time()
    STAGES[stage] = [now - sum(seconds for seconds, _ in STAGES.values()), peak_bytes() / 1e6]


def every(team: Team) -> Any:
    """What all processes noted, and what they exchanged."""
    assert isinstance(team, Counting)
    mine = {"stages": STAGES, "least": LEAST, "messages": team.messages, "bytes": team.bytes}
    return team.communicator.allgather(mine)


def main(cells: int, order: int, element: str) -> None:
    team = Counting(world().communicator)
    note(team, "imports")
    if team.rank:
        team.calls.follow()
        return
    team.calls.lead()
    try:
        solved(team, square(cells, element) if element else roof(cells, order), order, element)
    finally:
        team.calls.end(lambda rank: None)


def solved(team: Team, scene: ks.Scene, order: int, element: str) -> None:
    """Solve, and print what it took."""
    run = team.calls.run
    mesh = scene.read_mesh()
    run(note, team, "mesh")
    structure = resolve(scene, mesh)
    model: Any = model_of_team(team, structure, choose_model(structure, scene.solve))
    run(note, team, "set up")
    if model.kind == "plate":
        model.prepare()
    else:
        run(stiffnesses, team, model.problem.energy.piece)
        run(note, team, "stiffness of triangles")
        run(matrices, team, model.problem.energy.piece)
    run(note, team, "matrix")
    model.solve("direct")
    run(note, team, "solve")
    found = {
        "processes": team.size,
        "unknowns": model.unknowns,
        "each": run(every, team),
        **factors(model),
        **(iterations(model, structure, element) if element else {}),
    }
    if team.rank == 0:
        each = found.pop("each")
        print(json.dumps(found))
        for rank, of in enumerate(each):
            stages = {name: [round(value, 2) for value in values] for name, values in of["stages"].items()}
            per_unknown = round(of["bytes"] / model.unknowns, 1)
            least = {name: round(value, 3) for name, value in of["least"].items()}
            print(
                json.dumps(
                    {"rank": rank, **stages, "least": least, "messages": of["messages"], "bytes": per_unknown}
                )
            )


def stiffnesses(team: Team, piece: KoiterPiece) -> None:
    """Those of the triangles of each process in their own strains."""
    energy = piece.energy
    LEAST["stiffness of triangles"] = _least(
        team, lambda: TriangleStiffness.of(energy.surface, energy.section, energy.blocks)
    )


def matrices(team: Team, piece: KoiterPiece) -> None:
    """The matrix of the triangles of each process, with its pattern."""

    def made() -> None:
        piece.energy.__dict__.pop("sparsity", None)
        piece.energy.linear_stiffness()

    LEAST["matrix"] = _least(team, made)


def _least(team: Team, work: Callable[[], object]) -> float:
    """Processor seconds that something takes at least."""
    found = []
    for _ in range(REPEATS):
        begin = time.process_time()
        team.together(work)
        found.append(time.process_time() - begin)
    return min(found)


def factors(model: Any) -> dict[str, float]:
    """What MUMPS says of the factors."""
    solver = model._solver._factoriser if model.kind == "shell" else model._prepared["direct"].factoriser
    factor = solver.mumps._solvers[True].getPC().getFactorMatrix()
    unknowns = model.unknowns
    entries = factor.getMumpsInfog(9)
    entries = entries if entries > 0 else -1e6 * entries
    return {"entries of factors per unknown": entries / unknowns, "flops": factor.getMumpsRinfog(3)}


def iterations(model: Any, structure: Any, element: str) -> dict[str, int]:
    """Conjugate gradients to 1e-8 from zero: by PETSc's PCMG, and by the cycles of kshell on one process."""
    system = model.problem.system
    rhs = system.load + system.fixed_load
    divided = model._prepare("multigrid")
    run = conjugate_gradients(divided.matrix, rhs, divided.precondition, 1e-8)
    alone = PlateModel(structure, element).problem
    own = prepare(alone.assembled.matrix, alone.space, "multigrid")
    serial = conjugate_gradients(own.matrix, rhs, own.precondition, 1e-8)
    return {"iterations of PCMG": len(run.history) - 1, "of kshell": len(serial.history) - 1}


if __name__ == "__main__":
    words = [*sys.argv[1:], "2", ""][:3] if len(sys.argv) < 4 else sys.argv[1:]
    main(int(words[0]), int(words[1]), words[2] if len(words) > 2 else "")
