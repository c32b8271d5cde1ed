"""Geometry files meshed anew by gmsh, with triangles as large as is wanted at each place of a mesh there is.

The wanted sizes are a field over that mesh, linear in its triangles, which gmsh looks up wherever it makes a node; what
the file itself says of sizes, of regular meshes (transfinite, layers) and of quadrilaterals is left out. Places become
vertices: within surfaces they are embedded, along curves the nearest node of the meshed curve is moved there before
surfaces are meshed. All options are set here, so the same sizes give the same mesh.
"""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.errors import InputError
from kshell.mesh.build import build, reversed_triangles
from kshell.mesh.closest import Locator
from kshell.mesh.geometry_file import MOST_TRIANGLES, is_discrete, opened, written
from kshell.mesh.gmsh_file import read_gmsh
from kshell.mesh.mesh import Mesh
from kshell.mesh.words import count

Floats = NDArray[np.float64]

HERE = 1e-6  # distance from an entity of the geometry, in the size of the mesh, that is none
APART = 0.1  # of the wanted size: nearer to a curve a place within a surface would leave slivers
FRONTAL = 6  # gmsh's number of the frontal Delaunay algorithm
OPTIONS = {
    "Mesh.Algorithm": FRONTAL,
    "Mesh.MeshSizeExtendFromBoundary": 0,
    "Mesh.MeshSizeFromPoints": 0,
    "Mesh.MeshSizeFromCurvature": 0,
    "Mesh.MeshSizeFromParametricPoints": 0,
    "Mesh.MeshSizeFactor": 1,
    "Mesh.MeshSizeMin": 0,
    "Mesh.MeshSizeMax": 1e22,
    "Mesh.RecombineAll": 0,
    "Mesh.SubdivisionAlgorithm": 0,
    "Mesh.SecondOrderLinear": 0,
    "Mesh.RandomSeed": 1,
    "General.NumThreads": 1,
}


def mesh_by_size(
    mesh: Mesh, size: Floats, path: Path, order: int, places: Floats, allow_system: bool = False
) -> Mesh:
    """The geometry that a mesh was made from, meshed anew.

    Parameters
    ----------
    mesh : Mesh
        Made from the geometry, of order 1 or 2; what the sizes belong to.
    size : (vertex,) array
        Wanted lengths of edges at its vertices.
    path : Path
        .geo, .step, .brep or .iges.
    order : 1 or 2
    places : (n, 3) array
        What is to be a vertex, where it lies on the geometry.
    allow_system : bool
        Whether the file may run programs and write files.

    Returns
    -------
    Mesh
        With the groups of the mesh before, its normals to the same sides.

    Raises
    ------
    InputError
        If gmsh cannot mesh it, groups are lost, a triangle would be turned inside out, or the sizes would take more
        than `MOST_TRIANGLES`.
    """
    expected = _expected(mesh, size)
    if expected > MOST_TRIANGLES:
        raise InputError(f"{path.name}: the wanted sizes would make about {expected:.2g} triangles")
    with (
        tempfile.TemporaryDirectory(prefix="kshell-") as folder,
        opened(path, Path(folder), allow_system, "mesh it anew") as gmsh,
    ):
        if is_discrete(gmsh.model):
            raise InputError(
                f"{path.name}: holds triangles instead of smooth surfaces: they are not meshed anew"
            )
        target = Path(folder) / "mesh.msh"
        gmsh.model.mesh.clear()
        gmsh.model.mesh.removeConstraints()
        for option, value in OPTIONS.items():
            gmsh.option.setNumber(option, value)
        gmsh.option.setNumber("Mesh.ElementOrder", 1)
        _set_field(gmsh, mesh, size)
        on_curves = _embedded(gmsh.model, places, mesh, size)
        gmsh.model.mesh.generate(1)
        for tag, at in on_curves:
            _move_node(gmsh.model, tag, at)
        gmsh.model.mesh.generate(2)
        if order == 2:
            gmsh.model.mesh.setOrder(2)
        written(gmsh, path, target)
        new = build(read_gmsh(target, path.name), Mesh)
    lost = [name for name in mesh.groups if name not in new.groups]
    if lost:
        raise InputError(f"{path.name}: meshed anew it lacks {count(len(lost), 'group')}, e.g. {lost[0]!r}")
    return _facing_like(new, mesh)


def _expected(mesh: Mesh, size: Floats) -> float:
    """Number of triangles that sizes at vertices take, 4 / sqrt(3) times the area over their square."""
    x = mesh.points[mesh.triangles]
    area = 0.5 * np.linalg.norm(np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0]), axis=1)
    return float((4.0 / 3.0**0.5 * area * (size[mesh.triangles] ** -2.0).mean(axis=1)).sum())


