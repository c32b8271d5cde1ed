"""How fast and how exact plates are: kshell beside bare scikit-fem, in one run.

    python -m verification.benchmarks.plates

Every measurement runs in a process of its own with one thread; times are CPU seconds without imports, memory is
the peak of the process less what it held after the imports. Ratios compare runs of the same minute.
"""

from __future__ import annotations

import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

UNKNOWNS = 100_000
CELLS = {"argyris": 105, "morley": 158}  # squares per side that give about 1e5 unknowns


def peak_mb() -> float:
    """Peak resident memory of this process."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def unit_square(cells: int, shift: float = 0.0, scale: float = 1.0) -> Any:
    """Right triangles on a square; the group edge is its boundary."""
    import skfem

    from kshell.mesh.mesh import Mesh

    side = np.linspace(0, 1, cells + 1)
    plain = skfem.MeshTri.init_tensor(side, side)
    ends = plain.facets[:, plain.boundary_facets()].T
    return Mesh.from_arrays(plain.p.T * scale + shift, plain.t.T, {"edge": ends})


def run_kshell(element: str, cells: int) -> Callable[[], int]:
    """Stiffness and load of the free plate as a sparse matrix, from points and triangles alone."""
    import kshell as ks
    from kshell.elements import ElementArgyris, ElementMorley
    from kshell.material.section import plate_section
    from kshell.mesh.mesh import Mesh
    from kshell.plate.assembly import assemble
    from kshell.plate.conditions import Conditions
    from kshell.plate.domain import Domain
    from kshell.plate.forms import Bending
    from kshell.plate.layout import Layout
    from kshell.plate.loading import AreaLoad
    from kshell.plate.pattern import Pattern
    from kshell.plate.reduction import Reduction

    made = unit_square(cells)
    mesh = Mesh(made.points, made.triangles)  # topology is part of the work, on both sides
    used = {"argyris": ElementArgyris, "morley": ElementMorley}[element]()
    material = ks.Isotropic(E=10.92, nu=0.3)

    def work() -> int:
        domain = Domain(mesh, curved=element == "argyris")
        reduction = Reduction(Layout(mesh, used), Conditions())
        section = plate_section(mesh, 1.0, material)
        bending = Bending(domain, used, section)
        pressure = AreaLoad(domain, used, None, 1.0)
        matrix = assemble([bending], [pressure], domain, reduction, Pattern(reduction)).matrix
        return int(matrix.shape[0])

    return work


def run_skfem(element: str, cells: int) -> Callable[[], int]:
    """The same with scikit-fem's own element, basis and forms."""
    import skfem
    from skfem.helpers import dd, ddot, eye, trace

    side = np.linspace(0, 1, cells + 1)
    mesh = skfem.MeshTri.init_tensor(side, side)
    used = {"argyris": skfem.ElementTriArgyris, "morley": skfem.ElementTriMorley}[element]()

    @skfem.BilinearForm
    def bending(u: Any, v: Any, _: Any) -> Any:
        return ddot(0.7 * dd(u) + 0.3 * eye(trace(dd(u)), 2), dd(v))

    @skfem.LinearForm
    def load(v: Any, _: Any) -> Any:
        return 1.0 * v

    def work() -> int:
        basis = skfem.Basis(mesh, used, intorder=8 if element == "argyris" else 4)  # as scikit-fem's examples
        matrix = bending.assemble(basis)
        load.assemble(basis)
        return int(matrix.shape[0])

    return work


def measure(run: Callable[[str, int], Callable[[], int]], element: str) -> tuple[int, float, float]:
    """Unknowns, CPU seconds and MB of one run, after a small one that loads all modules."""
    run(element, 4)()
    work = run(element, CELLS[element])
    before, begin = peak_mb(), time.process_time()
    unknowns = work()
    return unknowns, time.process_time() - begin, peak_mb() - before


