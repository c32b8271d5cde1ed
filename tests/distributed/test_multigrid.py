"""The multigrid of plates in PETSc: what it is told, and its iterations on several processes."""

import json

import pytest

from tests.distributed.processes import MISSING, run_code

pytestmark = pytest.mark.skipif(bool(MISSING), reason=f"not there: {', '.join(MISSING)}")

PROGRAM = """
import json, sys
import numpy as np
import kshell as ks
from kshell.analysis.model_choice import choose_model
from kshell.analysis.models import model_of_team
from kshell.distributed.team import world
from kshell.plate.model import PlateModel
from kshell.scene.structure import resolve
from kshell.solvers.multigrid.pcg import conjugate_gradients

def smoothers(team, levels):
    pc = levels._pc
    found = [pc.getMGSmoother(k) for k in range(1, pc.getMGLevels())]
    return [[s.getType(), s.getTolerances()[3], s.getPC().getType()] for s in found]

def answers(element, support):
    names = ("left", "right", "bottom", "top")
    mesh = ks.geometry.Plane().mesh(64, 64, 1, names, (0.0, 1.0), (0.0, 1.0))
    supports = [getattr(ks, support)(["left", "top"]), ks.Clamped("right")]
    solve = {"element": element, "model": "plate", "large_deflection": False, "solver": "petsc"}
    material = ks.Isotropic(E=1e6, nu=0.3)
    plate = {"mesh": mesh, "thickness": 0.01, "material": material}
    scene = ks.Scene(**plate, supports=supports, loads=[ks.Pressure(1.0)], solve=solve)
    structure = resolve(scene, mesh)
    model = model_of_team(team, structure, choose_model(structure, scene.solve))
    system = model.problem.system
    rhs = system.load + system.fixed_load
    divided = model._prepare("multigrid")
    run = conjugate_gradients(divided.matrix, rhs, divided.precondition, 1e-8)
    alone = PlateModel(structure, element)
    exact = alone.problem.assembled
    left = np.linalg.norm(exact.matrix @ run.x - rhs) / np.linalg.norm(rhs)
    return {
        "iterations": len(run.history) - 1,
        "residual": left,
        "smoothers": team.calls.run(smoothers, team, divided._levels),
    }

team = world()
if team.rank:
    team.calls.follow()
else:
    team.calls.lead()
    try:
        found = [answers(e, s) for e in ("morley", "argyris") for s in ("Clamped", "SimplySupported")]
    finally:
        team.calls.end(lambda rank: None)
    print(json.dumps(found))
"""


def test_the_multigrid_of_several_processes_is_that_of_one() -> None:
    found = {}
    for ranks in (1, 4):
        done = run_code(ranks, PROGRAM)
        assert done.returncode == 0, done.stderr
        found[ranks] = json.loads(done.stdout.splitlines()[-1])
    for ranks, cases in found.items():
        for one, here in zip(found[1], cases, strict=True):
            assert here["iterations"] <= one["iterations"] + 1, (ranks, one, here)
            assert here["residual"] < 1e-5
            assert here["smoothers"]
            assert all(smoother == ["chebyshev", 3, "sor"] for smoother in here["smoothers"])
