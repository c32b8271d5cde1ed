"""Iterations of multigrid to 1e-8 in the energy norm: shapes, supports and sizes, both elements.

    python -m verification.benchmarks.iterations [--sizes 1e4 1e5 1e6] [--meshes FOLDER]

Prints a table of the iterations of conjugate gradients after nested iteration, writes it to iterations.csv beside
this file, with the machine, the versions and the commit it came from, and compares it with the targets: at most 15
iterations (clamped, supported) or 25 (free edges), and at most 2 more at 1e6 than at 1e5 unknowns. With 1e6
unknowns it takes half an hour.
"""

from __future__ import annotations

import argparse
import csv
import platform
import subprocess
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import pyamg
import scipy

import kshell as ks
from kshell.elements import ElementArgyris, ElementMorley
from kshell.mesh.mesh import Group, Mesh
from kshell.mesh.order import in_spatial_order
from kshell.plate.problem import PlateProblem
from kshell.scene.structure import resolve
from kshell.solvers import prepare

HERE = Path(__file__).parent
ELEMENTS: dict[str, tuple[Any, float]] = {"morley": (ElementMorley, 4.0), "argyris": (ElementArgyris, 9.0)}
SHAPES = ("square", "L", "hole", "graded")
SUPPORTS: dict[str, list[Any]] = {
    "clamped": [ks.Clamped("boundary")],
    "supported": [ks.SimplySupported("boundary")],
    "mixed": [ks.Clamped("left"), ks.SimplySupported("right")],
    "cantilever": [ks.Clamped("left")],
}
MOST = {"clamped": 15, "supported": 15, "mixed": 25, "cantilever": 25}
Row = tuple[str, str, float, str, int, int]  # element, shape, size asked for, supports, unknowns, iterations
GROWTH = 2  # from 1e5 to 1e6 unknowns


def shape_mesh(shape: str, vertices: int, folder: Path) -> Mesh:
    """A mesh by gmsh with about that many vertices and the groups boundary, left, right (thirds)."""
    path = folder / f"{shape}_{vertices}.npz"
    if not path.exists():
        _generate(shape, vertices, path)
    arrays = np.load(path)
    mesh, _ = in_spatial_order(Mesh(arrays["points"], arrays["triangles"]))
    boundary = mesh.boundary_edges
    ends = mesh.points[mesh.edges[boundary], 0]
    low, size = mesh.points[:, 0].min(), np.ptp(mesh.points[:, 0])
    left, right = (ends < low + size / 3).all(axis=1), (ends > low + 2 * size / 3).all(axis=1)
    groups = {
        "boundary": Group(1, boundary),
        "left": Group(1, boundary[left]),
        "right": Group(1, boundary[right]),
    }
    return Mesh(mesh.points, mesh.triangles, groups=groups)


def _generate(shape: str, vertices: int, path: Path) -> None:
    import gmsh

    area = {"square": 1.0, "L": 0.75, "hole": np.pi * (1 - 0.09), "graded": 0.75}[shape]
    size = float(np.sqrt(area / vertices * 2 / np.sqrt(3)))
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    occ = gmsh.model.occ
    if shape == "hole":
        occ.cut([(2, occ.addDisk(0, 0, 0, 1, 1))], [(2, occ.addDisk(0.2, 0.1, 0, 0.3, 0.3))])
    elif shape == "square":
        occ.addRectangle(0, 0, 0, 1, 1)
    else:
        occ.cut([(2, occ.addRectangle(0, 0, 0, 1, 1))], [(2, occ.addRectangle(0.5, 0.5, 0, 0.5, 0.5))])
    occ.synchronize()
    gmsh.option.setNumber("Mesh.MeshSizeExtendFromBoundary", 0)
    if shape == "graded":  # a hundred times finer at the re-entrant corner
        field = gmsh.model.mesh.field
        field.add("MathEval", 1)
        field.setString(1, "F", f"{3.8 * size}*(0.01 + ((x-0.5)^2+(y-0.5)^2)^0.45)")
        field.setAsBackgroundMesh(1)
    else:
        gmsh.option.setNumber("Mesh.MeshSizeMax", size)
        gmsh.option.setNumber("Mesh.MeshSizeMin", size)
    gmsh.option.setNumber("Mesh.Algorithm", 6 if vertices < 1e5 else 5)
    gmsh.model.mesh.generate(2)
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    _, nodes = gmsh.model.mesh.getElementsByType(2)
    gmsh.finalize()
    number = np.zeros(int(tags.max()) + 1, dtype=np.int64)
    number[tags.astype(np.int64)] = np.arange(len(tags))
    used, triangles = np.unique(number[nodes.astype(np.int64)], return_inverse=True)
    np.savez(
        path, points=coordinates.reshape(-1, 3)[used], triangles=triangles.reshape(-1, 3).astype(np.int32)
    )


