"""What a large linear solve takes on several processes, by process and by unknown, for verification/scale.md.

    mpiexec -n 4 python -m verification.benchmarks.scale CELLS [ORDER] [ELEMENT]

A cylindrical roof of CELLS x CELLS cells, or with ELEMENT morley or argyris a square plate. One line of JSON: processor
seconds and peak memory of each process after every stage, entries and flops of the factors as MUMPS counts them, and
calls and bytes of the exchanges of kshell.
"""

from __future__ import annotations

import json
import math
import sys
import time
from typing import Any

import numpy as np

import kshell as ks
from kshell.analysis.model_choice import choose_model
from kshell.analysis.models import model_of_team
from kshell.distributed.team import Team, world
from kshell.plate.model import PlateModel
from kshell.scene.structure import resolve
from kshell.solvers import prepare
from kshell.solvers.memory import peak_bytes
from kshell.solvers.multigrid.pcg import conjugate_gradients


class Counting(Team):
    """A team that counts what it exchanges."""

    calls, bytes = 0, 0

    def sum(self, shape: tuple[int, ...], *given: Any) -> Any:
        self.calls, self.bytes = self.calls + 1, self.bytes + 8 * math.prod(shape)
        return super().sum(shape, *given)

    def join(self, members: Any, row: tuple[int, ...], work: Any) -> Any:
        rows = sum(len(some) for some in members)
        self.calls, self.bytes = self.calls + 1, self.bytes + 8 * rows * math.prod(row)
        return super().join(members, row, work)


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


def main(cells: int, order: int, element: str) -> None:
    team = Counting(world().communicator)
    stages: dict[str, list[float]] = {}
    begin = time.process_time()

    def note(stage: str) -> None:
        nonlocal begin
        now = time.process_time()
        stages[stage] = [now - begin, peak_bytes() / 1e6]
        begin = now

    note("imports")
    scene = square(cells, element) if element else roof(cells, order)
    structure = resolve(scene, team.once(scene.read_mesh))
    note("mesh")
    model: Any = model_of_team(team, structure, choose_model(structure, scene.solve))
    note("model")
    seconds = assembly(model)
    note("matrix")
    model.solve("direct")
    note("solve")
    found = {
        "processes": team.size,
        "unknowns": model.unknowns,
        "stages": {name: _every(team, values) for name, values in stages.items()},
        "assembly of own triangles": _every(team, [seconds]),
        "calls": team.calls,
        "bytes per unknown": team.bytes / model.unknowns,
        **factors(model),
        **(iterations(model, structure, element) if element else {}),
    }
    if team.rank == 0:
        print(json.dumps(found), flush=True)


def assembly(model: Any) -> float:
    """Processor seconds of the stiffness of the triangles that this process has."""
    begin = time.process_time()
    if model.kind == "plate":
        model.prepare()
    else:
        model.problem.energy.part.linear_stiffness()
    return time.process_time() - begin


def factors(model: Any) -> dict[str, float]:
    """What MUMPS says of the factors."""
    solver = model._solver._factoriser if model.kind == "shell" else model._prepared["direct"].factoriser
    factor = solver._solvers[True].getPC().getFactorMatrix()
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


def _every(team: Team, values: list[float]) -> list[list[float]]:
    return [np.round(one, 2).tolist() for one in team.communicator.allgather(values)]


if __name__ == "__main__":
    words = [*sys.argv[1:], "2", ""][:3] if len(sys.argv) < 4 else sys.argv[1:]
    main(int(words[0]), int(words[1]), words[2] if len(words) > 2 else "")
