"""The shell scenes that come with kshell, on their meshes made by gmsh, against the same references."""

from __future__ import annotations

from collections.abc import Iterator

import kshell as ks
from kshell.verify.cases import beams, cylinders, doubly_curved
from kshell.verify.cases.case import TRUE_SURFACE, Case, Run, case
from kshell.verify.cases.unstructured import MESHES

# scene: the case on structured meshes, and the order of the mesh. Flat triangles (degree 1) are left out on charts:
# those of the tube would turn by 30 degrees from one to the next
SCENES = {
    "scordelis_lo": ("shell.scordelis_lo", 2),
    "pinched_cylinder": ("shell.pinched_cylinder.diaphragm", 2),
    "hemisphere": ("shell.hemisphere.full", 2),
    "hemisphere_hole": ("shell.hemisphere.hole", 2),
    "raasch_hook": ("shell.raasch", 2),
    "twisted_beam": ("shell.twisted_beam.across", TRUE_SURFACE),
    "twisted_beam_thin": ("shell.twisted_beam.across.thin", TRUE_SURFACE),
    "hypar": ("shell.hypar.t0.01", 2),
    "hypar_thin": ("shell.hypar.t0.001", 2),
    "tube": ("shell.tube.force", TRUE_SURFACE),
    "sphere_edge": ("shell.sphere.edge", TRUE_SURFACE),
    "pressurised_sphere": ("shell.sphere.pressure.t0.01", 2),
}


# loads of the structured cases where those of the files are smaller
UNIT_LOADS = {
    "tube": 'load.0.value=["x", "y", 0]',
    "sphere_edge": 'load.0.value=["x", "y", 0]',
    "pressurised_sphere": "load.0.value=1.0",
}


def scene(name: str) -> ks.Scene:
    """From its file."""
    changes = ["solve.large_deflection=false"]
    if name in UNIT_LOADS:
        changes.append(UNIT_LOADS[name])
    return ks.Scene.load(MESHES / f"{name}.toml", changes)


def cases() -> Iterator[Case]:
    """All of them."""
    structured = {one.id: one for family in (cylinders, doubly_curved, beams) for one in family.cases()}
    for name, (id, order) in SCENES.items():
        like = structured[id]
        on_chart = order == TRUE_SURFACE
        runs = [Run("koiter", 1, order, degree) for degree in ((2, 3) if on_chart else (1, 2, 3))]
        runs += [Run("argyris", 1, order)] if on_chart else []
        yield case(
            f"gmsh.{name}",
            f"{like.description}, from {name}.toml",
            lambda refinement, order, name=name: scene(name),  # type: ignore[misc]
            like.quantities,
            tuple(runs),
            id,
        )
