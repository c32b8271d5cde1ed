"""What steps of motion and contact cost, and how well cloth hangs.

Run with ``python -m verification.benchmarks.motion > motion.md``; ``large`` after it adds sheets of 4,608 and 10,368
triangles.

Large steps
    One second of a steel square, 0.5 m wide and 0.5 mm thick, that hangs from two corners and swings: CPU seconds of
    implicit Euler steps, against those of an explicit scheme at its stability limit, 2 / the largest frequency of the
    triangles with lumped masses, each step of which costs an evaluation of the forces and the rotations of the edges,
    which have no mass and must be solved for.
Drape
    A square of cloth comes to rest on a ball: the share of it that its shadow covers, for orders and meshes.
Contact
    CPU seconds of a step of a sheet that falls on a ball, for meshes.
"""

from __future__ import annotations

import sys
import time
import warnings
from dataclasses import replace
from typing import Any

import numpy as np
from scipy.linalg import eigh

import kshell as ks
from kshell.analysis.models import model_of
from kshell.verify.cases.large_scenes import rectangle

G = 9.81
# triangles along a side of sheets that fall, and steps
SHEETS, LARGE = ((10, 8), (24, 6)), ((48, 4), (72, 3))


def hanging(cells: int, order: int) -> ks.Scene:
    """The steel square."""
    return ks.Scene(
        mesh=rectangle(0.5, 0.5, cells, cells),
        thickness=5e-4,
        material=ks.Isotropic(E=210e9, nu=0.3, density=7850),
        supports=[ks.Fixed((0, 0, 0), "xyz"), ks.Fixed((0, 0.5, 0), "xyz")],
        loads=[ks.Gravity((0, 0, -G))],
        solve={"time": 1.0, "scheme": "euler", "order": order},
    )


def explicit(scene: ks.Scene) -> tuple[float, float]:
    """Largest stable step, and CPU seconds of one step: forces of a state, and its rotations."""
    model: Any = model_of(replace(scene, solve={**_options(scene), "analysis": "dynamic"}))
    problem = model.equilibrium()
    energy, basis = problem.energy, problem.reduction.basis
    mass = model.full_mass()
    diagonal = mass.diagonal()
    lumped = np.asarray(
        basis.T @ (mass.sum() / diagonal.sum() * diagonal)
    ).ravel()  # Hinton, Rock and Zienkiewicz
    moving = lumped > 0.0
    stiffness = (basis.T @ energy.linear_stiffness() @ basis).toarray()
    inner = stiffness[np.ix_(~moving, ~moving)]
    across = stiffness[np.ix_(~moving, moving)]
    condensed = stiffness[np.ix_(moving, moving)] - across.T @ np.linalg.solve(inner, across)
    root = 1.0 / np.sqrt(lumped[moving])
    last = len(root) - 1
    highest = eigh(
        root[:, None] * condensed * root, eigvals_only=True, subset_by_index=(last, last), overwrite_a=True
    )[0]
    x, many = np.zeros(energy.unknowns), 20
    factor = problem.factorise(energy.linear_stiffness())
    begin = time.process_time()
    for _ in range(many):
        _, residual, _ = problem.evaluate(x, 1.0, 1, energy.rest)
        factor.solve(basis.T @ residual)
    return 2.0 / float(np.sqrt(highest)), (time.process_time() - begin) / many


def _options(scene: ks.Scene) -> dict[str, Any]:
    return {"time": scene.solve.time, "scheme": scene.solve.scheme, "order": scene.solve.order}


def spent(scene: ks.Scene, **options: Any) -> tuple[float, ks.Result]:
    """CPU seconds of a motion, and its result."""
    begin = time.process_time()
    result = ks.simulate(scene, **options)
    return time.process_time() - begin, result


def cloth(cells: int, order: int) -> ks.Scene:
    """A square of stiff rubber over a ball, whose state of rest is one."""
    return ks.Scene(
        mesh=rectangle(0.5, 0.5, cells, cells),
        thickness=2e-3,
        material=ks.Isotropic(E=1e8, nu=0.3, density=1000.0),
        loads=[ks.Gravity((0, 0, -G))],
        contact=ks.Contact(friction=0.3, distance=2e-3, self=False),
        obstacles=[
            ks.Obstacle({"kind": "sphere", "centre": (0.25, 0.25, -0.186), "radius": 0.18}, name="ball")
        ],
        solve={"order": order},
    )


def shadow(result: ks.Result) -> float:
    """Area of the triangles of a state seen from above, against that at rest."""

    def area(points: Any) -> float:
        a, b, c = (points[result.mesh.triangles[:, k], :2] for k in range(3))
        u, v = b - a, c - a
        return float(np.abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]).sum()) / 2

    moved = result.points + result.fields["displacement"]
    return area(moved) / area(result.mesh.points)


def falling(cells: int) -> ks.Scene:
    """A soft sheet above a ball."""
    return ks.Scene(
        mesh=rectangle(0.5, 0.5, cells, cells),
        thickness=1e-3,
        material=ks.Isotropic(E=1e6, nu=0.3, density=200.0),
        loads=[ks.Gravity((0, 0, -G))],
        contact=ks.Contact(friction=0.3),
        obstacles=[
            ks.Obstacle({"kind": "sphere", "centre": (0.253, 0.252, -0.125), "radius": 0.12}, name="ball")
        ],
        solve={"scheme": "euler", "order": 1},
    )


def main(large: bool) -> None:
    """Print the tables."""
    warnings.simplefilter("ignore")
    print("# Motion and contact\n\nMade by `python -m verification.benchmarks.motion`; one thread.\n")
    print(
        "| hanging square | unknowns | stable explicit step | steps | CPU s, explicit | implicit step | CPU s | times |"
    )
    print("|---|---|---|---|---|---|---|---|")
    for cells, order in ((8, 1), (4, 2)):
        scene = hanging(cells, order)
        step, cost = explicit(scene)
        slow = cost / step
        for size in (0.02, 0.04):
            fast, result = spent(scene, step=size)
            print(
                f"| {2 * cells**2} triangles, order {order} | {result.unknowns} | {step:.2g} | {1 / step:.3g} | "
                f"{slow:.3g} | {size} | {fast:.3g} | {slow / fast:.3g} |",
                flush=True,
            )
    print(
        "\n| cloth on a ball | unknowns | share in the shadow | iterations | CPU s |\n|---|---|---|---|---|"
    )
    for cells, order in ((6, 2), (9, 2), (12, 1), (18, 1)):
        begin = time.process_time()
        result = ks.solve(cloth(cells, order))
        took = time.process_time() - begin
        print(
            f"| {2 * cells**2} triangles, order {order} | {result.unknowns} | {shadow(result):.4f} | "
            f"{result.solver['iterations']} | {took:.1f} |",
            flush=True,
        )
    print("\n| falling sheet | unknowns | steps | iterations | CPU s a step |\n|---|---|---|---|---|")
    for cells, steps in (*SHEETS, *(LARGE if large else ())):
        took, result = spent(falling(cells), step=0.02, time=0.02 * steps)
        print(
            f"| {2 * cells**2} triangles | {result.unknowns} | {steps} | {result.solver['iterations']} | "
            f"{took / steps:.3g} |",
            flush=True,
        )


if __name__ == "__main__":
    main("large" in sys.argv[1:])
