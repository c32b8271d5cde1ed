"""Where mesh and thickness meet: flat triangles of a curved shell are curved, if their vertices are good enough."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from kshell.errors import InputError
from kshell.material.section import shell_section
from kshell.mesh.check import is_flat
from kshell.mesh.mesh import Mesh

if TYPE_CHECKING:
    from kshell.scene.scene import Scene


def curved(scene: Scene, mesh: Mesh) -> Mesh:
    """The mesh of a scene, as its key `facets` says.

    Raises
    ------
    InputError
        If `facets` asks for curved triangles where they are curved already.
    """
    if scene.chart is not None or mesh.midpoints is not None:
        if scene.facets == "curved":
            why = (
                "the chart gives its shape" if scene.chart is not None else "it has mid-edge nodes of its own"
            )
            raise InputError(
                f'scene: facets = "curved" is for flat triangles, but {why} ({mesh.source}): leave facets out'
            )
        return mesh
    if is_flat(mesh.points) or mesh.curving is not None:
        return mesh
    from kshell.mesh.curving.decision import curve

    try:
        section = shell_section(mesh, scene.thickness, scene.material, scene.layers)
    except InputError:
        return mesh  # said with all else that is wrong with the section where it is used
    centres = mesh.points[mesh.triangles].mean(axis=1)[:, None]
    thickness = section.thickness(np.arange(len(mesh.triangles)), centres)[:, 0]
    return curve(mesh, thickness, scene.facets, scene.crease)
