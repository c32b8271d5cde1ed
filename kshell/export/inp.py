"""Scenes as .inp files of CalculiX (most of it Abaqus reads as well): S6 triangles, forces on nodes, one step a case.

CalculiX makes solids of its shells, with transverse shear: for thin ones the two programs agree as far as that matters.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.errors import InputError
from kshell.export.forces import combined, nodal_forces
from kshell.export.holds import holds
from kshell.export.nodes import Nodes
from kshell.material.materials import Isotropic
from kshell.material.part import Homogeneous
from kshell.mesh.check import is_flat
from kshell.result.saving import write_together
from kshell.scene.cases import load_factors
from kshell.scene.scene import Scene
from kshell.scene.structure import Structure, resolve
from kshell.version import __version__

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

IN_A_ROW = 12
SAFE = set("ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_")


def write_inp(
    scene: Scene, file: str | os.PathLike[str], *, model: str = "auto", allow_system: bool = False
) -> list[str]:
    """Write a scene as an .inp file.

    Parameters
    ----------
    scene : Scene
    file : path
        .inp
    model : "auto", "plate" or "shell"
        Of a plate nothing moves in its plane; "auto": a plate where the mesh is flat and all loads act across it.
    allow_system : bool
        As for `solve`.

    Returns
    -------
    The paths written.

    Raises
    ------
    InputError
        If the scene has what such a file cannot say: materials other than isotropic ones, thicknesses that vary inside
        of triangles, springs, links, own axes, temperatures, initial strains, loads that follow the surface.
    """
    path = Path(file)
    if path.suffix.lower() != ".inp":
        raise InputError(f"{path}: give the file a name that ends in .inp")
    structure = resolve(scene, scene.read_mesh(allow_system))
    text = "\n".join(_lines(scene, structure, _is_plate(structure, model))) + "\n"
    return write_together(path.parent, {path.name: lambda where: where.write_text(text, encoding="utf-8")})


def _is_plate(structure: Structure, model: str) -> bool:
    if model not in ("auto", "plate", "shell"):
        raise InputError(f'model = "{model}": must be "auto", "plate" or "shell"')
    if not is_flat(structure.space.points):
        if model == "plate":
            raise InputError('model = "plate": the mesh does not lie in a plane z = const')
        return False
    across = not any(load.item.stretches(load.places(structure.space)) for load in structure.loads)
    return model == "plate" or (model == "auto" and across)


def _lines(scene: Scene, structure: Structure, plate: bool) -> Iterator[str]:
    nodes = Nodes.of(structure.space)
    yield from ("*HEADING", scene.title or "kshell", f"** written by kshell {__version__}")
    yield "*NODE, NSET=ALL"
    for number, x in enumerate(nodes.points, start=1):
        yield f"{number}, {_numbers(x)}"
    yield "*ELEMENT, TYPE=S6, ELSET=EALL"
    for number, corners in enumerate(nodes.triangles + 1, start=1):
        yield f"{number}, " + ", ".join(map(str, corners))
    for name, group in structure.space.groups.items():
        surface = group.dimension == 2
        yield f"*{'ELSET' if surface else 'NSET'}, {'ELSET' if surface else 'NSET'}={_safe(name)}"
        yield from _listed(group.members if surface else nodes.on(group.dimension, group.members))
    yield from _sections(structure)
    yield "*BOUNDARY"
    moved = []
    for nodes_, freedom, values in holds(structure, nodes, plate):
        moved += [(n, freedom, v) for n, v in zip(nodes_, values, strict=True) if v != 0.0]
        yield from (f"{n + 1}, {freedom}, {freedom}" for n in nodes_)
    forces = nodal_forces(structure, nodes)
    for name, factors in _cases(scene).items():
        yield from _step(name, scene, moved, combined(forces, factors) if forces else np.zeros((0, 6)))


def _cases(scene: Scene) -> dict[str, Sequence[float]]:
    """Factors of the loads, by the name of the step."""
    if scene.cases:
        return {
            name: list(f) for name, f in load_factors(scene.loads, scene.cases, scene.combinations).items()
        }
    return {"all loads": [1.0] * len(scene.loads)}


def _sections(structure: Structure) -> Iterator[str]:
    """Materials and thicknesses: a set of triangles for each pair of them."""
    section = structure.section
    if not section.constant_per_triangle:
        raise InputError("thickness: it varies inside of triangles, which is not written into .inp files")
    thickness = section.thickness_per_triangle
    offset = np.broadcast_to(structure.offset, thickness.shape)
    number = section.part_numbers
    for k, part in enumerate(section.parts):
        material = getattr(part, "material", None)
        if not isinstance(part, Homogeneous) or not isinstance(material, Isotropic):
            raise InputError(f"{part.what}: isotropic materials alone are written into .inp files")
        yield f"*MATERIAL, NAME=M{k + 1}"
        yield from ("*ELASTIC", _numbers([material.E, material.nu]))
        if material.density:
            yield from ("*DENSITY", _numbers([material.density]))
    kinds, which = np.unique(np.stack([number, thickness, offset]), axis=1, return_inverse=True)
    for k, (part_number, t, height) in enumerate(kinds.T):
        yield f"*ELSET, ELSET=SECTION_{k + 1}"
        yield from _listed(np.flatnonzero(which.ravel() == k))
        shift = f", OFFSET={_number(height / t)}" if height else ""
        yield f"*SHELL SECTION, ELSET=SECTION_{k + 1}, MATERIAL=M{int(part_number) + 1}{shift}"
        yield _numbers([t])


def _step(name: str, scene: Scene, moved: Iterable[tuple[int, int, float]], forces: Floats) -> Iterator[str]:
    large = ", NLGEOM" if scene.solve.large_deflection is True else ""
    yield f"*STEP{large}"
    yield f"** {name}"
    yield "*STATIC"
    prescribed = list(moved)
    if prescribed:
        yield "*BOUNDARY"
        yield from (f"{n + 1}, {freedom}, {freedom}, {_number(value)}" for n, freedom, value in prescribed)
    rows, freedoms = np.nonzero(np.abs(forces) > 1e-14 * np.abs(forces).max(initial=0.0))
    yield "*CLOAD, OP=NEW"
    yield from (f"{n + 1}, {k + 1}, {_number(forces[n, k])}" for n, k in zip(rows, freedoms, strict=True))
    yield from ("*NODE FILE, OUTPUT=2D", "U", "*EL FILE", "S")
    yield from ("*NODE PRINT, NSET=ALL, TOTALS=ONLY", "RF", "*END STEP")


def _listed(members: Ints) -> Iterator[str]:
    for start in range(0, len(members), IN_A_ROW):
        yield ", ".join(str(member + 1) for member in members[start : start + IN_A_ROW])


def _numbers(values: Any) -> str:
    return ", ".join(map(_number, values))


def _number(value: float) -> str:
    """At most 20 characters, which is what CalculiX reads of a field: of longer ones it says that they are wrong."""
    return f"{value + 0.0:.13g}"


def _safe(name: str) -> str:
    """A name that such files take: capitals, digits and underscores, not those of kshell's own sets."""
    return "G_" + "".join(c if c in SAFE else "_" for c in name.upper())[:70]
