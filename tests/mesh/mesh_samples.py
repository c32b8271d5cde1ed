"""Meshes the tests share: small files in every variant gmsh writes, and a structured square."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from kshell.mesh import Mesh

# what the file of `write_with_gmsh` holds: dimension, number of cells on a mesh of size 0.25
EXPECTED_GROUPS = {
    "all": (2, 2.0),
    "right half": (2, 1.0),
    "middle": (1, 1.0),
    "outline": (1, 6.0),
    "1:7": (1, 1.0),
    "corner": (0, 0.0),
}


def write_with_gmsh(
    path: Path,
    version: float,
    binary: bool,
    order: int,
    save_all: bool,
    partitions: int = 0,
    parametric: bool = False,
    groups: bool = True,
    split: bool = False,
) -> None:
    """Two unit squares side by side: overlapping groups, an interior curve, two groups on one curve, a "
    "point."""
    import gmsh

    gmsh.initialize(readConfigFiles=False, interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        geo = gmsh.model.geo
        places = [(0, 0), (1, 0), (1, 1), (0, 1), (2, 0), (2, 1)]
        p = [geo.addPoint(x, y, 0, 0.25) for x, y in places]
        ends = [(0, 1), (1, 2), (2, 3), (3, 0), (1, 4), (4, 5), (5, 2)]
        c = [geo.addLine(p[a], p[b]) for a, b in ends]
        left = geo.addPlaneSurface([geo.addCurveLoop([c[0], c[1], c[2], c[3]])])
        right = geo.addPlaneSurface([geo.addCurveLoop([c[4], c[5], c[6], -c[1]])])
        geo.synchronize()
        group = gmsh.model.addPhysicalGroup if groups else lambda *given: None
        group(2, [left, right], 1, "all")
        group(2, [right], 2, "right half")
        group(1, [c[1]], 3, "middle")
        group(1, [c[0], c[2], c[3], c[4], c[5], c[6]], 4, "outline")
        group(1, [c[3]], 7)
        group(0, [p[5]], 1, "corner")
        gmsh.model.mesh.generate(2)
        gmsh.model.mesh.setOrder(order)
        if partitions:
            gmsh.option.setNumber("Mesh.PartitionCreateGhostCells", 1)
            gmsh.model.mesh.partition(partitions)
        gmsh.option.setNumber("Mesh.MshFileVersion", version)
        gmsh.option.setNumber("Mesh.Binary", int(binary))
        gmsh.option.setNumber("Mesh.SaveParametric", int(parametric))
        gmsh.option.setNumber("Mesh.SaveAll", int(save_all))
        gmsh.option.setNumber("Mesh.PartitionSplitMeshFiles", int(split))
        gmsh.write(str(path))
    finally:
        gmsh.finalize()


def square(n: int = 3, order: int = 1) -> Mesh:
    """Unit square of n x n cells with overlapping groups."""
    x, y = np.meshgrid(np.linspace(0, 1, n + 1), np.linspace(0, 1, n + 1))
    points = np.column_stack([x.ravel(), y.ravel(), 0 * x.ravel()])
    corner = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    lower = np.column_stack([corner, corner + 1, corner + n + 2])
    upper = np.column_stack([corner, corner + n + 2, corner + n + 1])
    triangles = np.concatenate([lower, upper])
    run = np.arange(n)
    bottom = np.column_stack([run, run + 1])
    left = np.column_stack([run, run + 1]) * (n + 1)
    groups = {
        "plate": triangles,
        "lower": lower,
        "bottom": bottom,
        "left": left,
        "two sides": np.concatenate([bottom, left]),
        "origin": [0],
    }
    if order == 1:
        return Mesh.from_arrays(points, triangles, groups)
    bare = Mesh.from_arrays(points, triangles)
    midpoints = bare.points[bare.edges].mean(axis=1)
    midpoints[:, 1] += 0.1 / n * np.sin(np.pi * midpoints[:, 0])
    return Mesh.from_arrays(points, triangles, groups, midpoints)


def msh2_text(points: list[tuple[float, float, float]], cells: list[str], names: str = "") -> str:
    """A small MSH 2.2 file; a cell is "type tag nodes..."."""
    nodes = "".join(f"{k} {x} {y} {z}\n" for k, (x, y, z) in enumerate(points, 1))
    lines = []
    for k, cell in enumerate(cells, 1):
        cell_type, tag, *corners = cell.split()
        lines.append(f"{k} {cell_type} 2 {tag} 1 {' '.join(corners)}\n")
    return (
        "$MeshFormat\n2.2 0 "
        f"8\n$EndMeshFormat\n{names}$Nodes\n{len(points)}\n{nodes}$EndNodes\n$Elements\n{len(cells)}\n{''.join(lines)}$EndElements\n"
    )


def triangle_set(mesh: Mesh, members: np.ndarray | None = None) -> set[tuple[float, ...]]:
    """Triangles by the coordinates of their corners, whatever their numbers are."""
    chosen = mesh.triangles if members is None else mesh.triangles[members]
    middle = mesh.points[chosen].mean(axis=1)
    return {tuple(row) for row in np.round(middle, 9).tolist()}


def group_places(mesh: Mesh) -> dict[str, tuple[int, list[tuple[float, ...]]]]:
    """Each group by the sorted places of its cells, whatever their numbers are."""
    middles = (mesh.points, mesh.points[mesh.edges].mean(axis=1), mesh.points[mesh.triangles].mean(axis=1))
    return {
        name: (
            group.dimension,
            sorted(map(tuple, (np.round(middles[group.dimension][group.members], 9) + 0.0).tolist())),
        )
        for name, group in mesh.groups.items()
    }