def iterations(shape: str, element: str, unknowns: float, folder: Path) -> dict[str, tuple[int, int]]:
    """Unknowns and iterations for each kind of support."""
    kind, per_vertex = ELEMENTS[element]
    mesh = shape_mesh(shape, round(unknowns / per_vertex), folder)
    found = {}
    for name, supports in SUPPORTS.items():
        scene = ks.Scene(
            mesh=mesh,
            thickness=0.01,
            material=ks.Isotropic(E=210e9, nu=0.3),
            supports=supports,
            loads=[ks.Pressure(1e3)],
        )
        problem = PlateProblem(resolve(scene, mesh), kind())
        system = problem.assembled
        solution = prepare(system.matrix, problem.space, "multigrid").solve(system.load, 1e-8)
        found[name] = (system.matrix.shape[0], solution.iterations)
    return found


def misses(rows: list[Row]) -> list[str]:
    """The targets that were not met, in words."""
    out = []
    count = {(element, shape, size, support): number for element, shape, size, support, _, number in rows}
    for (element, shape, size, support), number in count.items():
        case = f"{element} {shape} {support}"
        if number > MOST[support]:
            out.append(f"{case} at {size:.0e}: {number} iterations, {MOST[support]} are allowed")
        before = count.get((element, shape, 1e5, support))
        if size == 1e6 and before is not None and number - before > GROWTH:
            out.append(f"{case}: {before} iterations at 1e5, {number} at 1e6")
    return out


def write(rows: list[Row], path: Path) -> None:
    """The table as CSV, with the circumstances as comments above it."""
    commit = subprocess.run(
        ["git", "describe", "--always", "--dirty"], cwd=HERE, capture_output=True, text=True, check=False
    ).stdout.strip()
    with path.open("w", newline="", encoding="utf-8") as file:
        file.write(
            f"# machine: {platform.machine()} {platform.system()}; commit: {commit}; python "
            f"{platform.python_version()}, numpy {np.__version__}, scipy {scipy.__version__}, "
            f"pyamg {pyamg.__version__}\n"
        )
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["element", "shape", "size", "supports", "unknowns", "iterations"])
        table.writerows(rows)


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--sizes", nargs="+", type=float, default=[1e4, 1e5])
    parser.add_argument("--elements", nargs="+", choices=list(ELEMENTS), default=list(ELEMENTS))
    parser.add_argument("--shapes", nargs="+", choices=SHAPES, default=list(SHAPES))
    parser.add_argument("--out", type=Path, default=HERE, help="folder for iterations.csv")
    parser.add_argument(
        "--meshes", type=Path, default=Path(tempfile.gettempdir()), help="folder to keep meshes in"
    )
    options = parser.parse_args()
    print(f"{'element':9}{'shape':8}{'unknowns':>9}  " + "".join(f"{name:>12}" for name in SUPPORTS))
    rows: list[Row] = []
    for element in options.elements:
        for shape in options.shapes:
            for size in options.sizes:
                found = iterations(shape, element, size, options.meshes)
                rows += [(element, shape, size, name, *pair) for name, pair in found.items()]
                largest = max(n for n, _ in found.values())
                print(
                    f"{element:9}{shape:8}{largest:9d}  " + "".join(f"{i:12d}" for _, i in found.values()),
                    flush=True,
                )
                write(rows, options.out / "iterations.csv")
    print("\n".join(misses(rows)) or "all targets are met")


if __name__ == "__main__":
    main()