def digits() -> dict[str, float]:
    """Relative errors of the clamped and the simply supported square, 2048 triangles, Argyris."""
    import kshell as ks
    from kshell.analysis.solve import solve

    out = {}
    edges = {"clamped": ks.Clamped("edge"), "supported": ks.SimplySupported("edge")}
    centre = {"clamped": 1.26531908748e-3, "supported": 4.06235266068e-3}
    for name, support in edges.items():
        for shift, scale in ((0.0, 1.0), (1e3, 1.0), (0.0, 1e-3), (0.0, 1e3)):
            mesh = unit_square(32, shift, scale)
            c = scale / 2 + shift
            e = (c, shift, 0.0)
            scene = ks.Scene(
                mesh=mesh,
                thickness=1.0,
                material=ks.Isotropic(E=10.92, nu=0.3),
                supports=[support],
                loads=[ks.Pressure(1.0)],
                probes={"centre": (c, c, 0.0), "edge": e},
            )
            result = solve(scene, element="argyris", large_deflection=False)
            where = f"{name}, shift {shift:g}, scale {scale:g}"
            w = result.probe("centre")["u"][2] / scale**4
            out[f"{where}: deflection"] = abs(w / centre[name] - 1)
            if shift == 0 and scale == 1 and name == "clamped":
                out["clamped: moment at the centre"] = abs(result.probe("centre")["M"][0] / 0.0229050908 - 1)
                out["clamped: moment at mid-edge"] = abs(result.probe("edge")["M"][1] / -0.0513337658 - 1)
            if shift == 0 and scale == 1 and name == "supported":
                corners = result.reactions["edge"]["corners"]
                out["supported: corner force, worst corner"] = max(
                    abs(corner["force"][2] / 0.06496470 - 1) for corner in corners
                )
    return out


def whole_program() -> tuple[int, float]:
    """`kshell solve` of a Morley plate of 50,000 triangles: triangles, seconds from start to written results."""
    from kshell.mesh.write import write_msh

    with tempfile.TemporaryDirectory() as folder:
        mesh = unit_square(158)
        write_msh(mesh, Path(folder) / "plate.msh")
        words = ["solve", f"{folder}/plate.msh", "--thickness", "0.01", "--E", "210e9", "--nu", "0.3"]
        words += [
            "--clamped",
            "edge",
            "--pressure",
            "1000",
            "--element",
            "morley",
            "-o",
            f"{folder}/out",
        ]
        begin = time.perf_counter()
        subprocess.run(
            [sys.executable, "-m", "kshell", *words],
            check=True,
            capture_output=True,
        )
        return len(mesh.triangles), time.perf_counter() - begin


def measured(name: str, element: str) -> tuple[int, float, float]:
    """The best of three runs in processes of their own."""
    environment = dict(os.environ, OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")
    command = [sys.executable, "-m", "verification.benchmarks.plates", name, element]
    runs = [
        json.loads(
            subprocess.run(command, check=True, capture_output=True, env=environment, text=True).stdout
        )
        for _ in range(3)
    ]
    return runs[0][0], min(run[1] for run in runs), min(run[2] for run in runs)


def main() -> None:
    """Print all measurements."""
    print("stiffness and load of a square plate, one thread")
    titles = ("unknowns", "kshell s", "skfem s", "faster", "kshell MB", "skfem MB", "less")
    print(f"{'element':10}" + "".join(f"{title:>11}" for title in titles))
    for element in ("argyris", "morley"):
        n, ours, memory = measured("run_kshell", element)
        _, bare, bare_memory = measured("run_skfem", element)
        print(
            f"{element:10}{n:>11}{ours:>11.2f}{bare:>11.2f}{bare / ours:>10.1f}x{memory:>11.0f}{bare_memory:>11.0f}"
            f"{bare_memory / memory:>10.1f}x"
        )
    print("\nrelative errors, Argyris, 32 x 32 x 2 triangles")
    for name, error in digits().items():
        print(f"  {name:55}{error:.1e}")
    triangles, seconds = whole_program()
    print(
        f"\nkshell solve, Morley, {triangles} triangles, from process start to written results: {seconds:.2f} s"
    )


if __name__ == "__main__":
    if len(sys.argv) > 1:
        run = {"run_kshell": run_kshell, "run_skfem": run_skfem}[sys.argv[1]]
        print(json.dumps(measure(run, sys.argv[2])))
    else:
        main()