def _set_field(gmsh: Any, mesh: Mesh, size: Floats) -> None:
    """The wanted sizes as gmsh's background field; triangles of order 2 as the four between their nodes."""
    x, value = mesh.points[mesh.triangles], size[mesh.triangles]
    if mesh.midpoints is not None:
        middles = mesh.midpoints[mesh.triangle_edges]  # of edges 01, 12, 02
        halves = value[:, [0, 1, 0]] ** 0.5 * value[:, [1, 2, 2]] ** 0.5
        x, value = np.concatenate([x, middles], axis=1), np.concatenate([value, halves], axis=1)
        parts = np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]])
        x, value = x[:, parts].reshape(-1, 3, 3), value[:, parts].reshape(-1, 3)
    rows = np.concatenate([np.moveaxis(x, 2, 1).reshape(-1, 9), value], axis=1)
    view = gmsh.view.add("sizes")
    gmsh.view.addListData(view, "ST", len(rows), rows.ravel())
    field = gmsh.model.mesh.field
    number = field.add("PostView")
    field.setNumber(number, "ViewTag", view)
    field.setAsBackgroundMesh(number)


def _embedded(model: Any, places: Floats, mesh: Mesh, size: Floats) -> list[tuple[int, Floats]]:
    """Places embedded in the surfaces they lie in; (curve, place) of those that lie along curves, which cannot be."""
    on_curves: list[tuple[int, Floats]] = []
    surfaces = model.getEntities(2)
    borders = sorted({abs(tag) for _, tag in model.getBoundary(surfaces, False, False)})
    points = np.array([model.getValue(0, tag, []) for _, tag in model.getEntities(0)]).reshape(-1, 3)
    near = HERE * mesh.size
    kernel = model.occ if model.occ.getEntities(2) else model.geo
    for at in np.unique(places.reshape(-1, 3), axis=0):
        if len(points) and np.linalg.norm(points - at, axis=1).min() <= near:
            continue
        points = np.concatenate([points, at[None]])
        gaps = {tag: float(np.linalg.norm(_closest(model, 1, tag, at) - at)) for tag in borders}
        curve = min(gaps, key=gaps.__getitem__) if gaps else 0
        if curve and gaps[curve] <= near:
            on_curves.append((curve, at))
            continue
        wanted = size[np.linalg.norm(mesh.points - at, axis=1).argmin()]
        if curve and gaps[curve] < APART * wanted:
            continue
        for _, tag in surfaces:
            foot = _closest(model, 2, tag, at)
            if np.linalg.norm(foot - at) <= near and model.isInside(2, tag, foot.tolist()):
                number = max(tag for _, tag in model.getEntities(0)) + 1
                kernel.addPoint(*foot.tolist(), tag=number)
                kernel.synchronize()
                model.mesh.embed(0, [number], 2, tag)
                break
    return on_curves


def _closest(model: Any, dimension: int, tag: int, at: Floats) -> Floats:
    found = np.asarray(model.getClosestPoint(dimension, tag, at.tolist())[0])
    return found if len(found) == 3 else np.full(3, np.inf)


def _move_node(model: Any, curve: int, at: Floats) -> None:
    """The nearest inner node of a meshed curve moved along it to a place."""
    tags, flat, _ = model.mesh.getNodes(1, curve)
    if not len(tags):
        return
    nearest = int(np.linalg.norm(flat.reshape(-1, 3) - at, axis=1).argmin())
    model.mesh.setNode(tags[nearest], at.tolist(), model.getParametrization(1, curve, at.tolist()).tolist())


def _facing_like(new: Mesh, old: Mesh) -> Mesh:
    """The new mesh with its normals to the sides of the old one's."""
    if new.is_flat:
        return new
    found = Locator.of(old).find(new.points[new.triangles].mean(axis=1))
    normals = []
    for mesh in (new, old):
        x = mesh.points[mesh.triangles]
        normals.append(np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0]))
    against = (normals[0] * normals[1][found.triangles]).sum(axis=1) < 0.0
    return reversed_triangles(new, against) if against.any() else new


def sizes_at_vertices(mesh: Mesh, wanted: Floats) -> Floats:
    """(vertex,) sizes from those of the triangles (triangle,) around, their geometric mean."""
    total, number = np.zeros(len(mesh.points)), np.zeros(len(mesh.points))
    np.add.at(total, mesh.triangles, np.log(wanted)[:, None])
    np.add.at(number, mesh.triangles, 1.0)
    return np.asarray(np.exp(total / number))


def sizes_of_triangles(mesh: Mesh) -> Floats:
    """(triangle,) edge of the equilateral triangle with the same area."""
    x = mesh.points[mesh.triangles]
    twice = np.linalg.norm(np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0]), axis=1)
    return np.asarray(np.sqrt(2.0 / 3.0**0.5 * twice))
