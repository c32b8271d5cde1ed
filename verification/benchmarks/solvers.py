"""Time and memory of all solvers against the number of unknowns, in one run, drawn into one chart.

    python -m verification.benchmarks.solvers              sizes up to 1e6 unknowns, about twenty minutes
    python -m verification.benchmarks.solvers --quick      up to 1e5, about two minutes
    python -m verification.benchmarks.solvers --largest    adds Morley with 4e6 unknowns by multigrid

An L-shaped plate, clamped, under pressure, on an unstructured mesh. Every measurement is a process of its own:
processor seconds on one thread (other work on the machine disturbs them less than it does the clock), and the
peak of resident memory from the assembled matrix on. What is compared are the ratios at the end.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

HERE = Path(__file__).parent
METHODS = ("multigrid", "cholmod", "pardiso", "superlu")
NAMES = {
    "multigrid": "multigrid",
    "cholmod": "CHOLMOD (cvxopt)",
    "pardiso": "PARDISO (pypardiso)",
    "superlu": "SuperLU (scipy)",
}
SIZES = {"morley": (1e4, 3e4, 1e5, 3e5, 1e6), "argyris": (1e4, 3e4, 1e5, 3e5, 8e5)}
QUICK = {"morley": (1e4, 1e5), "argyris": (1e4, 1e5)}
SLOWEST = {"superlu": 1.2e5}  # unknowns beyond which a method is left out: it would take minutes
UNKNOWNS_PER_VERTEX = {"morley": 4.0, "argyris": 9.0}
AREA = 0.75


def mesh_file(vertices: int, folder: Path) -> Path:
    """An unstructured mesh of the L-shape with about that many vertices, as .npz of points and triangles."""
    path = folder / f"l_shape_{vertices}.npz"
    if path.exists():
        return path
    import gmsh

    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    corners = [(0, 0), (1, 0), (1, 0.5), (0.5, 0.5), (0.5, 1), (0, 1)]
    size = float(np.sqrt(AREA / vertices * 2 / np.sqrt(3)))
    points = [gmsh.model.geo.addPoint(x, y, 0, size) for x, y in corners]
    lines = [gmsh.model.geo.addLine(a, b) for a, b in zip(points, points[1:] + points[:1], strict=True)]
    gmsh.model.geo.addPlaneSurface([gmsh.model.geo.addCurveLoop(lines)])
    gmsh.model.geo.synchronize()
    gmsh.option.setNumber("Mesh.Algorithm", 6 if vertices < 3e5 else 5)
    gmsh.model.mesh.generate(2)
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    _, nodes = gmsh.model.mesh.getElementsByType(2)
    gmsh.finalize()
    number = np.zeros(int(tags.max()) + 1, dtype=np.int64)
    number[tags.astype(np.int64)] = np.arange(len(tags))
    triangles = number[nodes.astype(np.int64)].reshape(-1, 3)
    np.savez(path, points=coordinates.reshape(-1, 3), triangles=triangles.astype(np.int32))
    return path


def measure(element: str, path: Path, method: str, tolerance: float | None) -> dict[str, Any]:
    """One solve in this process."""
    import kshell as ks
    from kshell.elements import ElementArgyris, ElementMorley
    from kshell.mesh.mesh import Group, Mesh
    from kshell.mesh.order import in_spatial_order
    from kshell.plate.problem import PlateProblem
    from kshell.scene.structure import resolve
    from kshell.solvers import prepare

    begin = time.process_time()
    arrays = np.load(path)
    mesh = Mesh(arrays["points"], arrays["triangles"])
    mesh, _ = in_spatial_order(mesh)  # the same for all
    mesh = Mesh(mesh.points, mesh.triangles, groups={"edge": Group(1, mesh.boundary_edges)})
    scene = ks.Scene(
        mesh=mesh,
        thickness=0.01,
        material=ks.Isotropic(E=210e9, nu=0.3),
        supports=[ks.Clamped("edge")],
        loads=[ks.Pressure(1e3)],
    )
    problem = PlateProblem(resolve(scene, mesh), ElementMorley() if element == "morley" else ElementArgyris())
    matrix, load, space = problem.assembled.matrix, problem.assembled.load, problem.space
    assembled = time.process_time()
    assembly_peak = _peak_memory()
    before = _forget_peak()
    prepared = prepare(matrix, space, method)
    ready = time.process_time()
    solution = prepared.solve(load, tolerance)
    done = time.process_time()
    return {
        "element": element,
        "method": method,
        "tolerance": tolerance,
        "solver": solution.name,
        "unknowns": matrix.shape[0],
        "entries": int(matrix.nnz),
        "assembly": assembled - begin,
        "setup": ready - assembled,
        "solve": done - ready,
        "iterations": solution.iterations,
        "energy_error": solution.energy_error,
        "compliance": float(load @ solution.x),
        "before_mb": before,
        "peak_mb": _peak_memory(),
        "assembly_peak_mb": assembly_peak,
        "warnings": list(solution.warnings),
    }


def _status(name: str) -> float:
    for line in Path("/proc/self/status").read_text(encoding="utf-8").splitlines():
        if line.startswith(name):
            return float(line.split()[1]) / 1024
    raise RuntimeError(f"/proc/self/status has no {name}")


def _peak_memory() -> float:
    """Largest resident memory since `_forget_peak`, MB."""
    return _status("VmHWM")


def _forget_peak() -> float:
    """Start a new peak; the resident memory now, MB."""
    Path("/proc/self/clear_refs").write_text("5", encoding="utf-8")
    return _status("VmRSS")


def run_all(sizes: dict[str, tuple[float, ...]], largest: bool, folder: Path) -> list[dict[str, Any]]:
    """All measurements, one process each, one after the other."""
    cases: list[tuple[str, float, str, float | None]] = []
    for element, many in sizes.items():
        for unknowns in many:
            for method in METHODS:
                if unknowns <= SLOWEST.get(method, np.inf):
                    cases.append((element, unknowns, method, None))
            cases.append((element, unknowns, "multigrid", 1e-8))
    if largest:
        cases.append(("morley", 4e6, "multigrid", None))
    results = []
    for element, unknowns, method, tolerance in cases:
        path = mesh_file(round(unknowns / UNKNOWNS_PER_VERTEX[element]), folder)
        command = [
            sys.executable,
            "-m",
            "verification.benchmarks.solvers",
            "--one",
            element,
            str(path),
            method,
        ]
        command += [] if tolerance is None else [str(tolerance)]
        threads = {"OMP_NUM_THREADS": "1", "MKL_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
        done = subprocess.run(
            command, env={**os.environ, **threads}, capture_output=True, text=True, check=False
        )
        if done.returncode:
            print(f"{element} {unknowns:.0e} {method}: no answer: {done.stderr.strip().splitlines()[-1:]}")
            continue
        result = json.loads(done.stdout)
        results.append(result)
        print(row(result), flush=True)
    return results


def row(r: dict[str, Any]) -> str:
    """One measurement as a line of the table."""
    aim = "default" if r["tolerance"] is None else f"{r['tolerance']:.0e}"
    return (
        f"{r['element']:8}{r['unknowns']:9d}  {r['method']:10}{aim:8} assembly {r['assembly']:6.2f}  "
        f"setup {r['setup']:6.2f}  solve {r['solve']:6.2f} s  {r['iterations']:3d} iterations  "
        f"error {r['energy_error']:.0e}  peak {r['peak_mb']:6.0f} MB  beyond the matrix "
        f"{r['peak_mb'] - r['before_mb']:6.0f} MB"
    )


def total(r: dict[str, Any], assembly: bool = False) -> float:
    """Processor seconds of setup and solve, with the assembly if asked for."""
    return r["setup"] + r["solve"] + (r["assembly"] if assembly else 0.0)


def ratios(results: list[dict[str, Any]]) -> list[str]:
    """What the chart is about, in numbers: others over multigrid, and growth of the time per unknown."""
    lines = []
    by_size: dict[tuple[str, int], dict[str, dict[str, Any]]] = {}
    for r in results:
        key = r["method"] if r["tolerance"] is None else "tight"
        by_size.setdefault((r["element"], r["unknowns"]), {})[key] = r
    for (element, unknowns), found in sorted(by_size.items()):
        own = found.get("multigrid")
        for method, r in found.items():
            if own is None or method in ("multigrid", "tight"):
                continue
            lines.append(
                f"{element:8}{unknowns:9d}  {NAMES[method]:20} / multigrid:  time {total(r) / total(own):5.2f}, "
                f"with assembly {total(r, True) / total(own, True):5.2f}, peak memory "
                f"{r['peak_mb'] / own['peak_mb']:5.2f}, beyond the matrix "
                f"{(r['peak_mb'] - r['before_mb']) / (own['peak_mb'] - own['before_mb']):5.2f}"
            )
    for element in SIZES:
        own_list = [
            r for r in results if (r["element"], r["method"], r["tolerance"]) == (element, "multigrid", None)
        ]
        base = next((r for r in own_list if r["unknowns"] > 0.9e5), None)
        for r in own_list:
            if base is not None and r["unknowns"] > base["unknowns"]:
                growth = total(r, True) / r["unknowns"] / (total(base, True) / base["unknowns"])
                lines.append(
                    f"{element:8}{r['unknowns']:9d}  time per unknown over that at {base['unknowns']}: {growth:.2f}"
                )
    return lines


def draw(results: list[dict[str, Any]], path: Path) -> None:
    """Time and memory against unknowns, a row for each element."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    style = {"multigrid": ("C3", "o"), "cholmod": ("C0", "s"), "pardiso": ("C2", "^"), "superlu": ("C7", "v")}
    figure, axes = plt.subplots(2, 2, figsize=(10, 8), layout="constrained", sharex="col")
    for line, element in enumerate(("morley", "argyris")):
        for method in METHODS:
            mine = [
                r for r in results if r["element"] == element and r["method"] == method and not r["tolerance"]
            ]
            n = [r["unknowns"] for r in mine]
            colour, marker = style[method]
            options = {"color": colour, "marker": marker, "markersize": 4, "label": NAMES[method]}
            axes[line, 0].loglog(n, [total(r) for r in mine], **options)
            axes[line, 1].loglog(n, [r["peak_mb"] - r["before_mb"] for r in mine], **options)
        tight = [r for r in results if r["element"] == element and r["tolerance"]]
        axes[line, 0].loglog(
            [r["unknowns"] for r in tight],
            [total(r) for r in tight],
            color="C3",
            linestyle=":",
            label="multigrid to 1e-8",
        )
        axes[line, 0].set_ylabel(f"{element.capitalize()}: processor seconds")
        axes[line, 1].set_ylabel("memory beyond the matrix, MB")
        for axis in axes[line]:
            axis.grid(True, which="major", alpha=0.4)
            axis.legend(fontsize=8)
    for axis in axes[1]:
        axis.set_xlabel("unknowns")
    figure.suptitle("Setup and solution of a clamped L-shaped plate, one thread")
    figure.savefig(path, dpi=130)
    plt.close(figure)


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--quick", action="store_true", help="only up to 1e5 unknowns")
    parser.add_argument("--largest", action="store_true", help="add 4e6 Morley unknowns by multigrid")
    parser.add_argument("--out", type=Path, default=HERE, help="folder for solvers.png and solvers.json")
    parser.add_argument(
        "--meshes", type=Path, default=Path(tempfile.gettempdir()), help="folder to keep meshes in"
    )
    parser.add_argument("--one", nargs="+", metavar="ELEMENT MESH METHOD TOLERANCE", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.one:
        element, path, method, *tolerance = options.one
        print(json.dumps(measure(element, Path(path), method, float(tolerance[0]) if tolerance else None)))
        return
    options.out.mkdir(parents=True, exist_ok=True)
    results = run_all(QUICK if options.quick else SIZES, options.largest, options.meshes)
    print("\n".join(ratios(results)))
    (options.out / "solvers.json").write_text(json.dumps(results, indent=1), encoding="utf-8")
    draw(results, options.out / "solvers.png")
    print(f"chart: {options.out / 'solvers.png'}")


if __name__ == "__main__":
    main()
